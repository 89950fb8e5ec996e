"""A log in time at the times of the frames."""

import numpy as np
import pytest
import xarray as xr

from erlif.core.errors import EncoderError
from erlif.io.ingest.logs.resample import ContinuousLog, find_pulses, sample_log, unwrap_angle

TIME = np.arange(1001) * 1e-3


def continuous(angle, **columns):
    data = {"time": TIME, "angle": angle, **columns}
    return ContinuousLog(
        "log.csv", xr.Dataset({name: ("sample", values) for name, values in data.items()})
    )


def test_angles_are_those_of_the_motion_between_the_rows():
    """The error of linear interpolation is at most a eighth of the square of the step."""
    log = continuous(12 * np.sin(2 * np.pi * 3 * TIME))
    times = np.linspace(0.01, 0.99, 77)
    sampled = sample_log(log, times)
    bound = (2 * np.pi * 3) ** 2 * 12 * 1e-6 / 8
    np.testing.assert_allclose(sampled.angle, 12 * np.sin(2 * np.pi * 3 * times), atol=bound)
    slope = 12 * 2 * np.pi * 3 * np.cos(2 * np.pi * 3 * times)
    # the slope is that of a moment at most one row away
    np.testing.assert_allclose(sampled.angle_rate, slope, atol=8 * bound / 1e-3)
    assert sampled.number.values.tolist() == list(range(77))


def test_the_direction_is_right_in_spite_of_the_noise_of_the_encoder():
    rng = np.random.default_rng(5)
    log = continuous(12 * np.sin(2 * np.pi * TIME) + 0.05 * rng.standard_normal(TIME.size))
    times = np.linspace(0.02, 0.98, 97)
    far = np.abs(np.cos(2 * np.pi * times)) > 0.1
    rising = np.cos(2 * np.pi * times) > 0
    np.testing.assert_array_equal((sample_log(log, times).angle_rate > 0)[far], rising[far])


def test_other_numbers_are_interpolated_and_texts_taken_from_the_row_before():
    text = np.where(TIME < 0.5, "a", "b")
    sampled = sample_log(
        continuous(TIME, joint_load=100 + TIME, state=text), np.array([0.4996, 0.5])
    )
    np.testing.assert_allclose(sampled["joint_load"], [100.4996, 100.5])
    assert sampled["state"].values.tolist() == ["a", "b"]


@pytest.mark.parametrize("times", [[-0.01, 0.5], [0.5, 1.01]])
def test_frames_outside_the_log_are_refused_with_the_times(times):
    with pytest.raises(EncoderError, match=r"log.csv, 0 to 1 s; frame [01] is at"):
        sample_log(continuous(TIME), np.array(times))


def test_a_frame_in_a_gap_of_the_log_is_refused():
    time = np.concatenate([TIME[:300], TIME[400:]])
    log = ContinuousLog("log.csv", xr.Dataset(dict.fromkeys(("time", "angle"), ("sample", time))))
    sample_log(log, np.array([0.2, 0.299, 0.4, 0.5]))
    with pytest.raises(EncoderError, match=r"none from 0.299 to 0.4 s, where frame 1 was taken"):
        sample_log(log, np.array([0.2, 0.35]))


@pytest.mark.parametrize("sign", [1, -1])
def test_an_encoder_that_starts_again_is_counted_on(sign):
    true = sign * np.linspace(350, 371, 22)
    np.testing.assert_allclose(np.diff(unwrap_angle(true % 360, "log.csv")), sign)


def test_the_overflow_of_a_counter_is_refused():
    with pytest.raises(
        EncoderError, match=r"jumps from 6553.50 to 0.00 deg between values 2 and 3"
    ):
        unwrap_angle(np.array([6553.4, 6553.5, 0.0]), "log.csv")


def test_rising_voltages_and_counts_are_frames():
    edges = np.array([100, 300, 500])
    voltage = np.zeros(TIME.size)
    for edge in edges:
        voltage[edge : edge + 20] = 4.7
    log = continuous(TIME)
    expected = (edges - 0.5) * 1e-3
    np.testing.assert_allclose(find_pulses(log, voltage, 3), expected)
    count = np.searchsorted(edges, np.arange(TIME.size), side="right").astype(float)
    np.testing.assert_allclose(find_pulses(log, count, 3), expected)


def test_pulses_that_do_not_fit_the_frames_are_refused():
    voltage = np.where(np.arange(TIME.size) % 100 < 10, 5.0, 0.0)
    with pytest.raises(EncoderError, match=r"has 10 pulses, from 0.0995 to 0.9995 s, the cameras"):
        find_pulses(continuous(TIME), voltage, 9)
    count = np.floor(np.arange(TIME.size) / 100) * 2
    with pytest.raises(EncoderError, match=r"rises from 0 to 2 at 0\.1 s"):
        find_pulses(continuous(TIME), count, 10)
