"""The first start on a machine: kernels are compiled, and one line announces it."""

from __future__ import annotations

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

        def on_start(self, event: Any) -> None:
            if not self.announced:
                self.announced = True
                _announce(ANNOUNCEMENT)

        def on_end(self, event: Any) -> None:
            pass

    with event.install_listener("numba:compile", Listener()):
        yield


def _announce(line: str) -> None:
    """Write one line, above a progress bar where there is one."""
    tqdm = sys.modules.get("tqdm")
    if tqdm is not None and sys.stderr.isatty():
        tqdm.tqdm.write(line, file=sys.stderr)
    else:
        echo_aside(line)
