"""Why a pixel is doubtful: one bit per reason, kept beside the value and never instead of it."""

from enum import IntFlag

import numpy as np


class Flag(IntFlag):
    """Reasons not to answer at a pixel. The numbers are fixed by the file format."""

    SATURATED = 1
    """A camera read full scale."""
    DIM = 2
    """A camera saw too little light above its dark level for a ratio to mean anything."""
    BAD_PIXEL = 4
    """Hot, dead or noisy pixel of a camera."""
    OUTSIDE_OVERLAP = 8
    """Seen by one camera only."""
    BELOW_RANGE = 16
    """Film too thin: below the calibration, or not told from none by a single pixel in this light."""
    ABOVE_RANGE = 32
    """Film too thick: above the calibration, or where the ratio of a single pixel in this light tells little more."""
    POOR_REGISTRATION = 64
    """The cameras are not laid over each other well enough here."""
    NO_FILM = 128
    """Bubble or bare wall: the fluorescence of both bands is missing."""


FLAG_ATTRS: dict[str, object] = {
    "long_name": "reasons not to answer at this pixel",
    "units": "1",
    "flag_masks": np.array([flag.value for flag in Flag], np.uint8),
    "flag_meanings": " ".join(str(flag.name).lower() for flag in Flag),
}
"""CF attributes of every flag variable, made from the one table above."""
