"""The requests of the page as a web application of tornado."""

from __future__ import annotations

import asyncio
import json
import logging
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field
from importlib.resources import files
from typing import Any, TypeAlias

import tornado.web
from tornado.httpserver import HTTPServer
from tornado.httputil import HTTPServerRequest

from erlif.core.errors import ErlifError
from erlif.show.view import queries
from erlif.show.view.access import HEADERS, AccessRule
from erlif.show.view.films import FilmReader

_logger = logging.getLogger(__name__)

_PAGES = files("erlif.show.view").joinpath("page")
_KINDS = {"html": "html", "css": "css", "js": "javascript"}  # of text, by the suffix of a file

# Files of the pages by their names in the address.
FILES = {file.name: file for file in _PAGES.iterdir() if file.name.split(".")[-1] in _KINDS}

# What can be read, by its name in the address.
READING: dict[str, Callable[[queries.Request], queries.Found]] = {
    "films": queries.list_films,
    "cycle": queries.send_cycle,
    "map": queries.pack_map,
    "profile": queries.send_profile,
    "region": queries.send_region,
    "pixel": queries.send_pixel,
    "export": queries.export,
}

# What a page can send, by its name in the address: the region is shown first, and written to
# run.toml when it is confirmed.
Write: TypeAlias = Callable[[Sequence[FilmReader], bytes], Mapping[str, Any]]
WRITING: dict[str, Write] = {"settings": queries.change_region}


@dataclass(frozen=True)
class Shared:
    """Objects that all requests of a page share.

    Attributes
    ----------
    access : AccessRule
        Conditions under which requests are served.
    films : Sequence[FilmReader]
        Open films.
    executor : Executor
        Threads that read maps.
    page : str
        File of the page itself.
    reading : Mapping[str, Callable[[Request], Found]]
        What the page can ask for, by its name in the address.
    writing : Mapping[str, Callable[[Sequence[FilmReader], bytes], Mapping[str, Any]]]
        What the page can send, by its name in the address: functions of the films and the body.
    defects : set[tuple[type, str]]
        Those that were logged.
    """

    access: AccessRule
    films: Sequence[FilmReader]
    executor: Executor
    page: str = "view.html"
    reading: Mapping[str, Callable[[queries.Request], queries.Found]] = field(
        default_factory=lambda: READING
    )
    writing: Mapping[str, Write] = field(default_factory=lambda: WRITING)
    defects: set[tuple[type, str]] = field(default_factory=set)


class PageServer(HTTPServer):
    """A server with few connections: others on this machine could take all handles.

    Attributes
    ----------
    most : int
        Connections at a time, of which a browser has six for a page.
    """

    most = 64

    def handle_stream(self, stream: Any, address: Any) -> None:
        """Serve a new connection, or close it where there are too many."""
        if len(self._connections) < self.most:
            super().handle_stream(stream, address)
        else:
            stream.close()


class _Guarded(tornado.web.RequestHandler):
    """A request that is served to the page of this viewer alone."""

    def initialize(self, shared: Shared) -> None:
        self.shared = shared

    def set_default_headers(self) -> None:
        for name, value in HEADERS.items():
            self.set_header(name, value)

    def prepare(self) -> None:
        # the token is compared before anything of the request is used
        request: HTTPServerRequest = self.request
        refusal = self.shared.access.refusal(request.path, dict(request.headers.get_all()))
        if refusal:
            self.set_status(403)
            self.finish(f"Refused: {refusal}. Open the address that erlif has printed.")

    def send(self, content: str | bytes, kind: str) -> None:
        """Send text or bytes of a kind."""
        self.set_header("Content-Type", kind)
        self.finish(content)

    async def run(self, function: Callable[..., Any], *values: Any) -> Any:
        """Call a function in a thread of the executor."""
        return await asyncio.get_running_loop().run_in_executor(
            self.shared.executor, function, *values
        )

    def compute_etag(self) -> None:
        """None: no browser keeps what it gets, and the tag of a map takes a millisecond."""

    def log_exception(self, kind: Any, error: Any, traceback: Any) -> None:
        """Log a defect without its request, whose address holds the token."""
        if not isinstance(error, ErlifError | tornado.web.HTTPError):
            # the page asks again and again
            known = (kind, str(error)) in self.shared.defects
            self.shared.defects.add((kind, str(error)))
            if not known:
                _logger.error("the viewer has a defect", exc_info=(kind, error, traceback))

    def write_error(self, status_code: int, **details: Any) -> None:
        """An expected failure as a sentence; others without details of this machine."""
        error = (details.get("exc_info") or (None, None))[1]
        if isinstance(error, ErlifError):
            self.set_status(400)
            self.finish({"message": str(error)})
        else:
            reason = "the viewer has a defect" if status_code >= 500 else "this is not served"
            self.finish({"message": f"{reason} ({status_code})"})


class _PageFile(_Guarded):
    """A file of the page."""

    def get(self, name: str) -> None:
        name = name or self.shared.page
        if name not in FILES:
            raise tornado.web.HTTPError(404)
        kind = _KINDS[name.split(".")[-1]]
        self.send(FILES[name].read_bytes(), f"text/{kind}; charset=utf-8")


class _Reading(_Guarded):
    """Something that is read from the films, in a thread."""

    async def get(self, name: str) -> None:
        values = {key: self.get_query_argument(key) for key in self.request.query_arguments}
        request = queries.Request(self.shared.films, values)
        # reading maps would block the other requests of the page
        found = await self.run(self.shared.reading[name], request)
        if isinstance(found, bytes):
            self.send(found, "application/octet-stream")
        else:
            self.send(json.dumps(found, separators=(",", ":")), "application/json")


class _Writing(_Guarded):
    """Something that the page sends, as JSON."""

    async def post(self, name: str) -> None:
        write, films = self.shared.writing[name], self.shared.films
        self.finish(await self.run(write, films, self.request.body))


class _Missing(_Guarded):
    """Anything else."""

    def get(self) -> None:
        raise tornado.web.HTTPError(404)

    post = get


def make_application(shared: Shared) -> tornado.web.Application:
    """Make the application.

    Parameters
    ----------
    shared : Shared

    Returns
    -------
    tornado.web.Application

    Examples
    --------
    >>> from concurrent.futures import ThreadPoolExecutor
    >>> application = make_application(Shared(AccessRule(8000), [], ThreadPoolExecutor(1)))
    >>> application.settings["compress_response"]
    False
    """
    given = {"shared": shared}
    token = r"/[^/]*/"
    paths = {
        f"({'|'.join(shared.reading)})": _Reading,
        f"({'|'.join(shared.writing)})": _Writing,
        r"([^/]*)": _PageFile,
    }
    return tornado.web.Application(
        [(token + path, handler, given) for path, handler in paths.items()],
        default_handler_class=_Missing,
        default_handler_args=given,
        compress_response=False,
        log_function=lambda handler: None,
    )
