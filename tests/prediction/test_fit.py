"""Fits of simulated sequences whose truth is the orbit of the virtual rig."""

from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr
from scenes.kept import kept_orbit
from scenes.orbits import (
    FRAMES,
    MOTION,
    MOVED,
    RIG,
    SPEED,
    STATED,
    STD,
    VISCOSITY,
    follow_guided,
    free_orbit,
    held_orbit,
    measure,
)

from erlif.core.errors import ConfigError
from erlif.models.oil import vogel_viscosity
from erlif.models.reynolds import Motion
from erlif.prediction import (
    Estimate,
    MeasuredMotion,
    film_temperature,
    fit_motion,
    follow_motion,
    measured_minima,
)
from erlif.prediction.comparison import DESCRIBED
from erlif.rig.orbit import RigidBearing
from erlif.trend import VogelLaw

SCALE = 0.005  # error of the calibration that all films share


@pytest.fixture(scope="module")
def orbit():
    return free_orbit((215e-6, 30e-6))


def photograph(orbit, seed, line=0.0):
    """Positions with noise, a scale of all films, and a load line beside the assumed one [m]."""
    rng = np.random.default_rng(seed)
    turn = line / STATED.radius
    place = orbit @ np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    film = STATED.clearance - np.hypot(*orbit.T)
    shared = np.zeros((FRAMES, 2, 1))
    shared[:, 0, 0] = -SCALE * film
    value = place + rng.normal(size=place.shape) * STD + shared[..., 0] * rng.normal()
    return MeasuredMotion(value, np.diag(STD**2) * np.ones((FRAMES, 1, 1)), shared)


def test_viscosity_start_and_load_line_are_found_within_their_errors(orbit):
    pulls = []
    for seed in range(8):
        measured = photograph(orbit, seed, line=1e-3)
        found = fit_motion(measured, STATED, MOVED, profiles=False)
        truth = {
            "viscosity": VISCOSITY,
            "start_film": STATED.clearance - np.hypot(*orbit[0]),
            "start_attitude": np.arctan2(*orbit[0, ::-1]),
            "load_line": 1e-3,
        }
        pulls.append(
            [(found.estimates[k].value - v) / found.estimates[k].std for k, v in truth.items()]
        )
        assert abs(found.estimates["viscosity"].value / VISCOSITY - 1) < 0.03
        time = STATED.squeeze_constant / 0.12 * found.estimates["viscosity"].value / 222.4
        npt.assert_allclose(found.estimates["squeeze_time"].value, time, rtol=1e-9)
    # a chi-square of 8 x 4 correlated pulls; three standard deviations of 8 independent ones
    assert np.sqrt(np.mean(np.square(pulls), axis=0)).max() < 1 + 3 / np.sqrt(2 * 8)
    assert np.sqrt(np.mean(np.square(pulls))) > 0.4


def test_shared_error_is_not_averaged_away(orbit):
    """A scale s of all films shifts 1/sqrt(h), and with it the viscosity, by s/2."""
    both = photograph(orbit, 1)
    sure = MeasuredMotion(both.value, both.random_cov, both.shared[..., :0])
    found, alone = (
        fit_motion(one, STATED, MOVED, profiles=False).estimates["viscosity"].std
        for one in (both, sure)
    )
    assert found > 1.5 * alone


def test_profile_and_standard_deviation_agree_where_the_model_is_nearly_linear(orbit):
    found = fit_motion(photograph(orbit, 2), STATED, MOVED).estimates["viscosity"]
    npt.assert_allclose(found.high - found.low, 2 * 1.96 * found.std, rtol=0.05)
    # the limit of the temperature is open where that of the viscosity is
    law = VogelLaw(a=8e-5, b=900.0, c=-95.0)
    assert film_temperature(replace(found, high=np.inf), law).low == -np.inf


def test_minima_alone_determine_the_viscosity(orbit):
    film = STATED.clearance - np.hypot(*orbit.T)
    noisy = film + np.random.default_rng(5).normal(0, 1e-8, FRAMES)
    measured = measured_minima(noisy, np.full(FRAMES, 1e-8), clearance=STATED.clearance)
    found = fit_motion(measured, STATED, MOVED, profiles=False)
    found = found.estimates["viscosity"]
    assert abs(found.value - VISCOSITY) < 3 * found.std
    assert found.std < 0.01 * VISCOSITY


def test_means_over_cycles_are_compared_with_means(orbit):
    """Folded: each of fifty triggers holds a frame of either cycle."""
    trigger = np.arange(FRAMES) % 50
    both = photograph(orbit, 6)
    folded = MeasuredMotion(
        0.5 * (both.value[:50] + both.value[50:]),
        0.5 * both.random_cov[:50],
        0.5 * (both.shared[:50] + both.shared[50:]),
    )
    found = fit_motion(folded, STATED, MOVED, trigger=trigger, profiles=False)
    viscosity = found.estimates["viscosity"]
    assert abs(viscosity.value - VISCOSITY) < 3 * viscosity.std
    assert found.predicted.shape == (50, 2)
    assert found.frames.shape == (FRAMES, 2)


def test_film_that_does_not_change_leaves_a_lower_limit_of_the_viscosity():
    measured = measure(np.tile([225e-6, 0.0], (FRAMES, 1)), 7)
    still = Motion(MOTION.time, 0 * MOTION.angle, 222.4)
    found = fit_motion(measured, STATED, replace(MOVED, motion=still))
    viscosity = found.estimates["viscosity"]
    assert not viscosity.determined
    assert np.isinf(viscosity.high)
    assert viscosity.low > 1.0
    assert f"at least {viscosity.low:.3g} Pa s" in str(found.notes[0])


def fit_held(orbit, seed, **options):
    options = {"load_line_std": 0} | options
    return fit_motion(measure(orbit, seed), replace(STATED, long=True), MOVED, **options)


@pytest.fixture(scope="module")
def guided():
    orbit = held_orbit(side=5e-6)
    return orbit, fit_held(orbit, 8, sideways="guided")


def test_guided_pin_is_fitted_in_a_film_with_cavities(guided):
    orbit, found = guided
    film = STATED.clearance - np.hypot(*orbit[0])
    for name, value in (("viscosity", VISCOSITY), ("start_film", film), ("rest", 5e-6)):
        estimate = found.estimates[name]
        assert abs(estimate.value - value) < 3 * estimate.std
    assert abs(found.estimates["viscosity"].value / VISCOSITY - 1) < 0.03


def test_a_guided_pin_is_led_in_also_where_the_recording_is_shorter_than_a_turn():
    """One cycle of 50 triggers over 0.886 of a turn; the orbit is that of the virtual rig."""
    period = 2 * np.pi / SPEED
    moments = np.linspace(0.0, 0.886 * period, 50)
    orbit = kept_orbit(
        "less than a turn",
        lambda: follow_guided(
            RigidBearing(STATED.radius, STATED.clearance, STATED.length, 0.16),
            moments,
            steps=200,
            load=lambda _: 222.4,
            cavity=-1e5,
            start=(STATED.clearance - 25e-6, 0.0),
        ),
    )
    columns = {
        "time": moments,
        "crank_angle": np.degrees(SPEED * moments),
        "cycle": np.zeros(50, int),
        "joint_load": np.full(50, 222.4),
    }
    frames = xr.Dataset({name: ("frame", values) for name, values in columns.items()})
    moved = follow_motion(frames, RIG, crank_speed=SPEED, viscosity=STATED.viscosity)
    value = orbit + np.random.default_rng(4).normal(size=orbit.shape) * STD
    measured = MeasuredMotion(value, np.diag(STD**2) * np.ones((50, 1, 1)), np.zeros((50, 2, 0)))
    found = fit_motion(
        measured, STATED, moved, sideways="guided", load_line_std=1e-3, profiles=False
    )
    # the steps of this orbit leave a percent of it out
    npt.assert_allclose(found.estimates["viscosity"].value, 0.16, rtol=0.02)
    assert found.inflation < DESCRIBED


def test_viscosity_of_a_guided_pin_has_both_ends(guided):
    """Though cells that change to cavities make its profile jump."""
    viscosity = guided[1].estimates["viscosity"]
    assert viscosity.determined
    assert not any("at least" in note.text for note in guided[1].notes)
    npt.assert_allclose(viscosity.high - viscosity.low, 2 * 1.96 * viscosity.std, rtol=0.4)


def test_a_spring_that_is_stiff_has_the_viscosity_of_a_guided_pin(guided):
    """A search by secants ended beside the minimum, at 0.259 Pa s."""
    found = fit_held(guided[0], 8, sideways="spring", profiles=False)
    viscosity = found.estimates["viscosity"]
    assert abs(viscosity.value - VISCOSITY) < 3 * viscosity.std


def test_cavitation_pressure_is_fitted_beside_the_viscosity():
    found = fit_held(
        held_orbit(cavitation_pressure=-3e4),
        9,
        sideways="guided",
        fitted=("viscosity", "cavitation_pressure"),
        profiles=False,
    )
    for name, value in (("viscosity", VISCOSITY), ("cavitation_pressure", -3e4)):
        assert abs(found.estimates[name].value / value - 1) < 0.03
    assert "nearly the same way" in found.notes[0].text


def test_free_film_below_its_cavitation_pressure_is_reported(orbit):
    # under 222 N the full film falls to some kilopascals of suction beside the thinnest film
    for cavitation, reported in ((0.0, True), (-1e5, False)):
        joint = replace(STATED, cavitation_pressure=cavitation)
        found = fit_motion(photograph(orbit, 0), joint, MOVED, profiles=False)
        assert any("taken as full" in note.text for note in found.notes) == reported


def test_temperature_is_that_at_which_the_oil_has_the_viscosity():
    law = VogelLaw(a=8e-5, b=900.0, c=-95.0)
    at = [vogel_viscosity(T + 273.15, a=law.a, b=law.b, c=law.c + 273.15) for T in (25, 24, 26)]
    found = film_temperature(Estimate(at[0], 0.5 * (at[1] - at[2]), at[2], at[1], "Pa s"), law)
    npt.assert_allclose([found.value, found.low, found.high], [25, 24, 26], rtol=1e-9)
    npt.assert_allclose(found.std, 1.0, rtol=0.01)


@pytest.mark.parametrize(
    ("known", "changes", "message"),
    [
        (FRAMES, {"sideways": "loose"}, "free, guided or spring, got 'loose'"),
        (FRAMES, {"fitted": ("wear",)}, "viscosity or cavitation_pressure to fit, got 'wear'"),
        (3, {}, r"4 or more measured positions .* got 3 of 100"),
        (FRAMES, {"sideways": "spring"}, "positions of the pin for the fit of a spring"),
    ],
)
def test_what_cannot_be_fitted_is_refused(known, changes, message):
    film = np.where(np.arange(FRAMES) < known, 5e-6, np.nan)
    measured = measured_minima(film, np.full(FRAMES, 1e-8), clearance=STATED.clearance)
    with pytest.raises(ConfigError, match=message):
        fit_motion(measured, STATED, MOVED, **changes)
