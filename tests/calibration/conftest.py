"""A calibration whose parameters are known exactly."""

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
from scenes.fixture import K, P, Q, log_ratio

from erlif.calibration import Calibration
from erlif.calibration.departure import Departure


@pytest.fixture
def exact():
    """The true curve, with a covariance in which K and p are correlated."""
    covariance = np.array([[4e-6, 1e-6, 0], [1e-6, 4e-6, 0], [0, 0, 1e-6]])
    points = np.array([0.2, 9.0, 17.0])
    curve = xr.Dataset(
        {
            "curve_thickness": ("bin", points),
            "curve_ratio": ("bin", np.exp(log_ratio(points))),
            "curve_ratio_std": ("bin", np.full(3, 1e-3)),
            "curve_residual": ("bin", np.zeros(3)),
        }
    )
    return Calibration(K, P, Q, covariance, (0.3, 14.0), (580.0, 610.0), curve, 1.0, "wedge")


@pytest.fixture
def departing(exact):
    """The same with a spline of two pieces, its coefficients known to 0.001."""
    knots = np.array([0.3] * 4 + [6.0] + [14.0] * 4)
    spline = Departure(knots, np.array([0.0, 0.005, 0.0, 0.01, 0.015]), 1e-6 * np.eye(5))
    return replace(exact, departure=spline)
