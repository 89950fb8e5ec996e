"""The steps of `erlif.models.reynolds.full_film`, compiled: thousands of steps, many fits.

Tests hold this form to one in numpy. Constants are arguments, because the cache of compiled code
follows this file alone.
"""

from __future__ import annotations

import numpy as np

from erlif.core.speed.kernels import njit


@njit(cache=True, nogil=True, error_model="numpy")
def _velocity(x, y, turn, force, case, table, width, thinnest):  # type: ignore[no-untyped-def]
    """Velocity of one pin in the half-angle frame, over the clearance. [1/s]"""
    flow, spring, rest = case
    cosine, sine = turn
    distance = np.hypot(x, y)
    ux, uy = (x / distance, y / distance) if distance > 0 else (1.0, 0.0)
    pull = force[1] - spring * (sine * x + cosine * y - rest)
    fx, fy = cosine * force[0] + sine * pull, cosine * pull - sine * force[0]

    # the logarithms of both dampings are cubics between equally spaced nodes
    thin = -np.log(max(1 - distance, thinnest))
    k = min(int(thin / width), table.shape[1] - 1)
    s = thin - k * width
    first = ((table[0, k, 0] * s + table[1, k, 0]) * s + table[2, k, 0]) * s + table[3, k, 0]
    second = ((table[0, k, 1] * s + table[1, k, 1]) * s + table[2, k, 1]) * s + table[3, k, 1]
    along = (fx * ux + fy * uy) * np.exp(-first) * flow
    across = (fy * ux - fx * uy) * np.exp(-second) * flow
    return along * ux - across * uy, along * uy + across * ux


@njit(cache=True, nogil=True, error_model="numpy")
def _between(drive, k, at):  # type: ignore[no-untyped-def]
    """The drive within step k, from 0 at its start to 2 at its end, by a parabola."""
    a, b, c = drive[2 * k], drive[2 * k + 1], drive[2 * k + 2]
    bend = 0.5 * at * (at - 1)
    return (
        a[0] + at * (b[0] - a[0]) + bend * (a[0] - 2 * b[0] + c[0]),
        a[1] + at * (b[1] - a[1]) + bend * (a[1] - 2 * b[1] + c[1]),
    )


@njit(cache=True, nogil=True, error_model="numpy")
def march(  # type: ignore[no-untyped-def]
    time,
    turns,
    forces,
    cases,
    table,
    width,
    thinnest,
    fall,
    orbit,
    slope,
):
    """Follow pins by Runge-Kutta's rule of the fourth order, in place.

    Parameters
    ----------
    time : array, (step,)
        Times. [s]
    turns, forces : array, (2 step - 1, 2)
        Cosine and sine of half the bushing angle, and the load along its line and sideways, at the
        steps and in the middle between them. [1; N]
    cases : array, (case, 3)
        Velocity over force and damping, spring, and place without force, over the clearance.
    table : array, (4, interval, 2)
        Cubics of both logarithms of the dampings over -log(film/clearance).
    width : float
        Width of an interval of the table.
    thinnest : float
        Film over the clearance at the end of the table.
    fall : float
        Largest movement in one part of a step, over the film.
    orbit, slope : array, (case, step, 2)
        Displacements over the clearance in the half-angle frame, the first ones given, and their
        velocities.
    """
    for n in range(cases.shape[0]):
        case = cases[n]
        x, y = orbit[n, 0]
        u1, v1 = _velocity(x, y, turns[0], forces[0], case, table, width, thinnest)
        slope[n, 0, 0], slope[n, 0, 1] = u1, v1
        for k in range(time.size - 1):
            # a film that falls quickly is followed in parts of the step
            film, dt = max(1 - np.hypot(x, y), thinnest), time[k + 1] - time[k]
            parts = 1 + int(dt * np.hypot(u1, v1) / (fall * film))
            dt /= parts
            for part in range(parts):
                at = 2 * part / parts
                turn = _between(turns, k, at + 1 / parts)
                force = _between(forces, k, at + 1 / parts)
                half = 0.5 * dt
                u2, v2 = _velocity(
                    x + half * u1, y + half * v1, turn, force, case, table, width, thinnest
                )
                u3, v3 = _velocity(
                    x + half * u2, y + half * v2, turn, force, case, table, width, thinnest
                )
                turn = _between(turns, k, at + 2 / parts)
                force = _between(forces, k, at + 2 / parts)
                u4, v4 = _velocity(
                    x + dt * u3, y + dt * v3, turn, force, case, table, width, thinnest
                )
                x += dt / 6 * (u1 + 2 * u2 + 2 * u3 + u4)
                y += dt / 6 * (v1 + 2 * v2 + 2 * v3 + v4)
                u1, v1 = _velocity(x, y, turn, force, case, table, width, thinnest)
            orbit[n, k + 1, 0], orbit[n, k + 1, 1] = x, y
            slope[n, k + 1, 0], slope[n, k + 1, 1] = u1, v1
