"""The table of a budget: terms below their kind."""

import numpy as np
import pytest
import xarray as xr

from erlif.show.report import print_budget


@pytest.fixture
def budget():
    """Two terms of 3 nm and 4 nm, whose sum in quadrature is 5 nm."""
    std = np.array([[0.003, 0.0301], [0.004, np.nan], [0.005, 0.0301]])
    return xr.Dataset(
        {
            "std": (("term", "quantity"), std, {"units": "um"}),
            "kind": ("term", ["random", "shared", "sum"]),
            "value": ("quantity", [5.0, 6.25], {"units": "um"}),
        },
        {"term": ["photons", "calibration", "total"], "quantity": ["mean", "pixel"]},
        {"run": "wedge", "trigger": 2, "frames": 3},
    )


def test_terms_stand_below_their_kind_within_80_columns(budget):
    lines = print_budget(budget).splitlines()
    assert lines[0] == "Standard deviations in nm: wedge, trigger 2, 3 frame pairs"
    assert [" ".join(line.split()) for line in lines[2:]] == [
        "term mean pixel",
        "film thickness [um] 5.00 6.25",
        "random",
        "photons 3.0 30",
        "shared",
        "calibration 4.0 -",
        "total 5.0 30",
    ]
    wide = budget.isel(quantity=[0, 1, 0, 1, 0])
    assert max(map(len, print_budget(wide).splitlines())) <= 80
