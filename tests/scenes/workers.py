"""Pieces of work for the workers of a cluster, which import them from here."""

from __future__ import annotations

import json
import os
import signal
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from distributed import LocalCluster

from erlif.core.errors import FrameError


@dataclass(frozen=True)
class Squares:
    """Squares of numbers, with the process that computed each."""

    seconds: float = 0.0
    """Time for one. [s]"""

    def __call__(self, item: int) -> tuple[int, int]:
        time.sleep(self.seconds)
        return item**2, os.getpid()


@dataclass(frozen=True)
class Checked:
    """Leaves a file for each process that checks it."""

    folder: Path

    def check(self) -> None:
        with (self.folder / str(os.getpid())).open("a") as file:
            file.write("checked\n")

    def __call__(self, item: int) -> int:
        time.sleep(0.02)
        return os.getpid()


@dataclass(frozen=True)
class Faulty:
    """Raises at one item."""

    at: int
    error: Exception = field(default_factory=lambda: FrameError("frame 7 is damaged"))

    def __call__(self, item: int) -> None:
        if item == self.at:
            raise self.error


@dataclass(frozen=True)
class Deadly:
    """Ends its process at the first item, as often as there are files in a folder."""

    folder: Path

    def __call__(self, item: int) -> Any:
        if item == 0:
            for file in self.folder.iterdir():
                file.unlink()
                os.kill(os.getpid(), signal.SIGKILL)
        return item


def serve(file: Path) -> None:
    """A scheduler with one worker in a process that a test kills; its address goes to a file."""
    with LocalCluster(
        n_workers=1,
        threads_per_worker=1,
        processes=False,
        protocol="tcp",
        dashboard_address="127.0.0.1:0",
    ) as cluster:
        part = file.with_suffix(".part")
        part.write_text(json.dumps({"address": cluster.scheduler_address}), encoding="utf-8")
        part.rename(file)
        time.sleep(600)
