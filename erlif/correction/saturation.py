"""The count at which a camera saturates."""

from __future__ import annotations

import cv2
import numpy as np
import numpy.typing as npt

from erlif.core.arrays import Counts

# Pixels by count, (full scale + 1,).
Histogram = npt.NDArray[np.int64]

# Largest whole number up to which single precision holds all.
_EXACT = 1 << 24

# Counts below a pile-up that must each hold few pixels.
_BELOW = 16

# Pixels at the pile-up over those at any of the counts below it, at least.
_STEEP = 5

# Pixels of a pile-up, at least.
_LEAST_PILE = 20

# Pixels at the pile-up over those at all higher counts together, at least.
_ABOVE = 100


def count_pixels(counts: Counts, full_scale: int) -> Histogram:
    """Histogram of an image.

    Parameters
    ----------
    counts : array, (y, x)
        [DN]
    full_scale : int
        Largest possible count. [DN]

    Returns
    -------
    array of int, (full scale + 1,)
        Pixels by count.

    Examples
    --------
    >>> count_pixels(np.array([[0, 2, 2]], np.uint16), 3)
    array([1, 0, 2, 0])
    """
    # OpenCV counts four times as fast; its counts are single precision, exact up to 2^24
    if counts.size <= _EXACT and counts.dtype in (np.uint8, np.uint16):
        bins = max(full_scale, int(counts.max())) + 1
        return cv2.calcHist([counts], [0], None, [bins], [0, bins]).ravel().astype(np.int64)
    return np.bincount(counts.ravel(), minlength=full_scale + 1)


def find_pile_up(histogram: Histogram) -> int | None:
    """Find the count at which a camera saturates below its full scale.

    Saturated pixels pile up at one count: many pixels there, few just below, almost none above.
    Without saturation the histogram thins out towards its highest counts. An image of fewer than
    16 distinct counts is not judged. A camera whose pixels saturate at different counts, as after
    a correction inside the camera, shows no pile-up.

    Parameters
    ----------
    histogram : array of int, (full scale + 1,)
        Pixels by count, of one image or several.

    Returns
    -------
    int or None
        The count, None where there is no pile-up below full scale. [DN]

    Examples
    --------
    >>> histogram = np.zeros(4096, np.int64)
    >>> histogram[1000:3900] = 50
    >>> histogram[3900] = 5000
    >>> find_pile_up(histogram)
    3900
    """
    if np.count_nonzero(histogram) < _BELOW:
        return None

    # a few hot pixels may lie above a pile-up, a tail of the image may not
    above = histogram[::-1].cumsum()[::-1] - histogram
    candidates = np.nonzero((histogram >= _LEAST_PILE) & (_ABOVE * above < histogram))[0]
    # from the top: an evenly bright area further down may have a steep edge too
    for count in candidates[::-1]:
        below = histogram[max(count - _BELOW, 0) : count]
        if _BELOW <= count < histogram.size - 1 and histogram[count] > _STEEP * below.max():
            return int(count)
    return None
