"""A small film, and a viewer that serves it."""

import asyncio
import threading
from concurrent.futures import ThreadPoolExecutor

import pytest
from tornado.httpserver import HTTPServer
from tornado.netutil import bind_sockets

from erlif.show.plots.example import write_example
from erlif.show.view.access import AccessRule
from erlif.show.view.films import open_films
from erlif.show.view.handlers import Shared, make_application


@pytest.fixture(scope="session")
def example_path(tmp_path_factory):
    """film.nc of the example, alone in its directory."""
    return write_example(tmp_path_factory.mktemp("view") / "film.nc")


@pytest.fixture(scope="session")
def serve():
    """Serve films in a thread until the tests end; gives the access."""
    loop = asyncio.new_event_loop()
    thread = threading.Thread(target=loop.run_forever, daemon=True)
    thread.start()
    executor = ThreadPoolExecutor(2)
    opened, servers = [], []

    def start(*paths, run_dirs=()):
        films = open_films(paths, run_dirs)
        opened.extend(films)

        async def listen():
            sockets = bind_sockets(0, "127.0.0.1")
            access = AccessRule(sockets[0].getsockname()[1])
            server = HTTPServer(
                make_application(Shared(access, films, executor)), max_body_size=2**16
            )
            server.add_sockets(sockets)
            servers.append(server)
            return access

        return asyncio.run_coroutine_threadsafe(listen(), loop).result(10)

    yield start

    async def close():
        for server in servers:
            server.stop()
            await server.close_all_connections()

    asyncio.run_coroutine_threadsafe(close(), loop).result(10)
    loop.call_soon_threadsafe(loop.stop)
    thread.join(10)
    loop.close()
    executor.shutdown()
    for film in opened:
        film.close()
