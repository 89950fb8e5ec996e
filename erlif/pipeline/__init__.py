"""The order of the stages, and only here."""

from erlif.pipeline.batch import batch
from erlif.pipeline.budget import budget
from erlif.pipeline.fixture import calibrate
from erlif.pipeline.images import restore_images
from erlif.pipeline.init import init
from erlif.pipeline.run import process

__all__ = [
    "batch",
    "budget",
    "calibrate",
    "init",
    "process",
    "restore_images",
]
