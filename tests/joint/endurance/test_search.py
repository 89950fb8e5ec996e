"""The search for galling against simulated friction."""

import tracemalloc

import numpy as np
import pytest
from scipy.signal import lfilter

from conftest import FULL
from erlif.joint.endurance.blocks import StageFriction
from erlif.joint.endurance.search import find_onset
from erlif.joint.rig import EnduranceRig, simulate_endurance


def friction_of(*, rise, kept=0.9, at=170.0, rng, stages=2, noise=0.004):
    """Stages of 150 samples of 2 s; levels, running-in and drift differ from stage to stage."""
    found = []
    for k in range(stages):
        time = 1000.0 * k + np.arange(0.0, 300.0, 2.0)
        shape = lfilter([np.sqrt(1 - kept**2)], [1, -kept], rng.standard_normal(400))[-150:]
        passed = time - time[0]
        friction = 0.14 + 0.03 * (k == 0) + 0.02 * np.exp(-passed / 60) + 0.01 * passed / 300
        friction = friction + noise * shape
        if k == stages - 1:
            friction = friction + rise * -np.expm1(-np.maximum(passed - at, 0) / 4)
        found.append(StageFriction(time, friction))
    return found


def test_a_jump_is_found_where_it_is():
    """The first stage runs 0.03 higher, which hid jumps from a search for two levels."""
    search = find_onset(friction_of(rise=0.12, rng=np.random.default_rng(1)))
    assert search.p_value < 1e-9
    assert search.onset.stage == 1
    assert search.onset.earliest < 1170 < search.onset.latest
    assert search.onset.latest - search.onset.earliest < 10
    assert search.onset.rise == pytest.approx(0.12, abs=3 * search.onset.rise_std)


def test_running_in_drift_and_correlated_noise_are_no_galling():
    searches = [
        find_onset(friction_of(rise=0.0, rng=np.random.default_rng(seed)), significance=0.05)
        for seed in range(6)
    ]
    assert sum(search.onset is not None for search in searches) <= 1  # of 6, 0.3 expected
    assert np.mean([search.p_value for search in searches]) > 0.3

    # and a drift of the whole test
    stages = friction_of(rise=0.0, rng=np.random.default_rng(5), stages=4)
    drifting = [StageFriction(one.time, one.friction + 0.08 * one.time / 3300) for one in stages]
    assert find_onset(drifting).onset is None


def test_a_rise_that_is_significant_but_small_is_not_called_galling():
    stages = friction_of(rise=0.012, kept=0.0, noise=0.001, rng=np.random.default_rng(2))
    search = find_onset(stages)
    assert search.p_value < 1e-6
    assert search.onset is None
    assert search.small.rise == pytest.approx(0.012, abs=3 * search.small.rise_std)
    assert find_onset(stages, least_rise=0.005).onset is not None


@pytest.mark.parametrize("before_end", [2, 4, 6, 9])
def test_one_bad_sample_near_the_end_of_a_stage_is_no_galling(before_end):
    """A torque of twice its size in one sample of 1 s."""
    for seed in range(2):
        time = np.arange(0.0, 300.0)
        friction = 0.15 + 0.004 * np.random.default_rng(seed).standard_normal(300)
        friction[-before_end] += 0.15
        assert find_onset([StageFriction(time, friction)]).onset is None


def test_a_rise_that_recovers_is_no_galling_and_hides_none():
    """0.05 for 8 samples; in the same stage galling by 0.05 later."""
    rng = np.random.default_rng(5)
    (stage,) = friction_of(rise=0.0, kept=0.5, rng=rng, stages=1)
    brief = 0.05 * ((stage.time >= 100) & (stage.time < 116))
    assert find_onset([StageFriction(stage.time, stage.friction + brief)]).onset is None
    later = 0.05 * (stage.time >= 200)
    onset = find_onset([StageFriction(stage.time, stage.friction + brief + later)]).onset
    assert onset.earliest < 200 < onset.latest + 2


@pytest.mark.parametrize("form", ["student", "bursts", "spikes", "oscillating"])
def test_noise_of_other_kinds_is_no_galling(form):
    """Tests of three stages, of which one in a hundred may gall at 1 %."""
    rig = EnduranceRig(
        loads=(30e3, 40e3, 50e3), stage_duration=300, galling_stage=None, noise_form=form
    )
    found = 0
    for seed in range(6 if FULL else 2):
        log, truth = simulate_endurance(rig, rng=np.random.default_rng(seed))
        load = log.cell_1 + log.cell_2
        friction = log.arm * rig.arm / (load * rig.pin_radius)
        spans = [(log.time >= start) & (log.time < end) for start, end in truth.stages]
        stages = [StageFriction(log.time.values[s], friction.values[s]) for s in spans]
        found += find_onset(stages).onset is not None
    assert found == 0


def test_a_test_without_a_searchable_stage_has_no_onset():
    short = StageFriction(np.arange(5.0), np.full(5, 0.1))
    assert find_onset([short]).onset is None
    assert find_onset([short]).left_out == (0,)
    assert find_onset([]).p_value == 1.0


def test_a_stage_of_very_many_samples_takes_no_more_memory():
    """Friction at 500 Hz for two minutes; a rise at 100 s in white noise."""
    rng = np.random.default_rng(6)
    time = np.arange(0.0, 120.0, 2e-3)
    friction = 0.15 + 0.02 * rng.standard_normal(time.size) + 0.05 * (time >= 100.0)
    tracemalloc.start()
    try:
        onset = find_onset([StageFriction(time, friction)]).onset
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert onset.earliest < 100.0 < onset.latest
    assert onset.latest - onset.earliest < 1.0
    assert peak < 100e6  # 60,000 samples times 300 onsets are 144 MB


def test_a_pause_of_the_logger_within_a_stage_is_no_matter():
    """A pause of a hundred days at one load: places of the onset lie beside samples."""
    (stage,) = friction_of(rise=0.12, rng=np.random.default_rng(4), stages=1)
    time = np.where(stage.time < 60, stage.time, stage.time + 1e7)
    onset = find_onset([StageFriction(time, stage.friction)]).onset
    assert onset.earliest < 1e7 + 170 < onset.latest
    assert onset.latest - onset.earliest < 20


def paused(friction_after, *, seed, restart=0.0):
    """150 samples with a pause of ten minutes after the first 60; running-in begins again."""
    (stage,) = friction_of(rise=0.0, rng=np.random.default_rng(seed), stages=1)
    later = np.arange(stage.time.size) >= 60
    time = np.where(later, stage.time + 600, stage.time)
    again = 0.02 * np.exp(-(stage.time - stage.time[60]) / 60)
    return StageFriction(time, stage.friction + later * (friction_after + again + restart))


def test_a_rise_within_a_pause_of_the_log_is_found_between_its_ends():
    search = find_onset([paused(0.06, seed=3)])
    onset = search.onset
    assert search.p_value < 1e-3
    assert onset.earliest <= 118  # last sample before the pause
    assert 720 <= onset.latest < 760  # first sample after it
    assert onset.pause == (118, 720)
    assert onset.rise == pytest.approx(0.06, abs=3 * onset.rise_std)


def test_a_restart_at_another_level_is_no_galling():
    """Levels differ by 0.01 from stage to stage; so may those before and after a pause."""
    searches = [find_onset([paused(0.0, seed=seed, restart=0.01)]) for seed in range(4)]
    assert all(search.onset is None for search in searches)
