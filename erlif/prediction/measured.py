"""Measured positions of the pin, with the errors that are new at each trigger and those shared."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import xarray as xr

from erlif.calibration import calibration_of
from erlif.core.arrays import Array, Mask
from erlif.core.errors import ConfigError
from erlif.core.products import require
from erlif.core.statistics import covariance_root, symmetric_root
from erlif.io.files import settings_of
from erlif.trend import load_line_covariance

_MICRO, _MILLI = 1e6, 1e-3
_THINNEST = 0.1  # film with which weights are computed [um]
_TOGETHER = 500  # triggers, for their memory
_PLACES = 96  # places along sliding at which marks count as independent
_NEGLIGIBLE_MARKS = 1e-8  # share of the variance of the marks below which a source is left out
_NEGLIGIBLE = 1e-12  # share of the largest variance below which a source of errors is left out


@dataclass(frozen=True)
class MeasuredMotion:
    """Measured displacement of the pin at each trigger, or only that to the thinnest film.

    Attributes
    ----------
    value : Array
        Displacement of the pin along the load and sideways, (trigger, 2), or that towards the
        thinnest film where only the minimum was measured, (trigger, 1). [m]
    random_cov : Array
        Covariance of the errors that are new at every trigger, (trigger, axis, axis). [m2]
    shared : Array
        Change with one standard deviation of each error that is common to all triggers,
        (trigger, axis, source). [m]
    by_clearance : Array or None
        Change of the values with the clearance for the same measured films, (trigger, axis); by
        default 1 towards the thinnest film. [m/m]
    """

    value: Array
    random_cov: Array
    shared: Array
    by_clearance: Array | None = None

    @property
    def is_position(self) -> bool:
        """Whether both displacements were measured."""
        return bool(self.value.shape[1] == 2)

    @property
    def known(self) -> Mask:
        """Triggers with a measured value and its error, (trigger,)."""
        variances = np.diagonal(self.random_cov, axis1=1, axis2=2)
        found = np.isfinite(self.value).all(axis=1) & np.isfinite(self.shared).all(axis=(1, 2))
        return np.asarray(found & (np.isfinite(variances) & (variances > 0)).all(axis=1))

    @property
    def widening(self) -> Array:
        """`by_clearance`, with its default. (trigger, axis)"""
        if self.by_clearance is not None:
            return self.by_clearance
        distance = np.sqrt(np.sum(self.value**2, axis=1, keepdims=True))
        return np.asarray(self.value / np.maximum(distance, 1e-15))


def measured_positions(film: xr.Dataset, calibration_cov: Array | None = None) -> MeasuredMotion:
    """Take the positions of the pin from a film.

    Parameters
    ----------
    film : xarray.Dataset
        pin_displacement [um], pin_position_cov, pin_position_cov_random and
        pin_position_gradient, on dim trigger.
    calibration_cov : array, optional
        `RatioCurve.full_covariance`. Without it the whole part that is not random counts as one
        set of errors that all triggers share.

    Returns
    -------
    MeasuredMotion
        Marks of the surfaces repeat from trigger to trigger and are shared like the calibration;
        the error of the load line is left out, as the place of the line is an unknown of fits. In
        a film with settings and calibration each trigger shares those that it sees: pixels beyond
        the calibrated range do not count, and which ones these are changes as the thin line moves.

    Raises
    ------
    ErlifError
        If a variable is missing.
    ConfigError
        If the covariance belongs to another calibration.

    Examples
    --------
    >>> both = np.diag([4e-6, 9e-6]) * np.ones((3, 1, 1))
    >>> film = xr.Dataset({
    ...     "pin_displacement": (("trigger", "axis"), np.full((3, 2), 200.0)),
    ...     "pin_position_cov": (("trigger", "parameter", "parameter_other"), 2 * both),
    ...     "pin_position_cov_random": (("trigger", "parameter", "parameter_other"), both),
    ... })
    >>> found = measured_positions(film)
    >>> np.sqrt(found.random_cov[0].diagonal()) * 1e9, np.abs(found.shared[0].diagonal()) * 1e9
    (array([2., 3.]), array([2., 3.]))
    """
    require(film, "pin_displacement", "pin_position_cov", "pin_position_cov_random")
    value = film.pin_displacement.values / _MICRO
    whole = film.pin_position_cov.values[:, :2, :2] / _MICRO**2
    random = film.pin_position_cov_random.values[:, :2, :2] / _MICRO**2
    columns = np.zeros((len(value), 2, 0))
    if calibration_cov is not None:
        require(film, "pin_position_gradient")
        gradient = film.pin_position_gradient.values[:, :2] / _MICRO
        if gradient.shape[-1] != len(calibration_cov):
            raise ConfigError(
                f"Expected the covariance of the {gradient.shape[-1]} numbers of the calibration "
                f"of this film, got one of {len(calibration_cov)}. Give the calibration with which "
                "it was processed."
            )
        columns = gradient @ covariance_root(calibration_cov)

    # what is left repeats from trigger to trigger: marks of the surfaces
    by_line = load_line_covariance(film)[:, :2, :2] / _MICRO**2
    left = whole - random - by_line - columns @ np.swapaxes(columns, 1, 2)
    seen = _seen_angles(film)
    marks = _roots(left) if seen is None else _share_marks(left, seen)
    by_clearance = None
    if seen is not None:
        by_clearance = _widen(value * _MICRO, seen, film.pin_displacement.attrs["clearance"])
    return MeasuredMotion(value, random, np.concatenate([columns, marks], axis=2), by_clearance)


def measured_minima(
    film_min: Array, std: Array, *, clearance: float, std_shared: Array | float = 0.0
) -> MeasuredMotion:
    """Take minimum films where no positions were measured.

    Parameters
    ----------
    film_min, std : array, (trigger,)
        Minimum film and its standard deviation by what is new at every trigger. [m]
    clearance : float
        Radial clearance of the joint. [m]
    std_shared : array, (trigger, source) or (trigger,), or float
        Standard deviation by each error, or the one, that all triggers share. [m]

    Returns
    -------
    MeasuredMotion
        The displacement towards the thinnest film; where this is leaves no trace in a minimum.

    Examples
    --------
    >>> found = measured_minima(np.array([5e-6]), np.array([1e-8]), clearance=230e-6)
    >>> print(f"{found.value[0, 0] * 1e6:.1f}", found.is_position)
    225.0 False
    """
    film, random = np.asarray(film_min, dtype=float), np.asarray(std, dtype=float)
    shared = np.asarray(std_shared, dtype=float)
    if shared.ndim < 2:
        shared = np.broadcast_to(shared, film.shape)[:, np.newaxis]
    return MeasuredMotion(
        (clearance - film)[:, np.newaxis],
        (random**2)[:, np.newaxis, np.newaxis],
        shared[:, np.newaxis, (shared != 0).any(axis=0)],
    )


def _widen(place: Array, seen: Array, clearance: float) -> Array:
    """Change of displacements with the clearance, (trigger, axis).

    c - ex cos - ey sin is fitted to films that stay, where each trigger sees them; the error of a
    film is in proportion to it.
    """
    part = np.linspace(0.0, 1.0, _PLACES)
    angle = seen[:, :1] + part * (seen[:, 1:] - seen[:, :1])
    shapes = np.stack([np.cos(angle), np.sin(angle)], axis=2)
    films = clearance - np.einsum("tpa,ta->tp", shapes, place)
    weight = 1 / np.maximum(films, _THINNEST) ** 2
    normal = np.einsum("tp,tpa,tpb->tab", weight, shapes, shapes)
    right = np.einsum("tp,tpa->ta", weight, shapes)
    known = np.isfinite(normal).all(axis=(1, 2))
    found = np.full(place.shape, np.nan)
    found[known] = np.linalg.solve(normal[known], right[known][..., np.newaxis])[..., 0]
    return found


def _seen_angles(film: xr.Dataset) -> Array | None:
    """Angles at the ends of the visible part of the joint, (trigger, end). [rad]

    None where the film does not state them.
    """
    if not {"settings", "calibration"} <= set(film.attrs) or not {"x", "y"} <= set(film.coords):
        return None
    settings = settings_of(film)
    joint, roi = settings.joint, settings.thickness.roi
    if joint is None or not {"load_line", "clearance"} <= set(film.pin_displacement.attrs):
        return None
    axis = "x" if settings.optics.x_axis == "sliding" else "y"
    place = film[axis].values
    first, last = (place[0], place[-1]) if roi is None else getattr(roi, axis)
    radius = math.sqrt(joint.pin_radius * joint.bushing_radius) / _MILLI
    region = (np.array([first, last]) - film.pin_displacement.attrs["load_line"]) / radius

    # beyond this angle from the thinnest film, c - e cos(angle) is above the range
    load, side = film.pin_displacement.values.T
    eccentricity = np.hypot(load, side)
    clearance = film.pin_displacement.attrs["clearance"]
    highest = calibration_of(film).thickness_range[1]
    reach = np.arccos(np.clip((clearance - highest) / eccentricity, -1.0, 1.0))
    attitude = np.arctan2(side, load)
    ends = attitude[:, np.newaxis] + reach[:, np.newaxis] * np.array([-1.0, 1.0])
    return np.asarray(np.clip(ends, *region))


def _share_marks(covariances: Array, seen: Array) -> Array:
    """Errors by surface marks within the view of each trigger, (trigger, axis, source).

    Marks are taken as independent from place to place along sliding: waves and scratches of turning
    run along the axis. Each trigger weighs them as the least-squares fit of both displacements to
    what it sees, scaled to its own covariance.
    """
    known: Mask = np.asarray(
        np.isfinite(seen).all(axis=1) & np.isfinite(covariances).all(axis=(1, 2))
    )
    shares = np.full((len(seen), 2, _PLACES), np.nan)
    if not known.any():
        return shares[:, :, :0]

    places = np.linspace(seen[known, 0].min(), seen[known, 1].max(), _PLACES)
    shapes = np.stack([np.cos(places), np.sin(places)], axis=1)
    width = places[1] - places[0]
    for start in range(0, len(seen), _TOGETHER):
        at = start + np.flatnonzero(known[start : start + _TOGETHER])
        # two displacements need two places, also where nothing of a film is within the range
        middle, half = seen[at].mean(axis=1), np.maximum(0.5 * np.ptp(seen[at], axis=1), width)
        # the place at an end counts as far as it is seen, so that windows change continuously
        inside = (half[:, np.newaxis] - np.abs(places - middle[:, np.newaxis])) / width + 0.5
        weight = np.clip(inside, 0.0, 1.0)[..., np.newaxis]
        turned = np.linalg.pinv(shapes * weight) * np.swapaxes(weight, 1, 2)
        own = np.linalg.inv(symmetric_root(turned @ np.swapaxes(turned, 1, 2)))
        shares[at] = symmetric_root(covariances[at]) @ own @ turned

    # a few sources hold nearly all of it
    rows = shares[known].reshape(-1, _PLACES)
    size, axes = np.linalg.eigh(rows.T @ rows)
    return np.asarray(shares @ axes[:, size > _NEGLIGIBLE_MARKS * np.sum(size)])


def _roots(covariances: Array) -> Array:
    """Lower triangular roots of the covariances (trigger, 2, 2), which have one sign throughout."""
    first = np.sqrt(np.maximum(covariances[:, 0, 0], 0.0))
    safe = np.where(first > 0, first, 1.0)
    mixed = np.where(first > 0, covariances[:, 1, 0] / safe, 0.0)
    second = np.sqrt(np.maximum(covariances[:, 1, 1] - mixed**2, 0.0))
    roots = np.zeros((len(covariances), 2, 2))
    roots[:, 0, 0], roots[:, 1, 0], roots[:, 1, 1] = first, mixed, second
    large = np.nanmax(np.nan_to_num(roots) ** 2, axis=(0, 1), initial=0.0)
    return roots[:, :, large > _NEGLIGIBLE * large.max(initial=0.0)]
