"""Many runs to film-thickness maps, as ``erlif process`` prints them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from erlif.commands.ending import BAD_INPUT, DEFECT, INTERRUPTED, echo_aside
from erlif.commands.lines import wrap
from erlif.commands.progress import echo_above, working
from erlif.core.speed.imports import large_imports

if TYPE_CHECKING:
    from erlif.pipeline.batch import RunOutcome


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
    """One line on a run."""
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
