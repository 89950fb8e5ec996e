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


def test_friction_is_torque_over_load_and_radius():
    time = np.arange(100.0)
    found = measure_friction(log_of(time, torque=np.full(100, 160.0)), pin_radius=0.04)
    npt.assert_allclose(found["load"], 40e3)
    npt.assert_allclose(found.friction, 160 / (40e3 * 0.04))


def test_tare_arm_and_torque_ratio():
    time = np.arange(100.0)
    log = log_of(time, arm_force=np.full(100, -400.0))
    found = measure_friction(log, pin_radius=0.04, arm=0.4, tare=8e3, torque_ratio=1.25)
    npt.assert_allclose(found.friction, 160 / (32e3 * 0.04 * 1.25))


def test_a_force_without_arm_is_refused():
    with pytest.raises(EnduranceError, match="--arm"):
        measure_friction(log_of(np.arange(9.0), arm_force=np.ones(9)), pin_radius=0.04)


@pytest.mark.parametrize("offset", [0.0, 25.0])
def test_a_reversing_torque_is_free_of_its_offset(offset):
    time = np.arange(0.0, 60.0, 0.02)
    torque = offset + 160.0 * np.sign(np.sin(2 * np.pi * 1.9 * time + 0.1))
    found = measure_friction(log_of(time, torque=torque), pin_radius=0.04)
    npt.assert_allclose(found.friction, 0.1, rtol=1e-6)
    npt.assert_allclose(np.diff(found.time), 2 / 1.9, atol=0.03)


def test_a_reversing_torque_that_is_sampled_too_slowly_is_refused():
    time = np.arange(0.0, 60.0, 0.2)
    torque = 160.0 * np.sign(np.sin(2 * np.pi * 1.9 * time + 0.1))
    with pytest.raises(EnduranceError, match="sampled"):
        measure_friction(log_of(time, torque=torque), pin_radius=0.04)


def test_friction_without_load_is_unknown():
    time = np.arange(100.0)
    log = log_of(time, torque=np.full(100, 160.0))
    log["cells"][:, :10] = 5.0
    found = measure_friction(log, pin_radius=0.04)
    assert np.isnan(found.friction[:10]).all()
    assert np.isfinite(found.friction[10:]).all()


def test_a_torque_that_changes_its_sign_once_is_refused():
    time = np.arange(400.0)
    torque = np.where(time < 200, 160.0, -160.0)
    with pytest.raises(EnduranceError, match="Log the size of the torque"):
        measure_friction(log_of(time, torque=torque), pin_radius=0.04)


@pytest.mark.parametrize(
    ("options", "message"), [({"arm": 0.0}, "positive arm"), ({"arm": 0.4, "tare": 50e3}, "tare")]
)
def test_an_arm_or_tare_without_meaning_is_refused(options, message):
    log = log_of(np.arange(100.0), arm_force=np.full(100, 400.0))
    with pytest.raises(EnduranceError, match=message):
        measure_friction(log, pin_radius=0.04, **options)


@pytest.mark.parametrize("name", ["pin_radius", "arm", "torque_ratio"])
@pytest.mark.parametrize("value", [np.nan, 0.0, -1.0])
def test_a_length_that_is_no_positive_number_is_refused_by_its_name(name, value):
    log = log_of(np.arange(9.0), arm_force=np.ones(9))
    given = {"pin_radius": 0.04, "arm": 0.3, name: value}
    with pytest.raises(EnduranceError, match=f"positive {name}"):
        measure_friction(log, **given)


def test_an_arm_without_meaning_is_refused_beside_a_logged_torque():
    log = log_of(np.arange(9.0), torque=np.ones(9))
    with pytest.raises(EnduranceError, match="positive arm"):
        measure_friction(log, pin_radius=0.04, arm=0.0)


@pytest.mark.parametrize("friction", [0.0001, 15.36, 120.0, float("nan")])
def test_what_no_bearing_has_is_doubted(friction):
    (line,) = doubt_friction(friction, radius=0.03336, arm=30.0)
    assert "implausible" in line
    assert "the arm of 30 m" in line


@pytest.mark.parametrize("friction", [0.01, 0.15, 1.0])
def test_a_bearing_from_lubricated_to_galled_is_not_doubted(friction):
    assert doubt_friction(friction, radius=0.03336, arm=0.3) == []
