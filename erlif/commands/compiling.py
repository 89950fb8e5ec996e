"""The first start on a machine: kernels are compiled, and one line announces it."""

from __future__ import annotations

import gc
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from erlif.commands.ending import echo_aside

ANNOUNCEMENT = "compiling, once per machine"
"""The line that is shown when the first kernel is compiled."""


@contextmanager
def announced_compiling() -> Iterator[None]:
    """Announce on standard error, in one line, that kernels are compiled.

    Nothing is written where all of them come from the cache.
    """
    from numba.core import event

    class Listener(event.Listener):
        """Called by numba for each kernel, and for the functions of numba inside it."""

        announced = False
        depth = 0
        collects = True

        def on_start(self, event: Any) -> None:
            if not self.announced:
                self.announced = True
                _announce(ANNOUNCEMENT)

            # most objects of the compiler stay, and searching them for garbage takes an eighth of
            # its time; numba compiles in one thread at a time, so the depth is that of one kernel
            if self.depth == 0:
                self.collects = gc.isenabled()
                gc.disable()
            self.depth += 1

        def on_end(self, event: Any) -> None:
            self.depth -= 1
            if self.depth == 0 and self.collects:
                gc.enable()

    with event.install_listener("numba:compile", Listener()):
        yield


def _announce(line: str) -> None:
    """Write one line, above a progress bar where there is one."""
    tqdm = sys.modules.get("tqdm")
    if tqdm is not None and sys.stderr.isatty():
        tqdm.tqdm.write(line, file=sys.stderr)
    else:
        echo_aside(line)
