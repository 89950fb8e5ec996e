"""The friction of a torque log as drawn."""

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr
from scenes.pictures import picture, without_texts

from erlif.joint.friction import analyse_friction
from erlif.joint.plots import friction_over_reversals


@pytest.fixture(scope="module")
def log():
    time = np.arange(0.0, 80.0, 0.1)
    torque = np.where(time < 40, 0.6, 0.61) * np.where(time % 10 < 5, 1, -1)
    return xr.Dataset(
        {"cells": (("cell", "time"), [np.full(time.size, 400.0)]), "torque": ("time", torque)},
        {"time": time},
    )


def test_points_lie_at_the_pairs_and_the_line_at_their_mean(log):
    series = analyse_friction(log, shaft_radius=0.01, load_std=0.01)
    points, mean = friction_over_reversals(series)
    npt.assert_allclose(points.get_ydata(), [0.15] * 4 + [0.1525] * 4, rtol=1e-9)
    npt.assert_allclose(mean.get_ydata(), 0.15125, rtol=1e-9)
    npt.assert_allclose(points.get_xdata(), np.arange(5, 80, 10) / 60, atol=0.002)
    points, _ = friction_over_reversals(analyse_friction(log, shaft_radius=0.01, speed=0.1))
    assert points.axes.get_xlabel() == "sliding distance [m]"
    npt.assert_allclose(points.get_xdata(), np.arange(0.5, 8, 1), atol=0.01)


@picture
def test_picture_of_a_torque_log(log):
    series = analyse_friction(log, shaft_radius=0.01, load_std=0.01)
    points, _ = friction_over_reversals(series)
    return without_texts(points.axes.get_figure())
