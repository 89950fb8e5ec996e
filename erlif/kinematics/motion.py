"""Position and speed of a disc or a slider at every frame, and frames of a film at rest.

A motion without a linkage has no dead points to which the readings could be matched, and each frame
is a trigger unless the settings fold the frames.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import xarray as xr

from erlif.core.arrays import Array
from erlif.core.errors import EncoderError
from erlif.core.products import EncoderLog, require
from erlif.kinematics.folding import FrameColumns, describe_frames, fold_by_number, fold_by_phase

# Turn of a disc from frame to frame above which its sense is not certain. [degree]
_LARGEST_STEP = 150.0

_OFF_RATE = 0.05  # relative difference of the logged rate from that of the settings, reported

_TURN = 360.0

# Angles of the drive between which the bins of a cycle lie: a slider turns back there. [rad]
_DISC, _SLIDER = (0.0, math.pi), (-math.pi / 2, math.pi / 2)


@dataclass(frozen=True)
class TurningDisc:
    """A disc or shaft that turns past the contact.

    Attributes
    ----------
    radius : float
        Distance of the contact from the axis of rotation. [m]
    speed : float | None
        Speed of rotation; None: from angle and time of the log. [rad/s]
    """

    radius: float
    speed: float | None = None


@dataclass(frozen=True)
class Sinusoid:
    """A slider at stroke/2 sin(2 pi frequency t).

    Attributes
    ----------
    stroke : float
        Travel from end to end. [m]
    frequency : float
        Cycles in a second. [Hz]
    """

    stroke: float
    frequency: float


_USUAL_RPM = (0.1, 20_000.0)  # speeds of discs on test rigs [rpm]
_GIVE_SPEED = 'Give the speed of rotation as speed = "60 rpm" in [mechanism].'


def locate_rotation(
    log: EncoderLog,
    *,
    rotation: TurningDisc,
    zero: float = 0.0,
    triggers_per_cycle: int | None = None,
    bins: int | None = None,
) -> xr.Dataset:
    """Find angle and speed of a disc at each frame.

    Parameters
    ----------
    log : EncoderLog
        number (frame); angle (frame) [degree], time (frame) [s], angle_rate (frame) [degree/s],
        rotation_speed (frame) [rad s-1] and sliding_speed (frame) [m s-1] where they are known. A
        logged speed takes the place of that of the settings, and both of the slope of the angle.
    rotation : TurningDisc
    zero : float
        Angle of the disc at reading 0. [rad]
    triggers_per_cycle : int, optional
        Triggers in one turn. Default: each frame is a trigger.
    bins : int, optional
        Parts of a turn, each of which is one trigger.

    Returns
    -------
    xarray.Dataset
        On dim frame: trigger and cycle, counted from 0; sliding_speed [m s-1]; where the angle is
        logged, encoder_angle [degree] and crank_angle, that of the disc [degree, 0 to 360].

    Raises
    ------
    EncoderError
        If neither settings nor log give the speed, or frames of one trigger differ in angle.

    Examples
    --------
    A track of 20 mm radius at 10 rad/s:

    >>> log = EncoderLog(xr.Dataset({"number": ("frame", [0, 1])}))
    >>> locate_rotation(log, rotation=TurningDisc(0.02, 10.0)).sliding_speed.values
    array([0.2, 0.2])
    """
    require(log, "number")
    columns = _logged_columns(log)
    unusual: dict[str, str] = {}
    if "angle" in log:
        disc = (log.angle.values + math.degrees(zero)) % _TURN
        columns["crank_angle"] = (disc, "angle of the disc")
    if "sliding_speed" not in log:
        rate = np.abs(_choose_rate(log, rotation))
        speed = np.broadcast_to(rate * rotation.radius, log.sizes["frame"])
        columns["sliding_speed"] = (speed, "")
        unusual = _judge_rate(rate)
    located = _number_frames(log, columns, triggers_per_cycle, bins)
    return located.assign_attrs(unusual | _compare_rate(log, rotation.speed, "speed"))


def locate_slider(
    log: EncoderLog,
    *,
    slider: Sinusoid,
    zero: float | None = None,
    triggers_per_cycle: int | None = None,
    bins: int | None = None,
) -> xr.Dataset:
    """Find position and speed of a sinusoidal slider at each frame.

    The angle of its drive is 0 at mid-stroke, where the position rises with the angle. It is the
    logged angle plus `zero`; without a logged angle, 2 pi frequency time plus `zero`.

    Parameters
    ----------
    log : EncoderLog
        number (frame), and angle (frame) [degree] or time (frame) [s]; sliding_speed (frame)
        [m s-1] where it is logged, which takes the place of the computed one.
    slider : Sinusoid
    zero : float, optional
        Angle of the drive at reading 0, or at time 0; default: 0 for a logged angle. [rad]
    triggers_per_cycle, bins
        As for `locate_rotation`, of a cycle of the drive.

    Returns
    -------
    xarray.Dataset
        On dim frame: trigger and cycle, counted from 0; crank_angle, that of the drive [degree, 0
        to 360]; position from mid-stroke [mm]; stroke, +1 where the position rises and -1 where it
        falls; sliding_speed [m s-1]; encoder_angle where the angle is logged [degree].

    Raises
    ------
    EncoderError
        If the log has neither an angle nor, with `zero`, a time, or frames of one trigger differ in
        angle.

    Examples
    --------
    A stroke of 10 mm at 5 Hz passes mid-stroke at 0.157 m/s:

    >>> log = EncoderLog(xr.Dataset({"number": ("frame", [0, 1]), "angle": ("frame", [0.0, 90.0])}))
    >>> found = locate_slider(log, slider=Sinusoid(0.01, 5.0))
    >>> found.sliding_speed.values.round(3), found.position.values
    (array([0.157, 0.   ]), array([0., 5.]))
    """
    require(log, "number")
    logged, omega = _logged_columns(log), 2 * math.pi * slider.frequency
    if "angle" in log:
        drive = np.radians(log.angle.values) + (zero or 0.0)
    elif "time" in log and zero is not None:
        drive = omega * log.time.values + zero
    else:
        raise EncoderError(
            "Expected a column angle_deg with the angle of the drive, or a column time_s together "
            "with zero in [encoder], the angle of the drive at time 0: without them the position "
            "of the slider is not known. Add them, or leave [mechanism] out; the film then has no "
            "speed."
        )

    amplitude = slider.stroke / 2
    turned, position = np.degrees(drive) % _TURN, 1e3 * amplitude * np.sin(drive)
    speed = omega * amplitude * np.abs(np.cos(drive))

    # a drive that turns backwards passes mid-stroke the other way
    sense = -1 if "angle" in log and _angle_falls(log, np.degrees(drive)) else 1
    stroke = np.where(sense * np.cos(drive) >= 0, 1, -1).astype(np.int8)
    columns: FrameColumns = {
        "crank_angle": (turned, "angle of the drive, 0 at mid-stroke"),
        "position": (position, "position of the slider from mid-stroke"),
        "stroke": (stroke, "+1 position rising, -1 falling"),
        "sliding_speed": (speed, ""),
    }
    located = _number_frames(log, columns | logged, triggers_per_cycle, bins, _SLIDER)
    return located.assign_attrs(_compare_rate(log, omega, "frequency"))


def locate_logged(log: EncoderLog, *, triggers_per_cycle: int | None = None) -> xr.Dataset:
    """Number the frames of a run without a mechanism: a static film, or a logged speed.

    Parameters
    ----------
    log : EncoderLog
        number (frame); angle (frame) [degree] and sliding_speed (frame) [m s-1] where they are
        logged.
    triggers_per_cycle : int, optional
        Triggers in one cycle; 1 makes one trigger of all frames. Default: each frame is a trigger.

    Returns
    -------
    xarray.Dataset
        On dim frame: trigger and cycle, counted from 0; encoder_angle [degree] and sliding_speed
        [m s-1] where they are logged; stroke, the sign of the logged speed, where it changes.

    Raises
    ------
    EncoderError
        If frames of one trigger differ in angle.

    Examples
    --------
    Four frames of one film, averaged:

    >>> log = EncoderLog(xr.Dataset({"number": ("frame", np.arange(4))}))
    >>> locate_logged(log, triggers_per_cycle=1).trigger.values
    array([0, 0, 0, 0])
    """
    require(log, "number")
    columns = _logged_columns(log)
    if "sliding_speed" in log:
        signed = log.sliding_speed.values
        if signed.min() < 0 < signed.max():
            stroke = np.where(signed >= 0, 1, -1).astype(np.int8)
            columns["stroke"] = (stroke, "sign of the logged speed")
    return _number_frames(log, columns, triggers_per_cycle)


def _logged_columns(log: EncoderLog) -> FrameColumns:
    """Angle of the encoder and sliding speed, as far as they are logged."""
    columns: FrameColumns = {}
    if "angle" in log:
        columns["encoder_angle"] = (log.angle.values, "")
    if "sliding_speed" in log:
        speed = np.abs(log.sliding_speed.values)
        columns["sliding_speed"] = (speed, "sliding speed, logged")
    return columns


def _number_frames(
    log: EncoderLog,
    columns: FrameColumns,
    triggers_per_cycle: int | None,
    bins: int | None = None,
    dead_points: tuple[float, float] = _DISC,
) -> xr.Dataset:
    """The columns with trigger and cycle of each frame; without a request each is a trigger."""
    angle = np.asarray(columns["crank_angle"][0], float) if "crank_angle" in columns else None
    if bins is not None:
        if angle is None:
            raise EncoderError(
                "Expected a column angle_deg, because [encoder] averages the frames in bins of the "
                "angle; there is none. Log the angle, or remove bins."
            )
        fold = fold_by_phase(np.radians(angle), bins, dead_points, falling=_angle_falls(log, angle))
    else:
        # without a number of triggers all frames lie within one cycle
        per_cycle = triggers_per_cycle or log.sizes["frame"]
        fold = fold_by_number(log, angle if triggers_per_cycle else None, per_cycle)
    located = describe_frames(fold, columns, cycle="number of the cycle")
    remark = fold.remark or _compare_cycle(angle, triggers_per_cycle)
    return located.assign_attrs({"grouping": remark} if remark else {})


def _compare_cycle(angle: Array | None, triggers: int | None) -> str:
    """Remark that the triggers of a cycle span several turns; empty if they do not."""
    if angle is None or triggers is None or angle.size < 2:
        return ""
    turns = round(triggers * abs(float(np.median(_wrap(np.diff(angle))))) / _TURN)
    if turns < 2:
        return ""
    return (
        f"triggers_per_cycle = {triggers} spans {turns} turns, so that frames of one place lie in "
        f"{turns} triggers; {triggers / turns:.4g} would average them"
    )


def _angle_falls(log: EncoderLog, angle: Array) -> bool:
    """Whether the angle falls: by its rate, else by its steps where they are clearly backwards."""
    if "angle_rate" in log:
        return bool(np.median(log["angle_rate"].values) < 0)
    step = _wrap(np.diff(angle))
    return bool(step.size and -_LARGEST_STEP < np.median(step) < 0)


def _judge_rate(rate: float | Array) -> dict[str, str]:
    """A remark on a rate [rad/s] beyond those of discs on test rigs."""
    rpm = 60 * float(np.median(rate)) / (2 * math.pi)
    if not rpm or _USUAL_RPM[0] < rpm < _USUAL_RPM[1]:
        return {}
    text = f"the disc turns at {rpm:.3g} rpm, unlike those of test rigs"
    return {"contradiction": f"{text}. Correct speed, or the units of angle and time of the log"}


def _compare_rate(log: EncoderLog, given: float | None, key: str) -> dict[str, str]:
    """Compare the given rate [rad/s] with angle and time of the log; a remark if they differ."""
    logged = {"sliding_speed", "rotation_speed"} & set(log)
    if given is None or logged or not {"angle", "time"} <= set(log) or log.sizes["frame"] < 2:
        return {}

    # frames that lie more than half a turn apart show the rest of a turn, of either sense
    turn, time = np.diff(log.angle.values), np.diff(log.time.values)
    expected = abs(math.degrees(given)) * time
    if expected.min() <= 0:
        return {}
    rest = np.abs([_wrap(turn - expected), _wrap(turn + expected)])
    if np.median(rest, axis=1).min() < _OFF_RATE * np.median(expected):
        return {}

    # of the speeds that leave the same readings the log shows the slowest
    rate = float(np.median(np.abs(_wrap(turn)) / time))
    found, stated = rate / _TURN, abs(given) / (2 * math.pi)
    unit, per = ("rpm", 60.0) if key == "speed" else ("Hz", 1.0)
    text = (
        f"{key} is {per * stated:.4g} {unit}, but angle and time of the log give "
        f"{per * found:.4g} {unit}: the sliding speed is {stated / found:.3g} times theirs"
        if found
        else f"{key} is {per * stated:.4g} {unit}, but the angle of the log stands still"
    )
    return {"contradiction": f"{text}. Correct it, or the columns of the log"}


def _wrap(angle: Array) -> Array:
    """Angles from -180 to 180. [degree]"""
    return np.asarray((angle + _TURN / 2) % _TURN - _TURN / 2)


def _choose_rate(log: EncoderLog, rotation: TurningDisc) -> float | Array:
    """Speed of rotation as logged, as given, or as the angle changes. [rad/s]"""
    if "rotation_speed" in log:
        return np.asarray(log.rotation_speed.values)
    if rotation.speed is not None:
        return rotation.speed
    if "angle_rate" in log:  # of a continuous log, from the rows about each frame
        return np.asarray(np.radians(log.angle_rate.values))
    return _rate_of_frames(log)


def _rate_of_frames(log: EncoderLog) -> Array:
    """Speed of rotation at each frame, from the angles and times of the frames. [rad/s]"""
    if "angle" not in log or "time" not in log or log.sizes["frame"] < 2:
        raise EncoderError(
            "Expected the speed of rotation in [mechanism], or the columns angle_deg and time_s in "
            f"the encoder log to compute it from. {_GIVE_SPEED}"
        )

    # an encoder that counts on beyond a turn has no jumps; any other is below one turn
    angle, time = log.angle.values, log.time.values
    step = np.diff(angle)
    if np.ptp(angle) <= _TURN:
        step = _wrap(step)
        if np.abs(step).max() > _LARGEST_STEP:
            worst = int(np.argmax(np.abs(step)))
            raise EncoderError(
                f"Expected less than {_LARGEST_STEP:g} deg from frame to frame, from which the "
                f"speed of rotation follows; from frame {int(log.number[worst])} to the next the "
                f"logged angle turns by {step[worst]:.1f} deg, which may be whole turns more. "
                f"{_GIVE_SPEED}"
            )
    if not np.all(np.diff(time) > 0):
        raise EncoderError(
            "Expected column time_s to rise from frame to frame, to compute the speed of rotation "
            f"from it and angle_deg; it does not. Correct the times. {_GIVE_SPEED}"
        )
    if not np.any(step):
        raise EncoderError(
            "Expected the logged angle to change as the disc turns; it is the same in all frames, "
            f"as with one trigger in a turn. {_GIVE_SPEED}"
        )

    turned = np.radians(angle[0] + np.concatenate([[0.0], np.cumsum(step)]))
    return np.asarray(np.gradient(turned, time))
