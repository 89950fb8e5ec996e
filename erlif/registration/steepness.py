"""Where the light of a frame is too steep to register on."""

from __future__ import annotations

from typing import Final

import cv2
import numpy as np

from erlif.core.arrays import Image, Mask
from erlif.correction.light import BLOCK

LIMIT: Final = 0.04
"""Relative rise over blocks of 8 px above which light is steep. [1/px]"""

DARKEST: Final = 1e-3
"""Light from which on the logarithm is taken; dark blocks are set to it. [counts]"""


def is_steep(
    blocks: Image, shape: tuple[int, int], *, side: int = BLOCK, limit: float = LIMIT
) -> Mask:
    """Find where the film itself makes the light steep, as at the thin end of a wedge.

    There the ratio of the two bands varies as well, so their light rises differently, and a
    registration that took the rise for texture would shift one camera against the other.

    Parameters
    ----------
    blocks : array, (row, column), float32
        Mean light of the blocks of 8 px of one camera; only ratios count.
    shape : tuple of int
        Rows and columns of the image.
    side : int
        Pixels of the image along a block.
    limit : float
        Relative rise above which a block counts as steep. [1/px]

    Returns
    -------
    array of bool, (y, x)
        True on the pixels of steep blocks.

    Examples
    --------
    Exponential light rises everywhere by the same part of itself:

    >>> middle = 8 * np.broadcast_to(np.arange(8, dtype=np.float32), (6, 8))
    >>> bool(is_steep(np.exp(0.06 * middle), (48, 64))[:, 8:-8].all())
    True
    >>> bool(is_steep(np.exp(0.02 * middle), (48, 64)).any())
    False
    """
    level = np.log(np.maximum(blocks, DARKEST))

    # a median over 3 by 3 blocks, so that a single scratch or speck is not taken for the film
    down, along = np.gradient(cv2.medianBlur(level, 3))
    steep = down * down + along * along > (limit * BLOCK) ** 2
    pixels = np.repeat(np.repeat(steep, side, axis=0), side, axis=1)
    return np.asarray(pixels[: shape[0], : shape[1]])
