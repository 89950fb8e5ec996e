"""Thickness maps as text in a page: counts of a nanometre or more, deflated, in base64."""

from __future__ import annotations

import base64
import math
import zlib
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import xarray as xr

from erlif.core.arrays import Array, Image

_BLOCK = 4  # pixels on a side that share one pair of standard deviations
_LEAST_STD = 1e-4  # um, the standard deviation of code 1
_PER_OCTAVE = 12  # codes for a factor of two: standard deviations are kept to 3 %
_FINEST_STEP = 1e-3  # um
_FULL_SCALE = 65535  # counts of 16 bits
_REACH = 65.0  # um of the finest step that 16 bits reach, with some room
_WANTED = 50  # triggers that are kept before pixels are
_SAMPLED = 3  # maps whose size stands for that of all
_ROUNDED = 0.05  # of the random standard deviation of a pixel, the coarsest step of its thickness
_AROUND = 300  # characters of the element around a map, and of the numbers of its trigger
_MARGIN = 1.05  # of the mean size of the sampled maps
_FEWEST = 32  # pixels along the longer side of the smallest map


@dataclass(frozen=True)
class MapCoding:
    """Coding of the maps of a film: kept pixels and thickness of one count.

    Attributes
    ----------
    stride : int
        Every stride-th pixel along x and y is kept. [px]
    step : float
        Film thickness of one count. [um]
    """

    stride: int
    step: float


def finest_coding(thickest: float) -> MapCoding:
    """Keep every pixel, in steps of 1 nm if 16 bits reach `thickest` [um]."""
    return MapCoding(1, _FINEST_STEP * max(1, math.ceil(thickest / _REACH)))


def embed_map(
    film: xr.Dataset, *, trigger: int, coding: MapCoding, predicted: Array | Image | None = None
) -> str:
    """Write the map of one trigger as base64 text.

    The deflated bytes are: high bytes of the thickness counts of all pixels, low bytes, flags, then
    for blocks of 4 x 4 kept pixels one byte for the random and one for the shared standard
    deviation (median of the valid pixels; 0 without any, else 1 + 12 log2(std / 0.1 nm)), and with
    a prediction high and low bytes of its counts (65535 where there is none).

    Parameters
    ----------
    film : xarray.Dataset
        As `erlif.process` returns it.
    trigger : int
        Number of the trigger, counted from 0.
    coding : MapCoding
        Kept pixels, and the thickness of one count.
    predicted : array, (y, x), optional
        The predicted film at all pixels. [um]

    Returns
    -------
    str
        Base64.
    """
    # one selection for all variables, so that they stay on one grid
    one = film[["thickness", "thickness_std", "thickness_std_shared", "flags"]].isel(
        trigger=trigger, y=slice(None, None, coding.stride), x=slice(None, None, coding.stride)
    )
    flags = one.flags.values.astype(np.uint16)
    valid = flags == 0

    counts = np.zeros(flags.shape, np.uint16)
    whole = np.rint(one.thickness.values[valid] / coding.step)
    counts[valid] = np.clip(whole, 0, _FULL_SCALE).astype(np.uint16)

    # bytes of one kind follow each other, because the high ones hardly change and deflate well
    planes = [*_split_bytes(counts), *_split_bytes(flags)]
    planes += [
        _encode_std(np.where(valid, one[name].values, np.nan))
        for name in ("thickness_std", "thickness_std_shared")
    ]
    if predicted is not None:
        kept = predicted[:: coding.stride, :: coding.stride]
        # NaN compares as false
        known = (kept >= 0) & (kept < _FULL_SCALE * coding.step)
        whole = np.rint(np.where(known, kept, 0.0) / coding.step)
        planes += _split_bytes(np.where(known, whole, _FULL_SCALE).astype(np.uint16))
    packed = zlib.compress(b"".join(plane.tobytes() for plane in planes), 9)
    return base64.b64encode(packed).decode("ascii")


def _split_bytes(counts: npt.NDArray[np.uint16]) -> list[npt.NDArray[np.uint8]]:
    """High and low bytes."""
    return [(counts >> 8).astype(np.uint8), (counts & 255).astype(np.uint8)]


def _encode_std(std: Array) -> npt.NDArray[np.uint8]:
    """Codes of the blocks, on a logarithmic scale."""
    # 0 stands for a block without valid pixels
    median = _block_median(std)
    with np.errstate(divide="ignore", invalid="ignore"):
        code = 1 + np.rint(_PER_OCTAVE * np.log2(median / _LEAST_STD))
    return np.where(np.isfinite(code), np.clip(code, 1, 255), 0).astype(np.uint8)


def _block_median(values: Array) -> Array:
    """Lower median of the finite values of each block, NaN without any."""
    rows, columns = block_shape((values.shape[0], values.shape[1]))
    padded = np.full((rows * _BLOCK, columns * _BLOCK), np.nan)
    padded[: values.shape[0], : values.shape[1]] = values
    tiles = padded.reshape(rows, _BLOCK, columns, _BLOCK).transpose(0, 2, 1, 3)
    blocks = tiles.reshape(rows, columns, -1)

    # sorting puts NaN last, so that the middle of the finite values has a known place
    ordered = np.sort(blocks, axis=-1)
    finite = np.isfinite(blocks).sum(axis=-1)
    middle = np.maximum(finite - 1, 0) // 2
    return np.asarray(np.take_along_axis(ordered, middle[..., None], axis=-1)[..., 0])


def block_shape(shape: tuple[int, int]) -> tuple[int, int]:
    """Rows and columns of the blocks of a map of this shape."""
    return -(-shape[0] // _BLOCK), -(-shape[1] // _BLOCK)


def describe_coding(coding: MapCoding) -> dict[str, float]:
    """Constants of the coding by the names of replies.js."""
    return {
        "stride": coding.stride,
        "step": coding.step,
        "block": _BLOCK,
        "leastStd": _LEAST_STD,
        "perOctave": _PER_OCTAVE,
        "fullScale": _FULL_SCALE,
    }


@dataclass(frozen=True)
class KeptMaps:
    """Maps of a film that a page contains.

    Attributes
    ----------
    triggers : tuple of int
        Numbers of the triggers, rising.
    coding : MapCoding
        Kept pixels, and the thickness of one count.
    """

    triggers: tuple[int, ...]
    coding: MapCoding


def choose_maps(
    film: xr.Dataset,
    *,
    room: float,
    thickest: float,
    opening: int,
    triggers: Sequence[int],
) -> KeptMaps:
    """Choose triggers, pixels and steps whose maps fit into a page.

    Everything is kept where it fits. Else the steps grow to a twentieth of the standard deviation
    of a pixel, then pixels are left out until fifty triggers fit, and of the triggers as many are
    kept, evenly, as there is room for.

    Parameters
    ----------
    film : xarray.Dataset
        As `erlif.open_film` returns it.
    room : float
        Characters for all maps.
    thickest : float
        Film that 16 bits have to reach. [um]
    opening : int
        A trigger that is always kept.
    triggers : sequence of int
        The triggers to choose from, rising.

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> film = example_film()
    >>> choose_maps(film, room=1e6, thickest=16.0, opening=1, triggers=range(6))
    KeptMaps(triggers=(0, 1, 2, 3, 4, 5), coding=MapCoding(stride=1, step=0.001))
    """
    finest = finest_coding(thickest)
    std = np.nanmedian(np.nan_to_num(film.thickness_std.isel(trigger=opening).values))
    coarse = max(finest.step, round(float(_ROUNDED * std) / finest.step) * finest.step)
    sampled = spread_evenly(triggers, _SAMPLED, opening)

    def count(coding: MapCoding) -> int:
        sizes = [len(embed_map(film, trigger=k, coding=coding)) + _AROUND for k in sampled]
        return int(room / (_MARGIN * float(np.mean(sizes))))

    if count(finest) >= len(triggers):
        return KeptMaps(tuple(triggers), finest)
    longest = max(film.sizes["x"], film.sizes["y"])
    wanted, stride = min(len(triggers), _WANTED), 1
    while True:
        coding = MapCoding(stride, coarse)
        fitting = count(coding)
        if fitting >= wanted or longest // (stride + 1) < _FEWEST:
            kept = spread_evenly(triggers, max(1, fitting), opening)
            return KeptMaps(kept, coding)
        stride += 1


def spread_evenly(triggers: Sequence[int], count: int, kept: int) -> tuple[int, ...]:
    """Choose triggers evenly, `kept` among them.

    Examples
    --------
    >>> spread_evenly(range(100), 4, kept=10)
    (0, 10, 50, 99)
    """
    if count >= len(triggers):
        return tuple(triggers)
    places = np.linspace(0, len(triggers) - 1, count - 1).round().astype(int)
    return tuple(sorted({kept, *(triggers[k] for k in places.tolist())}))
