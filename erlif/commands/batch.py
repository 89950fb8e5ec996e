"""``erlif batch``: many runs to film-thickness maps."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from erlif.commands.ending import BAD_INPUT, DEFECT, INTERRUPTED, echo_aside
from erlif.commands.options import PATH, PROCESSING
from erlif.commands.progress import echo_above, working
from erlif.core.speed.imports import large_imports

if TYPE_CHECKING:
    from erlif.pipeline.batch import RunOutcome


@click.command()
@click.argument("runs", type=PATH, nargs=-1, required=True)
@click.option(
    "--calibration",
    type=PATH,
    help="For runs whose row names none; default: the calibration that each run.toml names.",
)
@click.option(
    "--resume",
    is_flag=True,
    help="Keep films made from the same inputs and settings by this version.",
)
@PROCESSING
def batch(runs: tuple[Path, ...], calibration: Path | None, resume: bool, **options: Any) -> None:
    """Turn many run directories into film-thickness maps.

    RUNS are run directories, or a table of runs: a CSV file with a column run_dir and, optionally,
    calibration and output. Each run has one line of result. A run that fails does not end the
    others; failures are listed at the end, and the exit status is then not 0.

    \b
    Example:
      erlif batch series_may/run_*
      erlif batch runs.csv --resume
      erlif batch runs.csv --scheduler tcp://cluster:8786
    """
    with large_imports():
        from erlif.pipeline.batch import RunState
        from erlif.pipeline.batch import batch as process_runs

    try:
        with working() as progress:
            outcomes = process_runs(
                runs,
                calibration=calibration,
                resume=resume,
                report=lambda outcome: echo_above(_describe(outcome)),
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
    """One line on a run."""
    from erlif.io.files import open_film
    from erlif.pipeline.batch import RunState
    from erlif.show.report import summarise_in_a_line

    if outcome.failed:
        return f"{outcome.run_dir}: failed, see below"
    with open_film(outcome.output) as film:
        line = summarise_in_a_line(film)
    before = outcome.state is RunState.FINISHED_BEFORE
    spent = "finished before" if before else f"{outcome.seconds:.1f} s"
    return f"{outcome.run_dir}: {line}; {spent}"
