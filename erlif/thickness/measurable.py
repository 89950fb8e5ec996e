"""The range of film thickness that a single pixel can measure, by its noise and the calibration.

A pixel is outside the measurable range where its noise could make the film zero, or arbitrarily
thick. Its own value must not decide this: pixels selected by their noise leave a biased mean. The
surroundings decide, without the pixel itself, and their noise is many times smaller. Their mean
ratio must lie within the calibrated range, and two standard deviations of a single pixel from the
ends of what the fixture covers. A normal error exceeds this once in 44; Currie (1968) takes 1.645,
once in 20.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from erlif.calibration import Calibration
from erlif.core.arrays import FlagImage, Image
from erlif.core.flags import Flag
from erlif.core.neighbourhood import mean_of_surroundings

CLEAR = 2.0
"""Distance of a measurable film from the ends of the calibration. [std of a pixel]"""

_AROUND = 17
"""Width of the surroundings that decide. [px]"""

_OWN = 5
"""Width of their middle, which is left out: interpolation correlates the noise there. [px]"""


class MeasurableRange(NamedTuple):
    """Mean ratio about each pixel, and where it lies beyond the measurable range.

    Attributes
    ----------
    surroundings : Image
        Mean of log_ratio about each pixel, (y, x). [1]
    beyond : FlagImage
        BELOW_RANGE, ABOVE_RANGE, or 0 within the range, (y, x).
    """

    surroundings: Image
    beyond: FlagImage


def find_range(
    log_ratio: Image, variance: Image, flags: FlagImage, calibration: Calibration
) -> MeasurableRange:
    """Find where single pixels can measure the film.

    Parameters
    ----------
    log_ratio : array, (y, x)
        Logarithm of camera 2 over camera 1. [1]
    variance : array, (y, x)
        Its variance by the noise of a pixel. [1]
    flags : array, (y, x)
        Pixels with a flag are left out.
    calibration : Calibration

    Returns
    -------
    MeasurableRange

    Examples
    --------
    Films of 0.5, 4 and 30 um against a calibration from 1 to 12 um:

    >>> import xarray as xr
    >>> calibration = Calibration(
    ...     0.65, 0.40, 0.25, 1e-8 * np.eye(3), (1.0, 12.0), (580.0, 610.0), xr.Dataset(), 1.0, ""
    ... )
    >>> film = np.repeat([0.5, 4.0, 30.0], 32) * np.ones((32, 1))
    >>> log_ratio = calibration.predict_log(film).astype(np.float32)
    >>> flags = np.zeros(film.shape, np.uint8)
    >>> found = find_range(log_ratio, np.full_like(log_ratio, 1e-6), flags, calibration)
    >>> [Flag(int(bits)).name or "valid" for bits in found.beyond[16, [16, 48, 80]]]
    ['BELOW_RANGE', 'valid', 'ABOVE_RANGE']
    """
    sound = flags == 0
    around = mean_of_surroundings(log_ratio, sound, width=_AROUND, without=_OWN)
    margin = np.float32(CLEAR) * np.sqrt(mean_of_surroundings(variance, sound))

    # the calibrated range, and the wider one that the fixture covers
    first, last = calibration.predict_log(calibration.thickness_range).astype(np.float32)
    thinnest, thickest = calibration.predict_log(calibration.covered_range).astype(np.float32)

    beyond = np.zeros(flags.shape, np.uint8)
    with np.errstate(invalid="ignore"):
        beyond[(around < first) | (around - margin < thinnest)] = Flag.BELOW_RANGE
        beyond[(around > last) | (around + margin > thickest)] = Flag.ABOVE_RANGE
    return MeasurableRange(mean_of_surroundings(log_ratio, sound), beyond)
