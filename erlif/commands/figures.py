"""``erlif figures``: the figures of a film as files."""

from __future__ import annotations

from pathlib import Path

import click

from erlif.commands.compiling import announced_compiling
from erlif.commands.options import ALLOW_OUTSIDE, OVERWRITE, PATH
from erlif.core.errors import OutputError


@click.command()
@click.argument("film", type=PATH)
@click.option("-o", "--output", type=PATH, help="Directory; default: figures/ beside FILM.")
@ALLOW_OUTSIDE
@OVERWRITE
def figures(film: Path, output: Path | None, allow_outside: bool, overwrite: bool) -> None:
    """Write the figures of a film as PNG and PDF.

    \b
    Example:
      erlif figures data_samples/straight_bushing/film.nc
    """
    from erlif.plots import write_figures

    output = output or film.parent / "figures"
    if output.is_file():
        raise OutputError(
            f"Expected a directory for the figures; {output} is a file. Give another name with -o."
        )
    with announced_compiling():
        paths = write_figures(film, output, overwrite=overwrite, allow_outside=allow_outside)
    for path in paths:
        click.echo(str(path))
