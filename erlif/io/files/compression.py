"""Maps rounded to their significant bits and compressed as chunks of HDF5 or zarr."""

from __future__ import annotations

import zlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import ModuleType
from typing import Any, Final

import numpy as np

from erlif.core.arrays import AnyArray, Image
from erlif.core.speed.kernels import njit

isal_zlib: ModuleType | None
try:
    from isal import isal_zlib
except ImportError:  # no wheel for this processor; zlib gives the same maps in other bytes
    isal_zlib = None

# CRC-32 of a chunk; that of isal is the same number in a tenth of the time.
checksum: Callable[[bytes], int] = zlib.crc32 if isal_zlib is None else isal_zlib.crc32

# Level of deflate: higher levels take longer and gain nothing on noise (docs/performance.md).
DEFLATE_LEVEL = 1

# Codec of zarr, with bitshuffle; zstd takes three times as long for 10 % (docs/performance.md).
BLOSC_CODEC: Final = "lz4"

# Its level, 1 to 9; others differ little.
BLOSC_LEVEL = 5

# Bits of the mantissa of a float32, the leading one left out.
MANTISSA_BITS = 23

# Largest rounding error over the standard deviation; adds at most 0.3 % to the variance.
SHARE_OF_STD = 0.1

# Bits of the exponent of a float32: alone they are a power of two.
_EXPONENT = np.uint32(0x7F800000)

# Exponent, 2^103, beyond which the sum in `_round_one` would overflow.
_LARGEST_STEP = np.uint32(0x73000000)

# A float32 of this many steps has one step as its last bit, half a binade to either side.
_UNIT_TO_SUM = np.float32(1.5 * 2**MANTISSA_BITS)


@dataclass(frozen=True)
class MapVariable:
    """A variable (trigger, y, x) that is written trigger by trigger.

    Attributes
    ----------
    name : str
        Name in the file.
    dtype : str
        Type in the file, "float32" or "uint16".
    attrs : Mapping[str, Any]
        Attributes in the file, units among them.
    bits : int
        Bits of the mantissa that are kept, where `std` is empty.
    std : str
        Map with the standard deviation of this one: the rounding error of each pixel is at most a
        tenth of it. Empty: `bits` are kept.
    """

    name: str
    dtype: str
    attrs: Mapping[str, Any]
    bits: int = MANTISSA_BITS
    std: str = ""


def round_map(values: Image, scale: Image, factor: float) -> Image:
    """Round every pixel to a multiple of a power of two, so that a map compresses well.

    Halves go to the even multiple, so that rounding shifts no mean.

    Parameters
    ----------
    values : array of float32
        Values of a map; their unit does not matter.
    scale : array of float32
        Like `values`. The step is the largest power of two up to ``factor * scale``, but never
        larger than the value.
    factor : float
        0.2 with a standard deviation as `scale` keeps the error within a tenth of it; ``2**-b``
        with the values themselves keeps b bits of the mantissa.

    Returns
    -------
    array of float32
        Rounded values. Values that are not finite become NaN; where `scale` is not finite or zero,
        the value stays as it is.

    Examples
    --------
    >>> values = np.array([5.03, 5.03, np.nan], np.float32)
    >>> round_map(values, np.array([0.4, 40.0, 0.4], np.float32), 0.2)
    array([ 5.,  4., nan], dtype=float32)
    """
    rounded = np.empty(np.shape(values), np.float32)
    _round(_flat(values), _flat(scale), np.float32(factor), rounded.reshape(-1))
    return rounded


def encode_netcdf(
    maps: Mapping[str, AnyArray], variables: Sequence[MapVariable]
) -> dict[str, bytes]:
    """Round and compress the maps of one trigger as the filters of HDF5 write a chunk.

    Parameters
    ----------
    maps : mapping of str to array, (y, x)
        Map of each variable by its name.
    variables : sequence of MapVariable
        Type and precision of the maps.

    Returns
    -------
    dict of str to bytes
        Chunk of each variable, shuffled and deflated.

    Examples
    --------
    >>> variables = [MapVariable("flags", "uint16", {})]
    >>> chunk = encode_netcdf({"flags": np.ones((100, 100), np.uint16)}, variables)["flags"]
    >>> len(chunk) < 200, zlib.decompress(chunk)[9_999:10_001] == bytes([1, 0])
    (True, True)
    """
    chunks = {}
    shuffled: AnyArray | None = None  # one for all maps: fresh memory costs as much as rounding
    for variable in variables:
        values = np.ascontiguousarray(maps[variable.name], variable.dtype)
        if variable.dtype == "float32":
            scale, factor = _precision(maps, variable)
            if shuffled is None or shuffled.size != 4 * values.size:
                shuffled = np.empty((4, values.size), np.uint8)
            planes = shuffled
            _round_and_shuffle(_flat(values), _flat(scale), np.float32(factor), planes)
        else:
            planes = np.stack([values & 0xFF, values >> 8]).astype(np.uint8)  # low bytes first
        chunks[variable.name] = deflate(planes)
    return chunks


def encode_zarr(maps: Mapping[str, AnyArray], variables: Sequence[MapVariable]) -> dict[str, bytes]:
    """Round and compress the maps of one trigger as the blosc codec of zarr writes a chunk.

    Arguments as in `encode_netcdf`.

    Returns
    -------
    dict of str to bytes
        Chunk of each variable.

    Examples
    --------
    >>> variables = [MapVariable("flags", "uint16", {})]
    >>> chunk = encode_zarr({"flags": np.ones((100, 100), np.uint16)}, variables)["flags"]
    >>> len(chunk) < 500
    True
    """
    from numcodecs import blosc

    # threads of blosc write the blocks of a chunk in any order; one thread gives the same bytes
    # every time (zarr sets the same)
    blosc.use_threads = False
    codec = blosc.Blosc(BLOSC_CODEC, BLOSC_LEVEL, blosc.BITSHUFFLE)

    chunks = {}
    for variable in variables:
        values = np.ascontiguousarray(maps[variable.name], variable.dtype)
        if variable.dtype == "float32":
            values = round_map(values, *_precision(maps, variable))
        chunks[variable.name] = bytes(codec.encode(values))
    return chunks


def deflate(planes: AnyArray) -> bytes:
    """Compress bytes with deflate, in the format of zlib.

    Parameters
    ----------
    planes : array of uint8
        Bytes in the order in which they are stored.

    Returns
    -------
    bytes
        ``zlib.decompress`` reverses it. The same bytes on every machine of one kind of processor.

    Examples
    --------
    >>> zlib.decompress(deflate(np.arange(4, dtype=np.uint8)))
    b'\\x00\\x01\\x02\\x03'
    """
    if isal_zlib is not None:
        return bytes(isal_zlib.compress(planes.data, DEFLATE_LEVEL))

    # noise has no repeated sequences: run lengths and Huffman codes alone take half the time
    stream = zlib.compressobj(
        DEFLATE_LEVEL, zlib.DEFLATED, zlib.MAX_WBITS, zlib.DEF_MEM_LEVEL, zlib.Z_RLE
    )
    return stream.compress(planes.data) + stream.flush()


def _precision(maps: Mapping[str, AnyArray], variable: MapVariable) -> tuple[Image, float]:
    """Scale and factor of `round_map` for a variable."""
    if variable.std:
        return maps[variable.std], 2 * SHARE_OF_STD  # the error is up to half a step
    return maps[variable.name], 2.0**-variable.bits


def _flat(values: AnyArray) -> Image:
    return np.ascontiguousarray(values, np.float32).reshape(-1)


@njit(nogil=True, cache=True)
def _round_one(value, scale, factor):  # type: ignore[no-untyped-def]
    """A value rounded as in `round_map`."""
    own = np.float32(value).view(np.uint32) & _EXPONENT
    wanted = np.float32(scale * factor).view(np.uint32) & _EXPONENT
    step = min(own, wanted)
    if wanted == _EXPONENT or step > _LARGEST_STEP:
        step = np.uint32(0)

    # The sum has one step as its last bit, so the addition itself rounds, halves to even. A value
    # of more steps than a float32 resolves is left alone.
    large = np.uint32(step).view(np.float32) * _UNIT_TO_SUM
    rounded = np.float32(value + large) - large
    if not np.abs(value) < np.float32(0.25) * large:
        rounded = value
    return rounded if np.abs(value) < np.float32(np.inf) else np.float32(np.nan)


@njit(nogil=True, cache=True)
def _round(values, scale, factor, rounded):  # type: ignore[no-untyped-def]
    """Fill `rounded`; see `round_map`."""
    for i in range(values.size):
        rounded[i] = _round_one(values[i], scale[i], factor)


@njit(nogil=True, cache=True)
def _round_and_shuffle(values, scale, factor, planes):  # type: ignore[no-untyped-def]
    """Round, and write the bytes of the values as planes, the lowest byte first."""
    for i in range(values.size):
        bits = np.float32(_round_one(values[i], scale[i], factor)).view(np.uint32)
        planes[0, i] = np.uint8(bits)
        planes[1, i] = np.uint8(bits >> np.uint32(8))
        planes[2, i] = np.uint8(bits >> np.uint32(16))
        planes[3, i] = np.uint8(bits >> np.uint32(24))
