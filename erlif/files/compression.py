"""Maps rounded to their significant bits, and compressed as HDF5 stores a chunk."""

from __future__ import annotations

import zlib
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from erlif.core.arrays import AnyArray, Image

_LEVEL = 1  # of zlib: higher ones cost much and gain little on noise


@dataclass(frozen=True)
class MapVariable:
    """A variable (trigger, y, x) that is written trigger by trigger."""

    name: str
    dtype: str
    attrs: Mapping[str, Any]
    bits: int = 23
    """Bits of the mantissa that are kept."""


def round_bits(values: Image, bits: int) -> Image:
    """Round float32 values to `bits` bits of mantissa; the largest relative error is 2**-(bits + 1)."""
    drop = 23 - bits
    if drop <= 0:
        return values
    whole = np.ascontiguousarray(values, np.float32).view(np.uint32)
    rounded = (whole + ((1 << (drop - 1)) - 1) + ((whole >> drop) & 1)) & np.uint32(
        ~((1 << drop) - 1) & 0xFFFFFFFF
    )
    return np.where(np.isfinite(values), rounded.view(np.float32), np.float32(np.nan))


def compress(values: AnyArray) -> bytes:
    """Bytes of an array as HDF5's shuffle and deflate filters write a chunk."""
    data = np.ascontiguousarray(values)
    shuffled = data.view(np.uint8).reshape(-1, data.itemsize).T
    # noise holds no repeats to look for: run lengths and Huffman codes alone are twice as fast and no larger
    deflate = zlib.compressobj(
        _LEVEL, zlib.DEFLATED, zlib.MAX_WBITS, zlib.DEF_MEM_LEVEL, zlib.Z_RLE
    )
    return deflate.compress(np.ascontiguousarray(shuffled).tobytes()) + deflate.flush()


def decompress(chunk: bytes, dtype: str, shape: tuple[int, ...]) -> AnyArray:
    """Reverse of `compress`."""
    item = np.dtype(dtype).itemsize
    planes = np.frombuffer(zlib.decompress(chunk), np.uint8).reshape(item, -1)
    return np.ascontiguousarray(planes.T).view(dtype).reshape(shape)
