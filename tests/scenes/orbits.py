"""Two cycles of the joint of Farzaneh (2002), and orbits of its pin in thicker oil than stated."""

import numpy as np

from erlif.models.mechanism import CrankRocker
from erlif.models.reynolds import Journal, crank_motion
from erlif.prediction import FrameMotion, MeasuredMotion
from erlif.rig.orbit import Bearing, follow_orbit

RIG = CrankRocker(crank=0.055, coupler=0.44, rocker=0.26, ground=0.51)
SPEED = 114 * 2 * np.pi / 60
STATED = Journal(0.03336, 0.03359, length=0.237, viscosity=0.12)
VISCOSITY = 0.15
FRAMES = 100
MOTION = crank_motion(RIG, crank_speed=SPEED, load=222.4, cycles=2, steps_per_cycle=100)
STEPS = np.arange(FRAMES) * 2
CRANK = np.arange(MOTION.time.size) * 2 * np.pi / 100
MOVED = FrameMotion(MOTION, STEPS, CRANK, 0.12)
STD = np.array([5e-9, 20e-9])


def free_orbit(start, **oil):
    """Two cycles of a free pin by Chebyshev collocation; thicker and tilt are as of the rig."""
    return follow_orbit(
        Bearing(STATED.radius, STATED.clearance, STATED.length, VISCOSITY),
        MOTION.time[STEPS],
        load=lambda time: 222.4,
        rotation=lambda time: float(RIG.rocker_speed(SPEED * time, crank_speed=SPEED)),
        start=start,
        **oil,
    )


def measure(orbit, seed):
    """Positions with noise that is new at every frame."""
    noisy = orbit + np.random.default_rng(seed).normal(size=orbit.shape) * STD
    covariance = np.diag(STD**2) * np.ones((FRAMES, 1, 1))
    return MeasuredMotion(noisy, covariance, np.zeros((FRAMES, 2, 0)))
