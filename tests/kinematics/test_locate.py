"""The encoder log against the linkage, whose loop closure is solved here once more."""

import math

import numpy as np
import pytest
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st
from scenes import linkage
from scenes.linkage import LINKAGE, OMEGA, PIN, apart, link_angles, make_log

from erlif.core.errors import EncoderError
from erlif.kinematics import encoder_notes, entrained_stroke
from erlif.models.mechanism import SliderCrank

LOW, HIGH = 47.4095, 71.8355  # degrees: acos of eq. A.1 with crank and coupler in line


def rocker_angle(crank):
    """Degrees at a crank angle in degrees."""
    return math.degrees(link_angles(math.radians(crank))[0])


def locate(log, *, on="rocker", zero=0.0, per_cycle=None, **mechanism):
    """The linkage of the thesis; the encoder reads the angle of the rocker itself."""
    encoder = {"mounted_on": on, "zero": zero, "triggers_per_cycle": per_cycle}
    return linkage.locate(log, **mechanism, **encoder)


def test_rocker_speed_is_the_derivative_of_the_angle():
    crank = 3.0 + np.arange(0, 360, 10.0)
    step = 1e-3
    derivative = [
        (rocker_angle(c + step) - rocker_angle(c - step)) / (2 * step) * OMEGA for c in crank
    ]
    found = locate(make_log([rocker_angle(c) for c in crank]))
    np.testing.assert_allclose(found.rocker_speed, derivative, atol=1e-5)
    np.testing.assert_array_equal(found.stroke, np.sign(derivative))
    np.testing.assert_allclose(found.sliding_speed, np.abs(derivative) * 33.36e-3, atol=1e-6)


@settings(max_examples=40)
@given(st.integers(8, 60), st.floats(0, 360))
def test_any_even_sampling_is_followed_through_the_dead_points(count, start):
    crank = start + np.arange(count) * 360 / count
    found = locate(make_log([rocker_angle(c) for c in crank]))
    # near a dead point the rocker hardly moves: 1e-7 degree of rounding is 1e-2 degree of crank
    assert apart(found.crank_angle, crank).max() < 0.05


@pytest.mark.parametrize("jitter", [0.0, 0.02])
@pytest.mark.parametrize("start", [0, 5, 24, 25, 26, 40])
def test_marks_at_even_rocker_angles_keep_their_strokes(jitter, start):
    up = LOW + 0.5 + np.arange(25) * 0.96
    angle = np.roll(np.concatenate([up, up[::-1]]), -start)
    rising = np.roll(np.repeat([1, -1], 25), -start)
    angle = angle + jitter * np.random.default_rng(start).standard_normal(50)
    np.testing.assert_array_equal(locate(make_log(angle)).stroke, rising)


@pytest.mark.parametrize("per_cycle", [None, 12])
def test_several_cycles_fold_onto_one(per_cycle):
    crank = 11.0 + np.arange(36) * 30.0
    found = locate(make_log([rocker_angle(c) for c in crank]), per_cycle=per_cycle)
    assert found.trigger.values.tolist() == list(range(12)) * 3
    assert found.cycle.values.tolist() == [0] * 12 + [1] * 12 + [2] * 12


def test_an_encoder_on_the_crank_is_read_as_it_is():
    reading = np.arange(24) * 30.0  # counts on over two turns
    found = locate(make_log(reading), on="crank", zero=math.radians(20))
    np.testing.assert_allclose(found.crank_angle, (reading + 20) % 360, atol=1e-9)
    assert found.trigger.values.tolist() == list(range(12)) * 2
    assert found.cycle.values.tolist() == [0] * 12 + [1] * 12
    speed = [
        (rocker_angle(c + 0.001) - rocker_angle(c - 0.001)) / 0.002 * OMEGA for c in reading + 20
    ]
    np.testing.assert_allclose(found.rocker_speed, speed, atol=1e-5)
    wrapped = locate(make_log(reading % 360), on="crank", zero=math.radians(20))
    xr.testing.assert_allclose(found.drop_vars("encoder_angle"), wrapped.drop_vars("encoder_angle"))


def test_readings_that_fall_on_the_crank_are_a_reversed_encoder():
    found = locate(make_log(-np.arange(24) * 30.0), on="crank", zero=math.radians(20))
    assert apart(found.crank_angle, 20 + np.arange(24) * 30.0).max() < 1e-9
    assert found.encoder_angle.direction == "falling"
    assert "falls while the angle of its link rises" in str(encoder_notes(found)[0])
    rising = locate(make_log(np.arange(24) * 30.0), on="crank")
    assert encoder_notes(rising) == []


def test_the_pin_of_a_slider_crank_turns_against_the_rod():
    """Joint speed is crank speed less rod speed; the rod angle is asin(-r sin t / l)."""
    slider = SliderCrank(0.0762, 0.2032)
    reading = np.arange(3, 360, 15.0)
    found = locate(make_log(reading), mechanism=slider, on="crank")

    def rod(t):
        return np.arcsin(-7.62 * np.sin(t) / 20.32)

    t = np.radians(reading)
    rod_speed = (rod(t + 1e-6) - rod(t - 1e-6)) / 2e-6 * OMEGA
    np.testing.assert_allclose(found.rocker_speed, OMEGA - rod_speed, rtol=1e-6)
    np.testing.assert_array_equal(found.stroke, np.where(rod_speed >= 0, 1, -1))
    followed = locate(make_log(np.degrees(rod(t + 0.1))), mechanism=slider)
    assert apart(followed.crank_angle, np.degrees(t + 0.1)).max() < 0.05


@pytest.mark.parametrize("reading", [LOW - 0.2, HIGH + 0.2, -1e9, 1e300])
def test_an_angle_out_of_reach_is_refused_with_the_range(reading):
    with pytest.raises(EncoderError, match=r"Frame 1, the logged angle.* 47\.41\d to 71\.83\d deg"):
        locate(make_log([50.0, reading, 60.0]))


def test_a_reading_just_beyond_a_dead_point_is_the_dead_point():
    found = locate(make_log([50.0, 60.0, 71.0, HIGH + 0.05, 71.0, 60.0]))
    assert found.rocker_speed.values[3] == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("angle", [[55.0], [55.0, 56.0], [55.0, 54.0], [55.0, 55.0, 55.1]])
def test_a_few_frames_are_enough(angle):
    found = locate(make_log(angle))
    assert found.trigger.values.tolist() == list(range(len(angle)))
    assert np.isfinite(found.rocker_speed).all()


def test_entrained_oil_travels_half_the_swing():
    expected = PIN * math.radians(HIGH - LOW) / 2
    assert entrained_stroke(LINKAGE, pin_radius=PIN) == pytest.approx(expected, rel=1e-5)
    assert entrained_stroke(SliderCrank(0.05, 0.2), pin_radius=PIN) == math.inf


@pytest.mark.parametrize(("beyond", "accepted"), [(0.15, True), (0.25, False)])
def test_without_a_zero_the_readings_may_span_the_swing_and_little_more(beyond, accepted):
    """A tenth of a degree of error at either end of the swing."""
    log = make_log([LOW, 60.0, HIGH + beyond, 60.0])
    if accepted:
        assert np.isfinite(locate(log, zero=None).rocker_speed).all()
    else:
        with pytest.raises(EncoderError, match=r"24\.426 deg; the logged angle spans 24\.676 deg"):
            locate(log, zero=None)


@pytest.mark.parametrize(("off", "accepted"), [(2.4, True), (2.6, False), (-2.6, False)])
def test_a_trigger_returns_to_within_half_a_spacing(off, accepted):
    """On the crank, one mark in 5 degrees: the second cycle may be half a mark off the first."""
    reading = np.arange(144) * 5.0
    reading[100] += off
    log = make_log(reading)
    if accepted:
        assert locate(log, on="crank", per_cycle=72).cycle.values[100] == 1
    else:
        with pytest.raises(EncoderError, match=r"frame 100 is 2\.60 deg from the first cycle's"):
            locate(log, on="crank", per_cycle=72)


@pytest.mark.parametrize(("frames", "cycles"), [(12, 1), (17, 1), (24, 2)])
def test_a_log_of_less_than_one_turn_and_a_half_is_one_cycle(frames, cycles):
    found = locate(make_log(np.arange(frames) * 30.0), on="crank")
    assert int(found.cycle.max()) + 1 == cycles
    assert int(found.trigger.max()) + 1 == (12 if cycles == 2 else frames)
