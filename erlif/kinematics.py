"""The encoder log against the mechanism: trigger, cycle, stroke, crank angle and speed of every frame."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt
import xarray as xr

from erlif.config import EncoderSettings, RunSettings, SliderCrankSettings
from erlif.core.errors import EncoderError, ModelError
from erlif.core.products import EncoderLog, require
from erlif.models.mechanism import CrankRocker, SliderCrank

Array = npt.NDArray[np.float64]

_ENCODER_ERROR = math.radians(0.1)  # a reading this far beyond a dead point is still taken as the dead point


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
    if settings.encoder.mounted_on == "crank":
        crank = (reading + (settings.encoder.zero or 0.0)) % (2 * math.pi)
    else:
        crank = _follow_crank(_link_angle(reading, mechanism, settings.encoder), mechanism)
    number = log.number.values - log.number.values[0]
    trigger, cycle = _fold(crank, number, log.angle.values, settings.encoder.triggers_per_cycle)
    omega = settings.mechanism.crank_speed
    if isinstance(mechanism, SliderCrank):
        speed = np.asarray(mechanism.joint_speed(crank, crank_speed=omega))
        angle_rate = np.asarray(mechanism.coupler_speed(crank, crank_speed=omega))
    else:
        speed = np.asarray(mechanism.rocker_speed(crank, crank_speed=omega))
        angle_rate = speed
    on_crank = settings.encoder.mounted_on == "crank"
    stroke = np.where(angle_rate >= 0, 1, -1).astype(np.int8)
    variables: dict[str, tuple[str, npt.NDArray[Any], dict[str, str]]] = {
        "trigger": ("frame", trigger, {"units": "1", "long_name": "encoder trigger of the cycle"}),
        "cycle": ("frame", cycle, {"units": "1", "long_name": "turn of the crank"}),
        "encoder_angle": ("frame", log.angle.values, {"units": "degree", "long_name": "encoder angle as logged"}),
        "stroke": (
            "frame",
            stroke,
            {
                "units": "1",
                "long_name": "+1 rocker angle rising, -1 falling" if on_crank else "+1 angle rising, -1 falling",
            },
        ),
        "crank_angle": (
            "frame",
            np.degrees(crank),
            {"units": "degree", "long_name": "crank angle from the ground link"},
        ),
        "rocker_speed": ("frame", speed, {"units": "rad s-1", "long_name": "angular speed in the joint, signed"}),
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


def _link_angle(reading: Array, mechanism: CrankRocker | SliderCrank, encoder: EncoderSettings) -> Array:
    """Angle of the link that carries the encoder, from the reading and its zero. [rad]"""
    low, high = mechanism.limits()
    swing = float(np.ptp(reading))
    if encoder.zero is None:
        if swing > high - low + 2 * _ENCODER_ERROR:
            raise EncoderError(
                f"Expected encoder angles within the swing of the linkage, {math.degrees(high - low):.3f} deg; the log spans "
                f"{math.degrees(swing):.3f} deg. Check the links in [mechanism], or mounted_on."
            )
        angle = reading + (low + high) / 2 - (reading.min() + reading.max()) / 2
    else:
        angle = reading + encoder.zero
        worst = int(np.argmax(np.maximum(low - angle, angle - high)))
        if not low - _ENCODER_ERROR <= angle[worst] <= high + _ENCODER_ERROR:
            raise EncoderError(
                f"Row {worst + 2}, column angle_deg: {math.degrees(reading[worst]):.3f} deg is link angle {math.degrees(angle[worst]):.3f} "
                f"deg, which the linkage cannot reach; its range is {math.degrees(low):.3f} to {math.degrees(high):.3f} deg, readings "
                f"{math.degrees(low - encoder.zero):.3f} to {math.degrees(high - encoder.zero):.3f} deg. Check zero, the links, or "
                "mounted_on."
            )
    return np.asarray(np.clip(angle, low, high))


def _follow_crank(angle: Array, mechanism: CrankRocker | SliderCrank) -> Array:
    """Crank angle of each reading [rad]: of the two that fit, the one that the crank reaches first as it turns on."""
    try:
        rising = np.asarray(mechanism.crank_angle(angle, rising=True))
        falling = np.asarray(mechanism.crank_angle(angle, rising=False))
    except ModelError as error:
        raise EncoderError(str(error)) from error
    turn = 2 * math.pi
    crank = np.empty(angle.size)
    ahead = np.nonzero(np.abs(np.diff(angle)) > 1e-9)[0]
    starts_rising = bool(angle[ahead[0] + 1] > angle[ahead[0]]) if ahead.size else True
    crank[0] = rising[0] if starts_rising else falling[0]
    for k in range(1, angle.size):
        options = np.array([rising[k], falling[k]])
        advance = (options - crank[k - 1]) % turn
        advance[advance < 1e-7] = turn  # the crank has moved since the last frame
        crank[k] = options[np.argmin(advance)]
    return crank


def _fold(
    crank: Array, number: npt.NDArray[np.int64], reading: Array, triggers_per_cycle: int | None
) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.int64]]:
    """Trigger and cycle of each frame."""
    turns = np.concatenate([[0.0], np.cumsum(np.diff(crank) % (2 * math.pi))]) / (2 * math.pi)
    per_cycle = triggers_per_cycle
    if per_cycle is None:
        cycles = turns[-1] + (turns[-1] / max(number[-1], 1))
        per_cycle = int(number[-1] + 1) if cycles < 1.5 else round((number[-1] + 1) / cycles)
    trigger, cycle = number % per_cycle, number // per_cycle
    order = np.argsort(trigger, kind="stable")
    first = {int(t): reading[k] for k, t in zip(order[::-1], trigger[order[::-1]], strict=True)}
    off = np.abs(reading - np.array([first[int(t)] for t in trigger]))
    spacing = float(np.median(np.abs(np.diff(reading)))) if reading.size > 1 else math.inf
    if off.max() > 0.5 * spacing:
        worst = int(np.argmax(off))
        source = "triggers_per_cycle" if triggers_per_cycle is not None else "the cycles found in the log"
        raise EncoderError(
            f"Expected the frames of one trigger at one angle; with {per_cycle} triggers per cycle ({source}), row {worst + 2} is "
            f"{off[worst]:.2f} deg from the first cycle's. Set triggers_per_cycle in [encoder] to the number of triggers per turn of "
            "the crank, and keep every row."
        )
    return trigger, cycle
