"""Simulated endurance tests."""

from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest
import scipy.stats

from erlif.core.errors import ModelError
from erlif.joint.rig import EnduranceRig, simulate_endurance, write_endurance_log

QUIET = EnduranceRig(
    noise=0.0, cell_noise=0.0, cell_error=0.0, stage_scatter=0.0, drift=0.0, running_in=0.0
)


def test_friction_of_the_log_is_the_true_one():
    log, truth = simulate_endurance(QUIET, rng=np.random.default_rng(1))
    load = log.cell_1 + log.cell_2
    start, end = truth.stages[-1]
    inside = (log.time >= start) & (log.time < end)
    friction = (log.arm * QUIET.arm / (load * QUIET.pin_radius)).where(inside, drop=True)
    before = friction.where(friction.time < truth.onset, drop=True)
    npt.assert_allclose(before, QUIET.friction, rtol=1e-12)
    assert friction[-1] == pytest.approx(QUIET.friction + QUIET.rise, rel=1e-3)
    assert float(load.sel(time=truth.onset)) == pytest.approx(truth.load)


def test_schedule_is_that_of_the_source():
    """Stages of ten minutes from 8,000 lbf in steps of 4,000 lbf, idle runs of 30 s before each."""
    _, truth = simulate_endurance(replace(QUIET, galling_stage=None), rng=np.random.default_rng(1))
    assert [end - start for start, end in truth.stages] == [600.0] * 6
    npt.assert_allclose(QUIET.loads, 4.4482216 * 1000 * np.array([8, 12, 16, 20, 24, 28]))
    assert (truth.failed, truth.load) == (False, max(QUIET.loads))
    assert np.isnan(truth.onset)


def test_noise_has_its_size_and_its_memory():
    rig = replace(QUIET, noise=0.005, white=0.0, galling_stage=None, correlation_time=10.0)
    log, truth = simulate_endurance(rig, rng=np.random.default_rng(2))
    load = log.cell_1 + log.cell_2
    stages = [
        (log.arm * rig.arm / (load * rig.pin_radius)).sel(time=slice(start + 1, end - 1)).values
        for start, end in truth.stages
    ]
    noise = np.concatenate(stages) - rig.friction
    assert noise.std() == pytest.approx(0.005, rel=0.15)
    assert np.corrcoef(noise[1:], noise[:-1])[0, 1] == pytest.approx(np.exp(-0.1), abs=0.03)


def test_same_seed_same_file(tmp_path):
    logs = [simulate_endurance(rng=np.random.default_rng(3))[0] for _ in range(2)]
    one, other = (write_endurance_log(log, tmp_path / "run.csv").read_bytes() for log in logs)
    assert one == other


def test_a_schedule_that_cannot_be_is_refused():
    rng = np.random.default_rng(1)
    with pytest.raises(ModelError, match="from 1 to 6"):
        simulate_endurance(replace(QUIET, galling_stage=7), rng=rng)
    with pytest.raises(ModelError, match="a stage"):
        simulate_endurance(replace(QUIET, loads=()), rng=rng)


@pytest.mark.parametrize(
    ("form", "tails"), [("normal", 0.0), ("student", 3.0), ("bursts", 3.0), ("spikes", 3.0)]
)
def test_noise_of_other_forms_has_heavier_tails(form, tails):
    """Excess kurtosis of friction in a long test; that of normal noise is 0."""
    rig = EnduranceRig(
        loads=(30e3,),
        stage_duration=2e4,
        galling_stage=None,
        running_in=0.0,
        drift=0.0,
        correlation_time=0.0,
        white=0.0,
        stage_scatter=0.0,
        noise_form=form,
    )
    log, truth = simulate_endurance(rig, rng=np.random.default_rng(4))
    ((start, end),) = truth.stages
    inside = (log.time > start) & (log.time < end)
    friction = (log.arm / (log.cell_1 + log.cell_2)).values[inside]
    excess = scipy.stats.kurtosis(friction)
    assert abs(excess) < 0.2 if tails == 0 else excess > tails
