"""Kernels of the film, compiled by a second process while the first registers the cameras.

numba compiles in one thread at a time. In a fresh environment a second process therefore compiles
what comes after the registration, and both find it in the cache of compiled kernels.
"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from erlif.core.products import AlignedFrames, RatioImages

_LONGEST = 120.0
"""Time after which the first process compiles by itself; the second takes about five. [s]"""

_SIDE = 32
"""Side of the image that is measured; the kernels are the same for every size. [px]"""


_COMMAND = f"from {__name__} import compile_film_kernels as run; run()"
"""Program of the second process."""


class _Second:
    """The second process, while there is one."""

    process: subprocess.Popen[bytes] | None = None


def compile_aside() -> None:
    """Start a second process that compiles the kernels of the film, where a processor is free."""
    if _Second.process is not None or (os.cpu_count() or 1) < 2 or not sys.executable:
        return
    # the same package in both: the cache finds kernels by their file, and -P leaves out a copy in
    # the working directory, such as the one that an installed erlif came from
    own = str(Path(__file__).parents[3])
    paths = os.pathsep.join(filter(None, (own, os.environ.get("PYTHONPATH"))))
    try:
        _Second.process = subprocess.Popen(
            [sys.executable, "-P", "-c", _COMMAND],
            env=os.environ | {"PYTHONPATH": paths},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
    except OSError:  # the first process then compiles everything by itself
        _Second.process = None


def wait_for_kernels() -> None:
    """Wait until the second process has finished, where there is one.

    Until then the first one compiles what it needs next by itself.
    """
    if _Second.process is not None:
        for compile_next in (_compile_plain_ratio, _compile_sum, _compile_cells, _compile_encoding):
            if _Second.process.poll() is None:
                compile_next()
        try:
            _Second.process.wait(_LONGEST)
        except subprocess.TimeoutExpired:
            return
        _Second.process = None


@contextmanager
def second_compiler() -> Iterator[None]:
    """End the second process with the block, whatever it is doing."""
    try:
        yield
    finally:
        if _Second.process is not None:
            _Second.process.kill()
            _Second.process.wait()
            _Second.process = None


def _compile_plain_ratio() -> RatioImages:
    """Take the ratio of a small frame pair, as sharpness and order of the cameras need it."""
    from erlif.pipeline.chain import as_frames
    from erlif.pipeline.passes import PairLight
    from erlif.ratio import BlurDifference, compute_ratio

    light = PairLight.empty((_SIDE, _SIDE))
    light.light[:], light.variance[:], light.variance_fixed[:], light.flags[:] = 1000, 1, 1, 0
    light.light[:, _SIDE // 2, _SIDE // 2] = 1  # a bubble
    std = np.zeros((_SIDE, _SIDE), np.float32)
    frames = AlignedFrames(as_frames(light).assign(displacement_std=(("y", "x"), std)))
    return compute_ratio(frames, blur=BlurDifference(0.1, 0.1))


def _compile_sum() -> None:
    """Add a ratio to a sum, as the frames of a fixture are added."""
    from erlif.ratio import RatioSum

    RatioSum((_SIDE, _SIDE)).add(_compile_plain_ratio())


def _compile_cells() -> None:
    """Sample the cells of an image, by which light that is not film is found."""
    from erlif.ratio import sample_cells

    image = np.ones((4 * _SIDE, 4 * _SIDE), np.float32)  # smaller ones have too few cells
    sample_cells(image, image, image, np.zeros(image.shape, np.uint8))


def _compile_encoding() -> None:
    """Compress small maps, as those of a trigger are compressed."""
    from erlif.io.files.compression import encode_netcdf
    from erlif.pipeline.film import MAPS

    shape = _SIDE, _SIDE
    encode_netcdf({one.name: np.ones(shape, one.dtype) for one in MAPS}, MAPS)


def compile_film_kernels() -> None:
    """Measure a small film, then take a ratio, which compiles the kernels for both."""
    from erlif.pipeline.passes import FilmTables, PairLight, PairRatio, measure_film
    from erlif.pipeline.passes.noise import CameraNoise
    from erlif.pipeline.passes.ratio import empty_ratio, measure_ratio
    from erlif.pipeline.passes.warp import PairWarp, tabulate_map
    from erlif.ratio import BlurDifference
    from erlif.registration import CameraMap, MapKind
    from erlif.trend import Region

    def image(value: float) -> np.ndarray[tuple[int, int], np.dtype[np.float32]]:
        return np.full((_SIDE, _SIDE), value, np.float32)

    # a straight curve of thickness over log ratio
    table = np.linspace(0, 1, 64, dtype=np.float32)
    limits = np.array([0, 1, 0, 1, 0, 1], np.float32)
    last = np.float32(62.9)
    tables = FilmTables(np.float32(0), np.float32(63), last, table, table, table, limits)

    flags = np.zeros((_SIDE, _SIDE), np.uint8)
    pair = PairRatio(image(0.5), image(1e-4), image(0), image(1e-6), flags, image(1000))
    measure_film(pair, tables, Region(slice(0, _SIDE), slice(0, _SIDE)))

    # the kernels of the warp are those of the registration, and are in the cache by now
    shape, flat = (_SIDE, _SIDE), image(0)
    camera_map = CameraMap(flat, flat, flat, flat == 0, flat > 0, 1.0, MapKind.SURFACE)
    light = PairLight.empty(shape)
    light.light[:], light.flags[:] = 1000, 0
    none, numbers = np.zeros((0, 0), np.float32), np.ones(3, np.float32)
    noise = CameraNoise(image(1), image(1)[:1], image(1e-6), none, none, numbers)
    measure_ratio(
        light,
        tabulate_map(camera_map),
        (noise, noise),
        (0.0, 0.0),
        blur=BlurDifference(0.1, 0.1),
        no_film_below=0.25,
        warped=PairWarp.empty(shape, "normal"),
        out=empty_ratio(shape),
    )
