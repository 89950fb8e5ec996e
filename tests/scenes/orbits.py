"""Two cycles of the joint of Farzaneh (2002), and orbits of its pin in thicker oil than stated."""

from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from scipy.stats import norm
from scipy.stats.qmc import LatinHypercube

from erlif.models.mechanism import CrankRocker
from erlif.models.reynolds import Journal, crank_motion, solve_journal
from erlif.prediction import FrameMotion, GivenErrors, MeasuredMotion, MotionFit
from erlif.rig.cavitation import follow_cavitated
from erlif.rig.orbit import RigidBearing, follow_orbit
from scenes.kept import kept_orbit

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

WIDTHS = GivenErrors(clearance=5e-6, load=0.1, load_line=0.5e-3, tilt=2e-5, drift=0.05)
"""From which rigs are drawn."""


def free_orbit(start, **oil):
    """Two cycles of a free pin by Chebyshev collocation; thicker and tilt are as of the rig."""
    return follow_orbit(
        RigidBearing(STATED.radius, STATED.clearance, STATED.length, VISCOSITY),
        MOTION.time[STEPS],
        load=lambda time: 222.4,
        rotation=lambda time: float(RIG.rocker_speed(SPEED * time, crank_speed=SPEED)),
        start=start,
        **oil,
    )


def follow_guided(bearing, time, *, steps=100, **options):
    """A guided pin by the rig's own cavities, after three turns in which they form."""
    period, middle = 2 * np.pi / SPEED, float(np.mean(RIG.limits()))
    return follow_cavitated(
        bearing,
        np.append(-3 * period, time),
        angle=lambda at: float(RIG.rocker_angle(SPEED * at)) - middle,
        step=period / steps,
        stiffness=np.inf,
        **options,
    )[1:]


@cache
def held_orbit(side=0.0, **changes):
    """Two cycles of a guided pin in a long film by fine steps and cells of the solver itself, after
    three turns; never to be changed.
    """
    joint = replace(STATED, viscosity=VISCOSITY, long=True, **changes)
    motion = crank_motion(RIG, crank_speed=SPEED, load=222.4, cycles=5, steps_per_cycle=800)
    solved = solve_journal(
        joint, motion, start=(205e-6, side), sideways="guided", cells=(192, 1), compiled=True
    )
    both = np.stack([solved.displacement_load, solved.displacement_side], axis=1)
    return both[3 * 800 : -1 : 16]


def measure(orbit, seed):
    """Positions with noise that is new at every frame."""
    noisy = orbit + np.random.default_rng(seed).normal(size=orbit.shape) * STD
    covariance = np.diag(STD**2) * np.ones((FRAMES, 1, 1))
    return MeasuredMotion(noisy, covariance, np.zeros((FRAMES, 2, 0)))


@dataclass(frozen=True)
class Drawn:
    """A rig whose given numbers are not those that are stated, and the positions of its pin."""

    measured: MeasuredMotion
    viscosity: float
    drift: float

    def pulls(self, found: MotionFit) -> dict[str, float]:
        """Errors of viscosity and drift over their standard deviations."""
        truth = {"viscosity": self.viscosity, "drift": self.drift}
        each = {name: found.estimates[name] for name in truth}
        return {name: (one.value - truth[name]) / one.std for name, one in each.items()}


def draw_rigs(count, sideways, seed=0):
    """Free or guided pins of the virtual rig, whose clearance, load, load line, tilt and drift are
    drawn from `WIDTHS`: each evenly over its distribution (Latin hypercube), so that a few rigs
    have the widths that are stated. The orbits of the guided ones of seed 0 are kept.
    """
    evenly = norm.ppf(LatinHypercube(5, rng=np.random.default_rng(seed)).random(count))
    for number, off in enumerate(evenly):
        yield _follow_rig(off, sideways, np.random.default_rng([seed, number]), keep=seed == 0)


def _follow_rig(off, sideways, rng, *, keep):
    """A rig whose given numbers are off by some of their standard deviations."""
    wider, heavier, line, tilt, drift = off * [
        WIDTHS.clearance, WIDTHS.load, WIDTHS.load_line, WIDTHS.tilt, WIDTHS.drift,
    ]  # fmt: skip
    clearance, load = STATED.clearance + wider, (1 + heavier) * 222.4
    viscosity, film = rng.uniform(0.1, 0.25), rng.uniform(12e-6, 26e-6)
    oil = RigidBearing(STATED.radius, clearance, STATED.length, viscosity)
    time = MOTION.time[STEPS]
    alike = {
        "load": lambda _: load,
        "thicker": lambda at: np.exp(drift * (max(at, 0.0) / time[-1] - 0.5)),
        "tilt": tilt,
    }
    if sideways == "free":
        start = clearance - film, rng.uniform(-30e-6, 30e-6)
        orbit = follow_orbit(
            oil,
            time,
            rotation=lambda at: float(RIG.rocker_speed(SPEED * at, crank_speed=SPEED)),
            start=start,
            **alike,
        )
    else:

        def follow():
            return follow_guided(oil, time, start=(clearance - film, 0.0), **alike)

        name = " ".join(f"{one:.5g}" for one in (*off, viscosity, film))
        orbit = kept_orbit(name, follow) if keep else follow()

    # the camera sees films: the displacement follows with the stated clearance
    turn = line / STATED.radius
    turned = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    seen = orbit * (1 - wider / np.hypot(*orbit.T))[:, np.newaxis] @ turned
    return Drawn(measure(seen, int(rng.integers(2**31))), viscosity, drift)
