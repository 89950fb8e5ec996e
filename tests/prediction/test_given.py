"""Errors of given numbers in a fit, against closed forms, refits and orbits of the virtual rig."""

from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest
from scenes.kept import kept_orbit
from scenes.orbits import (
    MOTION,
    MOVED,
    RIG,
    SPEED,
    STATED,
    STEPS,
    VISCOSITY,
    WIDTHS,
    draw_rigs,
    follow_guided,
    free_orbit,
    held_orbit,
    measure,
)

from conftest import FULL
from erlif.models.reynolds import crank_motion, solve_journal
from erlif.prediction import GivenErrors, fit_motion
from erlif.prediction.given import follow_changes
from erlif.rig.orbit import RigidBearing

CLEARANCE_STD, LOAD_STD = 5e-6, 0.1


@pytest.fixture(scope="module")
def free():
    return measure(free_orbit((215e-6, 30e-6)), 1)


@pytest.fixture(scope="module")
def guided():
    return measure(held_orbit(side=5e-6), 8)


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


def test_a_given_number_without_a_film_leaves_an_error_that_is_not_known(guided, monkeypatch):
    """A guided pin whose film no solution follows when the load changes is still fitted."""

    def lost(*args):
        changes = follow_changes(*args)
        nowhere = np.full_like(changes["load"].value, np.nan)
        return changes | {"load": replace(changes["load"], value=nowhere)}

    monkeypatch.setattr("erlif.prediction.fit.follow_changes", lost)
    given = GivenErrors(load=0.01, load_line=0.0)
    found = fit(guided, given, joint=replace(STATED, long=True), sideways="guided")
    assert np.isinf(found["viscosity"].parts["load"])
    assert np.isfinite(found["viscosity"].parts["fit"])


def test_a_given_load_line_of_a_guided_pin_is_not_fitted(guided):
    """Its error is one of the place at rest: r sin(line) of a pin at a displacement r."""
    joint, line = replace(STATED, long=True), 0.5e-3
    found = fit(guided, GivenErrors(load_line=line, tilt=4e-5), joint=joint, sideways="guided")
    assert found["viscosity"].parts["tilt"] > 0  # of a long joint by slices
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
    options = {"profiles": False, "sideways": "guided"}
    near, free, fixed = (
        fit_motion(one, joint, MOVED, load_line_std=std, **options)
        for one, std in ((guided, 5e-3), (measured, 5e-3), (measured, 0.0))
    )
    near, far = near.estimates, free.estimates
    gain = free.minimum.log_likelihood - fixed.minimum.log_likelihood
    found = far["load_line"]
    npt.assert_allclose(found.std, abs(found.value) / np.sqrt(2 * gain), rtol=0.2)
    assert abs(found.value - 1.5e-3) < 2 * found.std
    # the place at rest follows the line, at the displacement of the pin
    assert found.std > near["load_line"].std
    slope = float(np.mean(guided.value[:, 0])) / STATED.radius
    npt.assert_allclose(far["rest"].std, slope * found.std, rtol=0.05)


def test_a_tilt_holds_a_free_pin_as_thicker_oil_does(free):
    """The film is that of slices along the axis, whose oil is thicker in the mean."""
    tilt = 3e-5
    films = measure(free_orbit((215e-6, 30e-6), tilt=tilt), 1)
    told = fit(films)["viscosity"].value - fit(free)["viscosity"].value
    found = fit(free, GivenErrors(tilt=tilt))["viscosity"]
    # the mean square of a tilt about parallel, whose fourth power is three times its square
    npt.assert_allclose(found.parts["tilt"], np.sqrt(3) * told, rtol=0.1)


def test_a_tilt_holds_a_guided_pin_as_its_own_film_does():
    short = replace(STATED, viscosity=VISCOSITY)
    motion = crank_motion(RIG, crank_speed=SPEED, load=222.4, cycles=5, steps_per_cycle=200)
    half, found = 4e-5 * STATED.length / 2, []
    for shape in (None, np.array([-half, half])):
        solved = solve_journal(
            replace(short, axial_shape=shape),
            motion,
            start=(205e-6, 5e-6),
            sideways="guided",
            cells=(96, 6),
            compiled=True,
        )
        both = np.stack([solved.displacement_load, solved.displacement_side], axis=1)
        films = measure(both[3 * 200 : -1 : 4], 8)
        given = GivenErrors(load_line=0.0, tilt=4e-5)
        found.append(fit(films, given, sideways="guided")["viscosity"])
    told = found[1].value - found[0].value
    npt.assert_allclose(found[0].parts["tilt"], np.sqrt(3) * told, rtol=0.25)


def test_a_drift_of_the_viscosity_is_found_within_its_width(free):
    """8 % thinner oil at the last frame, which no error of one viscosity describes."""
    last = MOTION.time[STEPS[-1]]
    drift = measure(
        free_orbit((215e-6, 30e-6), thicker=lambda time: np.exp(-0.08 * (time / last - 0.5))), 1
    )
    options = {"profiles": False}
    without = fit_motion(drift, STATED, MOVED, **options)
    found = fit_motion(drift, STATED, MOVED, given=GivenErrors(drift=0.05), **options)
    assert without.inflation > 1.2
    assert found.inflation < 1.1
    viscosity, change = (found.estimates[name] for name in ("viscosity", "drift"))
    assert abs(change.value + 0.08) < 2.5 * change.std
    assert change.std < 0.02
    assert abs(viscosity.value - VISCOSITY) < 3 * viscosity.std
    # the steady oil has none
    still = fit(free, GivenErrors(drift=0.05))["drift"]
    assert abs(still.value) < 2.5 * still.std


def test_a_drift_that_the_positions_do_not_show_widens_the_fit_in_proportion():
    films = measure(free_orbit((215e-6, 30e-6)), 1)
    rough = replace(films, random_cov=1e4 * films.random_cov)
    small, large = (fit(rough, GivenErrors(drift=one))["viscosity"] for one in (0.01, 0.02))
    npt.assert_allclose(large.parts["drift"], 2 * small.parts["drift"], rtol=0.1)
    npt.assert_allclose(small.std, np.hypot(*small.parts.values()), rtol=1e-9)


def cavitated_orbit(name, **changes):
    """A guided pin by the rig's own cavities, after three turns."""
    return kept_orbit(
        name,
        lambda: follow_guided(
            RigidBearing(STATED.radius, STATED.clearance, STATED.length, VISCOSITY),
            MOTION.time[STEPS],
            load=lambda _: 222.4,
            start=(205e-6, 0.0),
            **changes,
        ),
    )


def test_a_drift_is_found_beside_a_guided_pin():
    """8 % thicker oil at the last frame."""
    last = MOTION.time[STEPS[-1]]
    orbit = cavitated_orbit(
        "8 % thicker", thicker=lambda time: np.exp(0.08 * (max(time, 0.0) / last - 0.5))
    )
    given = GivenErrors(load_line=0.5e-3, drift=0.05)
    found = fit(measure(orbit, 3), given, sideways="guided")
    change, viscosity = found["drift"], found["viscosity"]
    assert abs(change.value - 0.08) < 2.5 * change.std
    assert change.std < 0.02
    assert abs(viscosity.value - VISCOSITY) < 3 * viscosity.std


def test_the_cavitation_pressure_is_found_within_its_width(guided):
    """Both change the film alike: without a width the viscosity is known to less."""
    joint = replace(STATED, long=True)
    options = {"joint": joint, "sideways": "guided", "load_line_std": 0.0}
    exact, known = (
        fit(guided, GivenErrors(load_line=0.0, cavitation_pressure=std), **options)["viscosity"]
        for std in (0.0, 1e3)
    )
    assert exact.std < known.std
    assert set(known.parts) == {"fit", "cavitation_pressure"}
    assert "cavitation_pressure" not in fit(
        guided, GivenErrors(cavitation_pressure=1e3), joint=joint
    )


@pytest.mark.slow
def test_a_cavitation_pressure_beside_the_stated_one_is_found():
    """The cavities of the rig open at -75 kPa, where -60 are stated: else 15 % of viscosity."""
    joint = replace(STATED, cavitation_pressure=-6e4)
    films = measure(cavitated_orbit("cavities at -75 kPa", cavity=-7.5e4), 4)
    given = GivenErrors(load_line=0.0, cavitation_pressure=1.5e4)
    found = fit(films, given, joint=joint, sideways="guided")
    pressure, viscosity = found["cavitation_pressure"], found["viscosity"]
    assert abs(pressure.value + 7.5e4) < 3 * pressure.std
    assert pressure.std < 3e3
    assert abs(viscosity.value - VISCOSITY) < 3 * viscosity.std
    assert viscosity.std < 0.03 * VISCOSITY


def test_intervals_hold_the_given_errors(free):
    alone, found = (
        fit_motion(free, STATED, MOVED, given=given).estimates["viscosity"]
        for given in (None, GivenErrors(CLEARANCE_STD, LOAD_STD))
    )
    assert alone.parts == {}
    assert found.value == alone.value
    npt.assert_allclose(found.high - found.low, 2 * 1.96 * found.std, rtol=1e-3)
    assert alone.widened({"load": 1.0}).low == 0.0


def test_a_negative_error_is_refused():
    with pytest.raises(ValueError, match="zero or more"):
        GivenErrors(load=-0.1)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("pin", "count"), [("free", 60), ("guided", 8)] if FULL else [("free", 30)]
)
def test_errors_hold_their_share_of_rigs_that_are_drawn_from_their_widths(pin, count):
    """Clearance, load, load line, tilt and drift together; orbits are those of the virtual rig."""
    options = {"sideways": pin, "given": WIDTHS, "profiles": False}
    pulls = np.abs(
        [
            list(rig.pulls(fit_motion(rig.measured, STATED, MOVED, **options)).values())
            for rig in draw_rigs(count, pin)
        ]
    )
    for size, share in ((1, 0.683), (1.96, 0.95)):
        # 2.6 standard deviations of the binomial
        room = 2.6 * np.sqrt(share * (1 - share) / count)
        held = np.mean(pulls < size, axis=0)
        assert (np.abs(held - share) < room).all(), (size, held)
    npt.assert_allclose(np.sqrt(np.mean(pulls**2, axis=0)), 1.0, atol=2.6 / np.sqrt(2 * count))
