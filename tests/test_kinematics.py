"""The encoder log against the linkage. Truth: the loop closure of the four bars, solved here by itself."""

import math

import numpy as np
import pytest
import xarray as xr
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st
from scipy.optimize import brentq

from erlif.core.errors import EncoderError, ModelError
from erlif.kinematics import Encoder, entrained_stroke, locate_frames
from erlif.pipeline.joint import build_mechanism
from erlif.settings import RunSettings, SliderCrankSettings, read_run_settings

CRANK, COUPLER, ROCKER, GROUND = 5.5, 44.0, 26.0, 51.0  # cm, Farzaneh (2002)
OMEGA = 114 * 2 * math.pi / 60
LOW, HIGH = 47.4095, 71.8355  # degrees: acos of eq. A.1 with crank and coupler in line


def rocker_angle(crank):
    """Degrees at a crank angle in degrees, from the distance that the coupler must bridge."""

    def gap(psi):
        x = GROUND - ROCKER * math.cos(psi) - CRANK * math.cos(math.radians(crank))
        y = ROCKER * math.sin(psi) - CRANK * math.sin(math.radians(crank))
        return math.hypot(x, y) - COUPLER

    return math.degrees(brentq(gap, math.radians(30), math.radians(90), xtol=1e-14))


def make_log(angle, number=None, **columns):
    number = np.arange(len(angle)) if number is None else number
    data = {"number": ("frame", np.asarray(number)), "angle": ("frame", np.asarray(angle, float))}
    return xr.Dataset(
        data | {name: ("frame", np.asarray(values)) for name, values in columns.items()}
    )


@pytest.fixture(scope="module")
def settings(small_rig) -> RunSettings:
    """The thesis's linkage; the encoder reads the rocker angle itself."""
    return with_encoder(read_run_settings(small_rig.run), zero=0.0, triggers_per_cycle=None)


def with_encoder(settings, **changes):
    return settings.model_copy(update={"encoder": settings.encoder.model_copy(update=changes)})


def locate(log, settings):
    encoder = settings.encoder
    return locate_frames(
        log,
        mechanism=build_mechanism(settings),
        crank_speed=settings.mechanism.crank_speed,
        pin_radius=settings.joint.pin_radius,
        encoder=Encoder(encoder.mounted_on, encoder.zero, encoder.triggers_per_cycle),
    )


def apart(a, b):
    return np.abs((np.asarray(a) - np.asarray(b) + 180) % 360 - 180)


def test_the_cycle_is_found_from_the_rocker_angle(settings):
    crank = 7.0 + np.arange(0, 360, 4.0)
    found = locate(make_log([rocker_angle(c) for c in crank]), settings)
    assert apart(found.crank_angle, crank).max() < 1e-5
    assert found.trigger.values.tolist() == list(range(90))
    assert (found.cycle == 0).all()


def test_limits_and_top_speeds_are_those_of_the_linkage(settings):
    crank = np.arange(0, 360, 0.05)
    log = make_log([rocker_angle(c) for c in crank])
    found = locate(log, settings)
    assert float(log.angle.min()) == pytest.approx(LOW, abs=1e-4)
    assert float(log.angle.max()) == pytest.approx(HIGH, abs=1e-4)
    # exact kinematics; the sense in which the crank turns gives the faster stroke to the rising angle
    assert float(found.rocker_speed.max()) == pytest.approx(2.552104, rel=1e-6)
    assert float(found.rocker_speed.min()) == pytest.approx(-2.540492, rel=1e-6)


def test_rocker_speed_is_the_derivative_of_the_angle(settings):
    crank = 3.0 + np.arange(0, 360, 10.0)
    step = 1e-3
    derivative = [
        (rocker_angle(c + step) - rocker_angle(c - step)) / (2 * step) * OMEGA for c in crank
    ]
    found = locate(make_log([rocker_angle(c) for c in crank]), settings)
    np.testing.assert_allclose(found.rocker_speed, derivative, atol=1e-5)
    np.testing.assert_array_equal(found.stroke, np.sign(derivative))
    np.testing.assert_allclose(found.sliding_speed, np.abs(derivative) * 33.36e-3, atol=1e-6)


@hypothesis_settings(deadline=None, database=None, max_examples=40)
@given(st.integers(8, 60), st.floats(0, 360))
def test_any_even_sampling_is_followed_through_the_dead_points(settings, count, start):
    crank = start + np.arange(count) * 360 / count
    found = locate(make_log([rocker_angle(c) for c in crank]), settings)
    # near a dead point the rocker hardly moves: 1e-7 degree of rounding is 1e-2 degree of crank
    assert apart(found.crank_angle, crank).max() < 0.05


@pytest.mark.parametrize("jitter", [0.0, 0.02])
@pytest.mark.parametrize("start", [0, 5, 24, 25, 26, 40])
def test_marks_at_even_rocker_angles_keep_their_strokes(settings, jitter, start):
    up = LOW + 0.5 + np.arange(25) * 0.96
    angle = np.roll(np.concatenate([up, up[::-1]]), -start)
    rising = np.roll(np.repeat([1, -1], 25), -start)
    angle = angle + jitter * np.random.default_rng(start).standard_normal(50)
    np.testing.assert_array_equal(locate(make_log(angle), settings).stroke, rising)


@pytest.mark.parametrize("per_cycle", [None, 12])
def test_several_cycles_fold_onto_one(settings, per_cycle):
    crank = 11.0 + np.arange(36) * 30.0
    found = locate(
        make_log([rocker_angle(c) for c in crank]),
        with_encoder(settings, triggers_per_cycle=per_cycle),
    )
    assert found.trigger.values.tolist() == list(range(12)) * 3
    assert found.cycle.values.tolist() == [0] * 12 + [1] * 12 + [2] * 12


def test_frames_are_counted_from_the_first_number_of_the_log(settings):
    crank = 11.0 + np.arange(12) * 30.0
    found = locate(make_log([rocker_angle(c) for c in crank], number=np.arange(12) + 100), settings)
    assert found.trigger.values.tolist() == list(range(12))


def test_a_wrong_number_of_triggers_per_cycle_is_refused(settings):
    crank = 11.0 + np.arange(36) * 30.0
    log = make_log([rocker_angle(c) for c in crank])
    with pytest.raises(EncoderError, match="with 10 triggers per cycle"):
        locate(log, with_encoder(settings, triggers_per_cycle=10))


def test_without_a_zero_the_extremes_are_the_dead_points(settings):
    crank = np.arange(0, 360, 2.0)
    angle = np.array([rocker_angle(c) for c in crank])
    found = locate(make_log(angle - 12.3), with_encoder(settings, zero=None))
    assert apart(found.crank_angle, crank).max() < 0.5
    np.testing.assert_array_equal(found.encoder_angle, angle - 12.3)


def test_an_encoder_on_the_crank_is_read_as_it_is(settings):
    reading = np.arange(24) * 30.0  # counts on over two turns
    found = locate(
        make_log(reading), with_encoder(settings, mounted_on="crank", zero=math.radians(20))
    )
    np.testing.assert_allclose(found.crank_angle, (reading + 20) % 360, atol=1e-9)
    assert found.trigger.values.tolist() == list(range(12)) * 2
    assert found.cycle.values.tolist() == [0] * 12 + [1] * 12
    speed = [
        (rocker_angle(c + 0.001) - rocker_angle(c - 0.001)) / 0.002 * OMEGA for c in reading + 20
    ]
    np.testing.assert_allclose(found.rocker_speed, speed, atol=1e-5)
    wrapped = locate(
        make_log(reading % 360), with_encoder(settings, mounted_on="crank", zero=math.radians(20))
    )
    xr.testing.assert_allclose(found.drop_vars("encoder_angle"), wrapped.drop_vars("encoder_angle"))


def test_a_crank_that_seems_to_turn_back_is_refused(settings):
    with pytest.raises(EncoderError, match="Exchange the sign"):
        locate(make_log(-np.arange(24) * 30.0), with_encoder(settings, mounted_on="crank"))


def test_the_pin_of_a_slider_crank_turns_against_the_rod(settings):
    """Joint speed is crank speed less rod speed; the rod angle is asin(-r sin t / l)."""
    links = SliderCrankSettings(
        kind="slider-crank", crank="7.62 cm", coupler="20.32 cm", crank_speed="114 rpm"
    )
    slider = with_encoder(settings, mounted_on="crank").model_copy(update={"mechanism": links})
    reading = np.arange(3, 360, 15.0)
    found = locate(make_log(reading), slider)

    def rod(t):
        return np.arcsin(-7.62 * np.sin(t) / 20.32)

    t = np.radians(reading)
    rod_speed = (rod(t + 1e-6) - rod(t - 1e-6)) / 2e-6 * OMEGA
    np.testing.assert_allclose(found.rocker_speed, OMEGA - rod_speed, rtol=1e-6)
    np.testing.assert_array_equal(found.stroke, np.where(rod_speed >= 0, 1, -1))
    on_rod = with_encoder(slider, mounted_on="rocker", zero=0.0)
    followed = locate(make_log(np.degrees(rod(t + 0.1))), on_rod)
    assert apart(followed.crank_angle, np.degrees(t + 0.1)).max() < 0.05


@pytest.mark.parametrize("reading", [LOW - 0.2, HIGH + 0.2, -1e9, 1e300])
def test_an_angle_out_of_reach_is_refused_with_the_range(settings, reading):
    with pytest.raises(EncoderError, match=r"Frame 1, column angle_deg.* 47\.41\d to 71\.83\d deg"):
        locate(make_log([50.0, reading, 60.0]), settings)


def test_a_reading_just_beyond_a_dead_point_is_the_dead_point(settings):
    found = locate(make_log([50.0, 60.0, 71.0, HIGH + 0.05, 71.0, 60.0]), settings)
    assert found.rocker_speed.values[3] == pytest.approx(0.0, abs=1e-6)


def test_links_that_cannot_turn_are_refused(settings):
    links = settings.mechanism.model_copy(update={"crank": 0.3})
    with pytest.raises(ModelError, match="crank must be the shortest link"):
        locate(make_log([50.0, 60.0]), settings.model_copy(update={"mechanism": links}))


@pytest.mark.parametrize("angle", [[55.0], [55.0, 56.0], [55.0, 54.0], [55.0] * 5])
def test_a_few_frames_are_enough(settings, angle):
    found = locate(make_log(angle), settings)
    assert found.trigger.values.tolist() == list(range(len(angle)))
    assert np.isfinite(found.rocker_speed).all()


def test_entrained_oil_travels_half_the_swing(settings):
    assert entrained_stroke(
        build_mechanism(settings), pin_radius=settings.joint.pin_radius
    ) == pytest.approx(33.36e-3 * math.radians(HIGH - LOW) / 2, rel=1e-5)
