"""``erlif process``: run directories to film-thickness maps."""

from __future__ import annotations

from collections.abc import Sequence
from os.path import normpath
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from erlif.commands.ending import BAD_INPUT, DEFECT, INTERRUPTED, echo_aside
from erlif.commands.lines import verbosity, wrap
from erlif.commands.options import CALIBRATION, PATH, PROCESSING, expect_suffix, output_option
from erlif.commands.progress import echo_above, working
from erlif.core.errors import OutputError
from erlif.core.speed.imports import large_imports
from erlif.core.speed.memory import keep_memory

if TYPE_CHECKING:
    from erlif.pipeline.batch import RunOutcome


@click.command()
@click.argument("runs", metavar="RUN_DIR...", type=PATH, nargs=-1, required=True)
@CALIBRATION
@output_option("File in .nc or .zarr", "RUN_DIR/film.nc")
@click.option(
    "--resume",
    is_flag=True,
    help="Keep films made from the same inputs and settings by this version.",
)
@PROCESSING
def process(
    runs: tuple[Path, ...],
    calibration: Path | None,
    output: Path | None,
    resume: bool,
    **options: Any,
) -> None:
    """Turn run directories into film-thickness maps.

    Where run.toml names a calibration that does not exist yet, it is fitted from the fixture
    directory it belongs to. The same command resumes an interrupted run.

    In place of directories a table of runs may be named: a CSV file with a column run_dir and,
    optionally, calibration and output. Each of several runs has one line of result. One that fails
    does not end the others; failures are listed at the end, and the exit status is then not 0.

    \b
    Example:
      erlif process data_samples/straight_bushing
      erlif process long_run -o long_run/film.zarr --scheduler local:4
      erlif process series_may/run_*
      erlif process runs.csv --resume
    """
    if len(runs) > 1 or resume or (runs[0].exists() and not runs[0].is_dir()):
        if output is not None:
            raise OutputError(
                f"Expected one run directory, without --resume, with -o {output}. The films of "
                "several runs, of a table and of --resume are written into the directories of the "
                "runs, or to the column output of the table. Leave -o out."
            )
        process_series(runs, calibration=calibration, resume=resume, **options)
    else:
        process_one(runs[0], calibration, output, options)


def process_one(
    run_dir: Path, calibration: Path | None, output: Path | None, options: dict[str, Any]
) -> str:
    """Process a run, print its summary, and return it."""
    keep_memory()
    with large_imports():
        from erlif import pipeline
        from erlif.show.report import summarise, summarise_briefly

    # a name that promises another format is refused before the work starts
    output = output or run_dir / "film.nc"
    expect_suffix(output, ".nc", ".zarr")

    verbose = verbosity()
    source = calibration or _named_calibration(run_dir, allow_outside=options["allow_outside"])
    existed = source is None or source.exists()
    with working() as progress:
        film = pipeline.process(
            run_dir, calibration=calibration, output=output, progress=progress, **options
        )

    # the film stays open while it is summarised: its maps are read when they are used
    with film:
        summary = wrap(summarise(film)) if verbose else summarise_briefly(film)
    click.echo(summary)
    if source is not None and existed and verbose:
        click.echo(f"used: {source}")
    made = [source] if source is not None and not existed and source.exists() else []
    click.echo(f"written: {', '.join(str(path) for path in (*made, output))}")
    click.echo(f"next: erlif figures {output}")
    return summary


def _named_calibration(run_dir: Path, *, allow_outside: bool) -> Path | None:
    """Path of the calibration that run.toml names; None unless it names exactly one."""
    from erlif.core.errors import ErlifError
    from erlif.io.settings import read_run_settings

    try:
        named = read_run_settings(run_dir, allow_outside=allow_outside).calibrations
    except ErlifError:
        return None
    return Path(normpath(run_dir / named[0])) if len(named) == 1 else None


def process_series(runs: Sequence[Path], **options: Any) -> None:
    """Process runs and print one line of each; failures are listed at the end.

    Parameters
    ----------
    runs : sequence of Path
        Run directories, or one table of runs.
    **options
        As `erlif.pipeline.batch.batch` takes them.

    Raises
    ------
    click.exceptions.Exit
        With the status of the worst failure, if a run fails.
    """
    with large_imports():
        from erlif.pipeline.batch import RunState, batch

    try:
        with working() as progress:
            outcomes = batch(
                runs,
                report=lambda outcome: echo_above(wrap(_describe(outcome))),
                progress=progress,
                **options,
            )
    except KeyboardInterrupt:
        echo_aside("erlif: interrupted. The same command with --resume goes on.")
        raise click.exceptions.Exit(INTERRUPTED) from None

    failures = [outcome for outcome in outcomes if outcome.failed]
    if not failures:
        return
    echo_aside(f"erlif: {len(failures)} of {len(outcomes)} runs failed:")
    for failure in failures:
        message = failure.message.replace("\n", "\n  ")
        echo_aside(f"  {failure.run_dir}: {message}")
    defect = any(failure.state is RunState.DEFECT for failure in failures)
    raise click.exceptions.Exit(DEFECT if defect else BAD_INPUT)


def _describe(outcome: RunOutcome) -> str:
    """Describe a run in one line."""
    from erlif.core.notes import Level, split_notes
    from erlif.core.units import count_of
    from erlif.io.files import open_film
    from erlif.pipeline.batch import RunState
    from erlif.show.report import summarise_in_a_line

    if outcome.failed:
        return f"{outcome.run_dir}: failed, see below"
    with open_film(outcome.output) as film:
        line = summarise_in_a_line(film)
        notes = split_notes(str(film.attrs.get("notes", "")))
    warnings = sum(level is not Level.NOTE for level, _ in notes)
    warned = f"; {count_of(warnings, 'warning')}, see erlif report" if warnings else ""
    before = outcome.state is RunState.FINISHED_BEFORE
    spent = "finished before" if before else f"{outcome.seconds:.1f} s"
    return f"{outcome.run_dir}: {line}; {spent}{warned}"
