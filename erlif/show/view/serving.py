"""The viewer as a server on this machine."""

from __future__ import annotations

import asyncio
import socket
from collections.abc import Awaitable, Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from erlif.core.errors import ErlifError, reason_of
from erlif.show.view.access import AccessRule
from erlif.show.view.films import open_films

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
        raise ErlifError(
            f"Expected the packages of the viewer; {' and '.join(missing)} is not installed. "
            'Install it with: pip install "erlif[view]"'
        )


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
    from erlif.show.view.handlers import Shared, make_application

    films = open_films(paths, run_dirs)
    listening = open_port(port)
    try:
        with ThreadPoolExecutor(_THREADS) as executor:
            asyncio.run(
                serve(
                    lambda access: make_application(Shared(access, films, executor)),
                    listening,
                    ready=ready,
                    ended=asyncio.Event().wait,
                )
            )
    finally:
        for film in films:
            film.close()


def open_port(port: int) -> socket.socket:
    """Listen at a port of this machine; 0 takes a free one.

    Raises ErlifError where the port is taken.
    """
    try:
        listening = socket.create_server(("127.0.0.1", port))
    except OSError as error:
        raise ErlifError(
            f"Expected port {port} of this machine to be free ({reason_of(error)}). Choose another "
            "one with --port, or leave it out."
        ) from error
    listening.setblocking(False)
    return listening


async def serve(
    make: Callable[[AccessRule], Any],
    listening: socket.socket,
    *,
    ready: Callable[[str], None],
    ended: Callable[[], Awaitable[object]],
) -> None:
    """Serve an application to the page that has its token.

    Parameters
    ----------
    make : callable
        Makes the application of tornado.
    listening : socket
        As `open_port` returns it.
    ready : callable
        Receives the address of the page, the token included.
    ended : callable
        What it returns is awaited; the server then ends.
    """
    from tornado.httpserver import HTTPServer

    # the port is known once the socket is open, and the address names it
    access = AccessRule(int(listening.getsockname()[1]))
    server = HTTPServer(make(access), max_body_size=2**16)
    server.add_socket(listening)
    try:
        ready(access.address)
        await ended()
    finally:
        server.stop()
