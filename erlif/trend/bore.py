"""The shape of a bore along its axis, as the camera sees it: lobes, edges, a measured profile.

The gap is that of a straight bore and the shape. The film of a lobe changes within a block of
pixels by more than its log ratio is straight, so that a fit needs the shape at several places of
each block.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from erlif.core.arrays import Array
from erlif.trend.block_fit import BlockMeans
from erlif.trend.blocks import BLOCK


@dataclass(frozen=True, eq=False)
class AxialShape:
    """Height that a bore adds to its gap, along the axis.

    Attributes
    ----------
    place : Array
        Rising places along the axis, from the first pixel, (point,). [mm]
    height : Array
        Height there, linear between, (point,). [um]
    pitch : float
        Size of a pixel. [mm]
    """

    place: Array
    height: Array
    pitch: float

    def at(self, place: Array | float) -> Array:
        """Height at places along the axis from the first pixel [mm]. [um]"""
        return np.asarray(np.interp(place, self.place, self.height))

    def within(self, pixels: slice, position: Array) -> Array:
        """Height at positions from -1 to 1 over some pixels along the axis. [um]

        Parameters
        ----------
        pixels : slice
            Of the region.
        position : array

        Returns
        -------
        array
            Like position.
        """
        first, last = pixels.start, pixels.stop - 1
        return self.at(0.5 * self.pitch * (first + last + (last - first) * position))

    def in_blocks(self, blocks: BlockMeans, pixels: slice) -> Array:
        """Height at places that have the mean and the width of each block, (place, block). [um]

        Parameters
        ----------
        blocks : BlockMeans
        pixels : slice
            Of the region, along the axis.

        Returns
        -------
        array

        Examples
        --------
        The eight rows of a block without flags have their own places:

        >>> row = np.arange(8) / 31.5 - 1
        >>> one = np.array([row.mean()])
        >>> zero, strip = np.zeros(1), np.zeros(1, int)
        >>> squared = np.array([(row**2).mean()])
        >>> block = BlockMeans(zero, zero, zero, zero, one, squared, strip, strip)
        >>> slope = AxialShape(np.array([0.0, 6.3]), np.array([0.0, 63.0]), pitch=0.1)
        >>> slope.in_blocks(block, slice(0, 64)).ravel().round(6)
        array([0., 1., 2., 3., 4., 5., 6., 7.])
        """
        places = np.arange(BLOCK) - 0.5 * (BLOCK - 1)
        width = np.sqrt(np.maximum(blocks.across_squared - blocks.across**2, 0.0))
        return self.within(pixels, blocks.across + width * (places / places.std())[:, np.newaxis])
