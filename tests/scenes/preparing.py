"""A run on the way to its film, before the frames are measured."""

from pathlib import Path
from types import SimpleNamespace

from erlif.calibration import Calibration
from erlif.core.progress import silent
from erlif.io.ingest import open_run
from erlif.pipeline.fixture import find_calibration
from erlif.pipeline.physics.joint import locate_run
from erlif.pipeline.recording.prepare import PreparedRun, prepare_run

UNREAD = SimpleNamespace(correct=SimpleNamespace(pairs=SimpleNamespace(shape=(96, 128))))
"""A chain whose frames are not read."""


def prepare(directory: Path, calibration: Calibration) -> PreparedRun:
    """The run of a directory with its notes and what it is measured with."""
    run = open_run(directory)
    return prepare_run(run, locate_run(run), *find_calibration(run, calibration), silent)
