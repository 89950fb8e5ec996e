"""Frames of triggers, and the start of the search."""

import numpy as np
import numpy.testing as npt

from erlif.models.reynolds import Journal, Motion
from erlif.prediction.measured import MeasuredMotion
from erlif.prediction.orbits import FreeOrbits
from erlif.prediction.problem import FrameSteps, Problem

LONG = Journal(0.03336, 0.03359, length=0.237, viscosity=0.12, long=True)
TIME = np.linspace(0.0, 4.0, 41)
AT_REST = Motion(TIME, angle=0 * TIME, load=222.4)


def sinking(viscosity):
    """Pure squeeze of a long film in closed form."""
    ratio = 3.0 + TIME * 222.4 / (LONG.squeeze_constant * viscosity / LONG.viscosity)
    place = np.stack([LONG.clearance * ratio / np.hypot(1, ratio), 0 * TIME], axis=1)
    return MeasuredMotion(place, 1e-16 * np.eye(2) * np.ones((41, 1, 1)), np.zeros((41, 2, 0)))


def pose(measured):
    """The fit of the viscosity of a free pin."""
    frames = FrameSteps.of(measured, np.arange(41), None)
    problem = Problem(FreeOrbits(LONG, AT_REST), frames, measured, "free")
    return problem, problem.unknowns(("viscosity",), {"load_line": 5e-3})


def test_triggers_are_the_means_of_their_frames():
    measured = sinking(0.12)
    frames = FrameSteps.of(measured, np.arange(4), np.array([2, 0, -1, 2]))
    assert frames.measured.tolist() == [0, 2]
    values = np.array([[1.0, 2.0, 100.0, 4.0]])
    npt.assert_allclose(frames.average(values)[0, [0, 2]], [2.0, 2.5])
    assert np.isnan(frames.average(values)[0, 1])


def test_search_begins_at_the_closed_form_of_squeeze():
    _, unknowns = pose(sinking(0.48))
    start = dict(zip(unknowns.names, unknowns.start, strict=True))
    npt.assert_allclose(start["fluidity"], 0.25, rtol=1e-3)
    npt.assert_allclose(np.exp(start["start_film"]), 230e-6 * (1 - 3 / np.hypot(1, 3)), rtol=1e-3)
    assert not unknowns.fixed


def test_load_line_turns_the_orbit():
    problem, unknowns = pose(sinking(0.12))
    sets = np.tile(unknowns.start, (2, 1))
    sets[1, unknowns.names.index("load_line")] = 0.01
    straight, turned = problem.predict(sets, unknowns)
    npt.assert_allclose(np.hypot(*turned.T), np.hypot(*straight.T), rtol=1e-12)
    npt.assert_allclose(turned[:, 1], straight[:, 0] * np.sin(0.01), rtol=1e-9)
