"""``erlif figures``: the figures of a film as files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from erlif.commands.lines import describe_written
from erlif.commands.options import (
    ALLOW_OUTSIDE,
    OVERWRITE,
    PATH,
    TRIGGER,
    choose_one,
    output_option,
    several,
)
from erlif.commands.progress import working
from erlif.core.errors import OutputError
from erlif.core.speed.imports import large_imports


@click.command()
@click.argument("film", type=PATH)
@output_option("Directory", "figures/ beside FILM")
@TRIGGER
@click.option(
    "--format",
    "formats",
    callback=several,
    default="png,pdf",
    show_default=True,
    metavar="FORMAT,...",
    help="Of png, pdf and svg.",
)
@click.option("--dpi", type=float, help="Pixels per inch of images; default: 300.")
@click.option("--only", callback=several, metavar="NAME,...", help="Names of the figures to write.")
@click.option(
    "--style",
    metavar="STYLE",
    help="paper (columns of 85 and 179 mm, 8 points), slides (16:9, 18 points), or a style sheet "
    "of matplotlib.",
)
@ALLOW_OUTSIDE
@OVERWRITE
def figures(film: Path, output: Path | None, **options: Any) -> None:
    """Write the figures of a film.

    \b
    Example:
      erlif figures data_samples/straight_bushing/film.nc
      erlif figures data_samples/straight_bushing/film.nc --only thickness_map \\
          --crank-angle "90 deg" --format svg --style paper -o paper
    """
    with large_imports():
        from erlif.show.plots import write_figures

    output = output or film.parent / "figures"
    if output.is_file():
        raise OutputError(
            f"Expected a directory for the figures; {output} is a file. Give another name with -o."
        )
    trigger, described = choose_one(film, options)
    with working() as progress:
        paths = write_figures(film, output, trigger=trigger, progress=progress, **options)
    if described:
        click.echo(described)
    click.echo(describe_written(paths))
