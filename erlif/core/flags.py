"""Reasons why a pixel is not valid: one bit each, kept beside the value and never instead of it."""

from enum import IntFlag

import numpy as np

from erlif.core.arrays import FlagImage


class Flag(IntFlag):
    """Reasons why a pixel is not valid. The numbers are fixed by the file format.

    Examples
    --------
    >>> [flag.name for flag in Flag.DIM | Flag.NO_FILM]
    ['DIM', 'NO_FILM']
    """

    SATURATED = 1  #: a camera reads full scale
    DIM = 2  #: a camera has too little light above its dark level for a ratio
    BAD_PIXEL = 4  #: hot, dead or noisy pixel of a camera
    OUTSIDE_OVERLAP = 8  #: seen by one camera only
    BELOW_RANGE = 16  #: film thinner than the calibrated or the measurable range
    ABOVE_RANGE = 32  #: film thicker than the calibrated or the measurable range
    POOR_REGISTRATION = 64  #: the registration is not good enough for a ratio
    NO_FILM = 128  #: bubble or bare wall: the fluorescence of both bands is missing
    FILM_STEP = 256  #: beside a step of the film, which the lenses blur
    MASKED = 512  #: excluded by the settings, as a scratch or a bolt

    @property
    def title(self) -> str:
        """Name of the flag in words."""
        return str(self.name).lower().replace("_", " ")


def count_flags(flags: FlagImage) -> list[int]:
    """Count the valid pixels, then those of each flag.

    Parameters
    ----------
    flags : array, (y, x)
        Bits of `Flag`.

    Returns
    -------
    list of int
        Pixels without a flag, then those with each flag in the order of `Flag`; a pixel may have
        several.

    Examples
    --------
    >>> count_flags(np.array([[0, 0, 1], [3, 2, 2]], np.uint16))[:3]
    [2, 2, 3]
    """
    # most pixels are valid: four of them at once are passed over
    flat = np.ascontiguousarray(flags, np.uint16).reshape(-1)
    whole = flat.size // 4 * 4
    fours = flat[:whole].view(np.uint64)
    some = np.concatenate([fours[fours != 0].view(np.uint16), flat[whole:]])
    flagged = [int(np.count_nonzero(some & np.uint16(flag))) for flag in Flag]
    return [flags.size - int(np.count_nonzero(some)), *flagged]


# CF attributes of every flag variable, made from the table above.
FLAG_ATTRS: dict[str, object] = {
    "long_name": "reasons why this pixel is not valid",
    "units": "1",
    "flag_masks": np.array([flag.value for flag in Flag], np.uint16),
    "flag_meanings": " ".join(str(flag.name).lower() for flag in Flag),
}

# Colours that the colour map of film thickness does not contain. A pixel with several flags has
# the colour of the first.
FLAG_COLOURS = {
    Flag.MASKED: "#8A4FD8",
    Flag.NO_FILM: "#00D5F0",
    Flag.SATURATED: "#FFE600",
    Flag.OUTSIDE_OVERLAP: "#D9D9D9",
    Flag.POOR_REGISTRATION: "#9A9A9A",
    Flag.BAD_PIXEL: "#E4002B",
    Flag.DIM: "#5A5A5A",
    Flag.BELOW_RANGE: "#000000",
    Flag.ABOVE_RANGE: "#FFFFFF",
    Flag.FILM_STEP: "#B5793A",
}


_SMALLEST_SHARE = 5e-5  # share of pixels that rounds to 0.00 %


def describe_share(share: float, sign: str = " %") -> str:
    """Write the share of pixels with a flag to a hundredth of a per cent.

    Parameters
    ----------
    share : float
        From 0 to 1.
    sign : str
        What follows the number.

    Returns
    -------
    str

    Examples
    --------
    >>> describe_share(0.0068), describe_share(2e-6), describe_share(0.0, "%")
    ('0.68 %', 'below 0.01 %', '0.00%')
    """
    if 0 < share < _SMALLEST_SHARE:
        return f"below 0.01{sign}"
    return f"{100 * share:.2f}{sign}"
