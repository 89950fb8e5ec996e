"""Properties that all digital cameras share."""

# Variance of rounding to whole counts, uniform over one count. [DN2]
QUANTISATION_VAR = 1 / 12


def reading_var(read_noise: float, gain: float) -> float:
    """Variance of one count without light.

    Parameters
    ----------
    read_noise : float
        [electron]
    gain : float
        [electron/DN]

    Returns
    -------
    float
        Reading and rounding together. [DN2]

    Examples
    --------
    >>> round(reading_var(8.8, 4.4), 3)
    4.083
    """
    return (read_noise / gain) ** 2 + QUANTISATION_VAR
