"""Thickness maps as text in a page: whole steps of a nanometre or more, deflated, base64."""

from __future__ import annotations

import base64
import math
import zlib
from dataclasses import dataclass

import numpy as np
import xarray as xr

from erlif.core.arrays import Array, FlagImage

_BLOCK = 4  # pixels on a side that share one pair of standard deviations
_LEAST_STD = 1e-4  # um, the standard deviation of code 1
_PER_OCTAVE = 12  # codes for a factor of two: the standard deviation is kept to 3 %
_BUDGET = 11e6  # characters of the page for all maps
_PER_PIXEL = 2.2  # characters that a pixel takes


@dataclass(frozen=True)
class MapCoding:
    """How the maps of a film are written.

    Attributes
    ----------
    stride : int
        Every stride-th pixel along x and y is kept.
    step : float
        Thickness of one count. [um]
    """

    stride: int
    step: float


@dataclass(frozen=True)
class DecodedMap:
    """What a page holds of one trigger: thickness [um], NaN where flagged; flags; standard deviations of blocks [um]."""

    thickness: Array
    flags: FlagImage
    std: Array
    std_shared: Array


def choose_coding(film: xr.Dataset, *, thickest: float) -> MapCoding:
    """Keep every pixel if the page allows it, and steps of 1 nm if 16 bits reach `thickest` [um]."""
    pixels = film.sizes["trigger"] * film.sizes["y"] * film.sizes["x"]
    stride = max(1, math.ceil(math.sqrt(pixels * _PER_PIXEL / _BUDGET)))
    return MapCoding(stride, 1e-3 * max(1, math.ceil(thickest / 65.0)))


def embed_map(film: xr.Dataset, *, trigger: int, coding: MapCoding) -> str:
    """Write the map of one trigger as base64 text.

    The bytes under it, deflated: high bytes of the thickness counts of all pixels, their low bytes, the flags, then for blocks
    of 4 x 4 kept pixels one byte for the random and one for the shared standard deviation (median of the valid pixels;
    0 where there are none, else 1 + 12 log2(std / 0.1 nm)).
    """
    one = film[["thickness", "thickness_std", "thickness_std_shared", "flags"]].isel(
        trigger=trigger, y=slice(None, None, coding.stride), x=slice(None, None, coding.stride)
    )
    flags = one.flags.values.astype(np.uint8)
    good = flags == 0
    counts = np.zeros(flags.shape, np.uint16)
    counts[good] = np.clip(np.rint(one.thickness.values[good] / coding.step), 0, 65535).astype(
        np.uint16
    )
    planes = [(counts >> 8).astype(np.uint8), (counts & 255).astype(np.uint8), flags]
    planes += [
        _encode_std(np.where(good, one[name].values, np.nan))
        for name in ("thickness_std", "thickness_std_shared")
    ]
    packed = zlib.compress(b"".join(plane.tobytes() for plane in planes), 9)
    return base64.b64encode(packed).decode("ascii")


def _encode_std(std: Array) -> FlagImage:
    median = _block_median(std)
    with np.errstate(divide="ignore", invalid="ignore"):
        code = 1 + np.rint(_PER_OCTAVE * np.log2(median / _LEAST_STD))
    return np.where(np.isfinite(code), np.clip(code, 1, 255), 0).astype(np.uint8)


def _block_median(values: Array) -> Array:
    rows, columns = block_shape((values.shape[0], values.shape[1]))
    padded = np.full((rows * _BLOCK, columns * _BLOCK), np.nan)
    padded[: values.shape[0], : values.shape[1]] = values
    blocks = (
        padded.reshape(rows, _BLOCK, columns, _BLOCK)
        .transpose(0, 2, 1, 3)
        .reshape(rows, columns, -1)
    )
    ordered = np.sort(blocks, axis=-1)  # NaN last
    valid = np.isfinite(blocks).sum(axis=-1)
    middle = np.maximum(valid - 1, 0) // 2
    return np.asarray(np.take_along_axis(ordered, middle[..., None], axis=-1)[..., 0])


def block_shape(shape: tuple[int, int]) -> tuple[int, int]:
    """Rows and columns of the blocks of a map of this shape."""
    return -(-shape[0] // _BLOCK), -(-shape[1] // _BLOCK)


def decode_map(text: str, *, shape: tuple[int, int], coding: MapCoding) -> DecodedMap:
    """Read what `embed_map` wrote, as the page's own reader does.

    Parameters
    ----------
    text : str
        Base64.
    shape : (rows, columns)
        Of the kept pixels.
    coding : MapCoding
    """
    data = np.frombuffer(zlib.decompress(base64.b64decode(text)), np.uint8)
    pixels, blocks = shape[0] * shape[1], block_shape(shape)
    high, low, flags = (data[n * pixels : (n + 1) * pixels].reshape(shape) for n in range(3))
    codes = data[3 * pixels :].reshape(2, *blocks).astype(float)
    std = np.where(codes > 0, _LEAST_STD * 2 ** ((codes - 1) / _PER_OCTAVE), np.nan)
    thickness = np.where(flags == 0, (high.astype(float) * 256 + low) * coding.step, np.nan)
    return DecodedMap(thickness, flags, std[0], std[1])


def describe_coding(coding: MapCoding) -> dict[str, float]:
    """What the page's reader needs to know."""
    return {
        "stride": coding.stride,
        "step": coding.step,
        "block": _BLOCK,
        "leastStd": _LEAST_STD,
        "perOctave": _PER_OCTAVE,
    }
