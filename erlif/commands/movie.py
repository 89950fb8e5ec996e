"""``erlif movie``: the cycle of a film as a movie."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from erlif.commands.options import OVERWRITE, PATH, expect_suffix, output_option
from erlif.commands.progress import show_progress
from erlif.core.speed.imports import large_imports


@click.command()
@click.argument("film", type=PATH)
@output_option("File in .gif or .mp4", "cycle.gif beside FILM")
@click.option(
    "--fps",
    "frames_per_second",
    type=float,
    default=10.0,
    show_default=True,
    help="Frames, one a trigger, per second.",
)
@click.option(
    "--style", metavar="STYLE", help="paper, slides, or a style sheet of matplotlib, as in figures."
)
@OVERWRITE
def movie(film: Path, output: Path | None, **options: Any) -> None:
    """Write a movie of the cycle: map, mechanism, film against angle.

    MP4 needs the program ffmpeg. Of more than sixty triggers, sixty evenly chosen ones are shown.

    \b
    Example:
      erlif movie data_samples/straight_bushing/film.nc -o cycle.gif
    """
    with large_imports():
        from erlif.show.plots import cycle_movie

    output = output or film.parent / "cycle.gif"
    expect_suffix(output, ".gif", ".mp4")
    with show_progress() as progress:
        cycle_movie(film, output, progress=progress, **options)
    click.echo(f"written: {output}")
