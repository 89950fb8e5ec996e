"""The compiled steps against the plain ones."""

import numpy as np
import numpy.testing as npt
import pytest
from scenes.orbits import RIG

from erlif.models.reynolds import Groove, Journal, Mount, crank_motion, solve_journal

MOTION = crank_motion(RIG, crank_speed=12.0, load=222.4, cycles=0.6, steps_per_cycle=60)
CASES = {
    "free": ({}, {}),
    "long, guided, with cavities": (
        {"long": True, "cavitation_pressure": -3e4},
        {"sideways": "guided", "start": (2.1e-4, 2e-5), "cells": (64, 1)},
    ),
    "on a spring aside": (
        {"cavitation_pressure": 0.0},
        {"sideways": Mount(3e6, rest=1e-5, direction=0.2), "start": (1.8e-4, 0.0)},
    ),
    "with an axial shape": (
        {"axial_shape": [3e-5, 0.0, 1e-5]},
        {"grooves": [Groove(3.0, 0.4), Groove(-2.0)]},
    ),
    "with cells of unequal length at a lobe": (
        {"axial_shape": -1e-5 * np.maximum(1 - np.arange(-25.0, 16.0) ** 2 / 50, 0)},
        {"sideways": "guided", "start": (2.1e-4, 0.0)},
    ),
    "rough and piezoviscous": (
        {"roughness": 5e-6, "pressure_viscosity": 2e-7},
        {"sideways": "guided", "start": (2.2e-4, 0.0)},
    ),
    "without a groove": ({}, {"grooves": []}),
}


@pytest.mark.parametrize("name", CASES)
def test_compiled_steps_are_the_plain_ones(name):
    joint, case = CASES[name]
    journal = Journal(0.03336, 0.03359, length=0.237, viscosity=0.12, **joint)
    case = {"cells": (64, 3), "maps": [0, 7, 20], **case}
    plain, compiled = (
        solve_journal(journal, MOTION, compiled=choice, **case) for choice in (False, True)
    )
    for variable in plain.data_vars:
        size = max(float(np.abs(plain[variable]).max()), 1e-20)
        scale = 222.4 if variable.startswith("reaction") else size
        npt.assert_allclose(
            compiled[variable], plain[variable], atol=1e-8 * scale, err_msg=variable
        )
