"""Running-in of a bushing: pressure, arc of contact and friction torque as its wall wears.

The wall is a Winkler layer (Colbert et al. 2009, B1 to B3) on a rigid shaft, and every place of it
wears by Archard's law, dw/ds = k p (their appendix A). A clearance spreads its contact from the arc
of the unworn wall, an interference loses its squeeze, and both end at the pressure of a cosine with
a torque ratio of 4/pi (their figure 8).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

import numpy as np
from scipy.optimize import brentq

from erlif.core.arrays import Array
from erlif.core.described import describe_by
from erlif.core.errors import ModelError
from erlif.core.tables import read_table
from erlif.models.arguments import Values, formula
from erlif.models.contact.roots import like

if TYPE_CHECKING:
    import xarray as xr
    from scipy.interpolate import BSpline

# Share of a step in each of the two stages, with which the steps damp any stiffness.
_SHARE = 1 - 1 / np.sqrt(2)

# Change of the torque ratio within a step at most, of its distance from 1.
_LONGEST_STEP = 0.02

# First step, as a share of the whole sliding distance.
_SHORTEST = 1e-9

# Cells that carry load at the start at least, over half of the arc.
_FEWEST_CELLS = 8

# Smallest tabulated half angle [rad], and number of angles in each half of the table.
_NARROWEST, _KNOTS = 1e-2, 2000

# Half angle below which the torque ratio is 1 + a^2/10 to 5e-11. [rad]
_SERIES_BELOW = 1e-2


@dataclass(frozen=True)
class _Wall:
    """Half of the wall by cells, from the line of load round to the other side."""

    shaft_radius: float
    bushing_radius: float
    width: float
    thickness: float
    stiffness: float  # E'/t [Pa/m]
    load: float

    angle: Array
    cell: float

    def indentation(self, eccentricity: float) -> Array:
        """Indentation of the unworn wall, negative in a gap. Colbert et al. (2009), B1. [m]"""
        across = eccentricity * np.sin(self.angle)
        root = np.sqrt(self.bushing_radius**2 - across**2)

        # Rs - root without the cancellation of two radii
        near = self.shaft_radius - self.bushing_radius + across**2 / (self.bushing_radius + root)
        return near + eccentricity * np.cos(self.angle)

    def balance(self, worn: Array, softened: float) -> tuple[float, Array]:
        """Find eccentricity and pressure that carry the load, with E'/t divided by `softened`.

        The load that the wall carries rises with the eccentricity.
        """
        area = 2 * self.width * self.shaft_radius * self.cell

        def pressure_at(place: float) -> Array:
            overlap = self.indentation(place) - worn
            return np.asarray(self.stiffness / softened * np.maximum(overlap, 0))

        def excess(place: float) -> float:
            return float(area * np.sum(pressure_at(place) * np.cos(self.angle)) - self.load)

        if excess(self.bushing_radius) <= 0:
            raise ModelError(
                f"load of {self.load:g} N presses the shaft through the wall: its eccentricity "
                "reaches the radius of the bushing. Check load, modulus and thickness."
            )
        place = float(brentq(excess, 0.0, self.bushing_radius, xtol=1e-15 * self.bushing_radius))
        return place, pressure_at(place)

    def ratio(self, pressure: Array) -> float:
        """Torque ratio of a pressure."""
        return float(np.sum(pressure) / np.sum(pressure * np.cos(self.angle)))


@formula(specific_wear="positive specific_wear")
def run_in_bushing(
    load: float,
    *,
    shaft_radius: float,
    bushing_radius: float,
    width: float,
    thickness: float,
    modulus: float,
    specific_wear: float,
    sliding_distance: Values,
    cells: int = 720,
) -> xr.Dataset:
    """Wear a Winkler bushing by a rigid shaft. Colbert et al. (2009), appendices A and B.

    Parameters
    ----------
    modulus : float
        E' of the wall, see `erlif.models.contact.winkler_modulus`. [Pa]
    load : float
        Load on the shaft, of constant direction. [N]
    shaft_radius, bushing_radius : float
        Rs and Rb; a larger shaft is an interference. [m]
    width : float
        Width of the bushing. [m]
    thickness : float
        Thickness of the wall. [m]
    specific_wear : float
        Specific wear rate k of the wall. [1/Pa]
    sliding_distance : array of shape (n,)
        Distances at which the result is wanted, rising from 0 or more. [m]
    cells : int
        Cells round half of the bushing.

    Returns
    -------
    xarray.Dataset
        Over `sliding_distance` [m]: torque_ratio [1], half_angle of the contact [rad],
        eccentricity [m], peak_pressure [Pa] and worn_volume [m3]; with `angle` from the line of
        load [rad] also pressure [Pa] and depth [m].

    Raises
    ------
    ModelError
        A value that is not positive, distances that fall, a contact narrower than the cells
        resolve, or a wall that is worn through.

    Notes
    -----
    The shaft does not wear, friction does not move the line of load, and the worn wall keeps its
    stiffness. Debris is neglected. Steps are of second order and adapt to the change of the torque
    ratio.

    Examples
    --------
    A PTFE bushing of 10 mm with a radial clearance of 0.175 mm, after 0 and 70 m:

    >>> found = run_in_bushing(
    ...     100.0,
    ...     shaft_radius=5e-3,
    ...     bushing_radius=5.175e-3,
    ...     width=10e-3,
    ...     thickness=3e-3,
    ...     modulus=1e9,
    ...     specific_wear=5e-13,
    ...     sliding_distance=[0.0, 70.0],
    ...     cells=360,
    ... )
    >>> print([f"{ratio:.2f}" for ratio in found.torque_ratio.values])
    ['1.01', '1.10']
    """
    distances = np.atleast_1d(np.asarray(sliding_distance, float))
    rises = distances.ndim == 1 and distances.size > 0 and np.all(np.diff(distances) > 0)
    if not rises or np.any(np.isnan(distances)):
        raise ModelError(
            "sliding_distance must be one row of rising distances without NaN, got "
            f"{np.array2string(distances, threshold=8)} m."
        )
    cell, stiffness = np.pi / cells, modulus / thickness
    angle = np.asarray((np.arange(cells) + 0.5) * cell, np.float64)
    wall = _Wall(shaft_radius, bushing_radius, width, thickness, stiffness, load, angle, cell)
    return _describe(wall, distances, _wear(wall, distances, specific_wear))


def _wear(wall: _Wall, distances: Array, specific_wear: float) -> list[tuple[float, Array, Array]]:
    """Eccentricity, pressure and depth at each distance."""
    depth = np.zeros(wall.angle.size)
    place, pressure = wall.balance(depth, 1.0)
    carried = int(np.count_nonzero(pressure))
    if carried < _FEWEST_CELLS:
        raise ModelError(
            f"cells must resolve the contact at the start: {carried} of {wall.angle.size} cells "
            f"carry load, {_FEWEST_CELLS} are needed. Choose more cells."
        )

    at, stages = 0.0, []
    step = _SHORTEST * distances[-1]
    for wanted in distances:
        while at < wanted:
            trial = min(step, wanted - at)
            new_place, new_pressure, new_depth = _step(wall, depth, trial * specific_wear)
            change = abs(wall.ratio(new_pressure) - wall.ratio(pressure))
            allowed = _LONGEST_STEP * (wall.ratio(pressure) - 1)
            if change > allowed:
                step = trial / 2
                continue
            place, pressure, depth = new_place, new_pressure, new_depth
            if depth[0] > wall.thickness:
                raise ModelError(
                    f"sliding_distance must end before the wall is worn through: {depth[0]:.2g} m "
                    f"after {at + trial:.3g} m of {distances[-1]:.3g} m. Shorten it."
                )
            at = wanted if trial == wanted - at else at + trial
            step = max(step, trial) * (2 if change < allowed / 2 else 1)
        stages.append((place, pressure, depth))
    return stages


def _step(wall: _Wall, depth: Array, reach: float) -> tuple[float, Array, Array]:
    """One step of the diagonally implicit method of second order (Alexander 1977).

    `reach` is the wear rate times the distance. A stage that ends at depth w + a p has the pressure
    of the depth w on a wall that is softer by 1 + a E'/t.
    """
    inside = _SHARE * reach
    softened = 1 + inside * wall.stiffness
    _, pressure = wall.balance(depth, softened)
    base = depth + (1 - _SHARE) * reach * pressure
    _, pressure = wall.balance(base, softened)
    depth = base + inside * pressure

    # the pressure of the step's end is that of its depth, not that of its last stage
    place, pressure = wall.balance(depth, 1.0)
    return place, pressure, depth


def _describe(
    wall: _Wall, distances: Array, stages: list[tuple[float, Array, Array]]
) -> xr.Dataset:
    places, pressures, depths = (np.array(column) for column in zip(*stages, strict=True))
    along, both = ("sliding_distance",), ("sliding_distance", "angle")
    # the edge lies where the last two cells that carry load point to, half a cell on at least
    half = np.array([_edge(wall, pressure) for pressure in pressures])
    volume = 2 * wall.width * wall.shaft_radius * wall.cell * depths.sum(axis=1)
    return describe_by(
        read_table("erlif.joint.models", "variables.toml")["running_in"],
        {
            "torque_ratio": (along, np.array([wall.ratio(one) for one in pressures])),
            "half_angle": (along, half),
            "eccentricity": (along, places),
            "peak_pressure": (along, pressures.max(axis=1)),
            "worn_volume": (along, volume),
            "pressure": (both, pressures),
            "depth": (both, depths),
        },
        {"sliding_distance": (along, distances), "angle": ("angle", wall.angle)},
    )


def _edge(wall: _Wall, pressure: Array) -> float:
    """End of the contact, between the last cell with pressure and the next."""
    last = int(np.flatnonzero(pressure)[-1])
    if last == pressure.size - 1:
        return float(np.pi)
    if last == 0:
        return float(wall.cell)
    fall = pressure[last - 1] - pressure[last]
    beyond = pressure[last] / fall if fall > 0 else 0.5
    return float(wall.angle[last] + wall.cell * min(beyond, 1.0))


@formula()
def thin_wall_torque_ratio(
    load_per_length: Values,
    *,
    clearance: Values,
    shaft_radius: Values,
    thickness: Values,
    modulus: Values,
) -> Values:
    """Torque ratio of a shaft in a thin Winkler wall, with a clearance or an interference.

    The pressure is E'/t (e cos theta - c) up to the half angle a with cos a = c/e, which follows
    from c E' R / (q t) = cos a / (a - sin a cos a). The ratio is that of
    `erlif.joint.models.friction.thin_winkler_torque_ratio`, 2 (sin a - a cos a) / (a - sin a cos
    a), also beyond 90 degrees. An interference of more than q t / (pi E' R) presses all round: the
    ratio is 2 pi |c| E' R / (q t).

    Parameters
    ----------
    modulus : float or array
        E' of the wall, see `erlif.models.contact.winkler_modulus`. [Pa]
    load_per_length, clearance, shaft_radius, thickness : float or array
        Load over width, q [N/m], radial clearance c, negative for an interference [m], radius R of
        the shaft and thickness t of the wall [m].

    Returns
    -------
    float or array
        Torque over mu F R: from 1 for a wide clearance through 4/pi for none to 2 for an
        interference that is about to press all round, and more beyond it. [1]

    Raises
    ------
    ModelError
        A value that is not positive (clearance: not finite).

    Notes
    -----
    Colbert et al. (2009) measured 1.6 at an interference; their figure B1 covers clearances only.

    Examples
    --------
    At the interference q t / (pi E' R):

    >>> q = np.pi * 1e9 * 5e-3 * 75e-6 / 3e-3
    >>> case = {"clearance": -75e-6, "shaft_radius": 5e-3, "thickness": 3e-3, "modulus": 1e9}
    >>> print(f"{thin_wall_torque_ratio(q, **case):.4f}")
    2.0000
    """

    group = clearance * modulus * shaft_radius / (load_per_length * thickness)
    wanted = np.asarray(group, float)
    ratio = np.asarray(-2 * np.pi * wanted)  # all round
    opened = ~(wanted < -1 / np.pi)
    if np.any(opened):
        ratio[opened] = _opened_ratio(wanted[opened])
    return like(group, ratio)


def _opened_ratio(group: Array) -> Array:
    """Torque ratio of a wall that presses over a part of the shaft."""
    # the table is a start; one step of Newton's method makes it exact
    start = np.cbrt(1.5 / np.maximum(group, 1e-300))
    known = group < _group_of(np.array(_NARROWEST))
    start[known] = _angles_by_group()(np.arcsinh(group[known]))
    start = np.clip(start, 0.0, np.pi)
    across = np.sin(start) * np.cos(start)
    excess = group * (start - across) - np.cos(start)
    slope = 2 * group * np.sin(start) ** 2 + np.sin(start)
    half_angle = start - np.divide(excess, slope, out=np.zeros_like(slope), where=slope > 1e-6)

    across = np.sin(half_angle) * np.cos(half_angle)
    with np.errstate(invalid="ignore"):  # 0/0 at an angle of 0, for which the series stands
        wide = 2 * (np.sin(half_angle) - half_angle * np.cos(half_angle)) / (half_angle - across)
    # where the differences cancel: 1 + a^2/10
    ratio: Array = np.where(half_angle < _SERIES_BELOW, 1 + half_angle**2 / 10, wide)
    return ratio


def _group_of(half_angle: Array) -> Array:
    """Clearance of a contact of given half angle, in units of q t / (E' R). [1]"""
    group: Array = np.cos(half_angle) / (half_angle - np.sin(half_angle) * np.cos(half_angle))
    return group


@cache
def _angles_by_group() -> BSpline:
    """Half angle by arcsinh of the group, from no opening at all to `_NARROWEST`."""
    from scipy.interpolate import make_interp_spline  # at use, as all solvers of the theories

    half_angle = np.concatenate(
        [np.linspace(np.pi, 0.5, _KNOTS), np.geomspace(0.5, _NARROWEST, _KNOTS)[1:]]
    )
    return make_interp_spline(np.arcsinh(_group_of(half_angle)), half_angle, k=3)
