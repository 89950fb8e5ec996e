"""``erlif start``: one page from folders of frames to a film."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import click

from erlif.commands.options import PATH
from erlif.commands.view import serve_until_interrupted
from erlif.core.speed.imports import large_imports


@click.command()
@click.argument("directory", type=PATH, default=".")
@click.option("--port", type=click.IntRange(0, 65535), default=0, help="Default: a free one.")
@click.option("--no-browser", is_flag=True, help="Print the address and open no browser.")
def start(directory: Path, port: int, no_browser: bool) -> None:
    """Go from folders of frames to a film in the browser.

    The page finds frames, darks, flats and the log in a folder of the run and in one of the
    fixture, both below DIRECTORY. It shows the images, asks for what the files do not hold, and
    writes it to run.toml and fixture.toml: scale, origin of the profile, region and masks are
    drawn on the frame. Then it checks, calibrates and processes. Served on this machine only.

    \b
    Example:
      erlif start rehearsal
    """
    with large_imports():
        from erlif.show.start import serve_start

    serve_until_interrupted(
        partial(serve_start, directory, port=port), "page", browser=not no_browser
    )
