"""A run directory to a film: the method, stage by stage."""

from __future__ import annotations

import logging
import tempfile
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor, wait
from pathlib import Path
from typing import Any

import xarray as xr

from erlif.calibration import Calibration
from erlif.core.progress import Progress, ShowProgress, choose_progress
from erlif.core.speed.memory import release_memory
from erlif.core.timing import stage
from erlif.io.files import (
    PartialFilm,
    expect_folder,
    open_film,
    open_netcdf,
    refuse_existing,
    remove_remains,
    set_coordinates,
    takes,
)
from erlif.io.ingest import Run, open_run
from erlif.pipeline.audit.naming import naming
from erlif.pipeline.cycle import describe_triggers, group_frames, summarise_cycle
from erlif.pipeline.engines.ahead import compiling_ahead
from erlif.pipeline.engines.engine import Engine, open_engine
from erlif.pipeline.engines.results import FrameResult, TriggerResult, frames_in
from erlif.pipeline.engines.triggers import TriggerTask, run_triggers
from erlif.pipeline.film import summarise_triggers, with_light, with_record, with_theory
from erlif.pipeline.fixture import find_calibration
from erlif.pipeline.physics.clock import fit_start
from erlif.pipeline.physics.joint import locate_run
from erlif.pipeline.physics.prediction import tabulate_theory
from erlif.pipeline.physics.texture import widen_maps
from erlif.pipeline.recording.prepare import PreparedRun, prepare_run
from erlif.pipeline.recording.pulses import check_first_pulses
from erlif.pipeline.work import FilmWork

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
        Leave out frame pairs of which a file is missing or unreadable; the film lists them.
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
        The film, as docs/film_nc.md describes it; with `output`, maps are read from it when used.

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
            names = (None, "frames", "registration")
            film, *groups = (_load(Path(scratch) / "film.nc", name) for name in names)

            # the file goes; `film.erlif` finds its groups here
            film.encoding = {"groups": dict(zip(names[1:], groups, strict=True))}
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
    fitted: dict[Path, Calibration] | None = None,
) -> bool:
    """Process a run into a file; parameters as for `process`, `batch` and `find_calibration`.

    Returns False where the film is kept that the same work has made before.
    """
    if engine.elsewhere:  # workers elsewhere have another working directory
        run_dir, output = run_dir.absolute(), output.absolute()
    if run_dir.is_dir():  # another is refused when it is opened
        expect_folder(output)
    remove_remains(output)
    if not resume:
        refuse_existing(output, overwrite=overwrite, holds="thickness")

    # frames in pairs, log and settings; kinematics; the curve from ratio to film
    run = open_run(
        run_dir, skip_bad_frames=skip_bad_frames, find_start=fit_start, allow_outside=allow_outside
    )
    cycle = locate_run(run)
    triggers = describe_triggers(run, cycle)
    curve, known = find_calibration(
        run, calibration, allow_outside=allow_outside, progress=progress, fitted=fitted
    )
    _log_inputs(run, cycle, curve.calibration)
    work = FilmWork.of(run, curve, output)
    if resume and work.is_done(overwrite=overwrite):
        return False

    count = triggers.sizes["trigger"]
    with compiling_ahead(), ThreadPoolExecutor(1) as aside, work.unfinished(count) as unfinished:
        tables = aside.submit(tabulate_theory, run.settings)
        # dark, flat and noise; registration; light that is to be subtracted
        ready = prepare_run(run, cycle, curve, known, progress)
        del known  # the map of the fixture is large
        release_memory()
        with naming(ready.faults):
            # each pair: light, drift, ratio; each trigger: film
            results = measure_run(ready, unfinished, engine=engine, progress=progress)
            release_memory()
            hashes = work.hash_inputs(results)
            draft = with_light(summarise_triggers(ready, triggers, results), unfinished.maps)
            release_memory()
            wait([tables])  # what they lack is made, or refused, where the theory asks for it
            film, groups = with_record(with_theory(draft), hashes)
            widen_maps(unfinished.maps, len(results), draft.curve, draft.texture)
        work.write(unfinished, film, groups, hashes)
    return True


def measure_run(
    ready: PreparedRun, unfinished: PartialFilm, *, engine: Engine, progress: Progress
) -> list[TriggerResult]:
    """Measure the triggers of a run that are not finished yet.

    Parameters
    ----------
    ready : PreparedRun
    unfinished : PartialFilm
        Receives the maps.
    engine : Engine
    progress : callable

    Returns
    -------
    list of TriggerResult
        Of all triggers, in their order.

    Raises
    ------
    PulseError
        If the cameras show different pulses among the first triggers.
    """
    pairs = ready.run.pairs

    def inspect(first: Sequence[TriggerResult]) -> None:
        """Refuse a long run early whose cameras show different pulses."""
        check_first_pulses(
            frames_in(first),
            pairs,
            lambda frame: FrameResult.of(frame, ready.chain.measure(frame)).pulse,
        )

    with stage("film", _logger):
        return run_triggers(
            TriggerTask.of(ready),
            group_frames(ready.cycle, pairs),
            unfinished,
            engine=engine,
            progress=progress,
            places=[pairs.pages[0][0].path, pairs.pages[1][0].path],
            inspect=inspect,
        )


def _load(path: Path, group: str | None) -> xr.Dataset:
    """The root or a group of a film that was written just now."""
    with open_netcdf(path, group=group) as stored:
        return set_coordinates(stored).load()


def _log_inputs(run: Run, cycle: xr.Dataset, calibration: Calibration) -> None:
    """Log what was found in the directory, and which calibration is used."""
    rows, columns = run.pairs.shape
    _logger.info(
        "%d frame pairs of %d x %d pixels, %d left out",
        len(run.pairs.usable),
        columns,
        rows,
        len(run.pairs.skipped),
    )
    _logger.info("%s", summarise_cycle(cycle))
    _logger.info(
        "calibration %r of %s, calibrated range %.2f to %.2f um",
        calibration.fixture,
        calibration.date or "unknown date",
        *calibration.thickness_range,
    )
