"""Films of known truth, of which `erlif.prediction.compare_models` states what carries them.

Two cycles of 50 positions with noise of 5 nm along the load and 20 nm sideways, an error of 0.5 %
of all films and a shift that repeats at every trigger. The pins are those of the virtual rig, which
shares no code with the fit; the oil is given as 0.12 Pa s.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache

import numpy as np

from erlif.models.film import HAMROCK_DOWSON_LINE
from erlif.prediction import MeasuredMotion, SteadyFilm, compare_models
from erlif.prediction.comparison import REGIME_MAP
from erlif.rig import cavitation
from erlif.rig.orbit import RigidBearing, follow_orbit
from scenes.orbits import (
    CRANK,
    FRAMES,
    MOTION,
    MOVED,
    RIG,
    SPEED,
    STATED,
    STD,
    STEPS,
    follow_guided,
)

LOAD, OIL, PERIOD = 222.4, 0.12, 2 * np.pi / SPEED
TIME = MOTION.time[STEPS]
DRIVE = np.abs(np.asarray(RIG.rocker_speed(CRANK[STEPS], crank_speed=SPEED))) / LOAD
SCALE, MARKS = 0.005, np.array([10e-9, 30e-9])

# Dowson and Higginson, 2.65 R G^0.54 U^0.7 W^-0.13, and Martin, 4.9 R eta u / q, of hard walls
_MODULUS, _ALPHA, _RADIUS = 1e12 / (2 * (1 - 0.1**2)), 2e-8, 0.03336 * 0.03359 / 0.23e-3
_U = OIL * DRIVE * LOAD * 0.03336 / 2 / (2 * _MODULUS * _RADIUS)
_W = LOAD / 0.237 / (2 * _MODULUS * _RADIUS)
FORMULA = 2.65 * _RADIUS * (2 * _ALPHA * _MODULUS) ** 0.54 * _U**0.7 * _W**-0.13
STEADY = (
    SteadyFilm(HAMROCK_DOWSON_LINE, FORMULA, power=0.7),
    SteadyFilm(REGIME_MAP, 4.9 * _RADIUS * _U / _W, power=1.0),
)


@dataclass(frozen=True)
class Kind:
    """Films of one kind.

    Attributes
    ----------
    course : callable
        Generator to the true positions, (trigger, axis) [m], and the numbers that belong to them.
    right : str
        How a right sentence begins; "No model fits" always is right, where something else carries
        the film.
    sideways : tuple of str
        Transient films that are fitted.
    options : dict
        Of the comparison.
    """

    course: Callable
    right: str
    sideways: tuple[str, ...] = ("free", "any guided")
    options: dict = field(default_factory=dict)


def place(film):
    """Positions of a pin that stays on the load line under these films."""
    return np.stack([STATED.clearance - film, np.zeros_like(film)], axis=1)


def formula(rng, times=1.0):
    factor = times * rng.uniform(0.9, 1.1)
    return place(factor * FORMULA), {"factor": factor, "viscosity": OIL * factor ** (1 / 0.7)}


def power(rng, offset=0.0):
    exponent = rng.uniform(0.3, 0.55)
    film = offset + 9e-6 * (DRIVE / DRIVE.max()) ** exponent
    return place(film), {"power": exponent} | ({"offset": offset} if offset else {})


def constant(rng):
    return place(np.full(FRAMES, rng.uniform(5e-6, 15e-6))), {}


def free(rng, viscosity=OIL, falls=0.0):
    eta, film = viscosity * rng.uniform(0.85, 1.15), rng.uniform(6e-6, 20e-6)
    distance, angle = STATED.clearance - film, rng.uniform(-0.1, 0.1)
    orbit = follow_orbit(
        RigidBearing(STATED.radius, STATED.clearance, STATED.length, eta),
        TIME,
        load=lambda _: LOAD,
        rotation=lambda time: float(RIG.rocker_speed(SPEED * time, crank_speed=SPEED)),
        start=(distance * np.cos(angle), distance * np.sin(angle)),
        thicker=lambda time: np.exp(-falls * (max(time, 0.0) / TIME[-1] - 0.5)),
    )
    return orbit, {"viscosity": eta} | ({"drift": -falls} if falls else {})


@cache
def held(number):
    """A guided pin after three turns, extrapolated to infinitely many steps and nodes."""
    rng = np.random.default_rng(5000 + number)
    eta, film = rng.uniform(0.1, 0.15), rng.uniform(22e-6, 32e-6)

    def follow(along, steps):
        before, cavitation.ALONG = cavitation.ALONG, along
        try:
            return follow_guided(
                RigidBearing(STATED.radius, STATED.clearance, STATED.length, eta),
                TIME,
                steps=steps,
                load=lambda _: LOAD,
                start=(STATED.clearance - film, 0.0),
            )
        finally:
            cavitation.ALONG = before

    coarse = follow(12, 200)
    orbit = coarse + 2 * (follow(12, 400) - coarse) + 4 / 3 * (follow(24, 200) - coarse)
    return orbit, {"viscosity": eta}


def guided(rng):
    return held(int(rng.integers(3)))


def stick_slip(rng):
    phase = (7 * TIME / PERIOD + rng.uniform()) % 1
    return place(10e-6 + 1e-6 * phase), {}


GUIDED = ("free", "guided")
KINDS = {
    "formula": Kind(formula, "The film follows Hamrock-Dowson, line contact (2.65)"),
    "formula x 5": Kind(
        lambda rng: formula(rng, 5.03),
        "The shape is that of Hamrock-Dowson, line contact (2.65), the viscosity not",
    ),
    "power": Kind(power, "The film follows speed over load to the power"),
    "power above an offset": Kind(
        lambda rng: power(rng, 3e-6), "The film follows speed over load to"
    ),
    "constant": Kind(constant, "The film is constant within its errors"),
    "correlated constant": Kind(constant, "The film is constant within its errors"),
    "free pin": Kind(free, "Squeeze carries the film of a pin that is free sideways (very strong)"),
    "guided pin, line given": Kind(
        guided, "The swing carries the film of a guided pin", GUIDED, {"load_line_std": 0.0}
    ),
    "guided pin": Kind(guided, "The swing carries the film of a guided pin", GUIDED),
    "other oil": Kind(
        lambda rng: free(rng, 3 * OIL),
        "The shape is that of a pin that is free sideways, the viscosity not",
    ),
    "stick-slip": Kind(stick_slip, "No model fits"),
    "warming": Kind(lambda rng: free(rng, falls=0.12), "Squeeze carries the film of a pin that is"),
}
"""Rocking pins are those of a film (`erlif.pipeline.physics.fit`)."""


def wander(rng, correlation):
    """Noise of unit size with a first-order correlation, (trigger, axis)."""
    noise = rng.normal(size=(FRAMES, 2))
    for k in range(1, FRAMES):
        noise[k] = correlation * noise[k - 1] + np.sqrt(1 - correlation**2) * noise[k]
    return noise


def measure(orbit, rng, correlation=0.0):
    """Positions with their errors."""
    distance = np.hypot(*orbit.T)
    shared = np.zeros((FRAMES, 2, 3))
    shared[..., 0] = -SCALE * ((STATED.clearance - distance) / distance)[:, None] * orbit
    shared[:, 0, 1], shared[:, 1, 2] = MARKS
    value = orbit + STD * wander(rng, correlation) + shared @ rng.normal(size=3)
    return MeasuredMotion(value, np.diag(STD**2) * np.ones((FRAMES, 1, 1)), shared)


def compare(name, seed, correlation=None):
    """The comparison of a film of a kind, and its true numbers."""
    kind, rng = KINDS[name], np.random.default_rng([seed, *map(ord, name)])
    orbit, truth = kind.course(rng)
    if correlation is None:
        correlation = 0.8 if name.startswith("correlated") else 0.0
    measured = measure(orbit, rng, correlation)
    options = {"steady": STEADY, "drive": DRIVE, "sideways": kind.sideways, **kind.options}
    return compare_models(measured, STATED, MOVED, **options), truth


def pulls(found, truth):
    """Errors of the numbers of the first model over their standard deviations."""
    best = found.candidates[0].estimates
    return {
        key: (best[key].value - value) / best[key].std
        for key, value in truth.items()
        if key in best
    }
