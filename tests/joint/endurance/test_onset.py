"""The onset of galling and its interval against simulated friction."""

import numpy as np
import pytest

from erlif.joint.endurance.blocks import BlockRecord, StageFriction
from erlif.joint.endurance.noise import UNKNOWN, Noise
from erlif.joint.endurance.onset import locate_onset

WHITE = Noise(1e-3, 0.0)
TIME = np.arange(0.0, 200.0, 2.0)


def locate(true, noise):
    noisy = true + noise * np.random.default_rng(8).standard_normal(TIME.size)
    record = BlockRecord.of(StageFriction(TIME, noisy), 200.0)
    return locate_onset(record, WHITE, UNKNOWN, noise, 3)


@pytest.fixture(scope="module")
def onset():
    return locate(0.15 + 0.06 * (TIME > 131), 0.005)


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


def test_the_friction_before_an_early_onset_is_that_at_its_end_of_the_running_in():
    """0.15 + 0.05 exp(-t / 30 s) at the onset; over the 30 s before it is 0.163 on average."""
    onset = locate(0.15 + 0.05 * np.exp(-TIME / 30) + 0.06 * (TIME > 61), 0.001)
    assert onset.earliest < 61 < onset.latest
    assert onset.friction_before == pytest.approx(0.15 + 0.05 * np.exp(-61 / 30), abs=0.0015)
