"""Times, rotation and steps of the frames, against the law of cosines of the linkage."""

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr
from scenes.film import rocker_angle
from scenes.orbits import RIG, SPEED

from erlif.core.errors import EncoderError
from erlif.prediction import follow_motion


def frames(crank, *, cycle=None, **columns):
    """Frames at these crank angles [degree], under a dead load."""
    crank = np.asarray(crank, float)
    cycle = np.zeros(crank.size, int) if cycle is None else np.asarray(cycle)
    columns = {"joint_load": np.full(crank.size, 222.4)} | columns
    return xr.Dataset(
        {"crank_angle": ("frame", crank % 360), "cycle": ("frame", cycle)}
        | {name: ("frame", np.asarray(values, float)) for name, values in columns.items()}
    )


def follow(found, **options):
    return follow_motion(found, RIG, **{"crank_speed": SPEED, "viscosity": 0.12} | options)


def at_frames(moved, values):
    return np.asarray(values)[moved.steps]


def middle_of_swing():
    swing = rocker_angle(np.linspace(0, 360, 36001))
    return (swing.max() + swing.min()) / 2


def test_the_bushing_turns_with_the_rocker_about_the_middle_of_its_swing():
    crank = 40 + np.arange(30) * 12.0
    moved = follow(frames(crank))
    angle = np.degrees(at_frames(moved, moved.motion.angle))
    npt.assert_allclose(angle, rocker_angle(crank) - middle_of_swing(), atol=1e-5)
    against = follow(frames(crank), direction=-1)
    npt.assert_array_equal(against.motion.angle, -moved.motion.angle)


def test_without_times_the_crank_turns_at_its_set_speed():
    crank = 40 + np.arange(0, 800, 25.0)
    moved = follow(frames(crank))
    expected = np.radians(crank - 40) / SPEED
    npt.assert_allclose(at_frames(moved, moved.motion.time), expected, atol=1e-12)
    npt.assert_allclose(moved.cycles, (crank - 40) / 360)
    assert np.diff(moved.crank).max() <= 2 * np.pi / 50 + 1e-9


def test_cycles_without_frames_take_their_time():
    moved = follow(frames([10, 100, 190, 280, 370 + 720], cycle=[0, 0, 0, 0, 3]))
    npt.assert_allclose(moved.cycles, [0, 0.25, 0.5, 0.75, 3.0])


def test_logged_times_count_the_turns_between_frames():
    """One frame in every third turn and a bit, of a crank one per cent faster than set."""
    time = np.arange(8) * (3.13 * 2 * np.pi / SPEED)
    crank = 20 + np.degrees(1.01 * SPEED * time)
    moved = follow(frames(crank, time=time + 7.0))
    npt.assert_allclose(at_frames(moved, moved.motion.time), time, atol=1e-12)
    npt.assert_allclose(moved.cycles, 1.01 * SPEED * time / (2 * np.pi), rtol=1e-9)


def test_noise_of_the_encoder_does_not_shake_a_crank_at_constant_speed():
    """A tenth of a degree on the rocker is several degrees of the crank at its dead points."""
    time = np.arange(50) * (2 * np.pi / SPEED / 50)
    true = 25 + np.degrees(SPEED * time)
    noise = 0.1 * np.random.default_rng(3).standard_normal(50)
    slope = np.abs(np.gradient(rocker_angle(true), true))
    seen = true + np.clip(noise / np.maximum(slope, 0.01), -8, 8)
    moved = follow(frames(seen, time=time))
    assert np.abs(seen - true).max() > 3
    assert np.abs(np.degrees(moved.crank[moved.steps]) - true).max() < 0.7


def test_a_crank_that_turns_unevenly_passes_its_frames():
    turned = np.array([0.0, 20, 50, 100, 190, 250, 290, 320, 340, 350])
    moved = follow(frames(30 + turned, time=np.arange(10) * 0.05))
    npt.assert_allclose(np.degrees(at_frames(moved, moved.crank)), 30 + turned, rtol=1e-12)


def test_a_changing_viscosity_stretches_the_time():
    """The mean of 0.1 and 0.3 Pa s is 0.2; time counts twice at first, and two thirds at last."""
    crank = np.arange(0, 360, 10.0)
    viscosity = np.where(crank < 180, 0.1, 0.3)
    moved = follow(frames(crank), viscosity=viscosity)
    steps = np.diff(at_frames(moved, moved.motion.time)) * SPEED / np.radians(10)
    assert moved.viscosity == pytest.approx(0.2)
    npt.assert_allclose(steps[:17], 2.0)
    npt.assert_allclose(steps[18:], 2 / 3)


def test_frames_at_one_angle_or_over_too_many_turns_are_refused():
    with pytest.raises(EncoderError, match="two or more frames at different crank angles"):
        follow(frames([30.0, 30.0]))
    time = np.arange(3) * (1000 * 2 * np.pi / SPEED)
    with pytest.raises(EncoderError, match="at most 1666 turns of the crank"):
        follow(frames([0, 0, 0], time=time))


def test_times_in_another_unit_are_refused_where_the_crank_cannot_follow_them():
    crank = np.linspace(0, 340, 35)
    time = crank / np.degrees(SPEED)
    found = frames(crank, time=time + 0.003 * np.sin(np.radians(7 * crank)))
    assert follow(found).motion.time[-1] == pytest.approx(time[-1], rel=0.05)
    with pytest.raises(EncoderError, match="the unit of the times"):
        follow(found.assign(time=1000 * found.time))
