"""Position and speed of the mechanism at every frame, from the encoder log."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
import numpy.typing as npt
import xarray as xr

from erlif.core.arrays import Array
from erlif.core.errors import EncoderError, ModelError
from erlif.core.products import EncoderLog, require
from erlif.models.mechanism import CrankRocker, SliderCrank

_BACKWARD_COST = 3.0
"""Cost per radian beyond half a turn between frames: a slow crank is not a fast one in reverse."""

_ENCODER_ERROR = math.radians(0.1)
"""A reading this far beyond a dead point is taken as the dead point. [rad]"""

_EVEN_STEP = 1e-3
"""Added to steps before their logarithm, so that frames at rest do not decide. [rad]"""

_SINGLE_CYCLE = 1.5
"""Turns of the crank below which a log without triggers_per_cycle counts as one cycle."""

_OFF_ANGLE = 0.5
"""Deviation from the first cycle's angle that a trigger may have, in spacings of triggers."""

Mechanism = CrankRocker | SliderCrank


@dataclass(frozen=True)
class Encoder:
    """Where the encoder sits and what it counts.

    Attributes
    ----------
    mounted_on : Literal['rocker', 'crank']
        Link that carries it.
    zero : float | None
        Angle of that link at reading 0; None: the extremes of the log are the dead points.
        [rad]
    triggers_per_cycle : int | None
        None: as the angles suggest.
    """

    mounted_on: Literal["rocker", "crank"] = "rocker"
    zero: float | None = None
    triggers_per_cycle: int | None = None


def locate_frames(
    log: EncoderLog,
    *,
    mechanism: Mechanism,
    crank_speed: float,
    pin_radius: float | None,
    encoder: Encoder | None = None,
) -> xr.Dataset:
    """Find the position of the mechanism in its cycle at each frame.

    Parameters
    ----------
    log : EncoderLog
        angle (frame) [degree] and number (frame).
    mechanism : CrankRocker or SliderCrank
    crank_speed : float
        [rad s-1]
    pin_radius : float or None
        None where it is not known; there is then no sliding speed. [m]
    encoder : Encoder, optional
        Default: on the rocker, its zero found from the dead points.

    Returns
    -------
    xarray.Dataset
        On dim frame: trigger and cycle, counted from 0; encoder_angle [degree]; stroke, +1 where
        the angle rises and -1 where it falls; crank_angle [degree, 0 to 360]; rocker_speed
        [rad s-1, signed]; sliding_speed [m s-1]. For a slider-crank the rocker is the connecting
        rod, and its speed that of the joint between crank and rod.

    Raises
    ------
    EncoderError
        If the linkage cannot reach a logged angle, or the log does not fold into cycles.

    Examples
    --------
    A crank at constant speed, logged every 90 degrees:

    >>> mechanism = CrankRocker(0.055, 0.44, 0.26, 0.51)
    >>> log = EncoderLog(xr.Dataset({"number": ("frame", np.arange(4)),
    ...                              "angle": ("frame", [0.0, 90.0, 180.0, 270.0])}))
    >>> cycle = locate_frames(log, mechanism=mechanism, crank_speed=12.0, pin_radius=0.033,
    ...                       encoder=Encoder("crank"))
    >>> cycle.crank_angle.values.round()
    array([  0.,  90., 180., 270.])
    """
    require(log, "angle", "number")

    # on the crank the reading is the crank angle; on the rocker two crank angles fit each reading
    encoder = encoder or Encoder()
    reading = np.radians(log.angle.values)
    on_crank = encoder.mounted_on == "crank"
    if on_crank:
        crank = _crank_from_reading(reading, encoder)
    else:
        crank = _follow_crank(_link_angle(log, mechanism, encoder), mechanism)
    trigger, cycle = _fold(crank, log, encoder)

    # the crank pin of a slider-crank turns against the rod, the rocker pin against the frame
    if isinstance(mechanism, SliderCrank):
        speed = np.asarray(mechanism.joint_speed(crank, crank_speed=crank_speed))
        angle_rate = np.asarray(mechanism.coupler_speed(crank, crank_speed=crank_speed))
    else:
        speed = np.asarray(mechanism.rocker_speed(crank, crank_speed=crank_speed))
        angle_rate = speed
    stroke = np.where(angle_rate >= 0, 1, -1).astype(np.int8)

    rising = "+1 rocker angle rising, -1 falling" if on_crank else "+1 angle rising, -1 falling"
    columns = {
        "trigger": (trigger, "1", "encoder trigger of the cycle"),
        "cycle": (cycle, "1", "turn of the crank"),
        "encoder_angle": (log.angle.values, "degree", "encoder angle as logged"),
        "stroke": (stroke, "1", rising),
        "crank_angle": (np.degrees(crank), "degree", "crank angle from the ground link"),
        "rocker_speed": (speed, "rad s-1", "angular speed in the joint, signed"),
    }
    if pin_radius is not None:
        meaning = "surface speed of the pin against the bushing"
        columns["sliding_speed"] = (np.abs(speed) * pin_radius, "m s-1", meaning)
    return xr.Dataset(
        {
            name: ("frame", values, {"units": unit, "long_name": meaning})
            for name, (values, unit, meaning) in columns.items()
        },
        {"frame": np.arange(reading.size)},
    )


def entrained_stroke(mechanism: Mechanism, *, pin_radius: float) -> float:
    """Travel of the entrained oil in half a cycle, pin radius times half the swing.

    Parameters
    ----------
    mechanism : CrankRocker or SliderCrank
    pin_radius : float
        [m]

    Returns
    -------
    float
        Infinite for a slider-crank, whose crank pin turns all the way. [m]

    Examples
    --------
    >>> entrained_stroke(SliderCrank(0.05, 0.2), pin_radius=0.01)
    inf
    """
    if isinstance(mechanism, SliderCrank):
        return math.inf
    low, high = mechanism.limits()
    return pin_radius * (high - low) / 2


class _Fold(NamedTuple):
    """Trigger and cycle of each frame."""

    trigger: npt.NDArray[np.int64]
    cycle: npt.NDArray[np.int64]


def _crank_from_reading(reading: Array, encoder: Encoder) -> Array:
    """Crank angle of an encoder that sits on the crank. [rad]"""
    # steps of more than half a turn are steps backwards
    turn = 2 * math.pi
    step = np.diff(reading) % turn
    if step.size and np.median(step) > math.pi:
        raise EncoderError(
            "Expected column angle_deg to rise as the crank turns; it falls. Exchange the sign of "
            "angle_deg, or check mounted_on in [encoder], which places the encoder on the crank."
        )
    return np.asarray((reading + (encoder.zero or 0.0)) % turn)


def _link_angle(log: EncoderLog, mechanism: Mechanism, encoder: Encoder) -> Array:
    """Angle of the link that carries the encoder, from the reading and its zero. [rad]"""
    low, high = mechanism.limits()
    reading = np.radians(log.angle.values)

    # without a zero the middle of the readings is the middle of the swing
    if encoder.zero is None:
        swing = float(np.ptp(reading))
        if swing > high - low + 2 * _ENCODER_ERROR:
            raise EncoderError(
                "Expected encoder angles within the swing of the linkage, "
                f"{math.degrees(high - low):.3f} deg; column angle_deg spans "
                f"{math.degrees(swing):.3f} deg. Check the links in [mechanism], or mounted_on in "
                "[encoder]."
            )
        angle = reading + (low + high) / 2 - (reading.min() + reading.max()) / 2
        return np.asarray(np.clip(angle, low, high))

    # with a zero every reading is an angle of the link, which must be within its swing
    angle = reading + encoder.zero
    worst = int(np.argmax(np.maximum(low - angle, angle - high)))
    if not low - _ENCODER_ERROR <= angle[worst] <= high + _ENCODER_ERROR:
        raise EncoderError(
            f"Frame {int(log.number[worst])}, column angle_deg: "
            f"{math.degrees(reading[worst]):.3f} deg is link angle "
            f"{math.degrees(angle[worst]):.3f} deg, which the linkage cannot reach; its range is "
            f"{math.degrees(low):.3f} to {math.degrees(high):.3f} deg, readings "
            f"{math.degrees(low - encoder.zero):.3f} to {math.degrees(high - encoder.zero):.3f} "
            "deg. Check zero and mounted_on in [encoder], or the links in [mechanism]."
        )
    return np.asarray(np.clip(angle, low, high))


def _follow_crank(angle: Array, mechanism: Mechanism) -> Array:
    """Crank angle of each reading. [rad]

    Two crank angles fit a reading, one on either stroke. Of all sequences of these the one with the
    most even steps is taken (Viterbi's algorithm): near a dead point a single step does not
    determine whether the stroke has turned, its neighbours do.
    """
    try:
        options = np.stack(
            [mechanism.crank_angle(angle, rising=True), mechanism.crank_angle(angle, rising=False)]
        )
    except ModelError as error:
        raise EncoderError(str(error)) from error
    if angle.size == 1:
        return np.asarray(options[0])

    turn = 2 * math.pi
    step = (options[None, :, 1:] - options[:, None, :-1]) % turn  # (from, to, frame)
    step[step > turn - 1e-7] = 0.0  # rounding at a standstill
    size = np.log(step + _EVEN_STEP)
    backward = _BACKWARD_COST * np.maximum(step - math.pi, 0.0)

    # the cost of a pair of steps is the square of the change of their logarithm
    cost = backward[:, :, 0]
    came_from = np.empty((angle.size - 2, 2, 2), np.intp)
    for k in range(1, angle.size - 1):
        change = size[None, :, :, k] - size[:, :, None, k - 1]  # (before, from, to)
        total = cost[:, :, None] + change**2
        came_from[k - 1] = total.argmin(axis=0)
        cost = total.min(axis=0) + backward[:, :, k]

    # from the cheapest last pair back to the first frame
    side = np.empty(angle.size, np.intp)
    side[-2:] = np.unravel_index(cost.argmin(), cost.shape)
    for k in range(angle.size - 3, -1, -1):
        side[k] = came_from[k][side[k + 1], side[k + 2]]
    return np.asarray(options[side, np.arange(angle.size)])


def _fold(crank: Array, log: EncoderLog, encoder: Encoder) -> _Fold:
    """Fold the log into cycles, and check that each trigger comes back to its angle."""
    number, reading = log.number.values, log.angle.values
    since = number - number[0]
    per_cycle, source = encoder.triggers_per_cycle, "triggers_per_cycle"
    if per_cycle is None:
        # the step that follows the last frame completes its turn
        turns = float(np.sum(np.diff(crank) % (2 * math.pi))) / (2 * math.pi)
        cycles = turns + turns / max(since[-1], 1)
        frames = int(since[-1] + 1)
        per_cycle = frames if cycles < _SINGLE_CYCLE else round((since[-1] + 1) / cycles)
        source = "as the angles suggest"

    # filled from the back, so that the first frame of each trigger is the reference
    trigger, cycle = since % per_cycle, since // per_cycle
    first = np.empty(trigger.max() + 1)
    first[trigger[::-1]] = reading[::-1]
    off = np.abs(reading - first[trigger])
    if encoder.mounted_on == "crank":
        off = np.abs((off + 180) % 360 - 180)  # readings may differ by whole turns

    spacing = float(np.median(np.abs(np.diff(reading)))) if reading.size > 1 else math.inf
    if off.max() > _OFF_ANGLE * spacing:
        worst = int(np.argmax(off))
        raise EncoderError(
            f"Expected the frames of one trigger at one angle; with {per_cycle} triggers per cycle "
            f"({source}) frame {number[worst]} is {off[worst]:.2f} deg from the first cycle's. Set "
            "triggers_per_cycle in [encoder] to the number of triggers per turn of the crank, and "
            "keep every row."
        )
    return _Fold(trigger, cycle)
