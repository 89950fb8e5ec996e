"""The requests of the page as a web application of tornado."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from importlib.resources import files
from typing import Any

import tornado.web
from tornado.httputil import HTTPServerRequest

from erlif.core.errors import ErlifError
from erlif.show.view import queries
from erlif.show.view.access import HEADERS, AccessRule
from erlif.show.view.films import FilmReader

PAGE = {
    "": ("index.html", "text/html; charset=utf-8"),
    "view.css": ("view.css", "text/css; charset=utf-8"),
    "view.js": ("view.js", "text/javascript; charset=utf-8"),
    "draw.js": ("draw.js", "text/javascript; charset=utf-8"),
    "map.js": ("map.js", "text/javascript; charset=utf-8"),
    "charts.js": ("charts.js", "text/javascript; charset=utf-8"),
    "uPlot.css": ("uPlot.min.css", "text/css; charset=utf-8"),
    "uPlot.js": ("uPlot.iife.min.js", "text/javascript; charset=utf-8"),
}
"""Files of the page by their names in its address."""

Found = Mapping[str, Any] | bytes | queries.Export

READING: dict[str, Callable[[queries.Request], Found]] = {
    "films": queries.list_films,
    "cycle": queries.send_cycle,
    "map": queries.pack_map,
    "profile": queries.send_profile,
    "region": queries.send_region,
    "pixel": queries.send_pixel,
    "export": queries.export,
}
"""What can be read, by its name in the address."""


class _Guarded(tornado.web.RequestHandler):
    """A request that is served to the page of this viewer alone."""

    def initialize(
        self, access: AccessRule, films: Sequence[FilmReader], executor: Executor
    ) -> None:
        self.access, self.films, self.executor = access, films, executor

    def set_default_headers(self) -> None:
        for name, value in HEADERS.items():
            self.set_header(name, value)

    def prepare(self) -> None:
        # the token is compared before anything of the request is used
        request: HTTPServerRequest = self.request
        refusal = self.access.refusal(request.path, dict(request.headers.get_all()))
        if refusal:
            self.set_status(403)
            self.finish(f"Refused: {refusal}. Open the address that erlif view has printed.")

    def write_error(self, status_code: int, **details: Any) -> None:
        """An expected failure as a sentence; others without details of this machine."""
        error = (details.get("exc_info") or (None, None))[1]
        if isinstance(error, ErlifError):
            self.set_status(400)
            self.finish({"message": str(error)})
        else:
            reason = "there is no such page" if status_code == 404 else "the viewer has a defect"
            self.finish({"message": f"{reason} ({status_code})"})


class _PageFile(_Guarded):
    """A file of the page."""

    def get(self, name: str) -> None:
        if name not in PAGE:
            raise tornado.web.HTTPError(404)
        file, kind = PAGE[name]
        self.set_header("Content-Type", kind)
        self.finish(files("erlif.show.view").joinpath("page", file).read_bytes())


class _Reading(_Guarded):
    """Something that is read from the films, in a thread."""

    async def get(self, name: str) -> None:
        values = {key: self.get_query_argument(key) for key in self.request.query_arguments}
        request = queries.Request(self.films, values)
        # reading maps would block the other requests of the page
        found = await asyncio.get_running_loop().run_in_executor(
            self.executor, READING[name], request
        )
        if isinstance(found, queries.Export):
            self.set_header("Content-Type", "application/octet-stream")
            self.set_header("Content-Disposition", f'attachment; filename="{found.name}"')
            self.finish(found.content)
        elif isinstance(found, bytes):
            self.set_header("Content-Type", "application/octet-stream")
            self.finish(found)
        else:
            self.set_header("Content-Type", "application/json")
            self.finish(json.dumps(found, separators=(",", ":")))


class _Settings(_Guarded):
    """The region of interest in run.toml: shown first, and written when it is confirmed."""

    async def post(self) -> None:
        found = await asyncio.get_running_loop().run_in_executor(
            self.executor, queries.change_region, self.films, self.request.body
        )
        self.finish(found)


class _Missing(_Guarded):
    """Anything else."""

    def get(self) -> None:
        raise tornado.web.HTTPError(404)

    def post(self) -> None:
        raise tornado.web.HTTPError(404)


def make_application(
    access: AccessRule, films: Sequence[FilmReader], executor: Executor
) -> tornado.web.Application:
    """Make the application.

    Parameters
    ----------
    access : AccessRule
        Conditions under which requests are served.
    films : sequence of FilmReader
        Open films.
    executor : Executor
        Threads that read maps.

    Returns
    -------
    tornado.web.Application

    Examples
    --------
    >>> from concurrent.futures import ThreadPoolExecutor
    >>> application = make_application(AccessRule(8000), [], ThreadPoolExecutor(1))
    >>> application.settings["compress_response"]
    False
    """
    shared = {"access": access, "films": films, "executor": executor}
    token = r"/[^/]*/"
    return tornado.web.Application(
        [
            (token + f"({'|'.join(READING)})", _Reading, shared),
            (token + "settings", _Settings, shared),
            (token + r"([^/]*)", _PageFile, shared),
        ],
        default_handler_class=_Missing,
        default_handler_args=shared,
        compress_response=False,
        log_function=lambda handler: None,
    )
