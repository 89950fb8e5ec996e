"""The table of the inverse against root finding, on parameters that are known exactly."""

from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr
from scenes.fixture import find_films


@pytest.mark.parametrize("name", ["exact", "departing"])
def test_table_of_the_inverse_agrees_with_root_finding(name, request):
    calibration = request.getfixturevalue(name)
    table = calibration.inverse
    entries = np.arange(table.thickness.size)
    first, last = np.interp(calibration.thickness_range, table.thickness, entries)
    place = np.random.default_rng(0).uniform(first, last, 200)
    values = table.start + table.step * place
    film = find_films(calibration, values)
    npt.assert_allclose(calibration.predict_log(film), values, atol=1e-9)
    low, high = calibration.thickness_range
    beyond = calibration.predict_log([[low - 0.01], [high + 0.01]])
    npt.assert_array_equal(find_films(calibration, beyond), [[np.nan], [np.nan]])
    npt.assert_allclose(np.interp(place, entries, table.thickness), film, atol=2e-5)
    npt.assert_allclose(
        np.interp(place, entries, table.per_log_ratio), 1 / calibration.slope(film), rtol=1e-4
    )
    npt.assert_allclose(
        np.interp(place, entries, table.calibration_std), calibration.thickness_std(film), rtol=1e-3
    )


def test_table_covers_the_fixture_and_not_the_calibrated_range_alone(exact):
    assert exact.covered_range == (0.3, 17.0)
    npt.assert_allclose(exact.inverse.thickness[[0, -1]], [0.3, 17.0])
    assert replace(exact, curve=xr.Dataset()).covered_range == (0.3, 14.0)
