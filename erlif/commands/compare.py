"""``erlif compare``: runs against each other."""

from __future__ import annotations

from pathlib import Path

import click

from erlif.commands.lines import describe_written, wrap
from erlif.commands.options import ANGLE, OVERWRITE, PATH, output_option
from erlif.commands.progress import show_progress
from erlif.core.errors import ErlifError
from erlif.core.speed.imports import large_imports

_TABLES = ("compare.nc", "compare.csv", "compare.html")


@click.command()
@click.argument("films", type=PATH, nargs=-1, required=True)
@click.option(
    "--crank-angle",
    type=ANGLE,
    help='Crank angle of the difference map, "90 deg"; default: of the fastest trigger.',
)
@click.option(
    "--pair",
    type=int,
    nargs=2,
    default=(1, 2),
    show_default=True,
    help="Films of the difference map, counted from 1.",
)
@click.option(
    "--calibration",
    "calibrations",
    type=PATH,
    multiple=True,
    help="A further calibration for the control chart; may be given several times.",
)
@output_option("Directory for compare.nc, tables and figures", "none")
@OVERWRITE
def compare(
    films: tuple[Path, ...],
    crank_angle: float | None,
    pair: tuple[int, int],
    calibrations: tuple[Path, ...],
    output: Path | None,
    overwrite: bool,
) -> None:
    """Compare runs: which differ, by how much, and how sure that is.

    Errors of a calibration that runs share cancel; probabilities are corrected for the number of
    tests. With -o, compare.nc, the table of pairs as CSV and HTML, and the figures are written.

    \b
    Example:
      erlif compare load_50/film.nc load_100/film.nc
      erlif compare run_*/film.nc -o comparison
    """
    with large_imports():
        from erlif.io.files import refuse_existing, replacing_set, write_dataset
        from erlif.review.comparison import compare as compare_films
        from erlif.review.comparison import describe_comparison
        from erlif.show.report.comparison import FIGURES

    # everything that can be refused is refused before the work starts
    if len(films) > 1 and not (pair[0] != pair[1] and all(1 <= k <= len(films) for k in pair)):
        raise ErlifError(
            f"Expected two different films from 1 to {len(films)} for the difference map; got "
            f"{pair[0]} and {pair[1]}. Choose two of them."
        )
    if output is not None:
        names = (*_TABLES, *(f"{name}.png" for name in FIGURES))
        for name in names:
            refuse_existing(output / name, overwrite=overwrite, holds="difference_at")
    with show_progress() as progress:
        comparison = compare_films(
            films,
            pair=(pair[0] - 1, pair[1] - 1),
            crank_angle=crank_angle,
            calibrations=calibrations,
            progress=progress,
        )
    for line in describe_comparison(comparison):
        click.echo(wrap(line))
    if output is None:
        return

    from erlif.show.plots import write_comparison_figures
    from erlif.show.report import write_comparison_page, write_pair_table

    # one file of an earlier comparison beside those of this one would belong to other films
    with replacing_set(output, names) as scratch:
        write_dataset(comparison, scratch / _TABLES[0])
        write_pair_table(comparison, scratch / _TABLES[1])
        figures = write_comparison_figures(comparison, scratch)
        write_comparison_page(comparison, scratch / _TABLES[2], figures)
    written = (*_TABLES, *(path.name for path in figures))
    click.echo(describe_written([output / name for name in written]))
