"""``erlif view``: films in the browser."""

from __future__ import annotations

import os
import webbrowser
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from threading import Timer

import click

from erlif.commands.options import PATH
from erlif.core.speed.imports import large_imports

# Time for which the file that opens the browser is kept. [s]
_KEPT = 60.0


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
        from erlif.show.view import serve_films

    serve_until_interrupted(
        partial(serve_films, films, run_dirs=run_dirs, port=port), "viewer", browser=not no_browser
    )


def serve_until_interrupted(serve: Callable[..., None], what: str, *, browser: bool) -> None:
    """Serve a page until Ctrl-C, print its address, and open it in the browser where asked for.

    Parameters
    ----------
    serve : callable
        Takes `ready`, a function that receives the address.
    what : str
        Name of the page in messages.
    browser : bool
    """
    with ExitStack() as opened:

        def show(address: str) -> None:
            click.echo(f"The {what} is at {address}\nCtrl-C ends it.")
            if browser:
                webbrowser.open(opened.enter_context(leading_to(address)).as_uri())

        try:
            serve(ready=show)
        except KeyboardInterrupt:
            click.echo(f"The {what} has ended.")


@contextmanager
def leading_to(address: str) -> Iterator[Path]:
    """Write a page that leads to an address and that only its owner can read.

    Others on the machine see the command line of the browser, and with it the name of this file,
    but not the address. The file is removed after a minute, and in any case at the end.
    """
    # the directory is readable by its owner only as well
    with TemporaryDirectory(prefix="erlif_view_") as directory:
        page = Path(directory) / "view.html"
        with open(os.open(page, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "w") as file:
            file.write(
                '<!DOCTYPE html><html lang="en"><meta charset="utf-8"><title>erlif view</title>'
                f'<meta http-equiv="refresh" content="0; url={address}">'
                f'<p><a href="{address}">Open the viewer</a></p></html>\n'
            )
        removal = Timer(_KEPT, page.unlink, kwargs={"missing_ok": True})
        removal.daemon = True
        removal.start()
        try:
            yield page
        finally:
            removal.cancel()
