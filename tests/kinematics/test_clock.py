"""The offset of the clocks from the light of a known film: the rig's film law and its dyes."""

import numpy as np
import pytest

from erlif.core.errors import EncoderError
from erlif.kinematics.clock import find_clock_offset
from erlif.rig import RigSettings
from erlif.rig.dyes import BANDS, tabulate_signal
from erlif.rig.film import crank_at, list_triggers, rocker_speed

PERIOD = 60 / 114
SIGNALS = tuple(tabulate_signal(band) for band in BANDS)


def recorded(seed, noise=0.02, **changes):
    """Logarithm of the ratio of both cameras, and the log; the truth is the time of frame 0."""
    rng = np.random.default_rng(seed)
    rig = RigSettings(pulses_per_cycle=rng.uniform(19, 31), cycles=3, **changes)
    triggers = list_triggers(rig)
    light = np.log(SIGNALS[1](triggers.film_min + 0.5) / SIGNALS[0](triggers.film_min + 0.5))
    light = light + noise * rng.standard_normal(light.size)

    true = rng.uniform(0.05, 0.9 * PERIOD)
    time = np.arange(0, true + triggers.time[-1] - triggers.time[0] + 0.1, 1e-3)
    crank = crank_at(time - true + triggers.time[0], rig)
    log = {"time": time, "crank": crank, "speed": rocker_speed(crank, rig)}
    return triggers.time - triggers.time[0], light, log, true


def error_of(found, true):
    """Deviation from the truth, whole strokes apart. [s]"""
    return (found.value - true + PERIOD / 4) % (PERIOD / 2) - PERIOD / 4


@pytest.mark.parametrize("noise", [0.01, 0.04])
def test_the_standard_deviation_covers_the_error(noise):
    """The load changes the film by 0.6 % once in a turn."""
    pulls = []
    for seed in range(16):
        since, light, log, true = recorded(seed, noise)
        found = find_clock_offset(since, light, **log)
        pulls.append(error_of(found, true) / found.std)
    assert np.abs(pulls).max() < 4
    assert 0.45 < np.sqrt(np.mean(np.square(pulls))) < 1.6  # 16 values give it to 18 %


def test_the_other_stroke_is_named_where_it_fits_as_well():
    """The strokes of this linkage differ by half a per cent in speed."""
    since, light, log, _ = recorded(3, 0.04)
    assert find_clock_offset(since, light, **log).half_cycle


def test_a_linkage_with_unlike_strokes_shows_which_is_which():
    """A long crank and a short ground link: the return takes longer than the outward stroke."""
    links = {"crank": 12.0, "coupler": 40.0, "rocker": 26.0, "ground": 36.0}
    for seed in range(5):
        since, light, log, true = recorded(seed, 0.005, **links)
        found = find_clock_offset(since, light, **log)
        assert not found.half_cycle
        assert abs(found.value - true) < 5 * found.std + 1e-3


def test_offsets_whole_cycles_apart_are_counted():
    since, light, log, true = recorded(1)
    rig = RigSettings()
    time = np.arange(0, log["time"][-1] + 2 * PERIOD, 1e-3)
    crank = log["crank"][0] + time * 2 * np.pi / PERIOD
    found = find_clock_offset(since, light, time=time, crank=crank, speed=rocker_speed(crank, rig))
    assert found.cycles >= 2
    assert abs(error_of(found, true)) < 4 * found.std


def test_recordings_that_determine_no_offset_are_refused():
    """Light that does not follow the motion, copies of one exposure, few frames, a short log."""
    since, light, log, _ = recorded(1)
    noise = np.random.default_rng(2).standard_normal(light.size)
    for times, seen, message in (
        (since, noise, "light of the frames that follows the motion"),
        (since, np.full_like(light, 0.3), "the same in all frames"),
        (since[:11], light[:11], "at least 12 frames"),
        (2 * since, light, "longer than the recording"),
    ):
        with pytest.raises(EncoderError, match=message):
            find_clock_offset(times, seen, **log)


@pytest.mark.parametrize("stretch", [0.0, 0.01])
def test_a_wrong_rate_of_the_frames_shows_in_the_light(stretch):
    """Times that are too short by 1 per cent, as by a frame rate that is too high by it."""
    pulls = []
    for seed in range(4):
        since, light, log, _ = recorded(seed, 0.01)
        found = find_clock_offset(since / (1 + stretch), light, **log)
        pulls.append((found.stretch - stretch) / found.stretch_std)
        assert stretch == 0 or found.stretch > 4 * found.stretch_std
    assert np.abs(pulls).max() < 4
