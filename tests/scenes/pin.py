"""The pin of the virtual rig as a film without cavities carries it, by a solver of its own."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.interpolate import CubicSpline

from erlif.rig.film import crank_at, cycle_time, rocker_angle, rocker_range, rocker_speed
from erlif.rig.journal import follow_pin
from erlif.rig.orbit import RigidBearing, solve_squeeze
from erlif.rig.settings import RigSettings

RIG = RigSettings(film="reynolds", tilt=0.0, load_swing=0.0)


@dataclass(frozen=True)
class TruePin:
    """Motion and pressure of a pin; lengths in m."""

    rig: RigSettings
    bearing: RigidBearing
    time: np.ndarray
    angle: np.ndarray
    turning: np.ndarray
    position: np.ndarray  # (time, 4), without tilt
    rate: np.ndarray
    peak: np.ndarray  # Pa
    place: np.ndarray  # of the peak from the load line


def follow_true_pin(count, **changes):
    rig = replace(RIG, **changes)
    time = np.arange(count) * cycle_time(rig) / count
    crank = crank_at(time, rig)
    step = 1e-4
    fine = np.sort(np.concatenate([time - step, time, time + step]))
    before, here, after = np.moveaxis(follow_pin(fine, rig).reshape(-1, 3, 2), 1, 0)
    zero = np.zeros_like(here)
    bearing = RigidBearing(
        1e-3 * rig.journal_radius, 1e-6 * rig.clearance, 1e-3 * rig.length, rig.viscosity
    )
    peaks = np.array([_true_peak(bearing, one, rig.load) for one in here])
    return TruePin(
        rig,
        bearing,
        time,
        np.asarray(rocker_angle(crank, rig)) - np.mean(rocker_range(rig)),
        np.asarray(rocker_speed(crank, rig)),
        np.concatenate([here, zero], axis=1),
        np.concatenate([(after - before) / (2 * step), zero], axis=1),
        *peaks.T,
    )


def _true_peak(bearing, place, load):
    """Highest pressure of a full film under a load, and its place, by the series of the rig."""
    attitude = np.arctan2(place[1], place[0])
    eccentricity = np.hypot(*place) / bearing.clearance
    squeeze = solve_squeeze(eccentricity, bearing.length / bearing.radius)
    force = load * np.array([np.cos(attitude), -np.sin(attitude)])
    speed = force / (squeeze.damping * bearing.damping)
    unit = bearing.viscosity * bearing.radius**2 / bearing.clearance**3
    even, odd = unit * squeeze.pressure.T * speed[:, None]
    angle = np.concatenate([-squeeze.angle, squeeze.angle[::-1]])
    curve = CubicSpline(*(_sorted(angle, np.concatenate([even - odd, (even + odd)[::-1]]))))
    near = np.linspace(-0.3, 0.3, 6001)
    top = curve(near).argmax()
    return curve(near[top]), (near[top] + attitude) * bearing.radius


def _sorted(angle, pressure):
    order = angle.argsort()
    return angle[order], pressure[order]


def fit_true_film(film: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Displacements and tilts nearest to a true film, from positions about the middle. [um, mm]"""
    phi, z = x / np.sqrt(33.36 * 33.59), y[:, None]
    cos, sin = np.cos(phi) + 0 * z, np.sin(phi) + 0 * z
    design = np.stack([cos, sin, z * cos, z * sin], axis=-1).reshape(-1, 4)
    return np.linalg.lstsq(design, 230.0 - film.ravel().astype(float), rcond=None)[0]
