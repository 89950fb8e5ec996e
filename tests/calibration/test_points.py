"""Points of a line and of a surface, with and without the CMM's uncertainty."""

from dataclasses import fields, replace

import numpy as np
import pytest

from erlif.calibration.points import Points


@pytest.fixture
def line():
    """Ten points of a line with all uncertainties."""
    column = {each.name: np.ones(10) for each in fields(Points)}
    axes = {name: np.ones((10, 1)) for name in ("position", "gradient", "ratio_gradient")}
    return Points(**column | axes)


def test_a_profile_with_two_axes_is_a_surface(line):
    assert not line.on_surface
    assert replace(line, position=np.ones((10, 2))).on_surface


def test_error_bars_are_known_only_where_every_point_has_one(line):
    assert line.has_error_bars
    one_missing = line.thickness_std.copy()
    one_missing[3] = np.nan
    assert not replace(line, thickness_std=one_missing).has_error_bars
    assert not replace(line, thickness_std=np.full(10, np.nan)).has_error_bars
