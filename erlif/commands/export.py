"""``erlif export``: a film for other programs."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from erlif.commands.options import OVERWRITE, PATH, TRIGGER, choose_one, output_option
from erlif.commands.progress import show_progress
from erlif.core.speed.imports import large_imports


@click.command()
@click.argument("film", type=PATH)
@click.option(
    "--to",
    type=click.Choice(["csv", "mat", "tiff", "vtk"]),
    required=True,
    help="Table; MATLAB and Octave; ImageJ; ParaView.",
)
@TRIGGER
@output_option("File, of VTK a directory", "beside FILM, by its name")
@OVERWRITE
def export(film: Path, to: str, output: Path | None, overwrite: bool, **options: Any) -> None:
    """Write a film in the format of another program.

    CSV is a table of the triggers, with films, motion, theory and their errors; with --trigger or
    an angle it is the map of that trigger. MATLAB files hold all numbers. VTK is a folder with the
    surface of the pin for each trigger.

    \b
    Example:
      erlif export data_samples/straight_bushing/film.nc --to csv
      erlif export data_samples/straight_bushing/film.nc --to csv \\
          --crank-angle "90 deg"
      erlif export data_samples/straight_bushing/film.nc --to vtk
    """
    with large_imports():
        from erlif.io.conversion import EXPORTS
        from erlif.io.conversion import export as export_film

    chosen, described = choose_one(film, options)
    # the name states which trigger the file holds
    part = "" if chosen is None else f"_trigger{chosen}"
    output = output or film.with_name(f"{film.stem}{part}{EXPORTS[to].ending}")
    with show_progress() as progress:
        export_film(film, output, to=to, trigger=chosen, overwrite=overwrite, progress=progress)
    if described:
        click.echo(described)
    click.echo(f"written: {output}")
