"""The offset between the clock of the cameras and that of a log, from the motion."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.ndimage import minimum_filter1d

from erlif.core.arrays import Array
from erlif.core.errors import EncoderError

# Frames below which the motion does not show in their light.
FEWEST_FRAMES = 12

# Offsets tried in one turn of the crank.
STEPS_IN_CYCLE = 120

# Offsets tried in all.
MOST_STEPS = 20_000

# Least share of the variance of the light that the motion has to explain.
EXPLAINED = 0.5

# Difference of chi-square, three standard deviations, below which two offsets fit alike.
EQUAL = 9.0

_TURN = 2 * math.pi


@dataclass(frozen=True)
class ClockOffset:
    """Time of the first frame on the clock of a log.

    Attributes
    ----------
    value : float
        The offset. [s]
    std : float
        Its standard deviation. [s]
    explained : float
        Share of the variance of the light that the motion explains.
    half_cycle : bool
        Whether an offset in the other stroke fits as well.
    cycles : int
        Number of offsets, whole cycles apart, that fit as well; this one is among them.
    stretch : float
        Relative change of the times between frames that fits best.
    stretch_std : float
        Its standard deviation.
    """

    value: float
    std: float
    explained: float
    half_cycle: bool
    cycles: int
    stretch: float
    stretch_std: float


def find_clock_offset(
    since: Array, light: Array, *, time: Array, crank: Array, speed: Array
) -> ClockOffset:
    """Find the time of the first frame on the clock of a log.

    The light of the frames is a function of the film, and the film is taken as the same at equal
    speed on either stroke, so that the light is even about the dead points. It is described by
    powers of the speed, and by one harmonic of the crank angle for what changes once in a turn,
    such as the load. The offset is that of the least squares.

    Parameters
    ----------
    since : array, (frame,)
        Time of each frame after the first one. [s]
    light : array, (frame,)
        A quantity that depends on the film alone, such as the logarithm of the ratio of the light
        of both cameras.
    time : array, (sample,)
        Clock of the log, rising. [s]
    crank : array, (sample,)
        Crank angle, without jumps. [rad]
    speed : array, (sample,)
        Speed in the joint; only its size matters. [rad s-1]

    Returns
    -------
    ClockOffset

    Raises
    ------
    EncoderError
        If the frames are too few, the log is shorter than the recording, or the light does not
        follow the motion.

    Examples
    --------
    >>> time = np.linspace(0, 4, 4001)
    >>> since = np.arange(60) / 37
    >>> light = np.abs(np.sin(8 * (since + 1.25)))
    >>> found = find_clock_offset(since, light, time=time, crank=8 * time, speed=np.sin(8 * time))
    >>> bool(abs((found.value - 1.25) * 8 / np.pi % 1) < 1e-3)
    True
    """
    if since.size < FEWEST_FRAMES:
        raise EncoderError(
            f"Expected at least {FEWEST_FRAMES} frames to find their start from the motion; got "
            f'{since.size}. Give start = "0.25 s" in [encoder] of run.toml.'
        )
    room = float(time[-1] - time[0] - since[-1])
    if room < 0:
        raise EncoderError(
            f"Expected a log that is longer than the recording, {since[-1]:.6g} s; it has "
            f"{time[-1] - time[0]:.6g} s. Export the whole log, or check frame_rate in [encoder]."
        )
    if np.ptp(light) == 0:
        raise EncoderError(
            "Expected light of the frames that follows the motion of the joint, to find their "
            "start; it is the same in all frames. Check that they are no copies of one exposure, "
            'or give start = "0.25 s" in [encoder] of run.toml.'
        )
    turns = float(crank[-1] - crank[0]) / _TURN
    period = float(time[-1] - time[0]) / max(abs(turns), 1e-9)
    model = _Model(since, light, time, crank, np.abs(speed) / float(np.abs(speed).max()))

    # every offset at which all frames lie within the log
    count = int(min(max(room / period * STEPS_IN_CYCLE, 2), MOST_STEPS))
    offsets = time[0] + np.linspace(0, room, count + 1)
    residual = np.array([model.residual(offset) for offset in offsets])
    minima = np.flatnonzero(residual == minimum_filter1d(residual, 3, mode="nearest"))
    refined = [_refine_offset(model, offsets, int(place)) for place in minima]
    best = min(refined, key=model.residual)

    least = model.residual(best)
    variance = least / (since.size - _Model.PARAMETERS - 1)
    explained = 1 - least / model.without_motion
    if explained < EXPLAINED:
        raise EncoderError(
            "Expected light of the frames that follows the motion of the joint, to find their "
            f"start; the motion explains {max(explained, 0):.0%} of its variance. Give start = "
            '"0.25 s" in [encoder] of run.toml, or record the trigger of the cameras.'
        )

    # other minima of the same depth: the other stroke, and whole cycles apart
    alike = [one for one in refined if model.residual(one) - least < EQUAL * variance]
    phases = [((one - best) / period) % 1.0 for one in alike]
    same = sum(phase < 0.25 or phase > 0.75 for phase in phases)
    std, stretch, stretch_std = model.errors(best, variance)
    return ClockOffset(best, std, explained, same < len(alike), same, stretch, stretch_std)


class _Model:
    """Light of the frames as a function of their offset."""

    PARAMETERS = 6

    def __init__(self, since: Array, light: Array, time: Array, crank: Array, speed: Array) -> None:
        self.since, self.light = since, light
        self.time, self.crank, self.speed = time, crank, speed
        once = np.stack([np.ones_like(light), *self._harmonic(float(time[0]))], axis=1)
        # what remains without the speed; the harmonic is that of any offset
        self.without_motion = _squares(once, light)

    def _harmonic(self, offset: float) -> tuple[Array, Array]:
        crank = np.interp(self.since + offset, self.time, self.crank)
        return np.cos(crank), np.sin(crank)

    def columns(self, offset: float) -> Array:
        """Powers of the speed, and one harmonic of the crank angle."""
        speed = np.interp(self.since + offset, self.time, self.speed)
        powers = [np.ones_like(speed), speed, speed**2, speed**3]
        return np.stack([*powers, *self._harmonic(offset)], axis=1)

    def residual(self, offset: float) -> float:
        """Sum of the squared residuals."""
        return _squares(self.columns(offset), self.light)

    def errors(self, offset: float, variance: float) -> tuple[float, float, float]:
        """Standard deviation of the offset with all parameters free [s]; relative stretch of the
        times between frames and its standard deviation, after one step.
        """
        # change of the light with the offset
        columns = self.columns(offset)
        solution = np.linalg.lstsq(columns, self.light, rcond=None)[0]
        step = 1e-3 * float(np.mean(np.diff(self.since)))
        after, before = (self.columns(offset + sign * step) @ solution for sign in (1, -1))
        slope = np.asarray((after - before) / (2 * step))

        # the parts that no other parameter can take
        own = _beside(columns, slope)
        stretch = _beside(np.column_stack([columns, slope]), slope * self.since)
        size = float(np.sum(stretch**2))
        std = math.sqrt(variance / float(np.sum(own**2)))
        return std, float(stretch @ self.light) / size, math.sqrt(variance / size)


def _beside(columns: Array, values: Array) -> Array:
    """Residual of a least-squares fit of the columns to the values."""
    return np.asarray(values - columns @ np.linalg.lstsq(columns, values, rcond=None)[0])


def _squares(columns: Array, values: Array) -> float:
    return float(np.sum(_beside(columns, values) ** 2))


def _refine_offset(model: _Model, offsets: Array, place: int) -> float:
    """Least squares between the neighbours of a minimum, to a millionth of their distance. [s]"""
    from scipy.optimize import fminbound  # slow to load

    low = float(offsets[max(place - 1, 0)])
    high = float(offsets[min(place + 1, offsets.size - 1)])
    return float(fminbound(model.residual, low, high, xtol=1e-6 * (high - low)))
