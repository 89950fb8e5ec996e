"""Where the light of a frame is too steep to register on."""

from __future__ import annotations

from typing import Final

import cv2
import numpy as np

from erlif.core.arrays import Image, Mask
from erlif.core.neighbourhood import BLOCK, block_light

LIMIT: Final = 0.04
"""Relative rise over blocks of 8 px above which light is steep. [1/px]"""

DARKEST: Final = 1e-3
"""Light from which on the logarithm is taken; dark blocks are set to it. [counts]"""


def is_steep(signal: Image, *, limit: float = LIMIT) -> Mask:
    """Find where the film itself makes the light steep, as at the thin end of a wedge.

    There the ratio of the two bands varies as well, so their light rises differently, and a
    registration that took the rise for texture would shift one camera against the other.

    Parameters
    ----------
    signal : array, (y, x)
        Light of one camera; NaN where nothing is known.
    limit : float
        Relative rise over blocks of 8 px above which a block counts as steep. [1/px]

    Returns
    -------
    array of bool, (y, x)
        True on the pixels of steep blocks.

    Examples
    --------
    Exponential light rises everywhere by the same part of itself:

    >>> x = np.broadcast_to(np.arange(64, dtype=np.float32), (48, 64))
    >>> bool(is_steep(np.exp(0.06 * x))[:, 8:-8].all())
    True
    >>> bool(is_steep(np.exp(0.02 * x)).any())
    False
    """
    light = np.nan_to_num(block_light(signal, signal, BLOCK))
    steep = steep_blocks(light, limit=limit)
    steep = np.repeat(np.repeat(steep, BLOCK, axis=0), BLOCK, axis=1)
    return np.asarray(steep[: signal.shape[0], : signal.shape[1]])


def steep_blocks(light: Image, *, limit: float = LIMIT) -> Mask:
    """The same for blocks whose mean light is known.

    Parameters
    ----------
    light : array, (row, column), float32
        Mean light of the blocks of 8 px of one camera; only ratios count.
    limit : float
        Relative rise above which a block counts as steep. [1/px]

    Returns
    -------
    array of bool, (row, column)
    """
    blocks = np.log(np.maximum(light, DARKEST))

    # a median over 3 by 3 blocks, so that a single scratch or speck is not taken for the film
    down, along = np.gradient(cv2.medianBlur(blocks, 3))
    return np.asarray(down * down + along * along > (limit * BLOCK) ** 2)
