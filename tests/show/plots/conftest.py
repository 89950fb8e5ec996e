"""A film and a calibration by formula, for all figures."""

import functools

import numpy as np
import pytest
import xarray as xr
from scenes import film as scene
from scenes.film import changed as changed
from scenes.film import film as film
from scenes.film import film_path as film_path

from erlif.calibration import Calibration
from erlif.core.notes import Level, Note


@pytest.fixture(scope="package")
def calibration():
    """Forty points with known residuals from the model of the scene."""
    thickness = np.linspace(0.3, 15.5, 40)
    residual = 1e-3 * np.cos(np.arange(40))
    ratio = scene.true_ratio(thickness) + residual
    curve = xr.Dataset(
        {
            "curve_thickness": ("bin", thickness),
            "curve_ratio": ("bin", ratio),
            "curve_ratio_std": ("bin", np.full(40, 2e-3)),
            "curve_residual": ("bin", residual),
        }
    )
    covariance = np.diag([1e-3, 2e-3, 1e-3]) ** 2
    return Calibration(
        scene.K,
        scene.P,
        scene.Q,
        covariance,
        (0.5, 15.0),
        (580, 610),
        curve,
        1.1,
        "known wedge",
        (Note(Level.NOTE, "camera1", "dark 64.0 DN"),),
    )


@pytest.fixture
def with_settings(film):
    """Make a copy of the film with other text in its settings."""
    return functools.partial(scene.with_settings, film)
