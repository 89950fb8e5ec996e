"""The table of a budget holds its numbers in nanometres."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from erlif.show.report import render_budget


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


def test_terms_are_rows_in_nanometres(budget):
    assert render_budget(budget).splitlines() == [
        "Standard deviations in nm: wedge, trigger 2, 3 frame pairs.",
        "",
        "| term | mean | pixel | kind |",
        "|---|---:|---:|---|",
        "| film thickness [um] | 5.00 | 6.25 | |",
        "| photons | 3.0 | 30 | random |",
        "| calibration | 4.0 | - | shared |",
        "| **total** | **5.0** | **30** |  |",
    ]
