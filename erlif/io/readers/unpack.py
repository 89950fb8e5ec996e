"""Counts of 10 and 12 bits that a camera packed without gaps, expanded to 16 bits.

Two pixels of 12 bits take three bytes, four pixels of 10 bits take five. Cameras order the bits in
three ways: the highest bit first (Photron, Phantom, CoaXPress), the lowest bit first (Mono12p and
Mono10p of the GenICam pixel format naming convention), or the high eight bits of each pixel in a
byte of its own and the low bits of two pixels in the byte between (Mono12Packed, Mono10Packed of
GigE Vision). The wrong order raises no error, it yields wrong counts.
"""

from __future__ import annotations

from enum import Enum

import numpy as np

from erlif.core.arrays import AnyArray, Counts


class Packing(Enum):
    """Order of the bits of packed pixels."""

    HIGH_12 = 0  #: 12 bits, the highest first
    LOW_12 = 1  #: 12 bits, the lowest first: Mono12p
    SPLIT_12 = 2  #: 12 bits, the low four of two pixels in a byte between: Mono12Packed
    HIGH_10 = 3  #: 10 bits, the highest first
    LOW_10 = 4  #: 10 bits, the lowest first: Mono10p
    SPLIT_10 = 5  #: 10 bits, the low two of two pixels in a byte between: Mono10Packed

    @property
    def bits(self) -> int:
        """Bits of a pixel."""
        return 10 if self in (Packing.HIGH_10, Packing.LOW_10, Packing.SPLIT_10) else 12

    @property
    def group(self) -> tuple[int, int]:
        """Bytes and pixels of the smallest part that can be decoded by itself."""
        return (5, 4) if self in (Packing.HIGH_10, Packing.LOW_10) else (3, 2)

    def size(self, pixels: int) -> int:
        """Bytes that a number of pixels takes."""
        size, count = self.group
        return -(-pixels * size // count)


_HIGH = (Packing.HIGH_12, Packing.HIGH_10)
_SPLIT = (Packing.SPLIT_12, Packing.SPLIT_10)


def unpack(
    packed: AnyArray, pixels: int, packing: Packing, *, table: Counts | None = None
) -> Counts:
    """Expand packed counts to 16 bits.

    Parameters
    ----------
    packed : array of uint8, (byte,)
        `packing.size(pixels)` bytes or more. Those after them are ignored.
    pixels : int
        Number of counts.
    packing : Packing
        Order of the bits.
    table : array of uint16, (value,), optional
        Counts by packed value, for a camera that compressed them; one for each possible value.

    Returns
    -------
    array of uint16, (pixel,)
        [DN]

    Examples
    --------
    >>> three = np.array([0x12, 0x34, 0x56], np.uint8)
    >>> [hex(count) for count in unpack(three, 2, Packing.HIGH_12)]
    ['0x123', '0x456']
    >>> [hex(count) for count in unpack(three, 2, Packing.LOW_12)]
    ['0x412', '0x563']
    >>> [hex(count) for count in unpack(three, 2, Packing.SPLIT_12)]
    ['0x124', '0x563']
    """
    # whole groups are decoded; what the last of them holds beyond the pixels is cut off
    size, count = packing.group
    groups = -(-pixels // count)
    if packed.size < groups * size:
        packed = np.concatenate([packed, np.zeros(groups * size - packed.size, np.uint8)])
    stored = packed[: groups * size].reshape(groups, size).T.astype(np.uint16)

    bits = packing.bits
    counts = np.empty((groups, count), np.uint16)
    for pixel in range(count):
        byte, bit = divmod(pixel * bits, 8)
        if packing in _SPLIT:
            low = stored[1] >> (4 * pixel) & ((1 << bits - 8) - 1)
            counts[:, pixel] = stored[2 * pixel] << (bits - 8) | low
        elif packing in _HIGH:
            word = stored[byte] << 8 | stored[byte + 1]
            counts[:, pixel] = word >> (16 - bit - bits) & ((1 << bits) - 1)
        else:
            word = stored[byte] | stored[byte + 1] << 8
            counts[:, pixel] = word >> bit & ((1 << bits) - 1)
    image = counts.reshape(-1)[:pixels]
    return image if table is None else table[image]
