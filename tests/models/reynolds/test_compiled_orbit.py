"""The compiled orbits against the plain ones."""

import numpy as np
import numpy.testing as npt

from erlif.models.mechanism import CrankRocker
from erlif.models.reynolds import Journal, compiled_orbit, crank_motion
from erlif.models.reynolds.full_film import FullFilm, follow_full_film

RIG = CrankRocker(crank=0.055, coupler=0.44, rocker=0.26, ground=0.51)
JOINT = Journal(0.03336, 0.03359, length=0.237, viscosity=0.12)


def march(time, turns, forces, cases, table, width, thinnest, orbit, slope):
    """The steps of all pins in numpy, in place; arguments as of `compiled_orbit.march`."""
    logarithms = FullFilm.of(JOINT).table
    flow, spring, rest = cases.T

    def velocity(at, turn, force):
        # at: displacement in the half-angle frame over the clearance, (case, 2)
        cosine, sine = turn
        distance = np.hypot(at[:, 0], at[:, 1])
        centred = distance == 0  # where every direction is alike
        inside = distance + centred
        ux, uy = at[:, 0] / inside + centred, at[:, 1] / inside
        pull = force[1] - spring * (sine * at[:, 0] + cosine * at[:, 1] - rest)
        fx, fy = cosine * force[0] + sine * pull, cosine * pull - sine * force[0]
        easy = (
            np.exp(-logarithms(-np.log(np.maximum(1 - distance, thinnest)))) * flow[:, np.newaxis]
        )
        along = (fx * ux + fy * uy) * easy[:, 0]
        across = (fy * ux - fx * uy) * easy[:, 1]
        return np.stack([along * ux - across * uy, along * uy + across * ux], axis=1)

    state = orbit[:, 0]
    first = slope[:, 0] = velocity(state, turns[0], forces[0])
    for k, length in enumerate(np.diff(time)):
        middle, end = (turns[2 * k + 1], forces[2 * k + 1]), (turns[2 * k + 2], forces[2 * k + 2])
        second = velocity(state + 0.5 * length * first, *middle)
        third = velocity(state + 0.5 * length * second, *middle)
        fourth = velocity(state + length * third, *end)
        state = state + length / 6 * (first + 2 * second + 2 * third + fourth)
        first = velocity(state, *end)
        orbit[:, k + 1], slope[:, k + 1] = state, first


def test_compiled_orbits_are_the_plain_ones(monkeypatch):
    motion = crank_motion(RIG, crank_speed=12.0, load=222.4, cycles=2, steps_per_cycle=100)
    cases = {
        "start": np.array([[0.0, 0.0], [2e-4, 2e-5], [2.2e-4, -1e-5]]),
        "fluidity": np.array([1.0, 0.3, 2.0]),
        "stiffness": np.array([0.0, 1e5, 1e7]),
        "rest": np.array([0.0, 1e-5, 0.0]),
    }
    compiled = follow_full_film(JOINT, motion, **cases)
    monkeypatch.setattr(compiled_orbit, "march", march)
    plain = follow_full_film(JOINT, motion, **cases)
    npt.assert_allclose(compiled, plain, atol=1e-12 * JOINT.clearance)
