"""The position of the pin at every trigger: where it is measured, and as variables of the film."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from erlif.calibration import Calibration
from erlif.core.arrays import Array
from erlif.core.errors import ConfigError
from erlif.pipeline.results import TriggerResult
from erlif.settings import RunSettings
from erlif.trend import PARAMETERS, PinPosition, PinView

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
    results: Sequence[TriggerResult], calibration: Calibration, view: PinView | None
) -> dict[str, Any]:
    """Position of the pin and form of the gap at each trigger, as variables of the film.

    Parameters
    ----------
    results : sequence of TriggerResult
    calibration : Calibration
        With which they were measured.
    view : PinView or None

    Returns
    -------
    dict of str to variable
        Empty without a view.
    """
    if view is None or any(result.position is None for result in results):
        return {}
    found = [result.position for result in results if result.position is not None]
    shared = calibration.full_covariance
    value = np.array([one.value for one in found])
    place = {
        "clearance": view.clearance,
        "load_line": view.load_line,
        "axial_origin": view.axial_origin,
        "ancillary_variables": "pin_position_cov pin_position_cov_random pin_position_gradient",
    }
    names = {"long_name": "numbers of the position of the pin"}
    return {
        "axis": ("axis", np.array(AXES), {"long_name": "direction of displacement and tilt"}),
        "parameter": ("parameter", np.array(PARAMETERS), names),
        "pin_displacement": (
            ("trigger", "axis"),
            value[:, :2],
            {"units": "um", "long_name": "displacement of the pin from the centre of the bore"}
            | place,
        ),
        "pin_tilt": (
            ("trigger", "axis"),
            value[:, 2:],
            {"units": "um mm-1", "long_name": "change of the displacement along the axis"} | place,
        ),
        **_describe_covariance(found, shared),
        **_describe_form(found, shared, view),
    }


def _describe_covariance(found: Sequence[PinPosition], shared: Array) -> dict[str, Any]:
    """The whole covariance, and the parts from which that of several triggers follows."""
    both = ("trigger", "parameter", "parameter_other")
    comment = "displacements in um, tilts in um mm-1; parameter_other has the order of parameter"
    return {
        "pin_position_cov": (
            both,
            np.array([one.covariance(shared) for one in found]),
            {"long_name": "covariance of the position, all parts", "comment": comment},
        ),
        "pin_position_cov_random": (
            both,
            np.array([one.random_cov for one in found]),
            {"long_name": "part of it that is new at every trigger", "comment": comment},
        ),
        "pin_position_gradient": (
            ("trigger", "parameter", "calibration_parameter"),
            np.array([one.gradient for one in found]),
            {
                "long_name": "change of the position with the parameters of the calibration",
                "comment": "in the order of the covariance of the calibration",
            },
        ),
    }


def _describe_form(found: Sequence[PinPosition], shared: Array, view: PinView) -> dict[str, Any]:
    """Curvatures of the gap that a second fit leaves free."""
    form = np.array([one.form for one in found])
    std = np.sqrt([np.diag(one.form_covariance(shared)) for one in found])
    expected = np.array([one.value[0] for one in found]) / view.radius**2
    attrs = {"units": "um mm-2"}
    return {
        "film_curvature": (
            "trigger",
            expected + form[:, 0],
            attrs
            | {
                "long_name": "second derivative of the gap along sliding, at the load line",
                "expected": expected,
                "comment": "expected is, by trigger, that of circles of the radii in [joint]",
                "ancillary_variables": "film_curvature_std",
            },
        ),
        "film_curvature_std": (
            "trigger",
            std[:, 0],
            attrs | {"long_name": "its standard deviation, random and shared"},
        ),
        "film_curvature_axial": (
            "trigger",
            form[:, 1],
            attrs
            | {
                "long_name": "second derivative of the gap along the axis",
                "ancillary_variables": "film_curvature_axial_std",
            },
        ),
        "film_curvature_axial_std": (
            "trigger",
            std[:, 1],
            attrs | {"long_name": "its standard deviation, random and shared"},
        ),
    }
