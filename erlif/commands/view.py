"""``erlif view``: films in the browser."""

from __future__ import annotations

import webbrowser
from pathlib import Path

import click

from erlif.commands.loading import large_imports
from erlif.commands.options import PATH


@click.command()
@click.argument("films", metavar="FILM...", type=PATH, nargs=-1, required=True)
@click.option("--port", type=click.IntRange(0, 65535), default=0, help="Default: a free one.")
@click.option(
    "--run-dir",
    "run_dirs",
    type=PATH,
    multiple=True,
    help="Run directory of the film, for ratio and camera images; once for each FILM, in their "
    "order. Default: the directory of the film.",
)
@click.option("--no-browser", is_flag=True, help="Print the address and open no browser.")
def view(films: tuple[Path, ...], port: int, run_dirs: tuple[Path, ...], no_browser: bool) -> None:
    """Look at films in the browser, on this machine only.

    \b
    Example:
      erlif view data_samples/straight_bushing/film.nc
    """
    with large_imports():
        from erlif.view import serve_films

    def show(address: str) -> None:
        click.echo(f"The viewer is at {address}\nCtrl-C ends it.")
        if not no_browser:
            webbrowser.open(address)

    try:
        serve_films(films, run_dirs=run_dirs, port=port, ready=show)
    except KeyboardInterrupt:
        click.echo("The viewer has ended.")
