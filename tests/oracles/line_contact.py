"""Elastohydrodynamic film of a line contact: Reynolds, half-space and Barus, by Newton."""

from typing import NamedTuple

import numpy as np

from oracles.newton import take_step


class LineFilm(NamedTuple):
    """Films over R: smallest, at the line of centres, and of the flow (where dp/dx is zero)."""

    minimum: float
    central: float
    flow: float


def solve_line(U, W, G, *, cells=240):
    """Solve a steady contact with U = eta u/(E'R), W = w/(E'R), G = alpha E', in units R = E' = 1.

    Pressure is even over each cell, and the film is exact at the faces between cells; Reynolds'
    exit condition as a complementarity, whose active set changes from step to step. The load rises
    in steps from one that hardly flattens the bodies, each solution the start of the next.
    """
    light = min(W, np.sqrt(U))
    loads = np.geomspace(light, W, 1 + round(2 * np.log2(W / light)))
    scale = max(np.sqrt(8 * W / np.pi), np.sqrt(2 * 4.9 * U / W))
    faces = scale / 2 * np.sinh(np.linspace(-np.arcsinh(80), np.arcsinh(8), cells + 1))
    x, width = (faces[1:] + faces[:-1]) / 2, np.diff(faces)
    distance = np.diff(np.concatenate([faces[:1], x, faces[-1:]]))

    def potential(t):
        return t * np.log(np.abs(t) + 1e-300) - t

    sinking = (
        -4
        / np.pi
        * (potential(faces[:, None] - faces[:-1]) - potential(faces[:, None] - faces[1:]))
    )
    sinking -= sinking[0]  # the approach of the bodies is free

    pressure = np.where(x < 0, np.exp(-((x / scale) ** 2)), 0.0)
    pressure *= light / (pressure @ width)
    active = x < 0.5 * scale
    approach = 4.9 * U / light
    for load in loads:
        for _ in range(200):
            film = np.maximum(approach + faces**2 / 2 + sinking @ pressure, 1e-15)
            around = np.concatenate([[0.0], pressure, [0.0]])
            thinning = np.exp(-G * around)
            rise, mobility = -np.diff(thinning) / G, film**3 / (12 * U * distance)
            excess = np.diff(film - mobility * rise)

            # by the film, then by the pressures on both sides of a face
            by_film = 1 - 3 * mobility * rise / film
            by_pressure = by_film[:, None] * sinking
            i = np.arange(cells)
            by_pressure[i + 1, i] += mobility[1:] * thinning[1:-1]
            by_pressure[i, i] -= mobility[:-1] * thinning[1:-1]
            slope, by_approach = np.diff(by_pressure, axis=0), np.diff(by_film)

            pressure, approach, active, size = take_step(
                *(pressure, approach, active),
                excess=excess,
                slope=slope,
                by_approach=by_approach,
                area=width,
                load=load,
                film=film,
                sinking=sinking,
            )
            if size < 1e-8:
                break
        else:
            raise RuntimeError(f"no solution at a load of {load:.3g}")

    film = approach + faces**2 / 2 + sinking @ pressure
    flow = (film - mobility * rise)[cells // 2]
    return LineFilm(film.min(), np.interp(0, faces, film), flow)
