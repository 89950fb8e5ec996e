"""Stages and idle runs from the load."""

import numpy as np
import pytest

from erlif.joint.endurance import find_stages, join_stages
from erlif.joint.endurance.stages import note_stages

TIME = np.arange(0.0, 2000.0, 2.0)


def load_of(*steps, noise=100.0):
    """A load by its stretches (seconds, load), with noise and a steady loss of 1 %."""
    load = np.concatenate([level * np.linspace(1, 0.99, round(span / 2)) for span, level in steps])
    return load + noise * np.random.default_rng(1).standard_normal(load.size)


@pytest.mark.parametrize("idle", [0.0, 1e3, 12e3, 30e3])
@pytest.mark.parametrize("span", [30, 40, 90])
def test_idle_runs_are_recognised_whatever_their_load(idle, span):
    load = load_of((span, idle), (300, 36e3), (span, idle), (300, 54e3), (span, idle), (200, 72e3))
    stages = find_stages(TIME[: load.size], load)
    assert [stage.number for stage in stages] == [0, 1, 0, 2, 0, 3]
    loads = [stage.load for stage in stages if not stage.is_idle]
    assert loads == pytest.approx([36e3, 54e3, 72e3], rel=0.01)


@pytest.mark.parametrize(
    ("steps", "idle_load", "numbers"),
    [
        ((), None, []),
        (((100, 500.0), (500, 36e3)), None, [0, 1]),  # a first run without load
        (((60, 16e3), (600, 36e3)), None, [0, 1]),  # a short one
        (((200, 36e3), (200, 20e3), (200, 5e3)), None, [1, 0, 0]),
        (((200, 36e3), (200, 20e3), (200, 5e3)), 6e3, [1, 2, 0]),
    ],
)
def test_a_first_run_is_idle_without_load_or_short_and_a_given_idle_load_decides(
    steps, idle_load, numbers
):
    load = load_of(*steps) if steps else np.array([])
    stages = find_stages(TIME[: load.size], load, idle_load=idle_load)
    assert [stage.number for stage in stages] == numbers


def test_a_load_that_is_being_raised_is_no_stage():
    ramp = np.concatenate([np.full(100, 1e3), np.linspace(1e3, 36e3, 40), np.full(200, 36e3)])
    stages = find_stages(TIME[:340], ramp)
    assert [stage.number for stage in stages] == [0, 1]
    assert stages[1].start >= 270

    # beside a highest load of 180 kN a change from 12 to 20 kN is small
    later = load_of((400, 20e3), (40, 12e3), (400, 180e3))
    load = np.concatenate([load_of((40, 12e3)), np.linspace(12e3, 20e3, 40), later])
    stages = find_stages(TIME[: load.size], load)
    assert [stage.number for stage in stages] == [0, 1, 0, 2]
    assert stages[1].start >= 110


def test_time_at_rest_is_cut_off():
    load = load_of((40, 1e3), (400, 36e3))
    torque = np.where((TIME[:220] > 100) & (TIME[:220] < 400), 150.0, 0.5)
    stage = find_stages(TIME[:220], load, torque)[1]
    assert (stage.start, stage.end) == (102.0, 398.0)


def test_a_pause_of_the_log_divides_a_stage_into_parts_of_one_number():
    def paused(*steps, at, by):
        load = load_of(*steps)
        time = TIME[: load.size] + np.where(TIME[: load.size] >= at, by, 0.0)
        return find_stages(time, load)

    stages = paused((40, 1e3), (300, 36e3), (40, 1e3), (300, 54e3), at=100, by=900.0)
    assert [(one.number, one.part) for one in stages] == [(0, 1), (1, 1), (1, 2), (0, 1), (2, 1)]
    assert (stages[1].end, stages[2].start) == (98, 1000)
    assert [one.number for one in join_stages(stages[1:3])] == [1]

    # a first run that is brief would be idle where another stage follows
    stages = paused((60, 36e3), (600, 36e3), at=60, by=300.0)
    assert [(one.number, one.part) for one in stages] == [(1, 1), (1, 2)]


THREE = ((40, 1e3), (300, 36e3), (40, 1e3), (300, 54e3), (40, 1e3), (300, 72e3))


@pytest.mark.parametrize("form", ["noise", "ripple"])
def test_a_load_that_scatters_does_not_shatter_the_stages(form):
    """Noise of 3 % of each reading, and a ripple of 3 % in 8 s, sampled each second."""
    load = np.repeat(load_of(*THREE), 2)
    time = np.arange(float(load.size))
    noise = np.random.default_rng(2).standard_normal(load.size)
    ripple = np.sin(2 * np.pi * time / 8)
    load *= 1 + 0.03 * (noise if form == "noise" else ripple)
    stages = find_stages(time, load)
    assert [stage.number for stage in stages] == [0, 1, 0, 2, 0, 3]
    loads = [stage.load for stage in stages if not stage.is_idle]
    assert loads == pytest.approx([36e3, 54e3, 72e3], rel=0.01)
    (note,) = note_stages(time, load, stages)
    assert "the load scatters by" in str(note)


def test_a_part_shorter_than_the_mean_of_a_load_that_scatters_stays_whole():
    """Three readings before a pause, with outer ones 20 % off: each counts once in their mean."""
    load = load_of((140, 36e3), noise=0.02 * 36e3)
    load[[0, 2]] = 43.2e3, 28.8e3
    time = 10.0 * np.arange(load.size) + np.where(np.arange(load.size) < 3, 0.0, 900.0)
    assert [(one.number, one.part, one.last) for one in find_stages(time, load)] == [
        (1, 1, 2),
        (1, 2, 69),
    ]


def test_a_first_stretch_that_is_idle_as_it_is_short_is_noted():
    load = load_of((150, 36e3), (600, 54e3))
    time = TIME[: load.size]
    (note,) = note_stages(time, load, find_stages(time, load))
    assert "36.0 kN" in str(note) or "35.8 kN" in str(note)
    assert "--idle-load" in str(note)
    stages = find_stages(time, load, idle_load=1e3)
    assert note_stages(time, load, stages, idle_load=1e3) == []


def test_a_ramp_is_noted_and_the_loss_of_bolts_is_not():
    ramp = np.linspace(36e3, 54e3, 450)
    (note,) = note_stages(TIME[:450], ramp, find_stages(TIME[:450], ramp))
    assert str(note).startswith("stage 1: the load changes from 36.9 to 53.1 kN")
    load = load_of(*THREE)
    time = TIME[: load.size]
    assert note_stages(time, load, find_stages(time, load)) == []
