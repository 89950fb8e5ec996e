"""Film over the roughness of both surfaces, and the regimes of lubrication that it ranges in."""

import numpy as np

from erlif.core.errors import ModelError
from erlif.models.arguments import Values, formula
from erlif.models.contact.roots import like

# Ranges of the film parameter, overlapping as printed in Farzaneh (2002), section 2.2.2.
LUBRICATION_REGIMES = {
    "hydrodynamic": (5.0, 100.0),
    "elastohydrodynamic": (3.0, 10.0),
    "partial": (1.0, 5.0),
    "boundary": (0.0, 1.0),
}


@formula(film="film or zero")
def film_parameter(film: Values, *, roughness_a: Values, roughness_b: Values) -> Values:
    """Film thickness over combined roughness: Lambda = h / sqrt(Ra^2 + Rb^2).

    Farzaneh (2002), eq. 2.7.

    Parameters
    ----------
    film, roughness_a, roughness_b : float or array
        Minimum film thickness h [m], root-mean-square roughness of the two surfaces, not negative
        and not both zero [m].

    Returns
    -------
    float or array
        Film parameter Lambda, see `lubrication_regimes`. [1]

    Raises
    ------
    ModelError
        A negative or infinite value, or two surfaces without roughness.

    Notes
    -----
    The thesis prints 1.52e-6, metres divided by micrometres; its 0.54 um with 0.25 um on each
    surface gives 1.53, partial lubrication by its own list and not boundary lubrication. Its
    footnote defines the root mean square and calls it R_a.

    Examples
    --------
    >>> round(film_parameter(0.54e-6, roughness_a=0.25e-6, roughness_b=0.25e-6), 2)
    1.53
    """

    # smooth surfaces leave the parameter undefined
    combined = np.sqrt(roughness_a**2 + roughness_b**2)
    if np.any(np.equal(combined, 0)):
        raise ModelError("roughness_a and roughness_b must not both be zero.")
    return film / combined


@formula(film_parameter="number or zero")
def lubrication_regimes(film_parameter: Values) -> Values:
    """List the regimes of `LUBRICATION_REGIMES` whose range contains a film parameter.

    The ranges overlap, as printed in Farzaneh (2002), section 2.2.2. A range contains its lower end
    and not its upper one.

    Parameters
    ----------
    film_parameter : float or array
        Film parameter Lambda. [1]

    Returns
    -------
    tuple of str, or array of tuples
        Names of the regimes, in the order of the table; empty above 100 and for NaN.

    Examples
    --------
    >>> lubrication_regimes(1.52)
    ('partial',)
    >>> lubrication_regimes(7.0)
    ('hydrodynamic', 'elastohydrodynamic')
    """
    # numpy would make a table of tuples of equal length, so the array is filled one by one
    flat = np.ravel(np.asarray(film_parameter))
    regimes = np.empty(flat.size, object)
    for i, value in enumerate(flat):
        regimes[i] = tuple(
            name for name, (low, high) in LUBRICATION_REGIMES.items() if low <= value < high
        )

    return like(film_parameter, regimes.reshape(np.shape(film_parameter)))
