"""The page of a run that is watched: newest map, film over time, and what needs a look."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from threading import Event
from typing import TYPE_CHECKING

from erlif.core.errors import ErlifError
from erlif.show.view.layers import LAYERS, describe_layers
from erlif.show.view.queries import Found, Request, pack_values
from erlif.show.view.serving import require_library, serving

if TYPE_CHECKING:
    from erlif.pipeline.watch.setup import SetupWatch
    from erlif.pipeline.watch.watch import Watch

# Time for which a request for news waits for some. [s]
_PATIENCE = 5.0

# Time in which news reach the page, and the page asks again. [s]
_SENT = 1.0

# Requests at a time: each open page waits for news in a thread, and for a map in another.
_THREADS = 16


def readings_of(source: Watch | SetupWatch) -> dict[str, Callable[[Request], Found]]:
    """Functions that serve the requests of the page, by their name in the address.

    Parameters
    ----------
    source : Watch or SetupWatch

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
def live_page(
    source: Watch | SetupWatch, *, page: str = "live.html", port: int = 0
) -> Iterator[str]:
    """Serve the page while the block runs, and until an open page has shown the end.

    Parameters
    ----------
    source : Watch or SetupWatch
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
