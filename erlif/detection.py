"""The range of film in which a single pixel means something: limits of detection, by its noise and the slope of the calibration.

A pixel of a film so thin that its noise could make it none, or so thick that its noise could make it anything, is no measurement.
Whether it is one must not be decided by its own value: a rule that keeps the pixels whose noise came out small or turned them the
right way leaves a biased rest. So the surroundings decide, whose noise is many times smaller: their mean ratio has to
lie within the range of the calibration, and from the ends of what the fixture covers by at least two standard deviations of a single
pixel (for a normal error one in 44 is beyond that; Currie, Anal. Chem. 40 (1968) 586, takes 1.645 for one in 20).
"""

from __future__ import annotations

import cv2
import numpy as np
import numpy.typing as npt

from erlif.calibration import Calibration
from erlif.core.flags import Flag

Image = npt.NDArray[np.float32]
Mask = npt.NDArray[np.bool_]

CLEAR = 2.0
"""Standard deviations of a pixel that its film must keep from the ends of the calibration."""

_REACH = 9  # width of the surroundings [px]


def mean_of_surroundings(image: Image, sound: Mask) -> Image:
    """Mean of the sound pixels among the 9 x 9 about each pixel; NaN where there are none.

    Parameters
    ----------
    image : array, (y, x)
    sound : array of bool, (y, x)
        Pixels that count.
    """
    # about the middle, because the sums are taken in single precision
    middle = np.float32(np.median(image[sound][::97])) if sound.any() else np.float32(0)
    size = {"ddepth": -1, "ksize": (_REACH, _REACH), "normalize": False, "borderType": cv2.BORDER_CONSTANT}
    total = cv2.boxFilter(np.where(sound, image - middle, np.float32(0)), **size)
    count = cv2.boxFilter(sound.astype(np.float32), **size)
    return np.where(count > 0.5, middle + total / np.maximum(count, 1), np.float32(np.nan))


def find_range(
    log_ratio: Image, variance: Image, flags: npt.NDArray[np.uint8], calibration: Calibration
) -> tuple[Image, npt.NDArray[np.uint8]]:
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
    surroundings = mean_of_surroundings(log_ratio, sound)
    margin = np.float32(CLEAR) * np.sqrt(mean_of_surroundings(variance, sound))
    first, last = calibration.predict_log(calibration.thickness_range).astype(np.float32)
    thinnest, thickest = calibration.predict_log(calibration.covered_range).astype(np.float32)
    beyond = np.zeros(flags.shape, np.uint8)
    with np.errstate(invalid="ignore"):
        beyond[(surroundings < first) | (surroundings - margin < thinnest)] = Flag.BELOW_RANGE
        beyond[(surroundings > last) | (surroundings + margin > thickest)] = Flag.ABOVE_RANGE
    return surroundings, beyond
