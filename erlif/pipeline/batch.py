"""Many runs to their films, one after the other; a run that fails does not end the others."""

from __future__ import annotations

import logging
import os
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import partial
from pathlib import Path

from erlif.calibration import Calibration
from erlif.core.errors import ConfigError, ErlifError, OutputError
from erlif.core.progress import Progress, ShowProgress, choose_progress
from erlif.io.files import take
from erlif.io.ingest import RunEntry, read_run_table
from erlif.pipeline.engines.engine import open_engine
from erlif.pipeline.run import process_run

_logger = logging.getLogger(__name__)

# Suffixes of a film.
_SUFFIXES = (".nc", ".zarr")


class RunState(StrEnum):
    """State of a run after the batch."""

    FINISHED = "finished"  #: processed now
    #: Its film existed, made from the same inputs and settings by the same version.
    FINISHED_BEFORE = "finished before"
    REFUSED = "refused"  #: its input or its output cannot be used
    DEFECT = "defect"  #: a fault of erlif itself


@dataclass(frozen=True)
class RunOutcome:
    """Outcome of one run of a batch.

    Attributes
    ----------
    run_dir : Path
        Run directory, as it was given.
    output : Path
        Its film.
    state : RunState
        Whether the film is finished.
    message : str
        Reason of a failure; empty for a finished run.
    seconds : float
        Time it took. [s]
    """

    run_dir: Path
    output: Path
    state: RunState
    message: str
    seconds: float

    @property
    def failed(self) -> bool:
        """Whether there is no film."""
        return self.state in (RunState.REFUSED, RunState.DEFECT)


def batch(
    runs: str | Path | Iterable[str | Path | RunEntry],
    *,
    calibration: Calibration | str | Path | None = None,
    resume: bool = False,
    overwrite: bool = False,
    skip_bad_frames: bool = False,
    allow_outside: bool = False,
    workers: int | None = None,
    scheduler: str | None = None,
    report: Callable[[RunOutcome], None] | None = None,
    progress: ShowProgress = None,
) -> list[RunOutcome]:
    """Process many runs; a run that fails does not end the others.

    Parameters
    ----------
    runs : iterable of path or RunEntry
        Run directories, and tables of runs: CSV files with a column ``run_dir`` and, optionally,
        ``calibration`` and ``output``.
    calibration : Calibration or path, optional
        For the runs whose row of a table names none; default: the one that each run.toml names.
    resume : bool
        Keep a film that was made from the same inputs and settings by the same version, and do not
        compute it again.
    overwrite, skip_bad_frames, allow_outside, workers, scheduler
        As for `erlif.process`.
    report : callable, optional
        Receives the outcome of each run when it is known.
    progress : "bar", bool or callable, optional
        As for `erlif.process`; the name of the work starts with the name of the run directory.

    Returns
    -------
    list of RunOutcome
        In the order of the runs.

    Raises
    ------
    ErlifError
        If a table cannot be read, if a directory is given twice, or two runs have the same output;
        no run is then begun.

    Examples
    --------
    >>> outcomes = batch(["monday", "tuesday"], resume=True)
    >>> [outcome.state.value for outcome in outcomes]
    ['refused', 'refused']
    >>> outcomes[0].message[:45]
    'Expected a directory with run.toml in it; mon'
    """
    progress = choose_progress(progress)
    # a single path is a batch of one run
    entries = list_runs([runs] if isinstance(runs, str | Path) else runs)
    outcomes = []
    fitted: dict[Path, Calibration] = {}  # of a fixture that several runs share
    with open_engine(workers=workers, scheduler=scheduler) as engine:
        for entry in entries:
            # the calibration of a row of the table takes precedence
            process_one = partial(
                process_run,
                calibration=entry.calibration or calibration,
                resume=resume,
                overwrite=overwrite,
                skip_bad_frames=skip_bad_frames,
                allow_outside=allow_outside,
                engine=engine,
                fitted=fitted,
            )
            outcome = _process_entry(entry, process_one, progress)
            outcomes.append(outcome)
            if report is not None:
                report(outcome)
    return outcomes


def list_runs(runs: Iterable[str | Path | RunEntry]) -> list[RunEntry]:
    """The runs of a batch with the rows of its tables in their place.

    Parameters
    ----------
    runs : iterable of path or RunEntry
        As for `batch`.

    Returns
    -------
    list of RunEntry
        With the output of each.

    Raises
    ------
    ErlifError
        If a table cannot be read, there is no run, a run directory is given twice, two runs have
        the same output, or an output has the suffix of another format.

    Examples
    --------
    >>> [str(entry.output) for entry in list_runs(["monday"])]
    ['monday/film.nc']
    """
    given: list[RunEntry] = []
    for one in runs:
        if isinstance(one, RunEntry):
            given.append(one)
            continue
        take(one, "run", where="runs")
        if Path(one).suffix.lower() == ".csv" and not Path(one).is_dir():
            given += read_run_table(Path(one))
        else:
            given.append(RunEntry(Path(one)))
    if not given:
        raise ConfigError(
            "Expected at least one run directory or a table of runs; got none. Name one."
        )

    outputs = [one.output or one.run_dir / "film.nc" for one in given]
    run_dirs = [one.run_dir for one in given]
    _refuse_repeated(run_dirs, run_dirs)
    _refuse_repeated(outputs, run_dirs)
    for output in outputs:
        if output.suffix not in _SUFFIXES:
            raise OutputError(
                f"Expected a name in {' or '.join(_SUFFIXES)} for the output; got {output}. "
                "Correct the column output."
            )
    return [replace(one, output=output) for one, output in zip(given, outputs, strict=True)]


def _refuse_repeated(paths: Sequence[Path], run_dirs: Sequence[Path]) -> None:
    """Refuse a path that two runs share; links to one directory are the same path."""
    given: dict[str, Path] = {}
    for path, run_dir in zip(paths, run_dirs, strict=True):
        place = os.path.realpath(path)
        if place not in given:
            given[place] = run_dir
        elif path == run_dir:
            other = "" if given[place] == path else f", also as {given[place]}"
            raise ConfigError(
                f"Expected each run directory once; {path} is given twice{other}. Take one out."
            )
        else:
            raise OutputError(
                f"Expected an output for each run; {given[place]} and {run_dir} both have {path}. "
                "Change the column output of one."
            )


def _process_entry(
    entry: RunEntry, process_one: Callable[..., bool], progress: Progress
) -> RunOutcome:
    """Process one run and describe what became of it."""
    name, output = entry.run_dir.name, entry.output
    assert output is not None  # `list_runs` has given one to each
    started = time.perf_counter()
    state, message = RunState.FINISHED, ""
    _logger.info("%s: started", entry.run_dir)
    try:
        computed = process_one(
            entry.run_dir,
            output,
            progress=lambda what, done, total: progress(f"{name}, {what}", done, total),
        )
        if not computed:
            state = RunState.FINISHED_BEFORE
    except ErlifError as error:
        state, message = RunState.REFUSED, str(error)
    except OSError as error:
        state, message = RunState.REFUSED, f"{error.strerror or error}: {error.filename or ''}"
    except Exception as error:  # the other runs do not depend on a defect that this one shows
        _logger.exception("%s: a defect of erlif; please report it with these lines", entry.run_dir)
        state, message = RunState.DEFECT, f"a defect of erlif, {type(error).__name__}: {error}"
    return RunOutcome(entry.run_dir, output, state, message, time.perf_counter() - started)
