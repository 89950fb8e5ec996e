"""The posterior of the onset, for noise that is known."""

import numpy as np
import pytest

from erlif.joint.endurance.blocks import Record, StageFriction
from erlif.joint.endurance.noise import UNKNOWN, Noise
from erlif.joint.endurance.posterior import locate_onset

WHITE = Noise(1e-3, 0.0)


def locate(friction, time):
    record = Record.of(StageFriction(time, friction), 200.0)
    return locate_onset(record, WHITE, UNKNOWN, 0.005, 3)


@pytest.fixture(scope="module")
def onset():
    time = np.arange(0.0, 200.0, 2.0)
    friction = 0.15 + 0.005 * np.random.default_rng(8).standard_normal(100) + 0.06 * (time > 131)
    return locate(friction, time)


def test_probabilities_add_up_and_the_interval_holds_95_per_cent(onset):
    assert onset.weights.sum() == pytest.approx(1.0)
    inside = (onset.places >= onset.earliest) & (onset.places <= onset.latest)
    assert onset.weights[inside].sum() == pytest.approx(0.95, abs=0.03)
    assert (onset.stage, onset.pause) == (3, None)


def test_a_clear_step_lies_between_its_samples(onset):
    """The step is 12 standard deviations of a sample: it is located within a few of them."""
    assert onset.earliest < 131 < onset.latest
    assert onset.latest - onset.earliest < 6
    assert onset.rise == pytest.approx(0.06, abs=3 * onset.rise_std)
    assert onset.friction_before == pytest.approx(0.15, abs=0.005)


def test_an_interval_that_reaches_into_a_gap_holds_all_of_it():
    time = np.arange(0.0, 200.0, 2.0)
    friction = 0.15 + 0.003 * np.random.default_rng(8).standard_normal(100) + 0.06 * (time > 131)
    onset = locate(friction, np.where(time > 131, time + 500, time))
    assert onset.earliest <= 130
    assert onset.latest >= 632
    assert onset.pause == (130, 632)


def test_the_friction_before_an_early_onset_is_that_at_its_end_of_the_running_in():
    """0.15 + 0.05 exp(-t / 30 s) at the onset; over the 30 s before it is 0.163 on average."""
    time = np.arange(0.0, 200.0, 2.0)
    true = 0.15 + 0.05 * np.exp(-time / 30)
    noise = 0.001 * np.random.default_rng(8).standard_normal(100)
    record = Record.of(StageFriction(time, true + noise + 0.06 * (time > 61)), 200.0)
    onset = locate_onset(record, WHITE, UNKNOWN, 0.001, 0)
    assert onset.earliest < 61 < onset.latest
    assert onset.friction_before == pytest.approx(0.15 + 0.05 * np.exp(-61 / 30), abs=0.0015)
