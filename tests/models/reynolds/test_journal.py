"""The joint, its motion and its mount, and what is refused."""

import numpy as np
import numpy.testing as npt

from erlif.models.contact import conformal_radius
from erlif.models.mechanism import CrankRocker
from erlif.models.reynolds import Journal, Motion, Mount, crank_motion
from erlif.models.reynolds.journal import as_mount

SIZES = {"pin_radius": 0.03336, "bushing_radius": 0.03359, "length": 0.237, "viscosity": 0.12}


def test_gap_has_the_curvature_of_the_conformal_radius():
    joint = Journal(**SIZES)
    curvature = joint.clearance / joint.radius**2
    npt.assert_allclose(curvature, 1 / conformal_radius(0.03336, bushing_radius=0.03359))


def test_crank_motion_swings_about_the_middle_of_the_rocker():
    loads = np.linspace(5.0, 6.0, 801)
    rig = CrankRocker(crank=0.055, coupler=0.44, rocker=0.26, ground=0.51)
    motion = crank_motion(rig, crank_speed=-12.0, load=loads, cycles=2, steps_per_cycle=400)
    npt.assert_allclose(motion.time[-1], 4 * np.pi / 12.0)
    npt.assert_allclose(motion.angle[:401], motion.angle[400:], atol=1e-12)
    npt.assert_allclose(motion.angle.max(), -motion.angle.min(), atol=1e-4)  # between two steps
    npt.assert_array_equal(motion.load, loads)
    halves = crank_motion(rig, crank_speed=1.0, load=5.0, cycles=2, steps_per_cycle=7.5)
    npt.assert_allclose(halves.time, np.arange(16) * 2 * np.pi / 7.5)


def test_held_pin_needs_a_direction_under_a_turning_load():
    turning = Motion([0.0, 1.0], [0.0, 0.0], load=1.0, load_direction=[0.0, 1.0])
    assert Mount(np.inf, direction=0.2).direction_for(turning) == 0.2
    assert as_mount("free").direction_for(turning) == 0.0
    steady = Motion([0.0, 1.0], [0.0, 0.0], load=1.0, load_direction=0.3)
    assert as_mount(2e4).direction_for(steady) == 0.3
