"""The orbit in a full film against closed forms, the rig's own orbit, and the transient film."""

import numpy as np
import numpy.testing as npt
from scenes.orbits import RIG, SPEED
from scenes.orbits import STATED as JOINT

from erlif.models.reynolds import Journal, Motion, crank_motion, solve_journal
from erlif.models.reynolds.full_film import follow_full_film

LONG = Journal(0.03336, 0.03359, length=0.237, viscosity=0.12, long=True)
FILMS = np.array([1.0, 0.7, 0.2, 0.05, 0.01, 0.002])


def test_orbit_and_transient_film_agree_where_nothing_ruptures():
    motion = crank_motion(RIG, crank_speed=SPEED, load=222.4, cycles=1, steps_per_cycle=100)
    start = (205e-6, 10e-6)
    solved = solve_journal(JOINT, motion, start=start, cells=(128, 8))
    found = follow_full_film(JOINT, motion, start=np.array([start]))[0]
    npt.assert_allclose(found[:, 0], solved.displacement_load, atol=1e-7)
    npt.assert_allclose(found[:, 1], solved.displacement_side, atol=2e-7)


def test_long_joint_under_a_spring_creeps_to_its_rest():  # an exponential at small displacements
    time = np.linspace(0.0, 2.0, 201)
    unloaded = Motion(time, angle=0 * time, load=1e-9)
    found = follow_full_film(
        LONG, unloaded, start=np.zeros((1, 2)), stiffness=LONG.squeeze_constant, rest=1e-9
    )[0, :, 1]
    npt.assert_allclose(found, 1e-9 * -np.expm1(-time * LONG.clearance), rtol=1e-4, atol=1e-15)
