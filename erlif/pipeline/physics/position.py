"""The position of the pin at every trigger: where it is measured, and as variables of the film."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from decimal import Decimal
from typing import Any

import numpy as np

from erlif.calibration import Calibration
from erlif.core.arrays import Array
from erlif.core.errors import ConfigError
from erlif.core.notes import Level, Note
from erlif.core.units import Quantity
from erlif.core.variables import FILM
from erlif.io.settings import JointSettings, RunSettings
from erlif.models.contact import conformal_radius, contact_modulus, hertz_line
from erlif.trend import (
    PARAMETERS,
    SIGNIFICANT,
    Cause,
    GapForm,
    PinPosition,
    PinView,
    judge_form,
)

AXES = ("load", "side")
"""Directions of displacement and tilt: towards the load, and sideways along sliding."""


def choose_view(settings: RunSettings, shape: tuple[int, int]) -> PinView | None:
    """The joint of a run as its camera sees it.

    Parameters
    ----------
    settings : RunSettings
    shape : tuple of int
        Rows and columns of a frame.

    Returns
    -------
    PinView or None
        None without [joint], and where the image is wider than half a turn of the pin.

    Raises
    ------
    ConfigError
        If the load line of the settings is more than a quarter of a turn from the image.
    """
    joint = settings.joint
    if joint is None:
        return None
    along_x = settings.optics.x_axis == "sliding"
    rows, columns = shape
    sliding, axial = (columns, rows) if along_x else (rows, columns)
    pitch = settings.optics.pixel_pitch * 1e3
    given = settings.prediction.load_line
    view = PinView(
        joint.pin_radius,
        joint.bushing_radius,
        pitch,
        load_line=0.5 * (sliding - 1) * pitch if given is None else given * 1e3,
        axial_origin=0.5 * (axial - 1) * pitch,
        sliding_along_x=along_x,
    )
    last = (sliding - 1) * pitch
    if view.sees(0.0, last):
        return view
    if given is None:
        return None
    quarter = 0.5 * np.pi * view.radius
    raise ConfigError(
        "Expected a load line no more than a quarter of a turn of the pin from any pixel, "
        f"{last - quarter:.1f} to {quarter:.1f} mm; [prediction] load_line is "
        f"{view.load_line:.1f} mm. Correct load_line, pixel_pitch in [optics], or the radii in "
        "[joint]."
    )


def describe_positions(
    positions: Sequence[PinPosition | None], calibration: Calibration, view: PinView | None
) -> dict[str, Any]:
    """Position of the pin and form of the gap at each trigger, as variables of the film.

    Parameters
    ----------
    positions : sequence of PinPosition or None
        Of the triggers.
    calibration : Calibration
        With which they were measured.
    view : PinView or None

    Returns
    -------
    dict of str to variable
        Empty without a view.
    """
    found = [one for one in positions if one is not None]
    if view is None or len(found) < len(positions):
        return {}
    shared = calibration.full_covariance
    value = np.array([one.value for one in found])
    place = {
        "clearance": view.clearance,
        "load_line": view.load_line,
        "axial_origin": view.axial_origin,
    }
    columns = {
        "axis": np.array(AXES),
        "parameter": np.array(PARAMETERS),
        "pin_displacement": value[:, :2],
        "pin_tilt": value[:, 2:],
        "pin_position_cov": np.array([one.covariance(shared) for one in found]),
        "pin_position_cov_random": np.array([one.random_cov for one in found]),
        "pin_position_gradient": np.array([one.gradient for one in found]),
        **_describe_form(found, shared, view),
    }
    placed = ("pin_displacement", "pin_tilt")
    return {
        name: FILM[name].fill(values, **(place if name in placed else {}))
        for name, values in columns.items()
    }


def _describe_form(found: Sequence[PinPosition], shared: Array, view: PinView) -> dict[str, Array]:
    """Curvatures of the gap that a second fit leaves free."""
    form = np.array([one.form for one in found])
    std = np.sqrt([np.diag(one.form_covariance(shared)) for one in found])
    expected = np.array([one.value[0] for one in found]) / view.radius**2
    return {
        "film_curvature": expected + form[:, 0],
        "film_curvature_expected": expected,
        "film_curvature_std": std[:, 0],
        "film_curvature_axial": form[:, 1],
        "film_curvature_axial_std": std[:, 1],
    }


def note_form(
    positions: Sequence[PinPosition | None],
    calibration: Calibration,
    view: PinView | None,
    settings: RunSettings,
    load: float,
) -> list[Note]:
    """Notes on the form of the gap against that of rigid circles, and on its flattening.

    Parameters
    ----------
    positions : sequence of PinPosition or None
        Of the triggers.
    calibration : Calibration
    view : PinView or None
    settings : RunSettings
    load : float
        On the joint; NaN where it is not known. [N]

    Returns
    -------
    list of Note
        Empty where the form is that of the joint and rigid.
    """
    found = [one for one in positions if one is not None]
    if view is None or settings.joint is None:
        return []
    depth = _flattening(settings.joint, load)
    form = judge_form(
        found,
        view,
        calibration_cov=calibration.full_covariance,
        clearance_std=_clearance_std(settings.joint),
        flattening=depth,
    )
    if form is None:
        return []
    notes = []
    if form.cause is not Cause.NONE:
        notes.append(Note(Level.WARNING, "pin", _describe_cause(form, view, settings.joint)))

    std = [one.covariance(calibration.full_covariance)[0, 0] ** 0.5 for one in found]
    least = float(np.nanmedian(std))
    if depth > least:
        text = (
            f"the load flattens pin and bushing by up to {depth:.2g} um (Hertz, b^2/2R), more than "
            f"the standard deviation of the displacement towards the load, {least:.2g} um: it is "
            "that of the surfaces in the image, not of the axes. Film thickness and tilts are not "
            "affected"
        )
        notes.append(Note(Level.NOTE, "pin", text))
    return notes


def _describe_cause(form: GapForm, view: PinView, joint: JointSettings) -> str:
    """A deviation of the form in words, with its likely cause."""
    low, high = form.films
    if form.cause is Cause.BENDING:
        return (
            f"the gap is curved along the axis, {1e3 * form.bend:.2f} ± {1e3 * form.bend_std:.2f} "
            "nm/mm2, where a straight pin has none. Likely: a bent pin or an uneven bore. Position "
            "and tilts are those of the nearest straight pin"
        )
    found = (
        f"the curvature along sliding deviates by {100 * form.excess:+.1f} ± "
        f"{100 * form.excess_std:.1f} % from that of the radii in [joint], over films of "
        f"{low:.1f} to {high:.1f} um. Likely: "
    )
    if form.cause is Cause.FLATTENING:
        return found + "elastic flattening of the surfaces, which is of this size in a thin film"
    change, change_std = 100 * form.excess_change, 100 * form.excess_change_std
    if abs(change) > SIGNIFICANT * change_std and form.cause is Cause.CALIBRATION:
        return (
            found
            + f"the calibration, because the deviation changes with the film, by {change:+.1f} "
            f"± {change_std:.1f} %. Photograph the fixture again, and the dry joint"
        )
    clearance = view.clearance * (1 + form.excess)
    stated = f"stated to ± {_clearance_std(joint):.2g} um by the digits of the radii"
    radii = f"a clearance of {clearance:.1f} um in place of {view.clearance:.1f} um, {stated}"
    scale = f"films that the calibration makes {100 * abs(form.excess):.1f} % too " + (
        "thick" if form.excess > 0 else "thin"
    )
    first, second = (radii, scale) if form.cause is Cause.RADII else (scale, radii)
    return f"{found}{first}; or {second}. Maps alone do not separate the two"


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


def _clearance_std(joint: JointSettings) -> float:
    """Standard deviation of the clearance by the last digits of both radii. [um]"""
    return math.hypot(_rounding(joint.pin_radius), _rounding(joint.bushing_radius))


def _rounding(length: float) -> float:
    """Standard deviation of a length by its last stated digit, uniform over it. [um]"""
    if not isinstance(length, Quantity):
        return 0.0
    found = re.match(r"[+-]?[0-9.]+([eE][+-]?[0-9]+)?", length.text)
    if found is None:  # the settings refuse a length without a number
        return 0.0
    number = Decimal(found[0])
    last = 10.0 ** int(number.as_tuple().exponent)
    return 1e6 * last * float(length) / float(number) / math.sqrt(12)
