"""A simulated endurance test for the examples of the documentation."""

from __future__ import annotations

from functools import cache

import numpy as np
import xarray as xr

from erlif.joint.endurance import EnduranceResult, analyse_endurance
from erlif.joint.rig import EnduranceRig, simulate_endurance


@cache
def example_test(*, galls: bool = True) -> EnduranceResult:
    """Analyse a simulated test like the first one of Farzaneh (2002).

    Parameters
    ----------
    galls : bool
        False: a test that survives.

    Returns
    -------
    EnduranceResult

    Examples
    --------
    >>> example_test().failure.stage
    6
    """
    rig = EnduranceRig(interval=4.0, galling_stage=6 if galls else None)
    log, _ = simulate_endurance(rig, rng=np.random.default_rng(7))
    cells = log[["cell_1", "cell_2"]].to_dataarray("cell", name="cells")
    columns = xr.Dataset({"cells": cells.drop_vars("cell"), "arm_force": log["arm"]})
    columns = columns.assign(temperature=log["temperature"], vibration=log["vibration"])
    return analyse_endurance(columns, pin_radius=rig.pin_radius, arm=rig.arm, name="example")
