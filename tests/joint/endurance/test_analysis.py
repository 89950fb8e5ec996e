"""A log to its onset and load at failure."""

import numpy as np
import pytest
import xarray as xr

from erlif.core.errors import EnduranceError
from erlif.joint.endurance import Onset, Stage, analyse_endurance, failure_load

TIME = np.arange(200.0)
STAGES = (Stage(1, 0, 99, 0.0, 99.0, 36e3), Stage(2, 100, 199, 100.0, 199.0, 54e3))


def test_the_true_onset_and_load_are_found(simulated, rig):
    log, truth = simulated
    result = analyse_endurance(log, pin_radius=rig.pin_radius, arm=rig.arm, name="one")
    assert [stage.number for stage in result.stages] == [0, 1, 0, 2, 0, 3, 0, 4, 0, 5, 0, 6]
    for stage, (start, end) in zip(result.loaded, truth.stages, strict=True):
        assert start <= stage.start <= start + 3 * rig.interval
        assert end - 3 * rig.interval <= stage.end <= end + rig.interval
    assert result.onset.earliest < truth.onset < result.onset.latest
    assert result.failure.load == pytest.approx(truth.load, abs=2.5 * result.failure.std)


def test_a_log_without_a_stage_is_refused(simulated, rig):
    log, _ = simulated
    ramp = log.assign(cells=log.cells * 0 + np.linspace(1, 1e5, log.sizes["time"]))
    with pytest.raises(EnduranceError, match="stage of constant load"):
        analyse_endurance(ramp, pin_radius=rig.pin_radius, arm=rig.arm, idle_load=1e6)


def test_a_torque_that_reverses_too_slowly_for_stages_is_named():
    """20 then 40 kN for 5 min each, a reversal every 60 s."""
    time = np.arange(0.0, 600.0, 2.0)
    cells = np.where(time < 300, 20e3, 40e3)
    torque = 0.15 * 0.03 * cells * np.where(time % 120 < 60, 1.0, -1.0)
    log = xr.Dataset({"cells": (("cell", "time"), [cells]), "torque": ("time", torque)})
    with pytest.raises(EnduranceError, match=r"reverses with a period of 120 s.*erlif friction"):
        analyse_endurance(log.assign_coords(time=time), pin_radius=0.03)


def test_of(load):
    return xr.Dataset({"load": ("time", load)}, {"time": TIME})


test_of.__test__ = False


def onset(places):
    weights = np.full(len(places), 1 / len(places))
    return Onset(0, 0, 0, 1, 0.1, 0.1, 0.01, np.array(places, float), weights)


@pytest.mark.parametrize(
    ("places", "calibration", "std"), [([150.0], 0.01, 530), ([120.0, 180.0], 0.0, 600)]
)
def test_load_at_failure_is_that_of_the_onset_and_as_uncertain(places, calibration, std):
    load = np.where(TIME < 100, 36e3, 54e3 - 20 * (TIME - 100))
    found = failure_load(test_of(load), STAGES, onset(places), calibration=calibration)
    assert (found.load, found.std) == pytest.approx((53e3, std))
    assert (found.survived, found.failed, found.stage) == (36e3, True, 2)


def test_a_test_that_survives_is_censored_at_its_highest_load():
    found = failure_load(test_of(np.full(200, 54e3)), STAGES, None)
    assert (found.load, found.failed, found.survived) == (54e3, False, 54e3)
