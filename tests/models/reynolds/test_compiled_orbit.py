"""The compiled orbits against those of the virtual rig, which shares no code with them."""

import numpy as np
import numpy.testing as npt
from scenes.orbits import RIG, SPEED, STATED

from erlif.models.reynolds import crank_motion
from erlif.models.reynolds.full_film import follow_full_film
from erlif.rig.orbit import RigidBearing, follow_orbit


def test_pins_of_any_start_and_oil_sink_as_those_of_the_virtual_rig():
    motion = crank_motion(RIG, crank_speed=SPEED, load=222.4, cycles=6, steps_per_cycle=100)
    start = np.array([[0.0, 0.0], [1.8e-4, 2e-5], [1e-4, -1e-5]])
    fluidity = np.array([1.0, 0.3, 2.0])
    found = follow_full_film(STATED, motion, start=start, fluidity=fluidity)
    for pin, place, share in zip(found, start, fluidity, strict=True):
        orbit = follow_orbit(
            RigidBearing(STATED.radius, STATED.clearance, STATED.length, STATED.viscosity / share),
            motion.time,
            load=lambda time: 222.4,
            rotation=lambda time: float(RIG.rocker_speed(SPEED * time, crank_speed=SPEED)),
            start=tuple(place),
        )
        npt.assert_allclose(pin, orbit, atol=5e-8)


def test_a_film_that_falls_quickly_is_followed_between_sparse_steps():
    """By up to a half from one step to the next."""
    motion = crank_motion(RIG, crank_speed=SPEED, load=222.4, cycles=1, steps_per_cycle=25)
    start, fluidity = (8e-5, 1e-5), np.array([20.0, 80.0])
    found = follow_full_film(STATED, motion, start=np.array([start, start]), fluidity=fluidity)
    for pin, share in zip(found, fluidity, strict=True):
        orbit = follow_orbit(
            RigidBearing(STATED.radius, STATED.clearance, STATED.length, STATED.viscosity / share),
            motion.time,
            load=lambda time: 222.4,
            rotation=lambda time: float(RIG.rocker_speed(SPEED * time, crank_speed=SPEED)),
            start=start,
        )
        film, known = (STATED.clearance - np.hypot(*one.T) for one in (pin, orbit))
        npt.assert_allclose(film, known, rtol=1e-3)
