"""A run directory to a film: the method, stage by stage."""

from __future__ import annotations

import hashlib
import json
import logging
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import xarray as xr

from erlif.calibration import Calibration, check_bands, record_calibration
from erlif.core.errors import OutputError
from erlif.core.memory import release_memory
from erlif.core.progress import Progress, ShowProgress, choose_progress
from erlif.core.timing import stage
from erlif.core.version import __version__
from erlif.io.files import (
    PartialFilm,
    describe_hashes,
    has_identity,
    open_film,
    refuse_existing,
    remove_remains,
    takes,
    write_film,
)
from erlif.io.ingest import (
    InputChangedError,
    Run,
    hash_files_beside_frames,
    hash_inputs,
    open_run,
    refuse_changed,
    sign_inputs,
    stamp_inputs,
)
from erlif.io.ingest.hashes import Digests
from erlif.io.settings import to_toml
from erlif.pipeline.engines.engine import Engine, open_engine
from erlif.pipeline.engines.results import frames_in, known_digests
from erlif.pipeline.film import (
    MAPS,
    describe_cycle,
    describe_grid,
    describe_triggers,
    group_frames,
)
from erlif.pipeline.fixture import find_calibration
from erlif.pipeline.parts import KnownMap, complete_film, measure_run, prepare_run
from erlif.pipeline.physics.joint import locate_run
from erlif.pipeline.recording.clock import fit_start
from erlif.pipeline.recording.pulse_order import PulseError

_logger = logging.getLogger(__name__)


@takes(run_dir="run", calibration="calibration path", output="path")
def process(
    run_dir: str | Path,
    *,
    calibration: Calibration | str | Path | None = None,
    output: str | Path | None = None,
    overwrite: bool = False,
    skip_bad_frames: bool = False,
    allow_outside: bool = False,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: ShowProgress = None,
) -> xr.Dataset:
    """Turn a run directory into film-thickness maps.

    Parameters
    ----------
    run_dir : path
        Directory with ``run.toml``, frames of both cameras and the encoder log.
    calibration : Calibration or path, optional
        Default: the one that run.toml names; it is fitted where its fixture lies beside it and it
        does not exist yet.
    output : path, optional
        Where to write the film, netCDF or, by the suffix ``.zarr``, zarr. Default: nowhere, the
        film is only returned.
    overwrite : bool
        Replace an existing output.
    skip_bad_frames : bool
        Leave out unreadable frame pairs; the film lists them.
    allow_outside : bool
        Follow links and names of files that leave the directory.
    workers : int, optional
        Threads; default: one per processor. The result does not depend on it.
    scheduler : str, optional
        Workers of dask in place of threads: ``local:N`` starts N of them on this machine, the
        address or the file of a scheduler uses those that it has. The result is the same.
    progress : "bar", bool or callable, optional
        "bar" or True shows a bar for each step; a function receives the name of the step, the
        number of items that are finished, and their total.

    Returns
    -------
    xarray.Dataset
        The film, as docs/files.md describes it; with `output`, maps are read from it when used.

    Raises
    ------
    ErlifError
        If an input cannot be used, or the output exists.

    Examples
    --------
    >>> film = process("data_samples/straight_bushing")  # doctest: +SKIP
    >>> film.thickness.dims  # doctest: +SKIP
    ('trigger', 'y', 'x')
    """
    progress = choose_progress(progress)
    with open_engine(workers=workers, scheduler=scheduler) as engine:
        options: dict[str, Any] = {
            "calibration": calibration,
            "skip_bad_frames": skip_bad_frames,
            "allow_outside": allow_outside,
            "engine": engine,
            "progress": progress,
        }
        if output is not None:
            process_run(Path(run_dir), Path(output), overwrite=overwrite, **options)
            return open_film(output)
        with tempfile.TemporaryDirectory(prefix="erlif-") as scratch:
            process_run(Path(run_dir), Path(scratch) / "film.nc", overwrite=True, **options)
            path = Path(scratch) / "film.nc"
            with open_film(path) as film:
                film.load()
            groups = {}
            for name in ("frames", "registration"):
                with open_film(path, group=name) as group:
                    groups[name] = group.load()

            # the file goes; `film.erlif` finds its groups here
            film.encoding = {"groups": groups}
            return film


def process_run(
    run_dir: Path,
    output: Path,
    *,
    calibration: Calibration | str | Path | None,
    overwrite: bool,
    skip_bad_frames: bool,
    allow_outside: bool,
    engine: Engine,
    progress: Progress,
    resume: bool = False,
) -> bool:
    """Process a run into a file; parameters as for `process` and `batch`.

    Returns False where the film is kept that the same work has made before.
    """
    # workers elsewhere have another working directory
    if engine.elsewhere:
        run_dir, output = run_dir.absolute(), output.absolute()

    remove_remains(output)
    if not resume:
        refuse_existing(output, overwrite=overwrite, holds="thickness")
    run = open_run(
        run_dir,
        skip_bad_frames=skip_bad_frames,
        find_start=fit_start,
        allow_outside=allow_outside,
    )
    stamps = stamp_inputs(run)

    # kinematics: which frames belong to which trigger, and how fast the joint moved there
    cycle = locate_run(run)
    frames_of = group_frames(cycle, run.pairs)
    triggers = describe_triggers(run, cycle)
    _log_run(run, cycle)

    calibration = find_calibration(run, calibration, allow_outside=allow_outside, progress=progress)
    check_bands(calibration, (run.settings.camera1.band, run.settings.camera2.band))
    _log_calibration(calibration)
    digests = hash_files_beside_frames(run)
    if resume and output.exists():
        if has_identity(output, identify_work(run, calibration, hash_inputs(run, digests))):
            return False
        if not overwrite:
            raise OutputError(
                f"{output} exists already, made from other inputs or settings or by another "
                "version; use --overwrite to make it again, or name another output."
            )
        refuse_existing(output, overwrite=overwrite, holds="thickness")

    grid = describe_grid(run.settings, run.pairs.shape, len(frames_of))
    key = identify_start(run, calibration, digests)
    with (
        PartialFilm(output, key, grid, MAPS) as unfinished,
        discarded_after((PulseError, InputChangedError), unfinished),
    ):
        # the map of the fixture is large, and it is used only where the settings ask for it
        known = KnownMap.of(calibration, run.settings)
        calibration = replace(calibration, camera_map=None)
        ready = prepare_run(run, cycle, calibration, known, progress)
        del known
        release_memory()

        # frames: counts -> light -> ratio -> thickness, trigger by trigger
        with stage("film", _logger):
            results = measure_run(
                run, ready, frames_of, unfinished, engine=engine, progress=progress
            )
        release_memory()

        # the whole: statistics, theory, exponent, and the record of how it was made
        hashes = hash_inputs(run, digests | known_digests(frames_in(results), run.pairs))
        refuse_changed(run, stamps)
        film, groups = complete_film(run, cycle, triggers, ready, results, calibration, hashes)
        film.attrs["identity"] = identify_work(run, calibration, hashes)
        with stage("writing", _logger):
            write_film(unfinished, film, groups)
        _log_film(film, output)
    return True


@contextmanager
def discarded_after(kinds: tuple[type[Exception], ...], unfinished: PartialFilm) -> Iterator[None]:
    """Remove unfinished work of which nothing can be used after an exception."""
    try:
        yield
    except kinds:
        unfinished.discard()
        raise


def identify_work(run: Run, calibration: Calibration, hashes: Mapping[str, str]) -> str:
    """Identity of a piece of work: its inputs, its settings and the version of erlif."""
    return _identify(run, calibration, describe_hashes(hashes))


def identify_start(run: Run, calibration: Calibration, digests: Digests) -> str:
    """The same before the frames are read: they enter by name, size and time of change.

    Unfinished work is resumed by this. Its triggers keep the hashes of the frames that were read.
    """
    return _identify(run, calibration, sign_inputs(run, digests))


def _identify(run: Run, calibration: Calibration, inputs: str) -> str:
    parts = [
        __version__,
        to_toml(run.settings),
        inputs,
        record_calibration(calibration),
        json.dumps(sorted(run.pairs.skipped)),
    ]
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()


def _log_run(run: Run, cycle: xr.Dataset) -> None:
    """Log what was found in the directory."""
    rows, columns = run.pairs.shape
    _logger.info(
        "%d frame pairs of %d x %d pixels, %d left out",
        len(run.pairs.usable),
        columns,
        rows,
        len(run.pairs.skipped),
    )
    _logger.info("%s", describe_cycle(cycle))


def _log_calibration(calibration: Calibration) -> None:
    """Log which calibration is used."""
    low, high = calibration.thickness_range
    _logger.info(
        "calibration %r of %s, calibrated range %.2f to %.2f um",
        calibration.fixture,
        calibration.date or "unknown date",
        low,
        high,
    )


def _log_film(film: xr.Dataset, output: Path) -> None:
    """Log the result in one line."""
    trend = "no speed exponent"
    if "speed_exponent" in film:
        power, std = float(film.speed_exponent), float(film.speed_exponent_std)
        trend = f"speed exponent {power:.3f} ± {std:.3f}"
    low, high = float(film.film_min.min()), float(film.film_min.max())
    _logger.info("minimum film thickness %.2f to %.2f um, %s", low, high, trend)
    if output.is_file():
        _logger.info("%s written, %.1f MB", output, output.stat().st_size / 1e6)
