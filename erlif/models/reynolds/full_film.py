"""The orbit of a pin that is free sideways, in a full film: no cavities and no entrainment.

In the frame that turns with half the bushing angle the film is squeezed and nothing else (Booker
1965). Without cavities the forces are proportional to the velocities of the pin, by two dampings
that depend on the eccentricity alone. The orbit is then an ordinary differential equation of two
numbers, a thousand times quicker than the film itself, and many orbits are followed at once.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from erlif.core.arrays import Array
from erlif.core.errors import ModelError
from erlif.models.reynolds.journal import Journal, Motion, turn_vectors

if TYPE_CHECKING:
    from scipy.interpolate import CubicSpline  # loads scipy.optimize: imported where it is used

# Smallest film of the tables over the clearance.
THINNEST = 1e-5

_NODES = 128  # of the tables in log film; the spline between them is good to 1e-6
_POINTS = 192  # cells over half the circumference, and twice as many
_HARMONICS = 128  # sines along the axis, from end to end
_PLACES = 25  # from one end to the middle, at which the lowest pressure is sought
_SHAPED = 48  # nodes of the tables of a bore with a shape
_AXIAL = 16  # cells over half of its length, and twice as many

_RESOLUTION = 5e-4  # error of angle and load between the steps of the orbit, relative to their size
_LONGEST_STEP = 8  # steps of the motion in one of the orbit


@dataclass(frozen=True)
class FullFilm:
    """Dampings of a full film.

    The pressure is ambient at both ends, and along the thickest film, which is flooded.

    Attributes
    ----------
    unit : float
        eta L (R/c)^3, the unit of the dampings. [N s/m]
    stress : float
        eta R^2 / c^3, the unit of pressure over velocity. [Pa s/m]
    table : CubicSpline
        Over -log(film/clearance): logarithms of the dampings along and across the line of centres.
    suction : CubicSpline
        Over the same, logarithm of the depth of the lowest pressure of either motion.
    """

    unit: float
    stress: float
    table: CubicSpline
    suction: CubicSpline

    @classmethod
    def of(cls, journal: Journal) -> FullFilm:
        """The full film of a joint with rigid, smooth walls.

        Parameters
        ----------
        journal : Journal
            Its pressure viscosity is left out; foundation and roughness are refused. Where it has a
            shape along the axis, its clearance below is the least one.

        Returns
        -------
        FullFilm

        Raises
        ------
        ModelError
            An elastic liner or roughness.

        Examples
        --------
        A long film between circles that touch nearly, 12 pi / (1 - eps^2)^1.5:

        >>> from erlif.models.reynolds import Journal
        >>> joint = Journal(0.03336, 0.03359, length=0.237, viscosity=0.12, long=True)
        >>> along, across = FullFilm.of(joint).damping(np.array([0.1])).ravel() * joint.clearance
        >>> print(f"{along / joint.squeeze_constant * (1 - 0.9**2) ** 1.5:.5f}")
        1.00000
        """
        for name in ("foundation", "roughness"):
            if getattr(journal, name) is not None:
                raise ModelError(
                    "The orbit in a full film is that of rigid and smooth walls; the joint has "
                    f"{name}. Use solve_journal."
                )
        clearance, radius = journal.least_clearance, journal.radius
        rows = None
        if journal.axial_shape is not None:
            rows = _rows(journal, _AXIAL), _rows(journal, 2 * _AXIAL)
        return cls(
            journal.viscosity * journal.length * (radius / clearance) ** 3,
            journal.viscosity * radius**2 / clearance**3,
            *_tabulate(None if journal.long else journal.length / radius, rows),
        )

    def damping(self, film: Array) -> Array:
        """Force over velocity along and across the line of centres.

        Parameters
        ----------
        film : array, (...)
            Minimum film thickness over the clearance.

        Returns
        -------
        array, (..., direction)
            [N s/m]
        """
        thin = -np.log(np.clip(film, THINNEST, 1.0))
        return np.asarray(self.unit * np.exp(self.table(thin)))

    def lowest_pressure(self, film: Array, force: Array) -> Array:
        """A bound of the lowest pressure in the film, relative to ambient.

        Parameters
        ----------
        film : array, (...)
            Minimum film thickness over the clearance.
        force : array, (..., direction)
            Force on the pin along and across the line of centres. [N]

        Returns
        -------
        array, (...)
            [Pa]
        """
        thin = -np.log(np.clip(film, THINNEST, 1.0))
        velocity = np.abs(force) / (self.unit * np.exp(self.table(thin)))
        return np.asarray(-self.stress * (velocity * np.exp(self.suction(thin))).sum(axis=-1))


def follow_full_film(
    journal: Journal,
    motion: Motion,
    *,
    start: Array,
    fluidity: Array | float = 1.0,
    stiffness: Array | float = 0.0,
    rest: Array | float = 0.0,
) -> Array:
    """Follow pins of different start, viscosity and spring through one motion.

    Along and across the line of centres the velocity in the half-angle frame is force over damping.
    Runge-Kutta's rule of the fourth order, with the cubic of values and slopes between its steps.

    Parameters
    ----------
    journal : Journal
        The joint.
    motion : Motion
        Rotation of the bushing and load at each time.
    start : array, (case, axis)
        Displacement along the load line and sideways at the first time. [m]
    fluidity : array, (case,), or float
        Viscosity of the joint over that of the case.
    stiffness, rest : array, (case,), or float
        Sideways spring [N/m], and the position at which it is without force [m].

    Returns
    -------
    array, (case, step, axis)
        Displacement along the load line and sideways. [m]

    Raises
    ------
    ModelError
        A start outside the clearance, or a form of the joint that has no such orbit.

    Examples
    --------
    A long joint at rest sinks as eps / sqrt(1 - eps^2) = t W / K:

    >>> from erlif.models.reynolds import Journal, Motion
    >>> joint = Journal(0.03336, 0.03359, length=0.237, viscosity=0.12, long=True)
    >>> time = np.linspace(0.0, 5.0, 501)
    >>> rest = Motion(time, angle=0 * time, load=222.4)
    >>> sunk = follow_full_film(joint, rest, start=np.zeros((1, 2)))[0, -1, 0]
    >>> ratio = 5.0 * 222.4 / joint.squeeze_constant
    >>> print(f"{sunk / joint.clearance:.6f} {ratio / np.hypot(1, ratio):.6f}")
    0.825510 0.825510
    """
    from scipy.interpolate import CubicHermiteSpline, CubicSpline

    from erlif.models.reynolds import compiled_orbit  # only here, because numba loads slowly

    film, clearance = FullFilm.of(journal), journal.least_clearance
    place = np.array(start, dtype=float, ndmin=2) / clearance
    if not (np.hypot(*place.T) < 1 - THINNEST).all():
        raise ModelError(
            f"start lies outside the clearance of {clearance * 1e6:.4g} um, or leaves no film."
        )
    stride = _stride(motion)
    steps = np.unique(np.append(np.arange(0, motion.time.size, stride), motion.time.size - 1))
    time = motion.time[steps]
    flow = np.broadcast_to(fluidity, len(place)) / (film.unit * clearance)
    spring = np.broadcast_to(stiffness, len(place)) * clearance
    unloaded = np.broadcast_to(rest, len(place)) / clearance

    # the middle of each step from the curve through the motion, its load in the mean
    half = 0.5 * motion.angle
    middle = CubicSpline(motion.time, half)(0.5 * (time[1:] + time[:-1]))
    turned = np.empty(2 * time.size - 1)
    turned[::2], turned[1::2] = half[steps], middle
    cosines, sines = np.cos(turned), np.sin(turned)
    loads = motion.load * np.array([np.cos(motion.load_direction), np.sin(motion.load_direction)])
    between = [np.interp(0.5 * (time[1:] + time[:-1]), motion.time, one) for one in loads]
    forces = np.empty((2 * time.size - 1, 2))
    forces[::2], forces[1::2] = loads[:, steps].T, np.stack(between, axis=1)

    # into the frame that turns with half the bushing
    orbit = np.empty((len(place), time.size, 2))
    slope = np.empty_like(orbit)
    orbit[:, 0] = turn_vectors(place, -half[0])
    turns = np.stack([cosines, sines], axis=1)
    cases = np.stack([flow, spring, unloaded], axis=1)
    table = np.ascontiguousarray(film.table.c)
    width = float(film.table.x[1])
    compiled_orbit.march(time, turns, forces, cases, table, width, THINNEST, orbit, slope)

    # back to the laboratory at every step of the motion
    if stride > 1:
        orbit = CubicHermiteSpline(time, orbit, slope, axis=1)(motion.time)
    return np.asarray(turn_vectors(orbit, half) * clearance)


def _stride(motion: Motion) -> int:
    """Number of motion steps per step of the orbit that still resolves rotation and load."""
    from scipy.interpolate import CubicSpline

    stride = _LONGEST_STEP
    while stride > 1:
        kept = np.unique(np.append(np.arange(0, motion.time.size, stride), motion.time.size - 1))
        if kept.size >= 4 and all(
            np.abs(CubicSpline(motion.time[kept], one[kept])(motion.time) - one).max()
            <= _RESOLUTION * max(size, 1e-12)
            for one, size in (
                (motion.angle, 1.0),
                (motion.load, float(np.abs(motion.load).max())),
                (motion.load_direction, 1.0),
            )
            if np.ptp(one) > 0  # a constant is resolved by any steps
        ):
            break
        stride //= 2
    return stride


class _Rows(NamedTuple):
    """Rows of cells along the axis: lengths over the radius of the film, and the clearance in their
    middles and at their faces over the least one.
    """

    length: tuple[float, ...]
    centre: tuple[float, ...]
    face: tuple[float, ...]


def _rows(journal: Journal, along_half: int) -> _Rows:
    """Rows over the whole length of a bore with a shape, as `solve_journal` lays them."""
    from erlif.models.reynolds.transient import axial_edges  # loads the compiled steps

    edges = axial_edges(journal, along_half)
    edges = edges if edges[0] < 0 else np.concatenate([-edges[:0:-1], edges])
    centre = journal.clearance_at(0.5 * (edges[1:] + edges[:-1])) / journal.least_clearance
    face = journal.clearance_at(edges) / journal.least_clearance
    rows = np.diff(edges) / journal.radius, centre, face
    return _Rows(*(tuple(one.tolist()) for one in rows))


@cache
def _tabulate(
    slenderness: float | None, rows: tuple[_Rows, _Rows] | None
) -> tuple[CubicSpline, CubicSpline]:
    """Logarithms of dampings and of the lowest pressures over -log(film/clearance).

    Two grids and Richardson's extrapolation; in the unit of the dampings, and of pressure.
    """
    from scipy.interpolate import CubicSpline

    nodes = _NODES if rows is None else _SHAPED
    thin = np.linspace(0.0, -np.log(THINNEST), nodes)
    parts = np.split(-np.expm1(-thin), nodes // 16 if rows is None else nodes // 4)
    coarse, fine = (
        # in parts, whose harmonics take 6 MB in place of 50, and rows of cells 50 in place of 600
        np.concatenate(
            [
                _solve_squeeze(part, slenderness, n)
                if rows is None
                else _solve_shaped(part, n, rows[k])
                for part in parts
            ]
        )
        for k, n in enumerate((_POINTS, 2 * _POINTS))
    )
    logarithms = np.log(fine + (fine - coarse) / 3)
    return CubicSpline(thin, logarithms[:, :2]), CubicSpline(thin, logarithms[:, 2:])


def _solve_shaped(eccentricity: Array, points: int, rows: _Rows) -> Array:
    """As `_solve_squeeze`, on a bore with a shape: one system of all cells.

    The gap over the least clearance is G(z) - eps cos a. Columns of cells round the joint are
    eliminated from the flooded line on, so that both velocities share all but the last.
    """
    eps, width = eccentricity[:, np.newaxis], np.pi / points
    length, wide, edge = (np.array(one) for one in rows)
    g = width * (np.arange(points + 1) + np.array([[0.5], [0.0]]))[:, :, np.newaxis, np.newaxis]
    crest = (1 - eps**2) / (1 + eps * np.cos(g))  # H where the bore is narrowest
    cosine = (np.cos(g) + eps) / (1 + eps * np.cos(g))
    angle = crest / np.sqrt(1 - eps**2) * width  # of the cells, and between their centres
    side = (wide - eps * cosine[1]) ** 3 / angle[1] * length
    side[-1] *= 2  # from the last centre to the flooded line
    apart = np.pad(0.5 * (length[1:] + length[:-1]), 1, constant_values=np.nan)
    apart[[0, -1]] = 0.5 * length[[0, -1]]
    cosine, angle = cosine[0, :-1], angle[0, :-1]
    leak = (edge - eps * cosine) ** 3 * angle / apart
    sine = np.sqrt(1 - eps**2) * np.sin(g[0, :-1]) / (1 + eps * np.cos(g[0, :-1]))
    source = np.stack([cosine, sine], axis=-1) * angle[..., np.newaxis] * length[:, np.newaxis]

    right, inverse = 12 * source, np.empty((points, eps.size, length.size, length.size))
    row = np.arange(length.size)
    matrix = np.zeros_like(inverse)
    matrix[..., row, row] = leak[..., 1:] + leak[..., :-1] + side[1:]
    matrix[..., row[1:], row[:-1]] = matrix[..., row[:-1], row[1:]] = -leak[..., 1:-1]
    for k in range(points - 1, 0, -1):
        matrix[k, :, row, row] += side[k].T
        inverse[k] = np.linalg.inv(matrix[k])
        between = side[k][..., np.newaxis]
        matrix[k - 1] -= between * inverse[k] * side[k][:, np.newaxis]
        right[k - 1] += between * (inverse[k] @ right[k])

    # no flow through the thinnest film, or no pressure there
    pressure = np.empty_like(right)
    pressure[0, ..., 0] = np.linalg.solve(matrix[0], right[0, ..., :1])[..., 0]
    matrix[0, :, row, row] += 2 * side[0].T
    pressure[0, ..., 1] = np.linalg.solve(matrix[0], right[0, ..., 1:])[..., 0]
    for k in range(1, points):
        pressure[k] = inverse[k] @ (right[k] + side[k][..., np.newaxis] * pressure[k - 1])
    force = 2 * (pressure * source).sum(axis=(0, 2)) / length.sum()
    lowest = np.maximum(-pressure[..., 0].min(axis=(0, 2)), 1e-12)
    return np.column_stack([force, lowest, np.abs(pressure[..., 1]).max(axis=(0, 2))])


def _solve_squeeze(eccentricity: Array, slenderness: float | None, points: int) -> Array:
    """Dampings of both velocities, and their lowest pressures, (eccentricity, 4).

    With H = 1 - eps cos a and p = eta R^2/c^3 v q, the share of q that varies as sin(b z) from one
    end, b = (2k + 1) pi / L, obeys (H^3 q')' - (b R)^2 H^3 q = -12 s {cos a, sin a}, with the share
    s = 4 / ((2k + 1) pi) of a source that is even along the axis; q = 0 at a = pi. In
    Sommerfeld's variable g, H = (1 - eps^2) / (1 + eps cos g), of which H dg = sqrt(1 - eps^2) da,
    cells of equal width resolve a thin film too. Finite volumes of the second order.
    """
    eps, shape = eccentricity, np.sqrt(1 - eccentricity**2)
    width = np.pi / points
    centre, face = (
        (np.arange(n)[:, np.newaxis] + s) * width for n, s in ((points, 0.5), (points + 1, 0))
    )

    h = (1 - eps**2) / (1 + eps * np.cos(centre))
    cosine = (np.cos(centre) + eps) / (1 + eps * np.cos(centre))
    sine = shape * np.sin(centre) / (1 + eps * np.cos(centre))
    conductance = shape * ((1 - eps**2) / (1 + eps * np.cos(face))) ** 2 / width
    conductance[-1] *= 2  # from the last centre to the flooded line
    area = h / shape * width

    # a long film has one share, which does not vary along the axis
    odd_number = 2 * np.arange(1 if slenderness is None else _HARMONICS) + 1.0
    ones: Array = np.ones(1)
    share, mean, loss, shares = ones, ones, 0 * ones, ones[:, np.newaxis]
    if slenderness is not None:
        share = 4 / (odd_number * np.pi)
        mean = share / 2
        shares = np.sin(0.5 * np.pi * np.outer(odd_number, np.linspace(0.0, 1.0, _PLACES)))
        loss = np.asarray((odd_number * np.pi / slenderness) ** 2, np.float64)
    leak = (h**3 * area)[..., np.newaxis] * loss

    columns = []
    for source, begin in ((cosine, 0.0), (sine, 2.0)):
        side = conductance.copy()
        side[0] *= begin  # no flow through the thinnest film, or no pressure there
        diagonal = (side[1:] + side[:-1])[..., np.newaxis] + leak
        right = 12 * (source * area)[..., np.newaxis] * share
        q = _solve_rows(diagonal, side[1:-1, :, np.newaxis], right)
        force = 2 * np.einsum("pek,pe,k->e", q, source * area, mean)
        columns.append((force, q @ shares))
    (along, even), (across, odd) = columns
    lowest = np.maximum(-even.min(axis=(0, 2)), 1e-12), np.abs(odd).max(axis=(0, 2))
    return np.stack([along, across, *lowest], axis=1)


def _solve_rows(diagonal: Array, side: Array, right: Array) -> Array:
    """Solve symmetric tridiagonal systems (point, ...) whose side has negative signs, in place."""
    for k in range(1, len(diagonal)):
        factor = side[k - 1] / diagonal[k - 1]
        diagonal[k] -= factor * side[k - 1]
        right[k] += factor * right[k - 1]
    right[-1] /= diagonal[-1]
    for k in range(len(diagonal) - 2, -1, -1):
        right[k] = (right[k] + side[k] * right[k + 1]) / diagonal[k]
    return right
