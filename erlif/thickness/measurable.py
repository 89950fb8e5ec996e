"""The range of film in which a single pixel means something: limits of detection, by its noise and the slope of the calibration.

A pixel of a film so thin that its noise could make it none, or so thick that its noise could make it anything, is no measurement.
Whether it is one must not be decided by its own value: a rule that keeps the pixels whose noise came out small or turned them the
right way leaves a biased rest. So its surroundings decide, without itself, and their noise is many times smaller: their mean ratio has to
lie within the range of the calibration, and from the ends of what the fixture covers by at least two standard deviations of a single
pixel (for a normal error one in 44 is beyond that; Currie, Anal. Chem. 40 (1968) 586, takes 1.645 for one in 20).
"""

from __future__ import annotations

import numpy as np

from erlif.calibration import Calibration
from erlif.core.arrays import FlagImage, Image
from erlif.core.flags import Flag
from erlif.core.neighbourhood import mean_of_surroundings

CLEAR = 2.0
"""Standard deviations of a pixel that its film must keep from the ends of the calibration."""


_AROUND, _OWN = (
    17,
    5,
)  # width of the surroundings that decide, and of their middle that does not [px]


def find_range(
    log_ratio: Image, variance: Image, flags: FlagImage, calibration: Calibration
) -> tuple[Image, FlagImage]:
    """Find where films can be read off pixel by pixel.

    Parameters
    ----------
    log_ratio, variance : array, (y, x)
        With the random variance of a pixel.
    flags : array, (y, x)
        Pixels with a flag count for nothing.
    calibration : Calibration

    Returns
    -------
    surroundings : array, (y, x)
        Mean of the logarithm of the ratio about each pixel.
    beyond : array, (y, x)
        BELOW_RANGE, ABOVE_RANGE, or 0 within the range, by the surroundings.
    """
    sound = flags == 0
    around = mean_of_surroundings(log_ratio, sound, width=_AROUND, without=_OWN)
    margin = np.float32(CLEAR) * np.sqrt(mean_of_surroundings(variance, sound))
    first, last = calibration.predict_log(calibration.thickness_range).astype(np.float32)
    thinnest, thickest = calibration.predict_log(calibration.covered_range).astype(np.float32)
    beyond = np.zeros(flags.shape, np.uint8)
    with np.errstate(invalid="ignore"):
        beyond[(around < first) | (around - margin < thinnest)] = Flag.BELOW_RANGE
        beyond[(around > last) | (around + margin > thickest)] = Flag.ABOVE_RANGE
    return mean_of_surroundings(log_ratio, sound), beyond
