"""Errors of what the settings of a run give: viscosity, clearance, load, mount."""

from __future__ import annotations

import math

import numpy as np
import xarray as xr

from erlif.io.settings import RunSettings
from erlif.pipeline.physics.joint import describe_viscosity, joint_and_oil
from erlif.pipeline.physics.position import clearance_std
from erlif.prediction import GivenErrors
from erlif.prediction.fit import LOAD_LINE_STD
from erlif.trend import VogelLaw, viscosity_at


def reading_error(settings: RunSettings, frames: xr.Dataset) -> float:
    """Error of the viscosity over it by that of the logged temperature; 0 without Vogel's law."""
    law = None if settings.oil is None else describe_viscosity(settings.oil)
    if not isinstance(law, VogelLaw):
        return 0.0
    by_kelvin = law.b / (float(frames["temperature"].mean()) - law.c) ** 2
    return by_kelvin * float(settings.temperature.reading_std)


def viscosity_error(settings: RunSettings, frames: xr.Dataset) -> float:
    """Error of the viscosity over it: that stated for the oil, and that of the temperature."""
    oil = settings.oil
    if oil is None:
        return 0.0
    mean = float(viscosity_at(frames, describe_viscosity(oil)).mean())
    return math.hypot(float(oil.viscosity_std or 0.0) / mean, reading_error(settings, frames))


def given_errors(settings: RunSettings, film: xr.Dataset, frames: xr.Dataset) -> GivenErrors:
    """Collect the errors of given quantities: stated, else assumed or measured."""
    (joint, oil), options = joint_and_oil(settings), settings.prediction
    drift = oil.drift_std
    rounding = 1e-6 * clearance_std(joint)
    line = options.load_line_std or 0.1 * LOAD_LINE_STD
    return GivenErrors(
        clearance=rounding if joint.clearance_std is None else float(joint.clearance_std),
        load=0.01 * float(options.load_std),
        load_line=None if options.load_line is None else float(line),
        tilt=_tilt(film),
        drift=reading_error(settings, frames) if drift is None else float(drift) / 100,
        cavitation_pressure=float(options.cavitation_pressure_std or 0.0),
        viscosity=viscosity_error(settings, frames),
    )


def _tilt(film: xr.Dataset) -> float:
    """Root of the mean square that the tilt of the pin towards the load may have. [m/m]

    The measured mean, and its error by what all triggers share; zero where none is measured.
    """
    if "pin_tilt" not in film:
        return 0.0
    tilt, cov = film.pin_tilt.values[:, 0], film.pin_position_cov.values[:, 2, 2]
    known = np.isfinite(tilt) & np.isfinite(cov)
    if not known.any():
        return 0.0
    return 1e-3 * float(np.sqrt(np.mean(tilt[known]) ** 2 + np.mean(cov[known])))
