"""Orbit of a pin under load in a full film, without cavitation; free to move sideways.

The film depends on the angle alone, so the pressure is a sum of cosines along the axis. Each is a
linear boundary-value problem round the circumference, solved by Chebyshev collocation in
Sommerfeld's variable. The forces are then proportional to the velocities of the pin, and the orbit
is an ordinary differential equation in time.

Angles are from the load line, positive along +x of the picture. The pin rests, the bushing turns.
"""

from collections.abc import Callable
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

from erlif.core.arrays import Array
from erlif.core.errors import ModelError

# Collocation points over half the circumference.
POINTS = 32
# Cosines along the axis; the next ones add less than 1e-4 of the force.
HARMONICS = 96
# Smallest film of the orbit over the clearance.
THINNEST = 1e-3

_SLICES = 13  # along the axis, of a tilted film
_TABLE = 96  # eccentricities of the table; the spline between them is good to 2e-5
_TOLERANCE = 1e-8  # of the orbit; the clearance is its unit


class RigidBearing(NamedTuple):
    """Parallel cylinders and an oil of constant viscosity; `follow_cavitated` alone has all walls.

    Attributes
    ----------
    radius : float
        Geometric mean of the radii of pin and bushing. [m]
    clearance : float
        Difference of the radii. [m]
    length : float
        Length along the axis. The pressure is ambient at both ends and along the thickest film,
        which is flooded. [m]
    viscosity : float
        [Pa s]
    shape : callable or None
        What a bore that is not straight adds to the gap [m] at places along the axis from its
        middle [m].
    compliance : float
        Deflection of an elastic liner over the pressure on it. [m/Pa]
    roughness : float
        Root of the sum of squares of the rms roughness of both walls. [m]
    """

    radius: float
    clearance: float
    length: float
    viscosity: float
    shape: Callable[[Array], Array] | None = None
    compliance: float = 0.0
    roughness: float = 0.0

    @property
    def damping(self) -> float:
        """Unit of the damping, eta L (R/c)^3. [N s/m]"""
        return self.viscosity * self.length * (self.radius / self.clearance) ** 3


class Squeeze(NamedTuple):
    """Full film at one eccentricity, for unit velocities of the pin.

    The first column belongs to a velocity along the line of centres, towards the thinnest film; the
    second to one across it.

    Attributes
    ----------
    angle : Array
        Angle from the thinnest film, 0 to pi, (point,). [rad]
    pressure : Array
        Pressure in the middle plane over eta R^2/c^3 of the velocity, even and odd in the angle,
        (point, direction).
    damping : Array
        Force over velocity, in units of `RigidBearing.damping`, (direction,).
    """

    angle: Array
    pressure: Array
    damping: Array


def solve_squeeze(eccentricity: float, slenderness: float) -> Squeeze:
    """Solve the full film of one eccentricity [1]; `slenderness` is length over radius.

    With h = c H, H = 1 - eps cos a and p = eta R^2/c^3 v q, the part of q that varies as
    cos(b z), b = (2k + 1) pi/L, obeys ``(H^3 q')' - (b R)^2 H^3 q = -12 s {cos a, sin a}`` with its
    share s = 4 (-1)^k/((2k + 1) pi) of a uniform source; q = 0 at a = pi. Sommerfeld's variable g,
    H = (1 - eps^2)/(1 + eps cos g), resolves a thin film as well as a thick one.
    """
    series = _tabulate_series()
    shape = np.sqrt(1 - eccentricity**2)
    swell = 1 + eccentricity * np.cos(series.point)
    film = shape**2 / swell
    stretch = swell / shape  # dg/da
    sides = np.cos(series.point) + eccentricity, shape * np.sin(series.point)  # cos a, sin a: swell

    # H^3 q' is stiff q_g; its derivative over g has two terms
    sine = eccentricity * np.sin(series.point)
    stiff = film**3 * stretch
    stiff_slope = 3 * film**3 * sine / swell * stretch - film**3 * sine / shape

    number = (2 * np.arange(HARMONICS) + 1) * np.pi
    share = 4 * (-1.0) ** np.arange(HARMONICS) / number
    pressure, damping = np.empty((POINTS, 2)), np.empty(2)
    for side in (0, 1):
        value, first, second = series.terms[side]
        source = sides[side] / swell
        along = stretch[:, None] * (stiff[:, None] * second + stiff_slope[:, None] * first)
        across = film[:, None] ** 3 * value
        matrix = along - ((number / slenderness) ** 2)[:, None, None] * across
        right = -12 * share[:, None, None] * source[:, None]
        parts = (value @ np.linalg.solve(matrix, right))[..., 0]

        # both halves of the circumference; the mean of cos(b z) over the length is half its share
        pressure[:, side] = parts.sum(axis=0)
        damping[side] = (share / 2) @ (parts @ (2 * series.weight * source / stretch))
    return Squeeze(np.arctan2(sides[1], sides[0]), pressure, damping)


class _Series(NamedTuple):
    """Chebyshev polynomials of Sommerfeld's variable that vanish at the thickest film."""

    point: Array  # Sommerfeld's variable, 0 to pi, (point,) [rad]
    weight: Array  # of an integral over half the circumference, (point,) [rad]
    # Values with first and second derivatives, (point, term) each, even and odd.
    terms: tuple[tuple[Array, Array, Array], tuple[Array, Array, Array]]


@cache
def _tabulate_series() -> _Series:
    """Tabulate T_n(g/pi) - T_m(g/pi), m = 0 for even and 1 for odd n, at the nodes of T_2N."""
    angle = (np.arange(POINTS) + 0.5) * np.pi / (2 * POINTS)
    x = np.cos(angle)

    # Fejer's first rule on the nodes of T_2N, whose other half is the mirror image
    k = np.arange(1, POINTS + 1)
    weight = (1 - 2 * (np.cos(2 * np.outer(angle, k)) / (4 * k**2 - 1)).sum(axis=1)) / POINTS

    def tabulate(order: NDArray[np.int_]) -> tuple[Array, Array, Array]:
        value = np.cos(np.outer(angle, order))
        first = order * np.sin(np.outer(angle, order)) / np.sin(angle)[:, None]
        # the differential equation of the polynomials
        second = (x[:, None] * first - order**2 * value) / (1 - x[:, None] ** 2)
        lowest = order[0] % 2
        return (
            value - x[:, None] ** lowest,
            (first - lowest) / np.pi,
            second / np.pi**2,
        )

    return _Series(np.pi * x, np.pi * weight, (tabulate(2 * k), tabulate(2 * k + 1)))


class Mobility:
    """Damping of a bearing at any eccentricity, from a table.

    Parameters
    ----------
    bearing : RigidBearing
    """

    def __init__(self, bearing: RigidBearing) -> None:
        self.bearing = bearing
        self._spline = _tabulate_damping(bearing.length / bearing.radius)

    def damping(self, eccentricity: float | Array) -> Array:
        """Force over velocity along and across the line of centres, (..., direction). [N s/m]"""
        thin = -np.log1p(-np.minimum(eccentricity, 1 - THINNEST / 2))
        return np.asarray(self.bearing.damping * np.exp(self._spline(thin)))

    def damping_of_slices(self, place: Array, tilt: float) -> Array:
        """Force over velocity of a tilted pin, whose slices are squeezed as parallel films.

        Simpson's rule along the axis; `place` is over the clearance, `tilt` towards the load.

        Returns
        -------
        array, (direction of the force, direction of the velocity)
            [N s/m]
        """
        along = np.linspace(-0.5, 0.5, _SLICES)
        weight = np.resize([2.0, 4.0], _SLICES)
        weight[[0, -1]] = 1.0
        lift = along * tilt * self.bearing.length / self.bearing.clearance
        places = place + lift[:, None] * [1.0, 0.0]
        eccentricity = np.hypot(*places.T)
        line = places / eccentricity[:, None]
        across = np.stack([-line[:, 1], line[:, 0]], axis=1)
        both = self.damping(eccentricity)
        tensors = sum(
            size[:, None, None] * one[:, :, None] * one[:, None, :]
            for size, one in zip(both.T, (line, across), strict=True)
        )
        return np.asarray(np.tensordot(weight / weight.sum(), tensors, axes=1))


def lowest_pressure(bearing: RigidBearing, place: Array, load: float) -> float:
    """Lowest pressure over ambient in the middle plane under a load [N]. [Pa]

    `place` is the displacement of the pin along the load and along +x. [m]
    """
    eccentricity = float(np.hypot(*place)) / bearing.clearance
    attitude = np.arctan2(place[1], place[0])
    squeeze = solve_squeeze(eccentricity, bearing.length / bearing.radius)
    force = load * np.array([np.cos(attitude), -np.sin(attitude)])
    speed = force / (squeeze.damping * bearing.damping)

    # even and odd parts on both sides of the thinnest film
    unit = bearing.viscosity * bearing.radius**2 / bearing.clearance**3
    even, odd = unit * squeeze.pressure.T * speed[:, None]
    return float(min((even + odd).min(), (even - odd).min()))


@cache
def _tabulate_damping(slenderness: float) -> CubicSpline:
    """Logarithm of both dampings over -log(1 - eccentricity)."""
    thin = np.linspace(0, -np.log(THINNEST / 2), _TABLE)
    table = [solve_squeeze(one, slenderness).damping for one in -np.expm1(-thin)]
    return CubicSpline(thin, np.log(table))


def follow_orbit(
    bearing: RigidBearing,
    time: Array,
    *,
    load: Callable[[float], float],
    rotation: Callable[[float], float],
    start: tuple[float, float] = (0.0, 0.0),
    thicker: Callable[[float], float] | None = None,
    tilt: float = 0.0,
) -> Array:
    """Follow the pin from the moment of loading.

    In the frame that turns with half the bushing no oil is entrained, and load and velocity are
    proportional: ``u = load/damping`` along and across the line of centres. The turn of that frame
    is added in the frame of the picture.

    Parameters
    ----------
    bearing : RigidBearing
    time : array, (step,)
        Rising; the first is that of loading. [s]
    load : callable
        Load [N] at a time [s].
    rotation : callable
        Angular speed of the bushing [rad/s] at a time [s].
    start : (float, float)
        Displacement of the pin along the load and along +x at the first time. [m]
    thicker : callable, optional
        Viscosity over that of the bearing at a time [s].
    tilt : float
        Of the pin towards the load, with the displacement in the middle of the length. [m/m]

    Returns
    -------
    array, (step, direction)
        Displacement of the pin along the load and along +x. [m]

    Raises
    ------
    ModelError
        If the film becomes thinner than `THINNEST` of the clearance.
    """
    mobility, clearance = Mobility(bearing), bearing.clearance

    def squeeze(moment: float, place: Array) -> Array:
        if tilt:
            force = np.array([load(moment), 0.0])
            return np.asarray(np.linalg.solve(mobility.damping_of_slices(place, tilt), force))
        eccentricity = float(np.hypot(*place))
        line = place / eccentricity if eccentricity > 0 else np.array([1.0, 0.0])
        across = np.array([-line[1], line[0]])
        along_damping, across_damping = mobility.damping(eccentricity)
        force = np.array([load(moment), 0.0])
        return np.asarray(
            (force @ line) / along_damping * line + (force @ across) / across_damping * across
        )

    def velocity(moment: float, place: Array) -> Array:
        slower = clearance * (1.0 if thicker is None else thicker(moment))
        turn = rotation(moment) / 2 * np.array([-place[1], place[0]])
        return np.asarray(squeeze(moment, place) / slower + turn)

    def closes(_: float, place: Array) -> float:
        return float(1 - np.hypot(*place) - THINNEST)

    closes.terminal = True  # type: ignore[attr-defined]
    orbit = solve_ivp(
        velocity,
        (time[0], time[-1]),
        np.array(start) / clearance,
        method="DOP853",
        t_eval=time,
        events=closes,
        rtol=_TOLERANCE,
        atol=_TOLERANCE,
    )
    if not orbit.success or orbit.t.size < time.size:
        thinnest = 1e6 * THINNEST * clearance
        raise ModelError(
            f"Expected a film above {thinnest:.2g} um; the load closes it "
            f"{orbit.t[-1] - time[0]:.3g} s after loading. Choose fewer cycles since loading or a "
            "higher viscosity."
        )
    return np.asarray(orbit.y.T * clearance)
