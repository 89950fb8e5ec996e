"""Friction of the measured film: of the region of interest, and of the whole round joint."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import scipy
import xarray as xr

from erlif.core.arrays import Array
from erlif.core.variables import FILM
from erlif.models import shear
from erlif.models.reynolds import Journal
from erlif.models.reynolds.full_film import FullFilm
from erlif.models.reynolds.journal import as_mount
from erlif.prediction.given import GivenErrors
from erlif.prediction.measured import measured_positions
from erlif.trend import FilmStatistics

# Sideways force of a film with cavities over that of the full film, and its standard deviation.
_WEDGE, _WEDGE_STD = 0.75, 0.25

_MICRO, _MILLI = 1e6, 1e-3

# Tilts of equal probability by which the mean torque of a tilted pin is found.
_TILTS = (np.arange(256) + 0.5) / 256

_TOGETHER = 500  # triggers, for their memory


def find_drag(
    statistics: Sequence[FilmStatistics],
    couette: Array,
    *,
    area: float,
    calibration_cov: Array,
    viscosity_std: float = 0.0,
) -> xr.Dataset:
    """Find the shear force on the region of interest: its Couette part, eta U A / film.

    Parameters
    ----------
    statistics : sequence of FilmStatistics
        Of the triggers.
    couette : array, (trigger,)
        Viscosity times sliding speed. [Pa m]
    area : float
        Of the region. [m2]
    calibration_cov : array
        `RatioCurve.full_covariance`.
    viscosity_std : float
        Standard deviation of the viscosity over it.

    Returns
    -------
    xarray.Dataset
        film_drag and film_drag_std [N], on dim trigger.

    Examples
    --------
    >>> from erlif.trend import FilmNumber, FilmStatistics, GapMinimum
    >>> one, none = FilmNumber(5.0, 0.1, 0.0, np.zeros(3)), np.zeros(2)
    >>> gap = GapMinimum(one, one, one.scaled(0), one, none, 0.0, none, none, none)
    >>> film = FilmStatistics(one, gap, 0.0, FilmNumber(0.2, 0.01, 0.0, np.zeros(3)))
    >>> drag = find_drag([film], np.array([0.01]), area=1e-4, calibration_cov=np.eye(3))
    >>> drag.film_drag.values.round(3), drag.film_drag_std.values.round(3)
    (array([0.2]), array([0.01]))
    """
    value = np.array([one.region_inverse.value for one in statistics])
    known = np.array([one.region_inverse.std(calibration_cov) for one in statistics])
    std = np.hypot(known, viscosity_std * value)
    force = _MICRO * couette * area  # of a film of 1 um
    columns = {"film_drag": force * value, "film_drag_std": force * std}
    return xr.Dataset({name: FILM[name].fill(each) for name, each in columns.items()})


class _TiltFactor(NamedTuple):
    """Torque of a tilted pin over that of a parallel one: mean, change of this with the measured
    tilt, and the standard deviation that a straight line leaves.
    """

    mean: Array
    slope: Array
    bend_std: Array


def _tilt_factor(tilt: Array, std: Array, film: Array, *, length: float) -> _TiltFactor:
    """Factor of the torque over the tilts that a measured one leaves to a pin that is free."""
    std, most = np.maximum(std, 1e-12), 2 * film / length
    low, high = (scipy.special.ndtr((end - tilt) / std) for end in (-most, most))
    deviation = scipy.special.ndtri(low + (high - low) * _TILTS[:, np.newaxis])
    tilts = np.clip(tilt + std * deviation, -most, most)
    factor = shear.tilt_factor(np.abs(tilts), length=length, film=film)
    mean = factor.mean(axis=0)

    # the change of the mean of a normal distribution is the covariance over the variance
    slope = ((factor - mean) * (tilts - tilts.mean(axis=0))).mean(axis=0) / std**2
    return _TiltFactor(mean, slope, np.sqrt(np.maximum(factor.var(axis=0) - (slope * std) ** 2, 0)))


def find_friction(
    film: xr.Dataset,
    journal: Journal,
    *,
    viscosity: Array,
    direction: Array,
    sideways: str | float = "free",
    given: GivenErrors,
    viscosity_std: float = 0.0,
) -> xr.Dataset:
    """Find the friction of the film of a whole round joint from the position of its pin.

    Shear of the round gap, all round and over the whole length, and the moment of the load. A
    guided pin is held by the wedge of its film, one on a spring by that. The film is full where its
    lowest pressure under these forces lies above that of cavities. Else cavities take off half of
    the shear that they can, with the standard deviation of an even distribution, and a quarter of
    the wedge, with as much as standard deviation. The torque is the mean over the tilts towards the
    load that the measured one and its error leave to a pin that does not touch.

    Parameters
    ----------
    film : xarray.Dataset
        pin_displacement [um], pin_tilt [um/mm], pin_position_cov, pin_position_cov_random,
        sliding_speed [m s-1] and joint_load [N]; torque_logged [N m] where there is one; dim
        trigger.
    journal : Journal
        The joint, with any viscosity: `viscosity` takes its place.
    viscosity : array, (trigger,)
        [Pa s]
    direction : array, (trigger,)
        1 where the surface of the bushing moves along sliding, -1 where it moves against it.
    sideways : str or float
        "free", "guided", or a stiffness. [N/m]
    given : GivenErrors
        Of which clearance and load count.
    viscosity_std : float
        Standard deviation of the viscosity over it.

    Returns
    -------
    xarray.Dataset
        friction_torque and friction_torque_pressure [N m], friction_void_share [1],
        friction_coefficient [1], friction_power [W] and hersey_number [1], with standard
        deviations; torque_not_film [N m] with a logged torque. NaN where pin and bushing touch.

    Examples
    --------
    A film of 6 um at the load line of the joint of Farzaneh (2002):

    >>> film = xr.Dataset({
    ...     "pin_displacement": (("trigger", "axis"), [[224.0, 0.0]]),
    ...     "pin_tilt": (("trigger", "axis"), [[0.0, 0.0]]),
    ...     "pin_position_cov": (("trigger", "a", "b"), 1e-4 * np.eye(4)[None]),
    ...     "pin_position_cov_random": (("trigger", "a", "b"), 1e-4 * np.eye(4)[None]),
    ...     "sliding_speed": ("trigger", [0.0842]), "joint_load": ("trigger", [222.4]),
    ... })
    >>> joint, one = Journal(0.03336, 0.03359, length=0.237, viscosity=0.12), np.ones(1)
    >>> found = find_friction(film, joint, viscosity=0.12 * one, direction=one,
    ...                       given=GivenErrors(), viscosity_std=0.02)
    >>> print(f"{found.friction_torque.item():.3f} ± {found.friction_torque_std.item():.3f} N m, "
    ...       f"coefficient {found.friction_coefficient.item():.3f}")
    0.325 ± 0.007 N m, coefficient 0.044
    """
    (ex, ey), clearance = film.pin_displacement.values.T / _MICRO, journal.clearance
    distance = np.hypot(ex, ey)
    distance = np.where(distance < clearance, distance, np.nan)
    speed, load = film.sliding_speed.values, film["joint_load"].values
    rate = speed / journal.pin_radius  # it is that of the surface of the pin

    # a guided pin does not follow the mean turn of both surfaces, and is pressed sideways
    full, mount = FullFilm.of(journal), as_mount(sideways)
    film_min = clearance - distance
    damping = full.damping(film_min / clearance)[:, 1] * viscosity / journal.viscosity
    side = -direction * damping * distance * rate / 2 if mount.guided else -mount.stiffness * ey

    # a full film has no cavities unless its pressure would fall below theirs
    force = np.stack([ex * load + ey * side, ex * side - ey * load]) / distance
    broken = full.lowest_pressure(film_min / clearance, force.T) < journal.cavitation_pressure
    voids = np.where(broken, shear.void_share(distance / clearance), 0.0)
    wedge_std = np.where(broken & mount.guided, _WEDGE_STD * side, 0.0)
    side = np.where(broken & mount.guided, _WEDGE * side, side)

    whole = shear.journal_shear_torque(
        distance / clearance, journal, viscosity=viscosity, speed=speed
    )
    tilt, tilt_std = film.pin_tilt.values[:, 0], np.sqrt(film.pin_position_cov.values[:, 2, 2])
    each = np.stack([_MILLI * tilt, _MILLI * tilt_std, film_min])
    parts = [
        _tilt_factor(*each[:, at : at + _TOGETHER], length=journal.length)
        for at in range(0, tilt.size, _TOGETHER)
    ]
    tilts = _TiltFactor(*(np.concatenate(one) for one in zip(*parts, strict=True)))
    couette = whole * (1 - voids / 2) * tilts.mean
    by_load, by_side = direction * ey * load / 2, -direction * ex * side / 2
    pressure = by_load + by_side
    torque = couette + pressure

    # changes with displacements and tilt, and with the clearance at the same films
    thinner = couette * distance / (clearance**2 - distance**2)
    moment = direction * np.stack([-side, load]) / 2
    by_tilt = couette / tilts.mean * tilts.slope * _MILLI * _MICRO
    gradient = np.stack([*(thinner * np.stack([ex, ey]) / distance + moment), by_tilt])
    widening = measured_positions(film).widening.T
    wider = (gradient[:2] * widening).sum(axis=0) - thinner * clearance / distance

    def variance(name: str) -> Array:
        found = np.einsum("it,tij,jt->t", gradient, film[name].values[:, :3, :3], gradient)
        return np.asarray(found / _MICRO**2)

    # the wedge of a guided pin is in proportion to the viscosity
    causes = (
        viscosity_std * (couette + (by_side if mount.guided else 0.0)),
        given.clearance * wider,
        0.5 * ex * wedge_std,
        couette / tilts.mean * tilts.bend_std,
        voids / np.sqrt(12) * whole,
    )
    but_load = np.sqrt(variance("pin_position_cov") + sum(one**2 for one in causes))
    std = np.hypot(but_load, given.load * by_load)

    arm = load * journal.radius
    columns = {
        "friction_torque": torque,
        "friction_torque_std": std,
        "friction_torque_std_random": np.sqrt(variance("pin_position_cov_random")),
        "friction_torque_pressure": pressure,
        "friction_void_share": voids,
        "friction_coefficient": torque / arm,
        "friction_coefficient_std": np.hypot(but_load, given.load * (torque - by_load)) / arm,
        "friction_power": torque * rate,
        "friction_power_std": std * rate,
        "hersey_number": viscosity * speed * journal.length / load,
    }
    if "torque_logged" in film:
        columns["torque_not_film"] = np.abs(film["torque_logged"].values) - torque
    return xr.Dataset({name: FILM[name].fill(values) for name, values in columns.items()})
