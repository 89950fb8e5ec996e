"""``erlif pressure``: the pressure that carries the joint, from its measured film."""

from __future__ import annotations

from pathlib import Path

import click

from erlif.commands.ending import NO_RESULT
from erlif.commands.lines import wrap
from erlif.commands.options import OVERWRITE, PATH, expect_output, output_option
from erlif.commands.progress import working
from erlif.core.speed.imports import large_imports


@click.command()
@click.argument("film", type=PATH)
@output_option("File", "pressure.nc beside FILM")
@OVERWRITE
def pressure(film: Path, output: Path | None, overwrite: bool) -> None:
    """Find the pressure in the film of an oscillating joint.

    Writes pressure.nc and its figure. The Reynolds equation is solved on the measured film and its
    rate. The load is not put in: the one that the pressure makes is compared with it. The exit
    status is 3 where no trigger has a pressure; pressure.nc then states why.

    \b
    Example:
      erlif pressure data_samples/straight_bushing/film.nc
    """
    with large_imports():
        from erlif.io.files import write_dataset
        from erlif.pipeline.physics.pressure import pressure_from_film
        from erlif.show.plots import write_pressure_figure

    # everything that can be refused is refused before the work starts
    output = output or film.parent / "pressure.nc"
    picture = output.with_suffix(".png")
    expect_output(output, ".nc", overwrite=overwrite, holds="peak_pressure")
    expect_output(picture, ".png", overwrite=overwrite)
    with working() as progress:
        result = pressure_from_film(film, progress=progress)
    write_dataset(result, output)
    click.echo(wrap(result.attrs["statement"]))
    written = [output]
    if result.pressure_measured.values.any():
        click.echo(wrap(result.attrs["balance"]))
        click.echo(wrap(result.attrs["given"]))
        written.append(write_pressure_figure(result, picture))
    click.echo(f"written: {', '.join(str(path) for path in written)}")
    if len(written) == 1:
        click.get_current_context().exit(NO_RESULT)
