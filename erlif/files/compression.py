"""Maps rounded to their significant bits and compressed as HDF5 stores a chunk."""

from __future__ import annotations

import zlib
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from erlif.core.arrays import AnyArray, Image

DEFLATE_LEVEL = 1
"""Level of zlib: higher levels take much longer and gain little on noise."""

MANTISSA_BITS = 23
"""Bits of the mantissa of a float32, the leading one left out."""


@dataclass(frozen=True)
class MapVariable:
    """A variable (trigger, y, x) that is written trigger by trigger.

    Attributes
    ----------
    name : str
        Name in the file.
    dtype : str
        Type in the file, "float32" or "uint8".
    attrs : Mapping[str, Any]
        Attributes in the file, units among them.
    bits : int
        Bits of the mantissa that are kept.
    """

    name: str
    dtype: str
    attrs: Mapping[str, Any]
    bits: int = MANTISSA_BITS


def round_bits(values: Image, bits: int) -> Image:
    """Round to a number of bits of the mantissa, so that the values compress well.

    Parameters
    ----------
    values : array of float32
        Values of a map; their unit does not matter.
    bits : int
        Bits of the mantissa that are kept, 1 to 23.

    Returns
    -------
    array of float32
        Rounded values; the largest relative error is ``2**-(bits + 1)``. Values that are not finite
        become NaN.

    Examples
    --------
    >>> round_bits(np.array([1.0, 1.1, 1.26], np.float32), 2)
    array([1.  , 1.  , 1.25], dtype=float32)
    """
    drop = MANTISSA_BITS - bits
    if drop <= 0:
        return values

    # Rounding half to even on the bits themselves: half a step is added, less one where the last
    # kept bit is 0. A carry runs on into the exponent, as it must.
    whole = np.ascontiguousarray(values, np.float32).view(np.uint32)
    last_kept = (whole >> drop) & 1
    kept = np.uint32(~((1 << drop) - 1) & 0xFFFFFFFF)
    rounded = (whole + ((1 << (drop - 1)) - 1) + last_kept) & kept
    return np.where(np.isfinite(values), rounded.view(np.float32), np.float32(np.nan))


def compress(values: AnyArray) -> bytes:
    """Compress an array as the shuffle and deflate filters of HDF5 write a chunk.

    Parameters
    ----------
    values : array
        Map of any type.

    Returns
    -------
    bytes
        The chunk; `decompress` reverses it.

    Examples
    --------
    >>> len(compress(np.zeros((100, 100), np.float32))) < 40000 / 100
    True
    """
    data = np.ascontiguousarray(values)
    shuffled = data.view(np.uint8).reshape(-1, data.itemsize).T

    # Noise has no repeated sequences: run lengths and Huffman codes alone take half the time and
    # give no larger a file.
    deflate = zlib.compressobj(
        DEFLATE_LEVEL, zlib.DEFLATED, zlib.MAX_WBITS, zlib.DEF_MEM_LEVEL, zlib.Z_RLE
    )
    return deflate.compress(np.ascontiguousarray(shuffled).tobytes()) + deflate.flush()


def decompress(chunk: bytes, dtype: str, shape: tuple[int, ...]) -> AnyArray:
    """Reverse `compress`.

    Parameters
    ----------
    chunk : bytes
        Result of `compress`.
    dtype : str
        Type of the array.
    shape : tuple of int
        Shape of the array.

    Returns
    -------
    array

    Examples
    --------
    >>> values = np.arange(6, dtype=np.float32).reshape(2, 3)
    >>> decompress(compress(values), "float32", (2, 3))
    array([[0., 1., 2.],
           [3., 4., 5.]], dtype=float32)
    """
    itemsize = np.dtype(dtype).itemsize
    planes = np.frombuffer(zlib.decompress(chunk), np.uint8).reshape(itemsize, -1)
    return np.ascontiguousarray(planes.T).view(dtype).reshape(shape)
