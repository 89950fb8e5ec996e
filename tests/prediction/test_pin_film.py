"""The film round a pin of known motion, against the rig's own series and closed forms."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif.models.reynolds import Journal
from erlif.prediction.pin_film import solve_pin_motion

JOINT = Journal(0.03336, 0.03359, length=0.237, viscosity=0.12)


def test_the_true_motion_has_the_pressure_of_the_rig_and_carries_its_load(free_pin):
    for k in (0, 5, 9):
        found = solve_pin_motion(JOINT, free_pin.position[k], free_pin.rate[k], free_pin.turning[k])
        middle = found.pressure.sel(axial=0.0, method="nearest")
        assert float(middle.max()) == pytest.approx(free_pin.peak[k], rel=0.01)
        place = float(found.angle[middle.values.argmax()]) * JOINT.radius
        assert place == pytest.approx(free_pin.place[k], abs=3e-4)  # half a cell
        assert float(found.reaction_load) == pytest.approx(free_pin.rig.load, rel=0.006)
        assert float(found.reaction_side) == pytest.approx(0.0, abs=0.5)


def test_a_wedge_has_the_pressure_of_sommerfeld():
    """12 pi eps/((2 + eps^2) sqrt(1 - eps^2)) eta omega R L (R/c)^2 across the line of centres.

    A film without cavities.
    """
    eccentricity, turning = 0.6, 2.0
    long = Journal(0.0333, 0.0335, 0.2, 0.1, cavitation_pressure=-1e9, long=True)
    position = np.array([eccentricity * long.clearance, 0.0, 0.0, 0.0])
    found = solve_pin_motion(long, position, np.zeros(4), turning)
    force = (
        12 * np.pi * eccentricity / ((2 + eccentricity**2) * np.sqrt(1 - eccentricity**2))
        * 0.1 * turning * long.radius * 0.2 * (long.radius / long.clearance) ** 2
    )  # fmt: skip
    assert float(found.reaction_side) == pytest.approx(-force, rel=1e-3)
    assert float(found.reaction_load) == pytest.approx(0.0, abs=1e-3 * force)


def test_a_pin_that_swings_with_half_the_bushing_meets_no_pressure():
    position = np.array([2e-4, 1e-5, 0.0, 0.0])
    rate = np.array([-position[1], position[0], 0, 0]) * 1.5
    found = solve_pin_motion(JOINT, position, rate, 3.0, cells=(64, 4))
    npt.assert_allclose(found.pressure, 0.0, atol=1e-6)
