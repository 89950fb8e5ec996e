"""The viewer as a server on this machine."""

from __future__ import annotations

import asyncio
import socket
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from importlib.util import find_spec
from pathlib import Path

from erlif.core.errors import reason_of
from erlif.show.refusals import refusal
from erlif.show.view.access import AccessRule
from erlif.show.view.films import FilmReader, open_films

_THREADS = 2  # that read: a map is on its way while a profile is computed


def require_library() -> None:
    """Refuse to start without the packages of the viewer.

    Raises
    ------
    ErlifError
        With the line that installs them.

    Examples
    --------
    >>> require_library()
    """
    missing = [name for name in ("tornado", "tomlkit") if find_spec(name) is None]
    if missing:
        raise refusal("no_packages", missing=" and ".join(missing))


def serve_films(
    paths: Sequence[Path],
    *,
    run_dirs: Sequence[Path] = (),
    port: int = 0,
    ready: Callable[[str], None] = print,
) -> None:
    """Serve the viewer of some films until it is interrupted.

    Parameters
    ----------
    paths : sequence of Path
        ``film.nc`` or ``film.zarr``.
    run_dirs : sequence of Path
        Run directories in the order of the films, for ratio and camera images; default: the
        directory of each film.
    port : int
        Port on 127.0.0.1; 0 takes a free one.
    ready : callable
        Receives the address of the page, the token included.

    Raises
    ------
    ErlifError
        If a film cannot be opened, the port is taken, or the packages of the viewer are missing.

    Examples
    --------
    >>> serve_films([Path("no such film.nc")])  # doctest: +ELLIPSIS
    Traceback (most recent call last):
        ...
    erlif.core.errors.OutputError: Expected a film file; no such film.nc does not exist. ...
    """
    require_library()
    films = open_films(paths, run_dirs)
    try:
        asyncio.run(_serve(films, port, ready))
    finally:
        for film in films:
            film.close()


async def _serve(films: Sequence[FilmReader], port: int, ready: Callable[[str], None]) -> None:
    from tornado.httpserver import HTTPServer

    from erlif.show.view.handlers import make_application

    try:
        listening = socket.create_server(("127.0.0.1", port))
    except OSError as error:
        raise refusal("port_in_use", port=port, reason=reason_of(error)) from error
    # the port is known once the socket is open, and the address names it
    listening.setblocking(False)
    access = AccessRule(int(listening.getsockname()[1]))
    with ThreadPoolExecutor(_THREADS) as executor:
        server = HTTPServer(make_application(access, films, executor), max_body_size=2**16)
        server.add_socket(listening)
        try:
            ready(access.address)
            await asyncio.Event().wait()
        finally:
            server.stop()
