"""The position of the pin at every trigger: where it is measured, and as variables of the film."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from decimal import Decimal
from typing import Any

import numpy as np

from erlif.calibration import RunCurve
from erlif.core.notes import Note, remark, warn
from erlif.core.terms import SOURCES
from erlif.core.units import Quantity
from erlif.core.variables import FILM
from erlif.io.settings import JointSettings
from erlif.models.contact import conformal_radius, contact_modulus, hertz_line
from erlif.pipeline.plane import ObjectPlane
from erlif.trend import (
    PARAMETERS,
    SCALE_STD,
    SIGNIFICANT,
    Cause,
    GapForm,
    PinPosition,
    PinView,
    judge_form,
)

# Errors that frames do not show, of those that a note names.
_LISTED = 3

# Directions of displacement and tilt: towards the load, and sideways along sliding.
AXES = ("load", "side")


def describe_positions(
    positions: Sequence[PinPosition | None], calibration: RunCurve, view: PinView | None
) -> dict[str, Any]:
    """Position of the pin and form of the gap at each trigger, as variables of the film.

    Parameters
    ----------
    positions : sequence of PinPosition or None
        Of the triggers.
    calibration : RunCurve
        With which they were measured.
    view : PinView or None

    Returns
    -------
    dict of str to variable
        Empty without a view.
    """
    known = [one for one in positions if one is not None]
    if view is None or len(known) < len(positions):
        return {}
    shared = calibration.full_covariance
    value = np.array([one.value for one in known])
    form = np.array([one.form.value for one in known])
    form_std = np.sqrt([np.diag(one.form.covariance(shared)) for one in known])
    expected = value[:, 0] / view.radius**2
    place = {
        "clearance": view.least_clearance,
        "load_line": view.load_line,
        "axial_origin": view.axial_origin,
    }
    columns = {
        "axis": np.array(AXES),
        "parameter": np.array(PARAMETERS),
        "pin_displacement": value[:, :2],
        "pin_tilt": value[:, 2:],
        "pin_position_cov": np.array([one.covariance(shared) for one in known]),
        "pin_position_cov_random": np.array([one.random_cov for one in known]),
        "pin_position_gradient": np.array([one.gradient for one in known]),
        # curvatures that a second fit leaves free
        "film_curvature": expected + form[:, 0],
        "film_curvature_expected": expected,
        "film_curvature_std": form_std[:, 0],
        "film_curvature_axial": form[:, 1],
        "film_curvature_axial_std": form_std[:, 1],
    }
    placed = ("pin_displacement", "pin_tilt")
    return {
        name: FILM[name].fill(values, **(place if name in placed else {}))
        for name, values in columns.items()
    }


def note_form(
    positions: Sequence[PinPosition | None],
    calibration: RunCurve,
    plane: ObjectPlane,
    load: float,
) -> list[Note]:
    """Notes on the form of the gap against that of rigid circles, and on its flattening.

    Parameters
    ----------
    positions : sequence of PinPosition or None
        Of the triggers.
    calibration : RunCurve
    plane : ObjectPlane
    load : float
        On the joint; NaN where it is not known. [N]

    Returns
    -------
    list of Note
        Empty where the form is that of the joint and rigid.
    """
    known = [one for one in positions if one is not None]
    view, joint = plane.view, plane.settings.joint
    if view is None or joint is None:
        return []
    depth = _flattening(joint, load)
    form = judge_form(
        known,
        view,
        calibration_cov=calibration.full_covariance,
        clearance_std=clearance_std(joint),
        flattening=depth,
        systematics=calibration.systematics,
    )
    if form is None:
        return []
    notes = []
    if form.cause is not Cause.NONE:
        notes.append(_note_cause(form, view, joint))

    std = [one.covariance(calibration.full_covariance)[0, 0] ** 0.5 for one in known]
    least = float(np.nanmedian(std))
    if depth > least:
        text = (
            f"the load flattens pin and bushing by up to {depth:.2g} um (Hertz, b^2/2R), more than "
            f"the standard deviation of the displacement towards the load, {least:.2g} um: it is "
            "that of the surfaces in the image, not of the axes. Film thickness and tilts are not "
            "affected"
        )
        notes.append(remark("pin", text))
    return notes


def _note_cause(form: GapForm, view: PinView, joint: JointSettings) -> Note:
    """A deviation of the form, with its causes by likelihood."""
    imitations = [
        f"{SOURCES[one.term].what} ({100 * one.size:+.1f} %)" for one in form.imitations[:_LISTED]
    ]
    if form.cause is Cause.BENDING:
        by_dark = (
            "a wrong dark, or light that is not film, which weighs most where the beam is weak: "
            "look at the dark of this run, and photograph the dry joint"
        )
        causes = _list_causes(["a bent pin or an uneven bore", by_dark, *imitations])
        return warn(
            "pin",
            f"the gap is curved along the axis, {1e3 * form.bend:.2f} ± {1e3 * form.bend_std:.2f} "
            "nm/mm2, where a straight pin has none. Maps alone do not separate the causes: "
            f"{causes}. Position and tilts are those of the nearest straight pin",
        )

    excess, (low, high) = 100 * form.excess, form.films
    change, change_std = 100 * form.excess_change, 100 * form.excess_change_std
    std = clearance_std(joint)
    if form.cause is Cause.FLATTENING:
        own = ["elastic flattening of the surfaces, which is of this size in a thin film"]
    elif abs(change) > SIGNIFICANT * change_std and form.cause is Cause.CALIBRATION:
        own = [
            "the calibration, because the deviation changes with the film, by "
            f"{change:+.1f} ± {change_std:.1f} %. Photograph the fixture again, and the dry joint"
        ]
    else:
        clearance = view.clearance * (1 + form.excess)
        radii = (
            f"a clearance of {clearance:.1f} um in place of {view.clearance:.1f} um, stated to "
            f"± {std:.2g} um by the digits of the radii"
        )
        thick = "thick" if form.excess > 0 else "thin"
        scale = f"films that the calibration makes {abs(excess):.1f} % too {thick}"
        own = [radii, scale] if form.cause is Cause.RADII else [scale, radii]

    # radii and scale are known better than the errors that frames do not show, or less well
    own_cost = (form.excess / math.hypot(std / view.clearance, SCALE_STD)) ** 2
    first = bool(form.imitations) and form.imitations[0].cost < own_cost
    causes = _list_causes([*imitations, *own] if first else [*own, *imitations])
    std = 100 * form.excess_std
    return warn(
        "pin",
        f"the curvature along sliding deviates by {excess:+.1f} ± {std:.1f} % from that of the "
        f"radii in [joint], over films of {low:.1f} to {high:.1f} um. Maps alone do not separate "
        f"the causes; likely, in this order: {causes}",
    )


def _list_causes(causes: Sequence[str]) -> str:
    """Causes as one text, numbered where there are several."""
    if len(causes) == 1:
        return causes[0]
    return "; ".join(f"({n}) {cause}" for n, cause in enumerate(causes, 1))


def _flattening(joint: JointSettings, load: float) -> float:
    """Depth b^2/2R to which the load flattens pin and bushing; 0 without a load. [um]"""
    if not (np.isfinite(load) and load > 0):
        return 0.0
    radius = conformal_radius(joint.pin_radius, bushing_radius=joint.bushing_radius)
    modulus = contact_modulus(
        joint.pin.youngs_modulus,
        poisson_1=joint.pin.poissons_ratio,
        youngs_2=joint.bushing.youngs_modulus,
        poisson_2=joint.bushing.poissons_ratio,
    )
    contact = hertz_line(load / joint.length, radius=radius, contact_modulus=modulus)
    return float(1e6 * contact.half_width**2 / (2 * radius))


def clearance_std(joint: JointSettings) -> float:
    """Standard deviation of the clearance by the last digits of both radii. [um]"""
    return math.hypot(_rounding(joint.pin_radius), _rounding(joint.bushing_radius))


def _rounding(length: float) -> float:
    """Standard deviation of a length by its last stated digit, uniform over it. [um]"""
    if not isinstance(length, Quantity):
        return 0.0
    digits = re.match(r"[+-]?[0-9.]+([eE][+-]?[0-9]+)?", length.text)
    if digits is None:  # the settings refuse a length without a number
        return 0.0
    number = Decimal(digits[0])
    last = 10.0 ** int(number.as_tuple().exponent)
    return 1e6 * last * float(length) / float(number) / math.sqrt(12)
