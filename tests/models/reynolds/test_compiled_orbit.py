"""The compiled orbits against the plain ones."""

import numpy as np
import numpy.testing as npt

from erlif.models.mechanism import CrankRocker
from erlif.models.reynolds import Journal, crank_motion
from erlif.models.reynolds.full_film import follow_full_film

RIG = CrankRocker(crank=0.055, coupler=0.44, rocker=0.26, ground=0.51)
JOINT = Journal(0.03336, 0.03359, length=0.237, viscosity=0.12)


def test_compiled_orbits_are_the_plain_ones():
    motion = crank_motion(RIG, crank_speed=12.0, load=222.4, cycles=2, steps_per_cycle=100)
    cases = {
        "start": np.array([[0.0, 0.0], [2e-4, 2e-5], [2.2e-4, -1e-5]]),
        "fluidity": np.array([1.0, 0.3, 2.0]),
        "stiffness": np.array([0.0, 1e5, 1e7]),
        "rest": np.array([0.0, 1e-5, 0.0]),
    }
    plain, compiled = (
        follow_full_film(JOINT, motion, compiled=choice, **cases) for choice in (False, True)
    )
    npt.assert_allclose(compiled, plain, atol=1e-12 * JOINT.clearance)
