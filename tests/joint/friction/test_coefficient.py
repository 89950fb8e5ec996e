"""Friction from cells, arm and torque."""

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr

from erlif.core.errors import EnduranceError
from erlif.joint.friction import measure_friction
from erlif.joint.friction.coefficient import doubt_friction


def log_of(time, **columns):
    cells = xr.DataArray(np.full((2, time.size), 20e3), dims=("cell", "time"))
    members = {name: ("time", values) for name, values in columns.items()}
    return xr.Dataset({"cells": cells, **members}, {"time": time})


def test_tare_arm_and_torque_ratio():
    time = np.arange(100.0)
    log = log_of(time, arm_force=np.full(100, -400.0))
    found = measure_friction(log, pin_radius=0.04, arm=0.4, tare=8e3, torque_ratio=1.25)
    npt.assert_allclose(found.friction, 160 / (32e3 * 0.04 * 1.25))


@pytest.mark.parametrize("offset", [0.0, 25.0])
def test_a_reversing_torque_is_free_of_its_offset(offset):
    time = np.arange(0.0, 60.0, 0.02)
    torque = offset + 160.0 * np.sign(np.sin(2 * np.pi * 1.9 * time + 0.1))
    found = measure_friction(log_of(time, torque=torque), pin_radius=0.04)
    npt.assert_allclose(found.friction, 0.1, rtol=1e-6)
    npt.assert_allclose(np.diff(found.time), 2 / 1.9, atol=0.03)


def test_a_reversing_torque_is_refused_where_it_is_sampled_too_slowly_or_turns_once():
    time = np.arange(0.0, 60.0, 0.2)
    fast = 160.0 * np.sign(np.sin(2 * np.pi * 1.9 * time + 0.1))
    for torque, message in ((fast, "sampled"), (160.0 * np.sign(29.9 - time), "size of the")):
        with pytest.raises(EnduranceError, match=message):
            measure_friction(log_of(time, torque=torque), pin_radius=0.04)


def test_friction_without_load_is_unknown():
    time = np.arange(100.0)
    log = log_of(time, torque=np.full(100, 160.0))
    log["cells"][:, :10] = 5.0
    found = measure_friction(log, pin_radius=0.04)
    assert np.isnan(found.friction[:10]).all()
    assert np.isfinite(found.friction[10:]).all()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"arm": None}, "--arm"),
        ({"tare": 50e3}, "tare"),
        *(
            ({name: value}, f"positive {name}")
            for name in ("pin_radius", "arm", "torque_ratio")
            for value in (np.nan, 0.0, -1.0)
        ),
    ],
)
def test_options_without_meaning_are_refused_by_their_name(options, message):
    log = log_of(np.arange(9.0), arm_force=np.ones(9))
    with pytest.raises(EnduranceError, match=message):
        measure_friction(log, **({"pin_radius": 0.04, "arm": 0.3} | options))
    if options.get("arm") == 0.0:  # beside a logged torque too
        with pytest.raises(EnduranceError, match=message):
            measure_friction(log.rename(arm_force="torque"), pin_radius=0.04, arm=0.0)


def test_what_no_bearing_has_is_doubted():
    for friction in (0.0001, 15.36, 120.0, float("nan")):
        (line,) = doubt_friction(friction, radius=0.03336, arm=30.0)
        assert "implausible" in line
        assert "the arm of 30000 mm" in line
    for friction in (0.01, 0.15, 1.0):  # from lubricated to galled
        assert doubt_friction(friction, radius=0.03336, arm=0.3) == []
