"""Small simulations of the virtual rig and what reads them back, for the tests of the rig."""

import hashlib
from pathlib import Path

import numpy as np
import tifffile

from erlif.rig import RigSettings
from erlif.rig.orbit import RigidBearing

SMALL = RigSettings(
    width=96, height=80, fixture_frames=3, dead_pixels=1, dark_pages=16, flat_pages=8
)
"""A whole cycle of 50 triggers on 96 x 80 pixels."""

QUICK = RigSettings(width=64, height=48, spacing=8.0, fixture_frames=1, dark_pages=1, flat_pages=1)
"""Six triggers on 64 x 48 pixels."""

ACRYLIC = RigidBearing(np.sqrt(33.36e-3 * 33.59e-3), 0.23e-3, 0.237, 0.12)
LOAD, CYCLE = 222.411, 60 / 114  # N, 50 lbf; s


def small_rig(**changes) -> RigSettings:
    """Sixteen triggers on 128 x 96 pixels without bubbles, and what a test changes."""
    size = {"width": 128, "height": 96, "spacing": 3.0}
    return RigSettings(**{**size, "fixture_frames": 6, "bubbles": 0, **changes})


def read_frames(directory: Path, number: int) -> np.ndarray:
    """All frames of one camera, (frame, y, x). [DN]"""
    return np.stack(
        [tifffile.imread(path) for path in sorted((directory / f"camera{number}").glob("*.tif"))]
    )


def digest(directory: Path) -> dict[str, str]:
    """SHA-256 of every file by its path."""
    return {
        str(path.relative_to(directory)): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(directory.rglob("*"))
        if path.is_file()
    }
