"""``erlif report``: one HTML page about a film."""

from __future__ import annotations

from pathlib import Path

import click

from erlif.commands.compiling import announced_compiling
from erlif.commands.options import ALLOW_OUTSIDE, OVERWRITE, PATH, expect_suffix
from erlif.commands.progress import show_progress


@click.command()
@click.argument("film", type=PATH)
@click.option("-o", "--output", type=PATH, help="Default: report.html beside FILM.")
@ALLOW_OUTSIDE
@OVERWRITE
def report(film: Path, output: Path | None, allow_outside: bool, overwrite: bool) -> None:
    """Write one self-contained HTML page about a film.

    \b
    Example:
      erlif report data_samples/straight_bushing/film.nc
    """
    from erlif.report import write_report

    output = output or film.parent / "report.html"
    expect_suffix(output, ".html")
    with announced_compiling(), show_progress() as progress:
        page = write_report(
            film, output, overwrite=overwrite, allow_outside=allow_outside, progress=progress
        )
    click.echo(str(page))
