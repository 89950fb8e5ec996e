"""``erlif budget``: the uncertainty of one map, term by term."""

from __future__ import annotations

from pathlib import Path

import click

from erlif.commands.compiling import announced_compiling
from erlif.commands.options import ALLOW_OUTSIDE, PATH
from erlif.commands.progress import show_progress


@click.command()
@click.argument("run_dir", type=PATH)
@click.option("--calibration", type=PATH, help="Default: the calibration that run.toml names.")
@click.option(
    "--trigger", type=click.IntRange(min=0), help="Default: the trigger of highest speed."
)
@click.option(
    "--film",
    "films",
    type=float,
    multiple=True,
    help="Film thickness in um for which the budget is made; may be repeated.",
)
@ALLOW_OUTSIDE
def budget(
    run_dir: Path,
    calibration: Path | None,
    trigger: int | None,
    films: tuple[float, ...],
    allow_outside: bool,
) -> None:
    """Print the uncertainty of one map, term by term.

    \b
    Example:
      erlif budget data_samples/straight_bushing --trigger 12
    """
    from erlif.review.budget import budget as make_budget
    from erlif.show.report import render_budget

    with announced_compiling(), show_progress() as progress:
        found = make_budget(
            run_dir,
            trigger=trigger,
            calibration=calibration,
            films=films or None,
            allow_outside=allow_outside,
            progress=progress,
        )
    click.echo(render_budget(found), nl=False)
