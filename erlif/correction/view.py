"""The mean of some frames of a camera, as far as darks and flats are compared with it."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from erlif.core.arrays import AnyArray, Array, Image

# Blocks along each axis of the image in which large-scale light is compared.
BLOCKS = 8

# Largest side of the window about the middle that is kept pixel by pixel. [px]
_SIDE = 512


def mean_of_blocks(image: AnyArray) -> Array:
    """Mean of an image in `BLOCKS` x `BLOCKS` blocks, (row, column)."""
    return np.asarray(cv2.resize(image, (BLOCKS, BLOCKS), interpolation=cv2.INTER_AREA), float)


@dataclass(frozen=True)
class FrameView:
    """Mean counts of some frames, dark not subtracted.

    Attributes
    ----------
    window : tuple[slice, slice]
        Rows and columns about the middle that are kept pixel by pixel.
    centre : Image
        Mean counts there, (y, x). [DN]
    blocks : Array
        Mean counts of the whole frame in blocks, (row, column). [DN]
    """

    window: tuple[slice, slice]
    centre: Image
    blocks: Array


class ViewSum:
    """Sum of frames, from which their view follows.

    Parameters
    ----------
    shape : (rows, columns)
        [px]

    Examples
    --------
    >>> total = ViewSum((64, 96))
    >>> total.add(np.full((64, 96), 7, np.uint16))
    >>> view = total.mean()
    >>> view.centre.shape, float(view.blocks[0, 0])
    ((64, 96), 7.0)
    """

    def __init__(self, shape: tuple[int, int]) -> None:
        rows, columns = (self._middle(side) for side in shape)
        self.window = rows, columns
        self.count = 0
        self._centre = np.zeros((rows.stop - rows.start, columns.stop - columns.start), np.float32)
        self._blocks = np.zeros((BLOCKS, BLOCKS))

    @staticmethod
    def _middle(side: int) -> slice:
        start = max(side - _SIDE, 0) // 2
        return slice(start, start + min(side, _SIDE))

    def add(self, counts: AnyArray) -> None:
        """Add the counts of a frame (y, x)."""
        self.count += 1
        self._centre += counts[self.window]
        self._blocks += mean_of_blocks(counts)

    def mean(self) -> FrameView:
        """Mean of the added frames."""
        count = max(self.count, 1)
        centre = (self._centre / count).astype(np.float32, copy=False)
        return FrameView(self.window, centre, self._blocks / count)
