"""Simulated endurance tests, whose onset is known."""

import numpy as np
import pytest
import xarray as xr

from erlif.joint.rig import EnduranceRig, simulate_endurance


def as_read(log):
    """A simulated log in the form in which the reader returns it."""
    cells = log[["cell_1", "cell_2"]].to_dataarray("cell").drop_vars("cell")
    columns = {"cells": cells, "arm_force": log.arm}
    return xr.Dataset(columns).assign(temperature=log.temperature, vibration=log.vibration)


@pytest.fixture(scope="session")
def rig():
    return EnduranceRig(interval=4.0, stage_duration=400.0, galling_time=300.0)


@pytest.fixture(scope="session")
def simulated(rig):
    """Log as read, and truth, of a test that galls in its sixth stage."""
    log, truth = simulate_endurance(rig, rng=np.random.default_rng(11))
    return as_read(log), truth
