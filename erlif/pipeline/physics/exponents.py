"""The power of speed over load that the film of a run follows."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import scipy
import xarray as xr

from erlif.calibration import RunCurve
from erlif.core.arrays import Array
from erlif.core.notes import Note, warn
from erlif.core.variables import FILM
from erlif.pipeline.engines.results import TriggerResult
from erlif.pipeline.plane import ObjectPlane
from erlif.trend import (
    LARGEST_BEYOND,
    LEAST_TRIGGERS,
    fit_exponent,
    mean_at_constant_minimum,
)

# Standard deviations of the exponent of the mean film that the moving place of the minimum may
# change, and the change that never counts.
_MOVED, _UNMOVED = 3.0, 0.01

# Power of speed above which no film follows it, and share of the variance that it may leave. Theory
# has 1 at most, and squeeze makes films less steep.
_STEEPEST, _LEFT = 2.0, 0.1

# Change of the speed over itself up to which it is constant: that of a disc is, but for rounding.
_CONSTANT = 1e-6

# The film of each exponent.
_FILM_OF = {
    "speed_exponent": "film_min",
    "speed_exponent_mean": "film_mean",
    "speed_exponent_gap_mean": "film_gap_mean",
    "speed_exponent_central": "film_central",
}


def describe_exponents(
    film: xr.Dataset,
    results: Sequence[TriggerResult],
    calibration: RunCurve,
    *,
    plane: ObjectPlane | None = None,
) -> dict[str, Any]:
    """Speed exponents of the minimum and of both mean films, as variables of the film.

    Empty where the film has no speed or no load. With a plane and positions of the pin, a mean
    film has no exponent where the place of the minimum moves so far that this alone gives one
    beyond the error.
    """
    name = speed_of_trend(film)
    if name not in film or "joint_load" not in film:
        return {}

    statistics = [result.statistics for result in results]
    numbers = {
        "speed_exponent": [one.gap.minimum for one in statistics],
        "speed_exponent_mean": [one.mean for one in statistics],
        "speed_exponent_gap_mean": [one.gap.mean for one in statistics],
    }
    if "film_central" in film:
        numbers["speed_exponent_central"] = [one.gap.central for one in statistics]
    part = np.array([one.beyond_range > LARGEST_BEYOND for one in statistics])
    speed, load = film[name].values, film["joint_load"].values
    shared = scipy.linalg.block_diag(calibration.full_covariance, np.eye(1))

    exponents: dict[str, Any] = {}
    moved = np.array([]) if plane is None else _moved_mean(film, plane)
    for variable, films in numbers.items():
        values = np.array([one.value for one in films])
        if variable == "speed_exponent_mean":
            values[part] = np.nan
        random = np.array([one.random_std for one in films])
        # marks of the surfaces are the same at every trigger; the mean film includes them as
        # they are
        marks = [one.surface_std for one in films]
        gradient = np.column_stack([np.array([one.gradient for one in films]), marks])
        exponent = fit_exponent(
            values,
            random,
            speed=speed,
            load=load,
            gradient=gradient,
            covariance=shared,
        )
        alone: dict[str, float] = {}
        if variable != "speed_exponent" and moved.size:
            counted = np.where(np.isfinite(values), moved, np.nan)
            geometry = fit_exponent(counted, random, speed=speed, load=load).value
            if abs(geometry) > max(_MOVED * exponent.std, _UNMOVED):
                alone = {"geometric": geometry, "fitted": exponent.value}
                exponent = replace(exponent, value=math.nan, std=math.nan, log_scale=math.nan)
        exponents[variable] = FILM[variable].fill(
            exponent.value,
            **alone,
            long_name=f"power of |{name}|/load that {_FILM_OF[variable]} follows",
            speed=name,
            log_scale=exponent.log_scale,
            triggers_used=exponent.triggers,
        )
        exponents[f"{variable}_std"] = FILM[f"{variable}_std"].fill(exponent.std)
    return exponents


def _moved_mean(film: xr.Dataset, plane: ObjectPlane) -> Array:
    """Mean films of the pin at a constant minimum; empty without its positions. [um]"""
    view = plane.view
    if view is None or "pin_displacement" not in film:
        return np.array([])
    line = float(film["pin_displacement"].attrs["load_line"])
    angle = (plane.along[plane.within] - line) / view.radius
    return mean_at_constant_minimum(film["pin_displacement"].values, view.clearance, angle)


def note_steepness(film: xr.Dataset) -> list[Note]:
    """Warn of a film that changes with the speed of a linkage, but more than any film does."""
    name = speed_of_trend(film)
    if "crank_angle" not in film or name not in film:
        return []
    speed, minimum = np.abs(film[name].values), film["film_min"].values
    use = (speed > 0) & (minimum > 0)
    if use.sum() < LEAST_TRIGGERS or not np.ptp(speed[use]) > _CONSTANT * np.max(speed[use]):
        return []
    x, y = np.log(speed[use]), np.log(minimum[use])
    power = np.polyfit(x, y, 1)
    if power[0] < _STEEPEST or np.var(y - np.polyval(power, x)) > _LEFT * np.var(y):
        return []
    text = (
        f"the minimum film changes by {math.expm1(np.ptp(y)):.0%} with {name}, which changes by "
        f"{math.expm1(np.ptp(x)):.0%}: no film follows a speed with the power {power[0]:.1f}. "
        "Correct the lengths of the links, or log the load that changes with the crank"
    )
    return [warn("mechanism", text)]


def note_moved_mean(film: xr.Dataset) -> list[Note]:
    """Warn that the exponent of the mean film is due to the moving place of the minimum."""
    attrs = film["speed_exponent_mean"].attrs if "speed_exponent_mean" in film else {}
    if "geometric" not in attrs:
        return []
    text = (
        "no power of speed: the place of the minimum moves in the region, which alone makes n = "
        f"{attrs['geometric']:.3f} of the fitted {attrs['fitted']:.3f}. Use that of film_min, or a "
        "region of interest over which the film differs less"
    )
    return [warn("film_mean", text)]


def speed_of_trend(film: xr.Dataset) -> str:
    """Name of the speed: that of the joint, unless there is none or the log has its own."""
    computed = "rocker_speed" in film
    if "sliding_speed" in film:
        computed = computed and film.sliding_speed.attrs.get("source") != "log"
    return "rocker_speed" if computed else "sliding_speed"
