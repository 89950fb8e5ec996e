"""Readings of encoders on every link, wrapped, reversed and without a zero."""

import math
import re

import numpy as np
import pytest
from scenes.linkage import OMEGA, apart, link_angles, locate, make_log

from erlif.core.errors import EncoderError
from erlif.kinematics import encoder_notes
from erlif.kinematics.encoder import FEWEST_FRAMES, find_direction

FINE = np.linspace(0, 2 * np.pi, 2001)
ANGLES = {"rocker": 0, "coupler": 1}
CURVES = {link: np.degrees([link_angles(t)[n] for t in FINE]) for link, n in ANGLES.items()}


def angle_of(link, crank):
    return np.interp(np.asarray(crank) % (2 * np.pi), FINE, CURVES[link])


CYCLE = np.radians(7.0 + np.arange(0, 360, 4.0))


# mounting


def test_times_in_another_unit_leave_the_sign_open_at_once():
    """A turn of microseconds in place of seconds would be a million turns."""
    time = np.linspace(0, 0.5, 50)
    assert find_direction(1e6 * time, np.sin(8 * time), np.sin, crank_speed=8.0) == (0, 0.0)


@pytest.mark.parametrize("link", ["rocker", "coupler"])
@pytest.mark.parametrize("zero", [0.0, 33.3])
def test_crank_and_joint_speed_are_the_same_from_either_link(link, zero):
    reading = angle_of(link, CYCLE) - zero
    found = locate(make_log(reading), mounted_on=link, zero=math.radians(zero))
    assert apart(found.crank_angle, np.degrees(CYCLE)).max() < 0.2
    step = 1e-3
    speed = (angle_of("rocker", CYCLE + step) - angle_of("rocker", CYCLE - step)) / (2 * step)
    np.testing.assert_allclose(found.rocker_speed, np.radians(speed) * OMEGA, atol=0.02)
    np.testing.assert_array_equal(found.stroke, np.sign(speed))
    assert found.encoder_angle.mounted_on == link


# readings that start again


@pytest.mark.parametrize("link", ["rocker", "coupler"])
@pytest.mark.parametrize("given", [True, False])
def test_an_encoder_that_starts_again_at_zero_is_one_stroke(link, given):
    turned = 360.0 - float(CURVES[link].mean())
    reading = (angle_of(link, CYCLE) + turned) % 360
    assert np.ptp(reading) > 300
    zero = -math.radians(turned) if given else None
    found = locate(make_log(reading), mounted_on=link, zero=zero)
    assert np.abs(np.diff(found.encoder_angle)).max() < 2
    tolerance = 0.2 if given else 2.0  # the extremes are no dead points exactly
    assert apart(found.crank_angle, np.degrees(CYCLE)).max() < tolerance


# direction


@pytest.mark.parametrize("link", ["rocker", "coupler"])
@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("speed", [1.0, 0.97])
def test_the_direction_is_found_from_the_times_of_the_log(link, sign, speed):
    """The crank may be a little slower than set; the encoder has an error of 0.02 degree."""
    rng = np.random.default_rng(3)
    crank = 1.0 + np.arange(120) * 2 * np.pi / 49.7
    reading = sign * angle_of(link, crank) + 0.02 * rng.standard_normal(crank.size)
    found = locate(make_log(reading, time=crank / (speed * OMEGA)), mounted_on=link)
    assert found.encoder_angle.direction == {1: "rising", -1: "falling"}[sign]
    assert np.median(apart(found.crank_angle, np.degrees(crank))) < 1
    far = np.abs(np.gradient(angle_of("rocker", crank))) > 0.2
    np.testing.assert_array_equal(
        found.stroke[far], np.sign(np.gradient(angle_of("rocker", crank)))[far]
    )


@pytest.mark.parametrize("direction", ["falling", None])
def test_a_falling_reading_is_stated_or_follows_from_the_reach(direction):
    reading = 100.0 - angle_of("rocker", CYCLE)
    found = locate(make_log(reading), zero=math.radians(100.0), direction=direction)
    assert apart(found.crank_angle, np.degrees(CYCLE)).max() < 0.2
    notes = [str(note) for note in encoder_notes(found)]
    assert len(notes) == (direction is None)


@pytest.mark.parametrize("sign", [1, -1])
def test_a_direction_that_contradicts_the_times_is_refused(sign):
    crank = 1.0 + np.arange(120) * 2 * np.pi / 49.7
    log = make_log(sign * angle_of("rocker", crank), time=crank / OMEGA)
    stated = {1: "falling", -1: "rising"}[sign]
    with pytest.raises(EncoderError, match=f"{stated}, because of direction .* Leave direction"):
        locate(log, direction=stated)


# direction by the second harmonic of the readings


def wave(crank):
    return 10 * np.cos(crank) + np.cos(2 * crank + 0.4)


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("phase", [0.0, 1.7, 4.0])
@pytest.mark.parametrize("speed", [8.0, 8.3, 7.7])
def test_the_sign_is_found_at_any_phase_and_nearly_any_speed(sign, phase, speed):
    time = np.linspace(0, 3, 200)
    reading = 5 + sign * wave(speed * time + phase)
    found, noise = find_direction(time, reading, wave, crank_speed=8.0)
    assert found == sign
    assert noise < 0.1


def test_noise_leaves_the_sign_open_and_is_measured():
    rng = np.random.default_rng(1)
    time = np.linspace(0, 3, 200)
    reading = 10 * np.cos(8 * time) + 0.5 * rng.standard_normal(200)
    found, noise = find_direction(time, reading, wave, crank_speed=8.0)
    assert found == 0
    assert noise == pytest.approx(0.5, rel=0.15)


@pytest.mark.parametrize(("frames", "duration"), [(FEWEST_FRAMES - 1, 3.0), (200, 0.5)])
def test_a_short_log_leaves_the_sign_open(frames, duration):
    time = np.linspace(0, duration, frames)
    assert find_direction(time, wave(8 * time), wave, crank_speed=8.0)[0] == 0


def test_the_rod_of_a_slider_crank_leaves_the_sign_open():
    """It swings alike at both dead points: its second harmonic is zero."""

    def rod(crank):
        return np.arcsin(np.sin(crank) / 4)

    time = np.linspace(0, 3, 200)
    assert find_direction(time, -rod(8 * time), rod, crank_speed=8.0)[0] == 0


# zero


@pytest.mark.parametrize("noise", [0.0, 0.02])
def test_the_standard_deviation_of_a_fitted_zero_covers_its_error(noise):
    """Marks of an encoder every 0.96 degree, at random against the dead points."""
    pulls = []
    for seed in range(20):
        rng = np.random.default_rng(seed)
        low, high = CURVES["rocker"].min(), CURVES["rocker"].max()
        marks = np.arange(low + rng.uniform(0, 0.96), high, 0.96)
        swing = np.concatenate([marks, marks[::-1]])
        rising = CURVES["rocker"].argmin(), CURVES["rocker"].argmax()
        up = np.interp(marks, *sorted_branch(rising[0], rising[1]))
        down = np.interp(marks[::-1], *sorted_branch(rising[1], rising[0]))
        crank = np.unwrap(np.concatenate([up, down]))
        true = rng.uniform(-20, 20)
        reading = swing - true + noise * rng.standard_normal(swing.size)
        found = locate(make_log(reading, time=crank / OMEGA)).encoder_angle
        assert found.direction == "rising"
        pulls.append((found.zero - true) / found.zero_std)
    assert np.abs(pulls).max() < 3
    assert 0.5 < np.sqrt(np.mean(np.square(pulls))) < 1.45  # 20 values give it to 16 %


def sorted_branch(start, stop):
    """Rocker angle and crank angle of one stroke, in the order of the rocker angle."""
    places = np.arange(start, stop if stop > start else stop + FINE.size - 1)
    angle = CURVES["rocker"][places % (FINE.size - 1)]
    crank = FINE[1] * places
    order = np.argsort(angle)
    return angle[order], crank[order]


def test_a_fitted_zero_is_reported_with_its_standard_deviation_and_effect():
    """The effect by the slope and the curvature of the rocker angle over the crank angle."""
    low, high = CURVES["rocker"].min(), CURVES["rocker"].max()
    marks = np.arange(low + 0.3, high, 1.0)
    log = make_log(np.concatenate([marks, marks[::-1]]))
    found = locate(log)
    std = (high - low - np.ptp(marks)) / math.sqrt(12)
    assert found.encoder_angle.zero_std == pytest.approx(std, rel=1e-3)
    note = str(encoder_notes(found)[0])
    assert (
        f"fitted to the dead points of the linkage, {found.encoder_angle.zero:.3f} ± {std:.3f}"
        in note
    )

    turned, changed = (float(one) for one in re.findall(r"by (\d+\.\d+)", note))
    crank = np.degrees(FINE)
    slope = np.gradient(CURVES["rocker"], crank)
    shift = found.encoder_angle.zero_std / np.abs(np.interp(found.crank_angle, crank, slope))
    bend = np.abs(np.interp(found.crank_angle, crank, np.gradient(slope, crank)))
    assert turned == pytest.approx(np.median(shift), rel=0.05)
    assert changed == pytest.approx(100 * np.median(bend * shift) / np.abs(slope).max(), rel=0.1)

    given = locate(log, zero=0.0)
    assert "zero_std" not in given.encoder_angle.attrs
    assert encoder_notes(given) == []


@pytest.mark.parametrize(
    ("reading", "stated", "words"),
    [
        (
            [55.0] * 7,
            {"mounted_on": "coupler"},
            "a moving coupler in the log; it is 55 deg in all 7",
        ),
        ([55.0] * 7, {"mounted_on": "crank"}, "a moving crank in the log; it is 55 deg in all 7"),
        (np.arange(0, 360, 10.0), {"mounted_on": "crank", "direction": "falling"}, "direction"),
        (-np.arange(0, 360, 10.0), {"mounted_on": "crank", "direction": "rising"}, "direction"),
        # ten degrees to and fro, on a linkage that swings by 24.43
        (5 * np.sin(np.linspace(0, 4 * np.pi, 60)), {}, r"24\.426 deg, because zero .* spans 9\.9"),
    ],
)
def test_readings_that_contradict_the_linkage_are_refused(reading, stated, words):
    with pytest.raises(EncoderError, match=words):
        locate(make_log(reading), **stated)
