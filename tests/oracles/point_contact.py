"""Films of points and ellipses: rigid bodies by a linear problem, elastic ones by Newton."""

from typing import Any, NamedTuple

import numpy as np
import scipy.sparse
from scipy.sparse.linalg import spsolve

from oracles.newton import take_step


class PointFilm(NamedTuple):
    """Smallest film and that at the point of least distance when dry, over Rx; all of an elastic.

    Places over Rx: those along increase with the motion, those across go from the middle outwards.
    """

    minimum: float
    central: float
    film: Any = None  # (along, across)
    along: Any = None
    across: Any = None


def stretched(low, high, cells, inner):
    """Faces of cells that are even within `inner` and grow outwards."""
    return inner * np.sinh(
        np.linspace(np.arcsinh(low / inner), np.arcsinh(high / inner), cells + 1)
    )


def rigid_pressure(across, *, cells=150, far=150.0):
    """Reynolds' equation of a rigid paraboloid: div(h^3 grad q) = dh/dx, h = 1 + x^2 + y^2/across.

    Lengths along are in sqrt(2 Rx h0); half of the plane, Reynolds' exit condition.

    Returns
    -------
    pressure, area : array
        q = p h0^2/(12 eta u sqrt(2 Rx h0)) with constant viscosity, and the area of both halves.
    """
    wide = np.sqrt(across)
    fx = stretched(-far, 6.0, cells, 0.5)
    fy = stretched(0.0, far * max(1, wide), cells // 2, 0.5 * wide)
    x, y, dx, dy = (fx[1:] + fx[:-1]) / 2, (fy[1:] + fy[:-1]) / 2, np.diff(fx), np.diff(fy)
    along = (1 + fx[:, None] ** 2 + y**2 / across) ** 3 * dy
    along /= np.diff(np.concatenate([fx[:1], x, fx[-1:]]))[:, None]
    sideways = (1 + x[:, None] ** 2 + fy[1:] ** 2 / across) ** 3 * dx[:, None]
    sideways /= np.diff(np.append(y, fy[-1]))

    number = np.arange(x.size * y.size).reshape(x.size, y.size)
    diagonal = along[1:] + along[:-1] + sideways
    diagonal[:, 1:] += sideways[:, :-1]
    pairs = [
        (number[1:], number[:-1], along[1:-1]),
        (number[:, 1:], number[:, :-1], sideways[:, :-1]),
    ]
    rows = np.concatenate([number.ravel(), *(one.ravel() for i, j, _ in pairs for one in (i, j))])
    columns = np.concatenate(
        [number.ravel(), *(one.ravel() for i, j, _ in pairs for one in (j, i))]
    )
    entries = [-k.ravel() for *_, k in pairs for _ in range(2)]
    matrix = scipy.sparse.csr_matrix(
        (np.concatenate([diagonal.ravel(), *entries]), (rows, columns))
    )
    source = -(np.diff(fx**2)[:, None] * dy).ravel()

    active = source > 0
    while True:
        inside = np.flatnonzero(active)
        pressure = np.zeros(source.size)
        pressure[inside] = spsolve(matrix[inside][:, inside].tocsc(), source[inside])
        changed = np.where(active, pressure > 0, matrix @ pressure < source)
        if (changed == active).all():
            return pressure, 2 * (dx[:, None] * dy).ravel()
        active = changed


def rigid_film(across, share, *, cells=150, far=150.0):
    """gV = G W^3/U^2 and h/Rx (W/U)^2 of rigid bodies in Barus' oil.

    With the reduced pressure q = (1 - exp(-alpha p))/alpha the problem is that of constant
    viscosity. `share` is the largest alpha q; at 1 the pressure is unbounded and the film no longer
    depends on the load.
    """
    q, area = rigid_pressure(across, cells=cells, far=far)
    film = (12 * np.sqrt(2) * q.max() / share) ** (2 / 3)  # over Rx (G U)^(2/3)
    load = 2 * film * (-np.log1p(-share * q / q.max()) @ area)  # W G^(1/3) U^(-2/3)
    return load**3, film * load**2


def _potential(x, y, low, high, below, above):
    """Integral of 1/distance over rectangles, seen from points (Love 1929)."""

    def corner(u, v):
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.nan_to_num(u * np.arcsinh(v / np.abs(u))) + np.nan_to_num(
                v * np.arcsinh(u / np.abs(v))
            )

    return (
        corner(high - x, above - y)
        - corner(low - x, above - y)
        - corner(high - x, below - y)
        + corner(low - x, below - y)
    )


def solve_point(U, W, G, *, across=1.0, cells=(48, 18), far=12.0):
    """Solve a steady contact with U = eta u/(E'Rx), W = w/(E'Rx^2), G = alpha E', E' = Rx = 1.

    As `oracles.line_contact.solve_line`, on half of the plane.
    """
    nx, ny = cells
    light = min(W, (10 * U**2) ** 0.375)
    loads = np.geomspace(light, W, 1 + int(np.ceil(4 * np.log2(W / light))))
    rigid = 130 * across / (1 + 0.67 / across) ** 2 * 2.8 * (U / light) ** 2
    scale = max((1.5 * W) ** (1 / 3), np.sqrt(2 * 140 * (U / W) ** 2))
    wide = scale * max(1.0, across**0.6)
    fx = stretched(-far * scale, 3 * scale, nx, 0.8 * scale)
    fy = stretched(0.0, max(far / 2, 3) * wide, ny, 0.8 * wide)
    x, y, dx, dy = (fx[1:] + fx[:-1]) / 2, (fy[1:] + fy[:-1]) / 2, np.diff(fx), np.diff(fy)
    low, below = (one.ravel() for one in np.meshgrid(fx[:-1], fy[:-1], indexing="ij"))
    high, above = (one.ravel() for one in np.meshgrid(fx[1:], fy[1:], indexing="ij"))

    def at_faces(one, other):
        px, py = (each.ravel()[:, None] for each in np.meshgrid(one, other, indexing="ij"))
        both = _potential(px, py, low, high, below, above)
        both += _potential(px, py, low, high, -above, -below)
        return (px**2 / 2 + py**2 / (2 * across))[:, 0], 2 / np.pi * both

    # faces along the motion, then those across it, without the plane of symmetry
    gaps = [at_faces(fx, y), at_faces(x, fy[1:])]
    sides = [np.tile(dy, nx + 1), np.repeat(dx, ny)]
    steps = [
        np.repeat(np.diff(np.concatenate([fx[:1], x, fx[-1:]])), ny),
        np.tile(np.diff(np.append(y, fy[-1])), nx),
    ]
    number = np.arange(nx * ny).reshape(nx, ny)
    outside = np.full((1, ny), nx * ny)
    ends = [
        (np.vstack([outside, number]).ravel(), np.vstack([number, outside]).ravel()),
        (number.ravel(), np.hstack([number[:, 1:], outside[0][:1].repeat(nx)[:, None]]).ravel()),
    ]
    area = 2 * (dx[:, None] * dy).ravel()

    def outflow(flux, shape=()):
        first = np.diff(flux[0].reshape(nx + 1, ny, *shape), axis=0).reshape(nx * ny, *shape)
        second = flux[1].reshape(nx, ny, *shape)
        return first + np.diff(second, axis=1, prepend=0 * second[:, :1]).reshape(nx * ny, *shape)

    pressure = np.exp(-((x[:, None] / scale) ** 2) - (y / wide) ** 2) * (x[:, None] < 0)
    pressure = pressure.ravel() * light / (pressure.ravel() @ area)
    active = np.repeat(x < 0.5 * scale, ny)
    approach = rigid - (gaps[0][1] @ pressure).max()
    for load in loads:
        for _ in range(100):
            padded = np.append(pressure, 0.0)
            thinning = np.exp(-G * padded)
            flux, by_film, by_pressure, films = [], [], [], []
            for (gap, sinking), side, step, (one, other), drag in zip(
                gaps, sides, steps, ends, (1.0, 0.0), strict=True
            ):
                film = np.maximum(approach + gap + sinking @ pressure, 1e-15)
                rise = (thinning[one] - thinning[other]) / G
                mobility = film**3 / (12 * U * step) * side
                flux.append(drag * film * side - mobility * rise)
                by_film.append(drag * side - 3 * mobility * rise / film)
                slope = np.zeros((film.size, pressure.size + 1))
                slope[:, :-1] = by_film[-1][:, None] * sinking
                face = np.arange(film.size)
                slope[face, other] -= mobility * thinning[other]
                slope[face, one] += mobility * thinning[one]
                by_pressure.append(slope[:, :-1])
                films.append(film)
            excess, by_approach = outflow(flux), outflow(by_film)
            slope = outflow(by_pressure, (pressure.size,))

            pressure, approach, active, size = take_step(
                *(pressure, approach, active),
                excess=excess,
                slope=slope,
                by_approach=by_approach,
                area=area,
                load=load,
                film=films[0],
                sinking=gaps[0][1],
            )
            if size < 1e-6:
                break
        else:
            raise RuntimeError(f"no solution at a load of {load:.3g}")

    film = (approach + gaps[0][0] + gaps[0][1] @ pressure).reshape(nx + 1, ny)
    return PointFilm(film.min(), np.interp(0, fx, film[:, 0]), film, fx, y)
