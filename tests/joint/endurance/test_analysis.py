"""A log to its load at failure."""

import numpy as np
import pytest
import xarray as xr

from erlif.core.errors import EnduranceError
from erlif.joint.endurance import analyse_endurance


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
