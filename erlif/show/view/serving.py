"""The viewer as a server on this machine."""

from __future__ import annotations

import asyncio
import socket
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from threading import Thread
from typing import Any

from erlif.core.errors import ErlifError, reason_of
from erlif.show.view.access import AccessRule
from erlif.show.view.films import open_films

_THREADS = 2  # that read: a map is on its way while a profile is computed

_IDLE = 15  # s, after which a connection without a request is closed


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
        named = f"{' and '.join(missing)} {'is' if len(missing) == 1 else 'are'}"
        raise ErlifError(
            f"Expected the packages of the viewer; {named} not installed. "
            'Install with: pip install "erlif[view]"'
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
    films = open_films(paths, run_dirs)
    try:
        with (
            ThreadPoolExecutor(_THREADS) as executor,
            serving(port=port, films=films, executor=executor) as address,
        ):
            ready(address)
            while True:  # until it is interrupted
                time.sleep(1.0)
    finally:
        for film in films:
            film.close()


@contextmanager
def serving(*, port: int, **shared: Any) -> Iterator[str]:
    """Serve a page from a thread while the block runs.

    Parameters
    ----------
    port : int
        Port on 127.0.0.1; 0 takes a free one.
    **shared
        What the requests share, as for `erlif.show.view.handlers.Shared`, without the access.

    Yields
    ------
    str
        Address of the page, the token included.

    Raises
    ------
    ErlifError
        If the port is taken.
    """
    from erlif.show.view.handlers import PageServer, Shared, make_application

    # the port is known once the socket is open, and the address names it
    try:
        listening = socket.create_server(("127.0.0.1", port))
    except OSError as error:
        raise ErlifError(
            f"Expected port {port} of this machine to be free ({reason_of(error)}). Choose another "
            "one with --port, or leave it out."
        ) from error
    listening.setblocking(False)
    access = AccessRule(int(listening.getsockname()[1]))

    server = PageServer(
        make_application(Shared(access, **shared)),
        max_body_size=2**20,  # strokes of a brush, a point for each movement of the mouse
        idle_connection_timeout=_IDLE,
        body_timeout=_IDLE,
    )
    started: Future[Callable[[], object]] = Future()

    async def run() -> None:
        ended = asyncio.Event()
        asyncio.get_running_loop().set_exception_handler(_report_once())
        server.add_socket(listening)
        started.set_result(partial(asyncio.get_running_loop().call_soon_threadsafe, ended.set))
        await ended.wait()
        server.stop()
        await server.close_all_connections()

    thread = Thread(target=asyncio.run, args=(run(),), name="page", daemon=True)
    thread.start()
    end = started.result()
    try:
        yield access.address
    finally:
        end()
        thread.join()


def _report_once() -> Callable[[asyncio.AbstractEventLoop, dict[str, Any]], None]:
    """Logs each fault of the loop once, which tries again without a pause."""
    reported: set[str] = set()

    def report(loop: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
        text = f"{context['message']} {context.get('exception')}"
        if text not in reported:
            reported.add(text)
            loop.default_exception_handler(context)

    return report
