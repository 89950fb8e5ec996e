"""Orbits of the virtual rig with cavities, which take up to half a minute each to follow.

They are kept in tests/reference/orbits.npz as they were followed once; `tests/rig` holds the solver
that followed them. With ERLIF_FULL each is followed again and compared. One of a name that the file
lacks is followed and put there, so that a name has all numbers that a test may change.
"""

import os
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path

import numpy as np
import numpy.testing as npt

from erlif.rig import RigSettings

PATH = Path(__file__).parents[1] / "reference" / "orbits.npz"
EXACT = 1e-9
"""Largest difference to an orbit that is followed again. [m]"""


def kept_orbit(name: str, follow: Callable[[], np.ndarray]) -> np.ndarray:
    """The orbit of a name [m]; `follow` computes it."""
    orbits = {}
    if PATH.exists():
        with np.load(PATH) as file:
            orbits = dict(file)
    if name not in orbits:
        orbits[name] = follow().astype(np.float32)
        np.savez_compressed(PATH, **dict(sorted(orbits.items())))
    elif os.environ.get("ERLIF_FULL"):
        npt.assert_allclose(follow(), orbits[name], rtol=0, atol=EXACT)
    return orbits[name].astype(float)


def name_of(rig: RigSettings) -> str:
    """The settings of a rig that are not the usual ones."""
    usual = asdict(RigSettings())
    return ", ".join(f"{k} {v}" for k, v in asdict(rig).items() if v != usual[k])
