"""The order of the stages, and only here."""

from erlif.pipeline.batch import batch
from erlif.pipeline.fixture import calibrate
from erlif.pipeline.recording.images import restore_images
from erlif.pipeline.run import process

__all__ = [
    "batch",
    "calibrate",
    "process",
    "restore_images",
]
