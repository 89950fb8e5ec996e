"""The friction of the measured film of a run, and what its numbers leave out."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import xarray as xr

from erlif.calibration import RunCurve
from erlif.core.arrays import Array
from erlif.core.notes import Note, remark
from erlif.io.settings import OilSettings
from erlif.models.shear import shear_heating
from erlif.pipeline.engines.results import TriggerResult
from erlif.pipeline.physics.fit import given_errors, reading_error
from erlif.pipeline.physics.joint import describe_viscosity
from erlif.pipeline.physics.prediction import build_journal
from erlif.pipeline.plane import ObjectPlane
from erlif.prediction import find_drag, find_friction
from erlif.trend import VogelLaw, viscosity_at

# Thermal conductivity of mineral oils. [W/(m K)]
_CONDUCTIVITY = 0.13


def describe_friction(
    film: xr.Dataset, results: Sequence[TriggerResult], curve: RunCurve, plane: ObjectPlane
) -> tuple[xr.Dataset, list[Note]]:
    """Shear of the region of interest and friction of the whole joint, as far as both are known.

    Parameters
    ----------
    film : xarray.Dataset
        On dim trigger, with the position of the pin where there is one.
    results : sequence of TriggerResult
    curve : RunCurve
        With which they were measured.
    plane : ObjectPlane
        With the settings of the run.

    Returns
    -------
    friction : xarray.Dataset
        Empty without [oil] or a speed.
    notes : list of Note
    """
    settings = plane.settings
    oil = settings.oil
    if oil is None or "sliding_speed" not in film:
        return xr.Dataset(), []
    law = describe_viscosity(oil)
    if isinstance(law, VogelLaw) and "temperature" not in film:
        return xr.Dataset(), []
    conditions = film[[name for name in ("sliding_speed", "temperature") if name in film]]
    viscosity = viscosity_at(conditions, law)
    stated = float(oil.viscosity_std or 0.0) / float(viscosity.mean())
    relative = math.hypot(stated, reading_error(settings, film))
    found = find_drag(
        [one.statistics for one in results],
        viscosity * film.sliding_speed.values,
        area=1e-6 * plane.region_area,
        calibration_cov=curve.full_covariance,
        viscosity_std=relative,
    )

    if settings.joint is None or not {"pin_displacement", "joint_load"} <= set(film):
        return found, []
    options = settings.prediction
    moved = next((film[name].values for name in ("rocker_speed", "stroke") if name in film), 1.0)
    whole = find_friction(
        film,
        build_journal(settings, 1.0),  # its viscosity is not used
        viscosity=viscosity,
        direction=np.sign(moved) * (1 if options.direction == "along" else -1),
        sideways=options.sideways,
        given=given_errors(settings, film, film),
        viscosity_std=relative,
    )
    return found.merge(whole), _note(film, whole, oil, viscosity)


def _note(film: xr.Dataset, friction: xr.Dataset, oil: OilSettings, viscosity: Array) -> list[Note]:
    """What the friction of the film leaves out, and how much that can be."""
    torque, speed = friction.friction_torque.values, film.sliding_speed.values
    if not np.isfinite(torque).any():
        return []
    top = int(np.nanargmax(np.where(np.isfinite(torque), speed, np.nan)))
    heat = shear_heating(float(speed[top]), viscosity=viscosity[top], conductivity=_CONDUCTIVITY)
    place = film.pin_displacement
    rate = 1e6 * speed[top] / (place.attrs["clearance"] - np.hypot(*place.values[top]))
    voids = float(np.nanmax(friction.friction_void_share.values))
    text = (
        "full film between rigid, smooth, parallel walls all round the joint, cavities take off up "
        f"to {voids:.0%}. Left out: heating of the film over its walls, {heat:.1g} K at top speed, "
        f"and shear thinning, {rate:.1g} 1/s there"
    )
    if oil.viscosity_std is None:
        text += ". Not in its errors: that of the viscosity, viscosity_std in [oil]"
    return [remark("friction", text)]
