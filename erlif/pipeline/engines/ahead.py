"""Kernels of a first run, compiled by another process while this one registers the cameras.

numba compiles a kernel when it is called first, one at a time in each process, and keeps it for
later runs.
"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import xarray as xr

from erlif.calibration import Calibration
from erlif.core.products import AlignedFrames
from erlif.correction import NoiseTables
from erlif.io.files.compression import MapVariable, encode_netcdf
from erlif.models.reynolds import Journal, Motion, solve_journal
from erlif.models.reynolds.full_film import follow_full_film
from erlif.pipeline.passes import film, measure_film
from erlif.ratio import PairRatio, compute_ratio, flag_bubbles, measure_sharpness
from erlif.ratio.cells import sample_cells
from erlif.thickness import FilmTables
from erlif.trend import FilmCurve, GapShape, Region, find_gap_minima

# The smallest image whose light is averaged over cells. [px]
_SHAPE = (80, 96)

_PROGRAM = "from erlif.pipeline.engines.ahead import compile_kernels; compile_kernels()"


@contextmanager
def compiling_ahead() -> Iterator[None]:
    """Compile the kernels for the stages after registration in a process of its own.

    Nobody waits for the process: a kernel that it has not finished is compiled where it is called.
    With one processor there is none.
    """
    if (os.cpu_count() or 1) < 2 or is_compiled():
        yield
        return

    # "-P": the working directory is no place for imports
    with subprocess.Popen(
        [sys.executable, "-P", "-c", _PROGRAM],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    ) as process:
        try:
            yield
        finally:
            process.kill()


def is_compiled() -> bool:
    """Whether the largest kernel is kept, of this version of erlif or another."""
    stats = getattr(film._measure_film, "stats", None)  # none where numba compiles nothing
    return stats is None or any(Path(stats.cache_path).glob("film._measure_film-*.nbi"))


def compile_kernels() -> None:
    """Call what follows the registration for a small image without texture, in its order."""
    light, flags = np.full((2, 1, *_SHAPE), 1000, np.float32), np.zeros((2, 1, *_SHAPE), np.uint16)
    dims = ("camera", "frame", "y", "x")
    none = np.zeros_like(light)
    aligned = {"signal": light, "signal_var": light, "signal_var_fixed": none, "flags": flags}
    frames = xr.Dataset({name: (dims, image) for name, image in aligned.items()})
    frames["displacement_std"] = ("y", "x"), none[0, 0]
    compute_ratio(AlignedFrames(frames))

    one, zero, valid = light[0, 0], none[0, 0], flags[0, 0]
    flag_bubbles(one, one, valid.copy(), share=0.25)
    empty = np.zeros((0, 0), np.float32)
    measure_sharpness(
        one, valid, NoiseTables(one, zero, zero, empty, empty, np.ones(3, np.float32))
    )
    parameters = np.eye(3), (0.1, 12.0), (580.0, 610.0), xr.Dataset(), 1.0
    calibration = Calibration(0.65, 0.4, 0.25, *parameters, "")
    ratio = np.full(_SHAPE, calibration.predict_log(3.0), np.float32)
    pair = PairRatio(ratio, 1e-6 * one, zero, zero, valid, one)
    whole = Region(slice(0, _SHAPE[0]), slice(0, _SHAPE[1]))
    maps = measure_film(pair, FilmTables.of(calibration), whole)
    find_gap_minima(
        maps.sums,
        FilmCurve.of(calibration),
        region=whole,
        sliding_along_x=True,
        contacts=[GapShape.LINE],
    )
    encode_netcdf({"thickness": ratio}, [MapVariable("thickness", "float32", {}, std="thickness")])
    sample_cells(one, ratio, zero, valid)

    time = np.linspace(0.0, 1.0, 5)
    joint = Journal(0.03336, 0.03359, length=0.237, viscosity=0.12)
    motion = Motion(time, 0 * time, 1.0)
    follow_full_film(joint, motion, start=np.zeros((1, 2)))

    # the prediction of a long run alone, at the end of it: ten seconds
    solve_journal(joint, motion, cells=(16, 4), compiled=True)
