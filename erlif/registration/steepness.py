"""Where the light of a frame is too steep to register on."""

from __future__ import annotations

import numpy as np
from scipy import ndimage

from erlif.core.arrays import Image, Mask
from erlif.core.neighbourhood import _BLOCK, _block_light


def is_steep(signal: Image, *, limit: float = 0.04) -> Mask:
    """Find where the film itself makes the light steep, as at the thin end of a wedge.

    There the two bands rise differently, because the ratio does, and a registration that took the rise for texture would
    shift one camera against the other.

    Parameters
    ----------
    signal : array, (y, x)
        Light of one camera.
    limit : float
        Relative rise over blocks of 8 px above which a block counts as steep. [1/px]

    Returns
    -------
    array of bool, (y, x)
    """
    blocks = np.log(np.maximum(np.nan_to_num(_block_light(signal, signal, _BLOCK)), 1e-3))
    rise = np.hypot(*np.gradient(ndimage.median_filter(blocks, size=3, mode="nearest"))) / _BLOCK
    steep = np.repeat(np.repeat(rise > limit, _BLOCK, axis=0), _BLOCK, axis=1)
    return np.asarray(steep[: signal.shape[0], : signal.shape[1]])
