"""The friction of the measured film of a run, and what its numbers leave out."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import xarray as xr

from erlif.calibration import RunCurve
from erlif.core.notes import Note, remark
from erlif.models.shear import shear_heating
from erlif.pipeline.engines.results import TriggerResult
from erlif.pipeline.physics.bore import departure
from erlif.pipeline.physics.given import given_errors, viscosity_error
from erlif.pipeline.physics.joint import describe_contact, describe_viscosity
from erlif.pipeline.physics.prediction import build_journal
from erlif.pipeline.plane import ObjectPlane
from erlif.prediction import find_drag, find_friction
from erlif.trend import viscosity_at

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
    settings, oil = plane.settings, plane.settings.oil
    needed = (
        {"sliding_speed"} if oil is None or oil.vogel is None else {"sliding_speed", "temperature"}
    )
    if oil is None or not needed <= set(film):
        return xr.Dataset(), []
    viscosity = viscosity_at(film[[*needed]], describe_viscosity(oil))
    relative = viscosity_error(settings, film)
    sides, contact = (plane.region.rows, plane.region.columns), describe_contact(settings)
    # the speed is that of the faster surface; the film is sheared by the difference of both
    speed = film.sliding_speed.values * (1.0 if contact is None else contact.sliding)
    found = find_drag(
        [one.statistics for one in results],
        viscosity * speed,
        area=math.prod(1e-3 * plane.pitch * (one.stop - one.start) for one in sides),
        calibration_cov=curve.full_covariance,
        viscosity_std=relative,
    )

    if settings.joint is None or not {"pin_displacement", "joint_load"} <= set(film):
        return found, []
    if shaped := departure(settings):
        text = f"not of the whole joint, which is taken as a round rigid bore: {shaped}"
        return found, [remark("friction", text)]
    moved = next((film[name].values for name in ("rocker_speed", "stroke") if name in film), 1.0)
    whole = find_friction(
        film,
        build_journal(settings, 1.0),  # its viscosity is not used
        viscosity=viscosity,
        direction=np.sign(moved) * (1 if settings.prediction.direction == "along" else -1),
        sideways=settings.prediction.sideways,
        given=given_errors(settings, film, film),
        viscosity_std=relative,
    )
    heat = shear_heating(speed, viscosity=viscosity, conductivity=_CONDUCTIVITY).max()
    voids = whole.friction_void_share.values.max()
    text = (
        "full film between rigid, smooth, parallel walls all round the joint; cavities take off "
        f"{voids:.0%} at most. Left out: shear thinning, and heating of the film over its walls, "
        f"{heat:.1g} K at most"
    )
    if oil.viscosity_std is None:
        text += ". Not in its errors: that of the viscosity, viscosity_std in [oil]"
    return found.merge(whole), [remark("friction", text)]
