"""``erlif budget``: the uncertainty of one map, term by term."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from erlif.commands.lines import wrap
from erlif.commands.options import ALLOW_OUTSIDE, CALIBRATION, PATH, SKIP_BAD_FRAMES, QuantityOption
from erlif.commands.progress import working
from erlif.core.speed.imports import large_imports


@click.command()
@click.argument("run_dir", type=PATH)
@CALIBRATION
@click.option(
    "--trigger", type=click.IntRange(min=0), help="Default: the trigger of highest speed."
)
@click.option(
    "--film",
    "films",
    type=QuantityOption("um", "LENGTH"),
    multiple=True,
    help='Film for which the budget is made, "6 um"; may be repeated. Default: the 10th, 50th and '
    "90th percentile of the map.",
)
@click.option(
    "--target",
    metavar="SHARE|LENGTH",
    help='List the fewest remedies with which nine of ten runs lie within it, "1 %" or "50 nm": '
    "their standard deviation is 1/1.645 of it at most.",
)
@SKIP_BAD_FRAMES
@ALLOW_OUTSIDE
def budget(run_dir: Path, films: tuple[float, ...], **options: Any) -> None:
    """Print the uncertainty of one map, term by term.

    \b
    Example:
      erlif budget data_samples/straight_bushing --trigger 12
      erlif budget data_samples/straight_bushing --target "1 %"
    """
    with large_imports():
        from erlif.review.budget import budget as make_budget
        from erlif.show.report import print_budget

    # an empty option means the usual films
    with working() as progress:
        terms = make_budget(run_dir, films=films or None, progress=progress, **options)
    click.echo(wrap(print_budget(terms)))
