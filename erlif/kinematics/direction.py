"""Whether the readings of an encoder rise or fall with the angle of a link, from the times."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from erlif.core.arrays import Array

# Of the crank angle, by which the readings of a turn are described.
HARMONICS = 3

# Twice as many as the harmonics have coefficients.
FEWEST_FRAMES = 14

# Largest relative deviation of the crank speed from its setting.
LARGEST_SLIP = 0.05

# Standard deviations by which the second harmonic must differ from zero.
SIGNIFICANT = 5.0

_TURN = 2 * np.pi


class Direction(NamedTuple):
    """Sense of the readings.

    Attributes
    ----------
    sign : int
        +1 where they rise with the angle of the link, -1 where they fall, 0 where the log does not
        determine it.
    noise : float
        Standard deviation of a reading about the motion; 0 where it is not known. [rad]
    """

    sign: int
    noise: float


def find_direction(
    time: Array, reading: Array, link: Callable[[Array], Array], *, crank_speed: float
) -> Direction:
    """Find whether the readings rise or fall while the angle of a swinging link rises.

    A link dwells longer at one dead point than at the other: its angle has a second harmonic of
    the crank angle. A reversed reading changes the sign of the first harmonic and of the second.
    The square of the first one has lost that sign, so the product of its conjugate with the second
    shows it, whatever the phase of the crank.

    Parameters
    ----------
    time : array, (frame,)
        [s]
    reading : array, (frame,)
        [rad]
    link : callable
        Crank angle to angle of the link. [rad]
    crank_speed : float
        As set; the log may deviate by `LARGEST_SLIP`. [rad s-1]

    Returns
    -------
    Direction

    Examples
    --------
    >>> def link(crank): return np.cos(crank) + 0.2 * np.cos(2 * crank)
    >>> time = np.linspace(0, 1, 40)
    >>> find_direction(time, -link(8 * time + 1), link, crank_speed=8.0).sign
    -1
    """
    duration = float(np.ptp(time))
    if time.size < FEWEST_FRAMES or duration * crank_speed < 0.9 * _TURN:
        return Direction(0, 0.0)

    # the crank speed is searched in steps by which the log slips a twentieth of a turn
    count = int(np.ceil(LARGEST_SLIP * crank_speed * duration / (0.05 * _TURN)))
    speeds = crank_speed * (1 + LARGEST_SLIP * np.arange(-count, count + 1) / max(count, 1))
    fits = [_fit_harmonics(time, reading, float(speed)) for speed in speeds]
    best = min(fits, key=lambda fit: fit.residual)
    noise = float(np.sqrt(best.residual / (time.size - 1 - 2 * HARMONICS)))

    # harmonics of the link itself, on a grid that is fine for all that matter
    crank = np.arange(256) * _TURN / 256
    wave = np.asarray(link(crank))
    first, second = (2 * np.mean(wave * np.exp(-1j * m * crank)) for m in (1, 2))

    phase = best.first / abs(best.first) * np.conj(first) / abs(first)
    along = float((best.second * np.conj(phase**2) / second).real)
    std = noise * np.sqrt(2 / time.size) / abs(second)
    sure = abs(along) > SIGNIFICANT * std and 0.5 < abs(along) < 2.0
    return Direction(int(np.sign(along)) if sure else 0, noise)


class _Harmonics(NamedTuple):
    """First and second harmonic of the readings, and the sum of the squared residuals."""

    first: complex
    second: complex
    residual: float


def _fit_harmonics(time: Array, reading: Array, speed: float) -> _Harmonics:
    turn = speed * (time - time[0])
    columns = [np.ones_like(turn)]
    for m in range(1, HARMONICS + 1):
        columns += [np.cos(m * turn), np.sin(m * turn)]
    design = np.stack(columns, axis=1)
    solution = np.linalg.lstsq(design, reading, rcond=None)[0]
    residual = float(np.sum((reading - design @ solution) ** 2))
    one, two = (complex(solution[2 * m - 1], -solution[2 * m]) for m in (1, 2))
    return _Harmonics(one, two, residual)
