"""The encoder log against the mechanism: trigger, cycle, stroke, crank angle and speed of every frame."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
import xarray as xr

from erlif.core.arrays import AnyArray, Array
from erlif.core.errors import EncoderError, ModelError
from erlif.core.products import EncoderLog, require
from erlif.models.mechanism import CrankRocker, SliderCrank
from erlif.settings import EncoderSettings, RunSettings, SliderCrankSettings

_BACKWARD_COST = (
    3.0  # per radian beyond half a turn: a slow crank is not a fast one that turns the other way
)
_ENCODER_ERROR = math.radians(
    0.1
)  # a reading this far beyond a dead point is still taken as the dead point


def build_mechanism(settings: RunSettings) -> CrankRocker | SliderCrank:
    """The linkage of the settings; raises ModelError where its crank cannot turn (Grashof)."""
    links = settings.mechanism
    if isinstance(links, SliderCrankSettings):
        return SliderCrank(links.crank, links.coupler)
    return CrankRocker(links.crank, links.coupler, links.rocker, links.ground)


def locate_frames(log: EncoderLog, settings: RunSettings) -> xr.Dataset:
    """Find where in its cycle the mechanism was at each frame.

    Parameters
    ----------
    log : EncoderLog
        angle (frame) [degree] and number (frame).
    settings : RunSettings
        Mechanism, crank speed and how the encoder is mounted.

    Returns
    -------
    xarray.Dataset
        On dim frame: trigger and cycle, counted from 0; encoder_angle [degree]; stroke, +1 where the angle rises and -1 where it
        falls; crank_angle [degree, 0 to 360]; rocker_speed [rad s-1, signed]; sliding_speed [m s-1]. For a slider-crank the rocker
        is the connecting rod, and its speed that of the pin joint between crank and rod.

    Raises
    ------
    EncoderError
        If the linkage cannot reach a logged angle, or the log does not fold into cycles.
    ModelError
        If the links cannot turn.
    """
    require(log, "angle", "number")
    mechanism = build_mechanism(settings)
    reading = np.radians(log.angle.values)
    on_crank = settings.encoder.mounted_on == "crank"
    if on_crank:
        crank = _crank_from_reading(reading, settings.encoder)
    else:
        crank = _follow_crank(_link_angle(log, mechanism, settings.encoder), mechanism)
    trigger, cycle = _fold(crank, log, settings.encoder)
    omega = settings.mechanism.crank_speed
    if isinstance(mechanism, SliderCrank):
        speed = np.asarray(mechanism.joint_speed(crank, crank_speed=omega))
        angle_rate = np.asarray(mechanism.coupler_speed(crank, crank_speed=omega))
    else:
        speed = np.asarray(mechanism.rocker_speed(crank, crank_speed=omega))
        angle_rate = speed
    stroke = np.where(angle_rate >= 0, 1, -1).astype(np.int8)
    variables: dict[str, tuple[str, AnyArray, dict[str, str]]] = {
        "trigger": ("frame", trigger, {"units": "1", "long_name": "encoder trigger of the cycle"}),
        "cycle": ("frame", cycle, {"units": "1", "long_name": "turn of the crank"}),
        "encoder_angle": (
            "frame",
            log.angle.values,
            {"units": "degree", "long_name": "encoder angle as logged"},
        ),
        "stroke": (
            "frame",
            stroke,
            {
                "units": "1",
                "long_name": "+1 rocker angle rising, -1 falling"
                if on_crank
                else "+1 angle rising, -1 falling",
            },
        ),
        "crank_angle": (
            "frame",
            np.degrees(crank),
            {"units": "degree", "long_name": "crank angle from the ground link"},
        ),
        "rocker_speed": (
            "frame",
            speed,
            {"units": "rad s-1", "long_name": "angular speed in the joint, signed"},
        ),
        "sliding_speed": (
            "frame",
            np.abs(speed) * settings.joint.pin_radius,
            {"units": "m s-1", "long_name": "surface speed of the pin against the bushing"},
        ),
    }
    return xr.Dataset(variables, {"frame": np.arange(reading.size)})


def entrained_stroke(settings: RunSettings) -> float:
    """Travel of the entrained oil in half a cycle, pin radius times half the swing. [m]"""
    mechanism = build_mechanism(settings)
    if isinstance(mechanism, SliderCrank):
        return math.inf
    low, high = mechanism.limits()
    return settings.joint.pin_radius * (high - low) / 2


def _crank_from_reading(reading: Array, encoder: EncoderSettings) -> Array:
    """Crank angle of an encoder that sits on the crank. [rad]"""
    turn = 2 * math.pi
    step = np.diff(reading) % turn
    if step.size and np.median(step) > math.pi:
        raise EncoderError(
            "Expected column angle_deg to rise as the crank turns; it falls. Exchange the sign of angle_deg, or check mounted_on in [encoder]: "
            "it says that the encoder sits on the crank."
        )
    return np.asarray((reading + (encoder.zero or 0.0)) % turn)


def _link_angle(
    log: EncoderLog, mechanism: CrankRocker | SliderCrank, encoder: EncoderSettings
) -> Array:
    """Angle of the link that carries the encoder, from the reading and its zero. [rad]"""
    low, high = mechanism.limits()
    reading = np.radians(log.angle.values)
    swing = float(np.ptp(reading))
    if encoder.zero is None:
        if swing > high - low + 2 * _ENCODER_ERROR:
            raise EncoderError(
                f"Expected encoder angles within the swing of the linkage, {math.degrees(high - low):.3f} deg; column angle_deg spans "
                f"{math.degrees(swing):.3f} deg. Check the links in [mechanism], or mounted_on in [encoder]."
            )
        angle = reading + (low + high) / 2 - (reading.min() + reading.max()) / 2
    else:
        angle = reading + encoder.zero
        worst = int(np.argmax(np.maximum(low - angle, angle - high)))
        if not low - _ENCODER_ERROR <= angle[worst] <= high + _ENCODER_ERROR:
            raise EncoderError(
                f"Frame {int(log.number[worst])}, column angle_deg: {math.degrees(reading[worst]):.3f} deg is link angle "
                f"{math.degrees(angle[worst]):.3f} deg, which the linkage cannot reach; its range is {math.degrees(low):.3f} to "
                f"{math.degrees(high):.3f} deg, readings {math.degrees(low - encoder.zero):.3f} to {math.degrees(high - encoder.zero):.3f} "
                "deg. Check zero and mounted_on in [encoder], or the links in [mechanism]."
            )
    return np.asarray(np.clip(angle, low, high))


def _follow_crank(angle: Array, mechanism: CrankRocker | SliderCrank) -> Array:
    """Crank angle of each reading. [rad]

    Two crank angles fit a reading, one on either stroke. Of all the ways from frame to frame the one with the most even steps
    is taken (Viterbi's algorithm): about a dead point a single step cannot tell whether the stroke has turned, its neighbours can.
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
    step[step > turn - 1e-7] = 0.0  # rounding about a standstill
    size = np.log(step + 1e-3)
    backward = _BACKWARD_COST * np.maximum(step - math.pi, 0.0)
    cost = backward[:, :, 0]
    came_from = np.empty((angle.size - 2, 2, 2), np.intp)
    for k in range(1, angle.size - 1):
        total = (
            cost[:, :, None] + (size[None, :, :, k] - size[:, :, None, k - 1]) ** 2
        )  # (before, from, to)
        came_from[k - 1] = total.argmin(axis=0)
        cost = total.min(axis=0) + backward[:, :, k]
    side = np.empty(angle.size, np.intp)
    side[-2:] = np.unravel_index(cost.argmin(), cost.shape)
    for k in range(angle.size - 3, -1, -1):
        side[k] = came_from[k][side[k + 1], side[k + 2]]
    return np.asarray(options[side, np.arange(angle.size)])


def _fold(
    crank: Array, log: EncoderLog, encoder: EncoderSettings
) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.int64]]:
    """Trigger and cycle of each frame."""
    number, reading = log.number.values, log.angle.values
    since = number - number[0]
    per_cycle, source = encoder.triggers_per_cycle, "triggers_per_cycle"
    if per_cycle is None:
        turns = float(np.sum(np.diff(crank) % (2 * math.pi))) / (2 * math.pi)
        cycles = turns + turns / max(since[-1], 1)
        per_cycle = int(since[-1] + 1) if cycles < 1.5 else round((since[-1] + 1) / cycles)
        source = "as the angles suggest"
    trigger, cycle = since % per_cycle, since // per_cycle
    first = np.empty(trigger.max() + 1)
    first[trigger[::-1]] = reading[::-1]
    off = np.abs(reading - first[trigger])
    if encoder.mounted_on == "crank":
        off = np.abs((off + 180) % 360 - 180)  # readings of one place may differ by whole turns
    spacing = float(np.median(np.abs(np.diff(reading)))) if reading.size > 1 else math.inf
    if off.max() > 0.5 * spacing:
        worst = int(np.argmax(off))
        raise EncoderError(
            f"Expected the frames of one trigger at one angle; with {per_cycle} triggers per cycle ({source}) frame {number[worst]} is "
            f"{off[worst]:.2f} deg from the first cycle's. Set triggers_per_cycle in [encoder] to the number of triggers per turn of the "
            "crank, and keep every row."
        )
    return trigger, cycle
