"""Progress of long work on the terminal, and the line on kernels that are compiled."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Any

import click

from erlif.commands.ending import echo_aside
from erlif.core.progress import Progress

# What is counted, where it is not frame pairs.
_UNITS = {
    "figures": "figure",
    "movie": "frame",
    "maps": "map",
    "films": "film",
    "check": "part",
    "fit": "model",
    "pressure": "trigger",
}

# The line that is shown when the first kernel is compiled.
ANNOUNCEMENT = "compiling, once per machine"


@contextmanager
def working(*, lines: bool = True) -> Iterator[Progress]:
    """Show the progress of work that runs compiled kernels."""
    with announced_compiling(), show_progress(lines=lines) as progress:
        yield progress


@contextmanager
def announced_compiling() -> Iterator[None]:
    """Announce on standard error, in one line, that kernels are compiled.

    Nothing is written where all of them come from the cache.
    """
    from numba.core import event

    class Listener(event.Listener):
        """Called by numba for each kernel, and for the functions of numba inside it."""

        announced = False

        def on_start(self, event: Any) -> None:
            if not self.announced:
                self.announced = True
                echo_aside(ANNOUNCEMENT)

        def on_end(self, event: Any) -> None:
            pass

    with event.install_listener("numba:compile", Listener()):
        yield


@contextmanager
def show_progress(*, lines: bool = True) -> Iterator[Progress]:
    """Show a bar on a terminal, and, with `lines`, each finished piece of work elsewhere."""
    from tqdm import tqdm

    plain = not sys.stderr.isatty()
    bars: dict[str, Any] = {}

    def show(what: str, done: int, total: int) -> None:
        if plain:
            if lines and done == total and what not in bars:
                bars[what] = None
                echo_aside(f"{what}: {total} done")
            return
        with suppress(OSError):  # a terminal that is closed by now
            advance(what, done, total)

    def advance(what: str, done: int, total: int) -> None:
        # one bar at a time: the work is sequential
        if what not in bars:
            for bar in bars.values():
                bar.close()
            bars[what] = tqdm(total=total, desc=what, unit=_UNITS.get(what, "pair"), leave=False)
        bar = bars[what]
        bar.n = min(done, total)
        bar.refresh()

    try:
        yield show
    finally:
        for bar in bars.values():
            if bar is not None:
                with suppress(OSError):
                    bar.close()


def echo_above(text: str) -> None:
    """Write a line of result; it stands above the progress bar where there is one.

    Parameters
    ----------
    text : str
        One line, for standard output.
    """
    if not sys.stderr.isatty():
        click.echo(text)
        return
    from tqdm import tqdm

    with tqdm.external_write_mode():
        click.echo(text)
