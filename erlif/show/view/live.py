"""The page of a run that is watched: newest map, film over time, and what needs a look."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from threading import Event
from typing import Any, Protocol

from erlif.core.arrays import FlagImage, Image
from erlif.core.errors import ErlifError
from erlif.show.view.layers import LAYERS, describe_layers
from erlif.show.view.queries import Found, Request, pack_values
from erlif.show.view.serving import require_library, serving

# Time for which a request for news waits for some. [s]
_PATIENCE = 5.0

# Time in which news reach the page, and the page asks again. [s]
_SENT = 1.0

# Requests at a time: each open page waits for news in a thread, and for a map in another.
_THREADS = 16


class LiveSource(Protocol):
    """Protocol of the source of a page about a watched run."""

    def describe(self) -> dict[str, Any]:
        """Name of the run, size of a pixel [mm], and limits of the alarms."""
        ...

    def news(self, version: int, pairs: int, angles: int, timeout: float) -> dict[str, Any]:
        """The state once it is newer than `version`, with the pairs and angles after so many.

        All pairs come again where the minimum of another contact is theirs; `after` is the number
        of pairs that precede those that come.
        """
        ...

    def wait_for_map(self, after: int, timeout: float) -> None:
        """Wait until the newest map is of a later pair than `after`, at most `timeout` seconds."""
        ...

    def newest(self, layer: str) -> tuple[int, str, Image, FlagImage] | None:
        """Place, title, values and flags of a layer of the newest pair, (y, x); None before one."""
        ...


def readings_of(source: LiveSource) -> dict[str, Callable[[Request], Found]]:
    """Functions that serve the requests of the page, by their name in the address.

    Parameters
    ----------
    source : LiveSource

    Returns
    -------
    dict of str to callable
    """
    layers = [LAYERS[name] for name in ("thickness", "camera1", "camera2")]

    def describe(request: Request) -> Found:
        return source.describe() | describe_layers(layers)

    def news(request: Request) -> Found:
        version, pairs, angles = (request.whole(name) for name in ("version", "pairs", "angles"))
        found = source.news(version, pairs, angles, _PATIENCE)
        return {**found, "now": time.time()}

    def newest(request: Request) -> Found:
        layer = next((one for one in layers if one.name == request.text("layer")), None)
        if layer is None:
            raise ErlifError("Expected a layer that the page offers. Reload the page.")
        source.wait_for_map(request.whole("after"), _PATIENCE)
        shown = source.newest(layer.name)
        if shown is None:
            raise ErlifError(
                "Expected a pair that is measured; there is none yet. Wait for the first pair."
            )
        place, title, values, flags = shown
        return pack_values(request, layer, values, flags, text=title, place=place)

    return {"run": describe, "news": news, "map": newest}


@contextmanager
def live_page(source: LiveSource, *, page: str = "live.html", port: int = 0) -> Iterator[str]:
    """Serve the page while the block runs, and until an open page has shown the end.

    Parameters
    ----------
    source : LiveSource
    page : str
        File of the page itself.
    port : int
        Port on 127.0.0.1; 0 takes a free one.

    Yields
    ------
    str
        Address of the page, the token included.

    Raises
    ------
    ErlifError
        If the port is taken, or the packages of the viewer are missing.
    """
    require_library()
    executor, reading = ThreadPoolExecutor(_THREADS), readings_of(source)
    asked, shown = -math.inf, Event()

    def news(request: Request) -> Found:
        nonlocal asked
        asked = time.monotonic()
        found = reading["news"](request)
        if isinstance(found, dict) and found["closed"]:
            shown.set()
        return found

    shared = {"films": [], "executor": executor, "page": page, "reading": reading | {"news": news}}
    try:
        with serving(port=port, **shared) as address:
            try:
                yield address
            finally:
                # a page that is open asks at least once in this time, and shows the end
                if time.monotonic() - asked < _PATIENCE + _SENT and shown.wait(_PATIENCE):
                    time.sleep(_SENT)
    finally:
        executor.shutdown(wait=False, cancel_futures=True)
