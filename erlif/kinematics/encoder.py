"""The readings of an encoder as angles of the link that carries it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np

from erlif.core.arrays import Array
from erlif.core.errors import EncoderError
from erlif.core.products import EncoderLog
from erlif.models.mechanism import CrankRocker, SliderCrank

# A reading this far beyond a dead point is taken as the dead point. [rad]
ENCODER_ERROR = math.radians(0.1)

# Of the crank angle, by which the readings of a turn are described.
HARMONICS = 3

# Twice as many as the harmonics have coefficients.
FEWEST_FRAMES = 14

# Largest relative deviation of the crank speed from its setting.
LARGEST_SLIP = 0.05

# Speeds on either side of the stated one that are tried; times in another unit would take millions.
MOST_SPEEDS = 1000

# Standard deviations by which the second harmonic must differ from zero.
SIGNIFICANT = 5.0

# Second harmonic over the first, below which a link dwells alike at both dead points.
_ALIKE = 1e-9

_TURN = 2 * math.pi

Mechanism = CrankRocker | SliderCrank


@dataclass(frozen=True)
class Encoder:
    """Mounting of the encoder and meaning of its readings.

    Attributes
    ----------
    mounted_on : Literal['rocker', 'crank', 'coupler']
        Link that carries it.
    zero : float | None
        Angle of that link at reading 0; None: the extremes of the log are the dead points.
        [rad]
    triggers_per_cycle : int | None
        None: as the angles suggest.
    direction : Literal['rising', 'falling'] | None
        Whether the reading rises or falls while the angle of the link rises; None: as the log
        suggests, else rising.
    bins : int | None
        Parts of a cycle over which frames are averaged; None: frames are folded by their angles.
    """

    mounted_on: Literal["rocker", "crank", "coupler"] = "rocker"
    zero: float | None = None
    triggers_per_cycle: int | None = None
    direction: Literal["rising", "falling"] | None = None
    bins: int | None = None


class LinkAngle(NamedTuple):
    """Angle of the link that carries the encoder.

    Attributes
    ----------
    angle : Array
        Within the reach of the link; 0 to 2 pi on the crank. (frame,) [rad]
    reading : Array
        Reading of the encoder, counted on where it starts again at 0. (frame,) [degree]
    zero : float
        Angle of the link at reading 0. [rad]
    zero_std : float | None
        Its standard deviation where it was fitted. [rad]
    falling : bool
        Whether the reading falls while the angle rises.
    """

    angle: Array
    reading: Array
    zero: float
    zero_std: float | None
    falling: bool


def read_link_angle(
    log: EncoderLog, mechanism: Mechanism, encoder: Encoder, *, crank_speed: float
) -> LinkAngle:
    """Turn the readings of a log into angles of the link that carries the encoder.

    Parameters
    ----------
    log : EncoderLog
        angle (frame) [degree] and number (frame); time (frame) [s] where it is logged.
    mechanism : CrankRocker or SliderCrank
    encoder : Encoder
    crank_speed : float
        [rad s-1]

    Returns
    -------
    LinkAngle

    Raises
    ------
    EncoderError
        If the reading does not change, the link cannot reach it, or the log does not determine the
        zero.

    Notes
    -----
    Without a zero, the link angle at reading 0 lies between the value at which the smallest reading
    is the lower dead point and that at which the largest one is the upper dead point. Its
    estimate is the middle, its standard deviation that of the uniform distribution, the length
    over the square root of 12. The noise of the readings is added where the log has times.

    Examples
    --------
    An encoder that starts again at 0 after 360 degrees:

    >>> import xarray as xr
    >>> rig = CrankRocker(0.055, 0.44, 0.26, 0.51)
    >>> log = EncoderLog(xr.Dataset({"number": ("frame", [0, 1]), "angle": ("frame", [355.0, 4])}))
    >>> found = read_link_angle(log, rig, Encoder(zero=np.radians(60)), crank_speed=12.0)
    >>> np.degrees(found.angle).round(), found.reading
    (array([55., 64.]), array([355., 364.]))
    """
    logged = log.angle.values
    if logged.size > 1 and np.ptp(logged) == 0:
        raise EncoderError(
            f"Expected the angle of a moving {encoder.mounted_on} in the log; it is {logged[0]:g} "
            f"deg in all {logged.size} rows. Choose the column of the encoder with angle in "
            "[encoder] of run.toml, or leave [mechanism] out for a joint at rest."
        )
    if encoder.mounted_on == "crank":
        return _read_crank(log, encoder)
    return _read_swing(log, mechanism, encoder, crank_speed)


def _read_crank(log: EncoderLog, encoder: Encoder) -> LinkAngle:
    """Crank angle of an encoder that sits on the crank."""
    # steps of more than half a turn are steps backwards
    reading = np.radians(log.angle.values)
    step = np.diff(reading) % _TURN
    falls = bool(step.size and np.median(step) > math.pi)
    if "angle_rate" in log:
        falls = bool(np.median(log["angle_rate"].values) < 0)
    if falls and encoder.direction == "rising":
        raise EncoderError(
            "Expected the readings to rise as the crank turns; they fall. Write direction = "
            '"falling" in [encoder], or check mounted_on, which places the encoder on the crank.'
        )
    if encoder.direction == "falling" and step.size and not falls:
        raise EncoderError(
            "Expected the readings to fall as the crank turns, because of direction in [encoder]; "
            "they rise. Correct direction, or mounted_on, which places the encoder on the crank."
        )

    zero = encoder.zero or 0.0
    angle = ((-reading if falls else reading) + zero) % _TURN
    return LinkAngle(np.asarray(angle), log.angle.values, zero, None, falls)


def _read_swing(
    log: EncoderLog, mechanism: Mechanism, encoder: Encoder, crank_speed: float
) -> LinkAngle:
    """Angle of a link that swings."""
    link = choose_link(mechanism, encoder.mounted_on)
    low, high = link.limits
    counted = _unwrap_reading(log.angle.values)
    reading = np.radians(counted)

    # a reading that falls is a rising one of the other sign
    signs = {"rising": [1], "falling": [-1], None: [1, -1]}[encoder.direction]
    sign = signs[0]
    noise = 0.0
    if "time" in log and reading.size > 1:
        time = log["time"].values
        seen, noise = find_direction(time, reading, link.angle, crank_speed=crank_speed)
        if encoder.direction is not None and seen == -sign:
            here = "fall" if encoder.direction == "rising" else "rise"
            raise EncoderError(
                f"Expected readings that are {encoder.direction}, because of direction in "
                f"[encoder], while the angle of the {encoder.mounted_on} rises; by the times of "
                f"the log they {here}: the link dwells at the other dead point. Leave direction "
                "out, so that it is found, or check mounted_on and the links in [mechanism]."
            )
        sign = seen or sign

    if encoder.zero is not None:
        zero = encoder.zero
        if encoder.direction is None and not _fits_range(sign * reading + zero, low, high):
            # only one of the signs may leave the readings within reach
            sign = next((one for one in signs if _fits_range(one * reading + zero, low, high)), 1)
        angle = _turn_into(sign * reading + zero, low, high)
        _check_reach(angle, log, counted, sign, zero, (low, high))
        zero_std = None
    else:
        zero, zero_std = _fit_zero(sign * reading, low, high, noise, encoder)
        angle = sign * reading + zero
    angle = np.clip(angle, low, high)
    return LinkAngle(np.asarray(angle), counted, zero, zero_std, sign < 0)


def find_direction(
    time: Array, reading: Array, link: Callable[[Array], Array], *, crank_speed: float
) -> tuple[int, float]:
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
    sign : int
        1 rising, -1 falling, 0 where the log does not show it, as with the rod of a slider-crank,
        which dwells alike at both dead points.
    noise : float
        Standard deviation of the readings about their harmonics; 0 for a short log. [rad]

    Examples
    --------
    >>> def link(crank): return np.cos(crank) + 0.2 * np.cos(2 * crank)
    >>> time = np.linspace(0, 1, 40)
    >>> find_direction(time, -link(8 * time + 1), link, crank_speed=8.0)[0]
    -1
    """
    duration = float(np.ptp(time))
    if time.size < FEWEST_FRAMES or duration * crank_speed < 0.9 * _TURN:
        return 0, 0.0

    # the crank speed is searched in steps by which the log slips a twentieth of a turn
    count = int(np.ceil(LARGEST_SLIP * crank_speed * duration / (0.05 * _TURN)))
    if count > MOST_SPEEDS:
        return 0, 0.0
    speeds = crank_speed * (1 + LARGEST_SLIP * np.arange(-count, count + 1) / max(count, 1))
    fits = [_fit_harmonics(time, reading, float(speed)) for speed in speeds]
    residual, read_first, read_second = min(fits, key=lambda fit: fit[0])
    noise = float(np.sqrt(residual / (time.size - 1 - 2 * HARMONICS)))

    # harmonics of the link itself, on a grid that is fine for all that matter
    crank = np.arange(256) * _TURN / 256
    wave = np.asarray(link(crank))
    first, second = (2 * np.mean(wave * np.exp(-1j * m * crank)) for m in (1, 2))
    if abs(second) < _ALIKE * abs(first):
        return 0, noise

    phase = read_first / abs(read_first) * np.conj(first) / abs(first)
    along = float((read_second * np.conj(phase**2) / second).real)
    std = noise * np.sqrt(2 / time.size) / abs(second)
    sure = abs(along) > SIGNIFICANT * std and 0.5 < abs(along) < 2.0
    return int(np.sign(along)) if sure else 0, noise


def _fit_harmonics(time: Array, reading: Array, speed: float) -> tuple[float, complex, complex]:
    """Sum of the squared residuals, and first and second harmonic of the readings."""
    turn = speed * (time - time[0])
    columns = [np.ones_like(turn)]
    for m in range(1, HARMONICS + 1):
        columns += [np.cos(m * turn), np.sin(m * turn)]
    design = np.stack(columns, axis=1)
    solution = np.linalg.lstsq(design, reading, rcond=None)[0]
    residual = float(np.sum((reading - design @ solution) ** 2))
    one, two = (complex(solution[2 * m - 1], -solution[2 * m]) for m in (1, 2))
    return residual, one, two


class Link(NamedTuple):
    """A link that swings.

    Attributes
    ----------
    limits : tuple[float, float]
        Angles between which it swings. [rad]
    angle : Callable[..., Array]
        Crank angle to its angle. [rad]
    crank : Callable[..., Array]
        Its angle to the crank angle, with `rising`. [rad]
    speed : Callable[..., Array]
        Crank angle to its speed, with `crank_speed`. [rad s-1]
    """

    limits: tuple[float, float]
    angle: Callable[..., Array]
    crank: Callable[..., Array]
    speed: Callable[..., Array]


def choose_link(mechanism: Mechanism, mounted_on: str) -> Link:
    """Choose the link that carries the encoder and swings.

    Parameters
    ----------
    mechanism : CrankRocker or SliderCrank
    mounted_on : str
        Only "coupler" makes a difference; the rod of a slider-crank is its coupler.

    Returns
    -------
    Link

    Examples
    --------
    >>> rig = CrankRocker(0.055, 0.44, 0.26, 0.51)
    >>> np.degrees(choose_link(rig, "rocker").limits).round(1)
    array([47.4, 71.8])
    """
    one = mechanism
    if isinstance(one, SliderCrank):
        return Link(one.limits(), one.coupler_angle, one.crank_angle, one.coupler_speed)
    if mounted_on == "coupler":
        inverse = one.crank_angle_from_coupler
        return Link(one.coupler_limits(), one.coupler_angle, inverse, one.coupler_speed)
    return Link(one.limits(), one.rocker_angle, one.crank_angle, one.rocker_speed)


def _unwrap_reading(reading: Array) -> Array:
    """Unwrap readings where the encoder starts again at 0 or at 360. [degree]"""
    # a link that swings moves by less than half a turn from frame to frame
    turns = np.round(np.diff(reading) / 360.0)
    if not turns.size or np.abs(turns).max() != 1:
        return reading  # nothing starts again, or these are no readings of a link that swings
    return np.asarray(reading - 360.0 * np.concatenate([[0.0], np.cumsum(turns)]))


def _turn_into(angle: Array, low: float, high: float) -> Array:
    """Angles moved by whole turns, so that they lie about the reach of the link. [rad]"""
    away = (float(angle.min()) + float(angle.max())) / 2 - (low + high) / 2
    turns = round(away / _TURN) if abs(away) < 2 * _TURN else 0
    return angle - turns * _TURN


def _fits_range(angle: Array, low: float, high: float) -> bool:
    moved = _turn_into(angle, low, high)
    return bool(moved.min() >= low - ENCODER_ERROR and moved.max() <= high + ENCODER_ERROR)


def _check_reach(
    angle: Array,
    log: EncoderLog,
    counted: Array,
    sign: int,
    zero: float,
    limits: tuple[float, float],
) -> None:
    """Refuse an angle that the link cannot reach."""
    low, high = limits
    worst = int(np.argmax(np.maximum(low - angle, angle - high)))
    if low - ENCODER_ERROR <= angle[worst] <= high + ENCODER_ERROR:
        return
    first, last = sorted(math.degrees(sign * (limit - zero)) for limit in limits)
    raise EncoderError(
        f"Frame {int(log.number[worst])}, the logged angle: {counted[worst]:.3f} deg is link angle "
        f"{math.degrees(angle[worst]):.3f} deg, which the linkage cannot reach; its range is "
        f"{math.degrees(low):.3f} to {math.degrees(high):.3f} deg, readings {first:.3f} to "
        f"{last:.3f} deg. Check zero, direction and mounted_on in [encoder], or the links in "
        "[mechanism]."
    )


def _fit_zero(
    reading: Array, low: float, high: float, noise: float, encoder: Encoder
) -> tuple[float, float]:
    """Link angle at reading 0 with its standard deviation, from the extremes of the log. [rad]"""
    swing = float(np.ptp(reading))
    slack = high - low - swing
    if slack < -2 * ENCODER_ERROR:
        raise EncoderError(
            "Expected encoder angles within the swing of the linkage, "
            f"{math.degrees(high - low):.3f} deg; the logged angle spans {math.degrees(swing):.3f} "
            "deg. Check the links in [mechanism], mounted_on and units in [encoder], or whether a "
            "counter has overflowed or was reset."
        )

    # a log over a whole cycle comes as near to both dead points as its steps are long
    step = float(np.abs(np.diff(reading)).max()) if reading.size > 1 else 0.0
    if slack > 2 * step + 2 * ENCODER_ERROR:
        raise EncoderError(
            "Expected a log that reaches both ends of the swing of the linkage, "
            f"{math.degrees(high - low):.3f} deg, because zero is not given; the logged angle "
            f"spans {math.degrees(swing):.3f} deg. Give zero in [encoder], or check the links in "
            f"[mechanism] and mounted_on, which places the encoder on the {encoder.mounted_on}."
        )

    zero = (low + high) / 2 - (float(reading.min()) + float(reading.max())) / 2
    # each extreme has the noise of one reading at most; the zero is the mean of two
    std = math.hypot(max(slack, 0.0) / math.sqrt(12), noise / math.sqrt(2))
    return zero, max(std, -slack / math.sqrt(12))
