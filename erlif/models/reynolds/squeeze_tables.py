"""Forces and lowest pressures of a full film that is squeezed, tabulated over its thickness."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from erlif.core.arrays import Array
from erlif.models.reynolds.flow import mobility_of
from erlif.models.reynolds.journal import Journal

if TYPE_CHECKING:
    from scipy.interpolate import CubicSpline  # loads scipy.optimize: imported where it is used

# Smallest film of the tables over the clearance.
THINNEST = 1e-5

_POINTS = 192  # cells over half the circumference, and twice as many
_HARMONICS = 128  # sines along the axis, from end to end
_PLACES = 25  # from one end to the middle, at which the lowest pressure is sought
_AXIAL = 16  # cells over half of the length of a bore with a shape, and twice as many

# Nodes of the tables in log film, and of them in one solution. The spline between 128 is good to
# 1e-6; harmonics in parts take 6 MB in place of 50, and rows of cells 50 in place of 600.
_STRAIGHT, _SHAPED = (128, 16), (48, 4)


def tabulate_squeeze(journal: Journal) -> tuple[CubicSpline, CubicSpline]:
    """Tables of a joint with rigid walls.

    Parameters
    ----------
    journal : Journal

    Returns
    -------
    dampings, pressures : CubicSpline
        Logarithms of the dampings along and across the line of centres, in eta L (R/c)^3, and of
        the depths of the lowest pressures, in eta R^2/c^3 times the velocity, with the least
        clearance c; over -log(film/c).
    """
    # without the rounding of the radius by which another clearance would have tables of its own
    slenderness = None if journal.long else round(journal.length / journal.radius, 9)
    rough = (journal.roughness or 0.0) / journal.least_clearance
    if journal.axial_shape is None:
        return _tabulate(slenderness, None, rough)
    return _tabulate(slenderness, (_rows(journal, _AXIAL), _rows(journal, 2 * _AXIAL)), rough)


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
    slenderness: float | None, rows: tuple[_Rows, _Rows] | None, rough: float
) -> tuple[CubicSpline, CubicSpline]:
    """The tables by two grids and Richardson's extrapolation."""
    from scipy.interpolate import CubicSpline

    nodes, at_once = _STRAIGHT if rows is None else _SHAPED
    thin = np.linspace(0.0, -np.log(THINNEST), nodes)
    parts = np.split(-np.expm1(-thin), nodes // at_once)

    grids = []
    for k, points in enumerate((_POINTS, 2 * _POINTS)):
        if rows is None:
            solved = [_solve_squeeze(part, slenderness, points, rough) for part in parts]
        else:
            solved = [_solve_shaped(part, points, rows[k], rough) for part in parts]
        grids.append(np.concatenate(solved))
    coarse, fine = grids
    logarithms = np.log(fine + (fine - coarse) / 3)
    return CubicSpline(thin, logarithms[:, :2]), CubicSpline(thin, logarithms[:, 2:])


def _conductance(gap: Array, rough: float) -> Array:
    """Flow of a gap under pressure, with the roughness over the same clearance: H^3 if smooth."""
    return mobility_of(gap, 1 / 12, rough)[0]


def _solve_shaped(eccentricity: Array, points: int, rows: _Rows, rough: float) -> Array:
    """As `_solve_squeeze`, on a bore with a shape: one system of all cells.

    The gap over the least clearance is G(z) - eps cos a. Columns of cells, one at each angle, are
    eliminated from the flooded line on, so that both velocities share all but the last.
    """
    eps, width = eccentricity[:, np.newaxis], np.pi / points
    length, wide, edge = (np.array(one) for one in rows)

    # Sommerfeld's variable g in the middles of the cells and at their faces
    g = width * (np.arange(points + 1) + np.array([[0.5], [0.0]]))[:, :, np.newaxis, np.newaxis]
    crest = (1 - eps**2) / (1 + eps * np.cos(g))  # H where the bore is narrowest
    cosine = (np.cos(g) + eps) / (1 + eps * np.cos(g))
    angle = crest / np.sqrt(1 - eps**2) * width  # of the cells, and between their centres

    # conductances round the joint and along it, and the source of both velocities
    side = _conductance(wide - eps * cosine[1], rough) / angle[1] * length
    side[-1] *= 2  # from the last centre to the flooded line
    apart = np.pad(0.5 * (length[1:] + length[:-1]), 1, constant_values=np.nan)
    apart[[0, -1]] = 0.5 * length[[0, -1]]
    cosine, angle = cosine[0, :-1], angle[0, :-1]
    leak = _conductance(edge - eps * cosine, rough) * angle / apart
    sine = np.sqrt(1 - eps**2) * np.sin(g[0, :-1]) / (1 + eps * np.cos(g[0, :-1]))
    source = np.stack([cosine, sine], axis=-1) * angle[..., np.newaxis] * length[:, np.newaxis]

    # the column of an angle with that of the angle before it, from the flooded line on
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

    # back to the flooded line
    for k in range(1, points):
        pressure[k] = inverse[k] @ (right[k] + side[k][..., np.newaxis] * pressure[k - 1])

    force = 2 * (pressure * source).sum(axis=(0, 2)) / length.sum()
    lowest = np.maximum(-pressure[..., 0].min(axis=(0, 2)), 1e-12)
    return np.column_stack([force, lowest, np.abs(pressure[..., 1]).max(axis=(0, 2))])


def _solve_squeeze(
    eccentricity: Array, slenderness: float | None, points: int, rough: float
) -> Array:
    """Dampings of both velocities, and their lowest pressures, (eccentricity, 4).

    With H = 1 - eps cos a and p = eta R^2/c^3 v q, the share of q that varies as sin(b z) from one
    end, b = (2k + 1) pi / L, obeys (H^3 q')' - (b R)^2 H^3 q = -12 s {cos a, sin a}, with the share
    s = 4 / ((2k + 1) pi) of a source that is even along the axis; q = 0 at a = pi. In
    Sommerfeld's variable g, H = (1 - eps^2) / (1 + eps cos g), of which H dg = sqrt(1 - eps^2) da,
    cells of equal width resolve a thin film too. Between rough walls H^3 has a factor of
    `mobility_of`. Finite volumes of the second order.
    """
    eps, shape = eccentricity, np.sqrt(1 - eccentricity**2)
    width = np.pi / points
    centre, face = (
        (np.arange(n)[:, np.newaxis] + s) * width for n, s in ((points, 0.5), (points + 1, 0))
    )

    h = (1 - eps**2) / (1 + eps * np.cos(centre))
    cosine = (np.cos(centre) + eps) / (1 + eps * np.cos(centre))
    sine = shape * np.sin(centre) / (1 + eps * np.cos(centre))
    edge = (1 - eps**2) / (1 + eps * np.cos(face))
    conductance = _conductance(edge, rough) * shape / edge / width
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
    leak = (_conductance(h, rough) * area)[..., np.newaxis] * loss

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
