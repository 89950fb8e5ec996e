"""Errors of given numbers in a fit, against closed forms, refits and orbits of the virtual rig."""

from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest
from scenes.orbits import (
    MOTION,
    MOVED,
    RIG,
    SPEED,
    STATED,
    STEPS,
    VISCOSITY,
    free_orbit,
    measure,
)

from erlif.models.reynolds import crank_motion, solve_journal
from erlif.prediction import GivenErrors, fit_motion
from erlif.rig.orbit import Bearing, follow_orbit

CLEARANCE_STD, LOAD_STD = 5e-6, 0.1


@pytest.fixture(scope="module")
def free():
    return measure(free_orbit((215e-6, 30e-6)), 1)


@pytest.fixture(scope="module")
def guided():
    """Of a long joint, by fine steps of the solver itself, after three turns."""
    joint = replace(STATED, viscosity=VISCOSITY, long=True)
    motion = crank_motion(RIG, crank_speed=SPEED, load=222.4, cycles=5, steps_per_cycle=800)
    solved = solve_journal(
        joint, motion, start=(205e-6, 5e-6), sideways="guided", cells=(192, 1), compiled=True
    )
    both = np.stack([solved.displacement_load, solved.displacement_side], axis=1)
    return measure(both[3 * 800 : -1 : 16], 8)


def fit(measured, given=None, *, joint=STATED, moved=MOVED, **options):
    return fit_motion(measured, joint, moved, given=given, profiles=False, **options).estimates


def test_the_load_of_a_free_pin_enters_the_viscosity_in_proportion(free):
    """The orbit depends on viscosity over load alone, so that K/W is known without the load."""
    found = fit(free, GivenErrors(load=LOAD_STD))
    viscosity = found["viscosity"]
    npt.assert_allclose(viscosity.parts["load"], LOAD_STD * viscosity.value, rtol=5e-3)
    npt.assert_allclose(viscosity.std, np.hypot(*viscosity.parts.values()), rtol=1e-12)
    assert found["squeeze_time"].parts["load"] < 1e-3 * found["squeeze_time"].value
    assert found["start_film"].parts["load"] < found["start_film"].parts["fit"]


def test_the_clearance_enters_the_viscosity_by_the_power_three_halves():
    """A thin film is that of a cylinder of radius R^2/c on a plane: F ~ eta (R^2/c)^(3/2)."""
    joint = replace(STATED, long=True)
    ratio = 15.0 + MOTION.time[STEPS] * 222.4 / joint.squeeze_constant
    still = replace(MOVED, motion=replace(MOTION, angle=0 * MOTION.angle))
    films = measure(np.stack([joint.clearance * ratio / np.hypot(1, ratio), 0 * ratio], axis=1), 2)
    found = fit(films, GivenErrors(clearance=CLEARANCE_STD), joint=joint, moved=still)["viscosity"]
    share = found.parts["clearance"] / found.value
    npt.assert_allclose(share, 1.5 * CLEARANCE_STD / joint.clearance, rtol=0.02)


@pytest.mark.parametrize("pin", ["free", "guided"])
def test_changes_are_those_of_another_fit(pin, request):
    """The load of a held pin is no power of the viscosity: its cavities do not scale with it."""
    measured = request.getfixturevalue(pin)
    joint = replace(STATED, long=pin == "guided")
    options = {"sideways": pin, "joint": joint, "load_line_std": 0.0}
    given = GivenErrors(CLEARANCE_STD, LOAD_STD, load_line=0.0)
    found = fit(measured, given, **options)["viscosity"]
    wider = replace(joint, bushing_radius=joint.bushing_radius + CLEARANCE_STD)
    moved = replace(measured, value=measured.value + CLEARANCE_STD * measured.widening)
    again = fit(moved, **options | {"joint": wider})["viscosity"].value
    npt.assert_allclose(found.parts["clearance"], abs(again - found.value), rtol=0.03)

    heavy = replace(MOVED, motion=replace(MOTION, load=(1 + LOAD_STD) * MOTION.load))
    again = fit(measured, moved=heavy, **options)["viscosity"].value
    npt.assert_allclose(found.parts["load"], abs(again - found.value), rtol=0.1)


def test_a_given_load_line_of_a_guided_pin_is_not_fitted(guided):
    """Its error is one of the place at rest: r sin(line) of a pin at a displacement r."""
    joint, line = replace(STATED, long=True), 0.5e-3
    found = fit(guided, GivenErrors(load_line=line), joint=joint, sideways="guided")
    assert "load_line" not in found
    displaced = float(np.mean(guided.value[:, 0]))
    expected = displaced * line / STATED.radius
    npt.assert_allclose(found["rest"].parts["load_line"], expected, rtol=0.01)
    assert abs(found["rest"].value - 5e-6) < 3 * found["rest"].std
    assert "load_line" in fit(guided, joint=joint, sideways="guided")
    assert "load_line" in fit(guided, GivenErrors(load_line=line), joint=joint)


def test_the_error_of_a_fitted_load_line_is_that_of_the_likelihood(guided):
    """It is known by what the likelihood falls where it is fixed at the assumed place."""
    joint, line = replace(STATED, long=True), 1.5e-3 / STATED.radius
    turned = np.array([[np.cos(line), np.sin(line)], [-np.sin(line), np.cos(line)]])
    measured = replace(guided, value=guided.value @ turned)
    options = {"joint": joint, "sideways": "guided", "load_line_std": 5e-3}
    near, far = fit(guided, **options), fit(measured, **options)
    free, fixed = (
        fit_motion(measured, joint, MOVED, profiles=False, sideways="guided", load_line_std=std)
        for std in (5e-3, 0.0)
    )
    gain = free.minimum.log_likelihood - fixed.minimum.log_likelihood
    found = far["load_line"]
    npt.assert_allclose(found.std, abs(found.value) / np.sqrt(2 * gain), rtol=0.2)
    assert abs(found.value - 1.5e-3) < 2 * found.std
    # the place at rest follows the line, at the displacement of the pin
    assert found.std > near["load_line"].std
    slope = float(np.mean(guided.value[:, 0])) / STATED.radius
    npt.assert_allclose(far["rest"].std, slope * found.std, rtol=0.05)


def test_intervals_hold_the_given_errors(free):
    alone, found = (
        fit_motion(free, STATED, MOVED, given=given).estimates["viscosity"]
        for given in (None, GivenErrors(CLEARANCE_STD, LOAD_STD))
    )
    assert alone.parts == {}
    assert found.value == alone.value
    npt.assert_allclose(found.high - found.low, 2 * 1.96 * found.std, rtol=1e-3)
    assert alone.widened({"load": 1.0}).low == 0.0


def test_errors_hold_their_share_of_orbits_with_other_clearances_and_loads():
    """Of 40 orbits by collocation, 68 and 95 % are within one and two standard deviations."""
    rng = np.random.default_rng(4)
    pulls = []
    for seed in range(40):
        clearance = STATED.clearance + CLEARANCE_STD * rng.normal()
        load, viscosity = 222.4 * (1 + LOAD_STD * rng.normal()), rng.uniform(0.1, 0.3)
        orbit = follow_orbit(
            Bearing(STATED.radius, clearance, STATED.length, viscosity),
            MOTION.time[STEPS],
            load=lambda time, load=load: load,
            rotation=lambda time: float(RIG.rocker_speed(SPEED * time, crank_speed=SPEED)),
            start=(clearance - rng.uniform(8e-6, 30e-6), rng.uniform(-30e-6, 30e-6)),
        )
        # the camera sees films: the displacement follows with the stated clearance
        distance = np.hypot(*orbit.T)[:, np.newaxis]
        measured = measure(orbit * (1 - (clearance - STATED.clearance) / distance), seed)
        found = fit(measured, GivenErrors(CLEARANCE_STD, LOAD_STD))["viscosity"]
        pulls.append((found.value - viscosity) / found.std)
    # 2.6 standard deviations of the binomial about 27.3 and 38
    within = [int(np.sum(np.abs(pulls) < size)) for size in (1, 1.96)]
    assert 20 <= within[0] <= 35
    assert within[1] >= 35
    npt.assert_allclose(np.sqrt(np.mean(np.square(pulls))), 1.0, atol=2.6 / np.sqrt(80))


def test_a_negative_error_is_refused():
    with pytest.raises(ValueError, match="zero or more"):
        GivenErrors(load=-0.1)
