"""Counts of 10 and 12 bits that a camera packed without gaps, expanded to 16 bits.

Two pixels of 12 bits take three bytes, four pixels of 10 bits take five. Cameras order the bits in
three ways: the highest bit first (Photron, Phantom, CoaXPress), the lowest bit first (Mono12p and
Mono10p of the GenICam pixel format naming convention), or the high eight bits of each pixel in a
byte of its own and the low bits of two pixels in the byte between (Mono12Packed, Mono10Packed of
GigE Vision). The wrong order raises no error, it yields wrong counts.
"""

from __future__ import annotations

from enum import IntEnum

import numpy as np
from numba import njit

from erlif.core.arrays import AnyArray, Counts


class Packing(IntEnum):
    """Order of the bits of packed pixels."""

    HIGH_12 = 0
    """12 bits, the highest first."""
    LOW_12 = 1
    """12 bits, the lowest first: Mono12p."""
    SPLIT_12 = 2
    """12 bits, the low four of two pixels in a byte between: Mono12Packed."""
    HIGH_10 = 3
    """10 bits, the highest first."""
    LOW_10 = 4
    """10 bits, the lowest first: Mono10p."""
    SPLIT_10 = 5
    """10 bits, the low two of two pixels in a byte between: Mono10Packed."""

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


_NO_TABLE = np.empty(0, np.uint16)


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

    Raises
    ------
    ValueError
        If there are fewer bytes than the pixels take, or fewer counts in the table than values.

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
    if packed.size < packing.size(pixels):
        raise ValueError(f"{pixels} pixels take {packing.size(pixels)} bytes, got {packed.size}")

    if table is not None and table.size < 1 << packing.bits:
        raise ValueError(f"a table of {1 << packing.bits} counts is needed, got {table.size}")

    # the kernel decodes whole groups; what the last of them holds beyond the pixels is cut off
    size, count = packing.group
    groups = -(-pixels // count)
    if packed.size < groups * size:
        packed = np.concatenate([packed, np.zeros(groups * size - packed.size, np.uint8)])
    counts = np.empty(groups * count, np.uint16)
    stream = np.require(packed, np.uint8, ["C", "W"])
    _unpack(stream, counts, int(packing), _NO_TABLE if table is None else table)
    return counts[:pixels]


# one signature, so that one function is compiled for all orders: half a second, once per machine
@njit("void(uint8[::1], uint16[::1], int64, uint16[::1])", nogil=True, cache=True)
def _unpack(packed: AnyArray, counts: Counts, packing: int, table: Counts) -> None:
    """Decode whole groups; branches stand outside the loops, which are vectorised."""
    if packing == 0:  # HIGH_12
        for n in range(counts.size // 2):
            a, b, c = np.uint16(packed[3 * n]), packed[3 * n + 1], packed[3 * n + 2]
            counts[2 * n] = (a << 4) | (b >> 4)
            counts[2 * n + 1] = ((b & 15) << 8) | c
    elif packing == 1:  # LOW_12
        for n in range(counts.size // 2):
            a, b, c = packed[3 * n], packed[3 * n + 1], np.uint16(packed[3 * n + 2])
            counts[2 * n] = ((b & 15) << 8) | a
            counts[2 * n + 1] = (c << 4) | (b >> 4)
    elif packing == 2:  # SPLIT_12
        for n in range(counts.size // 2):
            a, b, c = packed[3 * n], packed[3 * n + 1], packed[3 * n + 2]
            counts[2 * n] = (a << 4) | (b & 15)
            counts[2 * n + 1] = (c << 4) | (b >> 4)
    elif packing == 3:  # HIGH_10
        for n in range(counts.size // 4):
            a, b, c = packed[5 * n], packed[5 * n + 1], packed[5 * n + 2]
            d, e = packed[5 * n + 3], packed[5 * n + 4]
            counts[4 * n] = (a << 2) | (b >> 6)
            counts[4 * n + 1] = ((b & 63) << 4) | (c >> 4)
            counts[4 * n + 2] = ((c & 15) << 6) | (d >> 2)
            counts[4 * n + 3] = ((d & 3) << 8) | e
    elif packing == 4:  # LOW_10
        for n in range(counts.size // 4):
            a, b, c = packed[5 * n], packed[5 * n + 1], packed[5 * n + 2]
            d, e = packed[5 * n + 3], packed[5 * n + 4]
            counts[4 * n] = ((b & 3) << 8) | a
            counts[4 * n + 1] = ((c & 15) << 6) | (b >> 2)
            counts[4 * n + 2] = ((d & 63) << 4) | (c >> 4)
            counts[4 * n + 3] = (e << 2) | (d >> 6)
    else:  # SPLIT_10
        for n in range(counts.size // 2):
            a, b, c = packed[3 * n], packed[3 * n + 1], packed[3 * n + 2]
            counts[2 * n] = (a << 2) | (b & 3)
            counts[2 * n + 1] = (c << 2) | ((b >> 4) & 3)

    if table.size:
        for n in range(counts.size):
            counts[n] = table[counts[n]]
