"""Profiles of maps that are formulas."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif.core.errors import ErlifError
from erlif.show.view.lines import line_profile

GRID = {"x": (1.0, 0.1), "y": (2.0, 0.1)}
ROWS, COLUMNS = np.indices((60, 80)).astype(np.float32)
PLANE = (2 * (1.0 + 0.1 * COLUMNS) - 3 * (2.0 + 0.1 * ROWS)).astype(np.float32)
STD = np.full(PLANE.shape, 0.5, np.float32)


@pytest.mark.parametrize(
    "line", [(1.0, 2.0, 8.9, 7.9), (8.9, 2.0, 1.0, 7.9), (3.0, 7.0, 3.0, 3.0), (8, 4, 2, 4)]
)
def test_a_plane_is_read_in_any_direction(line):
    """The nearest pixel is at most half a pixel off in x and in y."""
    x0, y0, x1, y1 = line
    found = line_profile(PLANE, STD, line, **GRID)
    share = found["position"] / np.hypot(x1 - x0, y1 - y0)
    truth = 2 * (x0 + share * (x1 - x0)) - 3 * (y0 + share * (y1 - y0))
    assert abs(found["value"] - truth).max() <= 0.05 * (2 + 3) + 1e-5
    npt.assert_allclose(found["position"][[0, -1]], [0, np.hypot(x1 - x0, y1 - y0)])
    npt.assert_allclose(found["std"], 0.5)


def test_noise_falls_with_the_root_of_the_width():
    noise = np.random.default_rng(1).normal(10, 0.5, PLANE.shape).astype(np.float32)
    found = line_profile(noise, STD, (1.0, 5.0, 8.9, 5.0), **GRID, width=25)
    npt.assert_allclose(found["std"], 0.1)
    npt.assert_allclose(found["value"], noise[18:43].mean(axis=0), rtol=1e-6)
    assert 0.8 < found["value"].std() / 0.1 < 1.2


def test_flagged_pixels_interrupt_a_thin_line_and_are_left_out_of_a_wide_one():
    values = PLANE.copy()
    values[30, 20:25] = np.nan
    thin = line_profile(values, STD, (1.0, 5.0, 8.9, 5.0), **GRID)
    assert np.flatnonzero(np.isnan(thin["value"])).tolist() == [20, 21, 22, 23, 24]
    assert np.isnan(thin["std"][20:25]).all()
    wide = line_profile(values, STD, (1.0, 5.0, 8.9, 5.0), **GRID, width=3)
    npt.assert_allclose(wide["value"], 2 * (1 + 0.1 * np.arange(80)) - 15, atol=1e-5)
    npt.assert_allclose(wide["std"][[0, 22]], [0.5 / 3**0.5, 0.5 / 2**0.5])


def test_a_line_outside_the_map_has_no_values():
    found = line_profile(PLANE, STD, (20.0, 20.0, 25.0, 20.0), **GRID)
    assert np.isnan(found["value"]).all()


def test_an_endless_line_is_refused():
    with pytest.raises(ErlifError, match=r"at most 100000 px.*Draw a shorter one"):
        line_profile(PLANE, STD, (0, 0, 1e9, 0), **GRID)
