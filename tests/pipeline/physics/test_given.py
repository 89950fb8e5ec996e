"""Errors of what the settings give: stated, else of the thermometer or of the last digits."""

import tomllib

import numpy as np
import pytest
import xarray as xr
from scenes.film import RUN_TOML

from erlif.io.settings import RunSettings
from erlif.pipeline.physics.given import given_errors, viscosity_error

OIL = {"pressure_viscosity": "0 1/Pa"}
VOGEL = {"vogel": {"a": "0.05 mPa s", "b": "1100 K", "c": "-115 degC"}}
WARM = xr.Dataset({"temperature": ("frame", np.array([30.0, 40.0]))})


def settings(joint=None, **tables):
    raw = tomllib.loads(RUN_TOML)
    return RunSettings.model_validate(raw | {"joint": raw["joint"] | (joint or {})} | tables)


def test_oil_and_thermometer_are_independent_errors_of_the_viscosity():
    """Vogel at 35 degC: d ln eta / dT = b / (T - c)^2 = 1100 / 150^2 per kelvin."""
    stated = {"viscosity": "0.12 Pa s", "viscosity_std": "0.006 Pa s"}
    assert viscosity_error(settings(oil=OIL | stated), WARM) == pytest.approx(0.05)
    mean = 0.05e-3 * (np.exp(1100 / 145) + np.exp(1100 / 155)) / 2
    oil = OIL | VOGEL | {"viscosity_std": f"{0.03 * mean} Pa s"}
    one = settings(oil=oil, temperature={"reading_std": "0.5 K"})
    assert viscosity_error(one, WARM) == pytest.approx(np.hypot(0.03, 0.5 * 1100 / 150**2))
    assert viscosity_error(settings(oil=OIL | {"viscosity": "0.12 Pa s"}), WARM) == 0


def test_a_clearance_is_known_to_the_last_digits_of_both_radii():
    """Two lengths to 10 um, uniform: sqrt(2 / 12) of it."""
    radii = {"pin_radius": "33.36 mm", "bushing_radius": "33.59 mm"}
    oil, film = OIL | {"viscosity": "0.12 Pa s"}, xr.Dataset()
    found = given_errors(settings(radii, oil=oil), film, WARM)
    assert found.clearance == pytest.approx(10e-6 * np.sqrt(2 / 12))
    assert found.load == 0.01
    stated = settings(radii | {"clearance_std": "2 um"}, oil=oil, prediction={"load_std": "3 %"})
    found = given_errors(stated, film, WARM)
    assert (found.clearance, found.load) == pytest.approx((2e-6, 0.03))
