"""Angles, times, temperature, load and pulse energy of a log, against the mechanism of run.toml."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr

from erlif.core.arrays import Array
from erlif.core.notes import Note, remark, warn
from erlif.core.products import EncoderLog
from erlif.core.units import count_of, parse_quantity
from erlif.io.settings import RunSettings
from erlif.pipeline.recording.pulses import read_energies

_FEWEST = 8  # rows from which on steps are compared

_FEWEST_BY_CRANK = 12  # rows from which on the place of the encoder is judged

_TO_AND_FRO = 0.1  # of the way in one direction that is gone in the other, on a rocker

_GAP = 1.7  # step over that of its neighbours from which a trigger is missing; 2 for one trigger

# Relative difference of the two steps on either side that are compared with one in between.
_EVEN = 0.1

_SPEED = 0.05  # relative deviation of the speed by the log from that of run.toml that is reported

_STROBE = 0.8  # length of the mean of directions from which these are one; 0 for chance

_STUCK = 3  # equal angles in a row from which the encoder stood still; a dead point leaves two

_PAUSE = 20.0  # time step over the median one from which the recording paused

_OIL = (-40.0, 150.0)  # temperature of the oil of a test rig [degree_Celsius]

_JUMP = 10.0  # change of temperature from row to row that no oil has [K]

# Factor between the load of the log and that of run.toml from which a unit is wrong; 4.4 between
# pounds and newtons.
_LOAD = 3.0

# Units in which loads are logged.
_FORCES = ("kN", "kgf", "lbf", "mN", "gf")

# Change of the light per change of the pulse energy below which they are unrelated; 1 else.
_WITHOUT_PULSE = 0.3


@dataclass(frozen=True)
class Steps:
    """Encoder angle and time of each frame pair, as the log holds them.

    Attributes
    ----------
    angle : Array | None
        Encoder angle, (frame,). [degree]
    time : Array | None
        (frame,). [s]
    """

    angle: Array | None
    time: Array | None

    @classmethod
    def of(cls, log: EncoderLog) -> Steps:
        """Angles and times of a log."""
        angle = np.asarray(log.angle.values, float) if "angle" in log else None
        time = np.asarray(log["time"].values, float) if "time" in log else None
        return cls(angle, time)


def signed_steps(angle: Array) -> Array:
    """Steps of an encoder that may start again at 0.

    Parameters
    ----------
    angle : array, (row,)
        [degree]

    Returns
    -------
    array, (row - 1,)
        From -180 to 180. [degree]

    Examples
    --------
    >>> signed_steps(np.array([350.0, 5.0, 2.0]))
    array([15., -3.])
    """
    return np.asarray((np.diff(angle) + 180.0) % 360.0 - 180.0)


def note_mounting(log: EncoderLog, settings: RunSettings) -> Iterator[Note]:
    """Warn of an encoder that is stated to be on the crank but swings."""
    angle, encoder = Steps.of(log).angle, settings.encoder
    if settings.linkage is None or encoder is None or encoder.mounted_on != "crank":
        return
    if angle is None or angle.size < _FEWEST_BY_CRANK or np.ptp(angle) >= 180.0:
        return
    step = signed_steps(angle)
    ways = sorted((float(step[step > 0].sum()), -float(step[step < 0].sum())))
    if ways[0] > _TO_AND_FRO * ways[1]:
        yield warn(
            "encoder",
            f"it is stated to be on the crank, but goes to and fro from {angle.min():.1f} to "
            f'{angle.max():.1f} deg: speed and theory are wrong. Set mounted_on = "rocker" in '
            "[encoder]",
        )


def note_motion(log: EncoderLog, located: xr.Dataset, settings: RunSettings) -> Iterator[Note]:
    """Steps of angle and time against each other and against the mechanism."""
    yield from note_angles(log)
    yield from _note_times(Steps.of(log).time)
    yield from note_speed(log, located, settings)


def note_angles(log: EncoderLog) -> Iterator[Note]:
    """Note range and steps of the angle; warn of jumps and of an encoder that stands still."""
    angle = Steps.of(log).angle
    if angle is None or angle.size < _FEWEST:
        return
    signed = signed_steps(angle)
    step = np.abs(signed)
    turns = int(np.count_nonzero(np.diff(np.sign(signed[step > 0]))))
    low, high, most = angle.min(), angle.max(), step.max()
    reversals = count_of(turns, "reversal")
    yield remark(
        "motion",
        f"angle from {low:.2f} to {high:.2f} deg in steps of {np.median(step):.3g} deg (median), "
        f"{most:.3g} deg at most; {reversals}",
    )

    # a trigger is missed among even steps; where an encoder turns unevenly from trigger to trigger,
    # the steps change by themselves
    beside = np.stack([np.roll(step, shift) for shift in (-2, -1, 1, 2)])[:, 2:-2]
    usual = np.median(beside, axis=0)
    even = (np.abs(beside - usual) <= _EVEN * usual).all(axis=0)
    gaps = 2 + np.flatnonzero(even & (step[2:-2] > _GAP * usual))
    if gaps.size:
        shown = ", ".join(f"{k} and {k + 1} ({step[k]:.3g} deg)" for k in gaps[:5])
        yield warn(
            "motion",
            f"the angle jumps between frames {shown}: a trigger was missed, or rows of the log "
            "are out of place. Compare the log with the frames there",
        )

    still = step == 0
    runs = np.convolve(still, np.ones(_STUCK - 1), "valid") == _STUCK - 1
    if runs.any():
        first = int(np.argmax(runs))
        yield warn(
            "motion",
            f"the angle stays at {angle[first]:g} deg in frames {first} to {first + _STUCK - 1} "
            "and perhaps longer: the encoder or its logger was stuck. Check the cable, and leave "
            "these frames out",
        )


def _note_times(time: Array | None) -> Iterator[Note]:
    """Note range and steps of the time; warn of pauses."""
    if time is None or time.size < _FEWEST:
        return
    step = np.diff(time)
    usual = float(np.median(step))
    low, high = step.min(), step.max()
    yield remark(
        "motion",
        f"time from {time[0]:.6g} to {time[-1]:.6g} s, steps of {usual:.3g} s (median), {low:.3g} "
        f"to {high:.3g} s",
    )
    pauses = np.flatnonzero(step > _PAUSE * usual)
    if pauses.size:
        shown = ", ".join(f"{k} and {k + 1} ({step[k]:.3g} s)" for k in pauses[:5])
        yield warn(
            "motion",
            f"the recording pauses between frames {shown}. Check whether the rig stood still or "
            "frames are missing",
        )


def note_speed(log: EncoderLog, located: xr.Dataset, settings: RunSettings) -> Iterator[Note]:
    """Speed of the crank by angles and times against that of run.toml."""
    time = Steps.of(log).time
    if time is None or time.size < _FEWEST:
        return
    if settings.linkage is None or "crank_angle" not in located:
        return
    turned = np.diff(located.crank_angle.values) % 360.0
    stated = float(np.degrees(settings.linkage.crank_speed)) / 6.0

    # a slow camera sees the crank some turns later; the rest of a turn shows its speed
    expected = 6.0 * stated * np.diff(time)
    if np.median(expected) > 180.0:
        apart = np.exp(1j * np.radians(turned - expected))
        if abs(apart.mean()) > _STROBE and apart.mean().real > 0:
            return
    # a step above half a turn may be one backwards
    moved = (turned > 0.1) & (turned < 180.0)
    if moved.sum() < _FEWEST // 2:
        return

    # the median does not depend on the error of a reading near a dead point, nor on a wrong one
    speed = float(np.median(turned[moved] / np.diff(time)[moved])) / 6.0
    yield remark(
        "motion",
        f"the crank turns at {speed:.4g} rpm by angles and times, {stated:.4g} rpm in run.toml",
        "Correct crank_speed, or the unit of the column of time"
        if abs(speed / stated - 1) > _SPEED
        else "",
    )


def note_conditions(log: EncoderLog, settings: RunSettings) -> Iterator[Note]:
    """Temperature and load of the log."""
    if "temperature" in log:
        values = np.asarray(log["temperature"].values, float)
        low, high, jumps = values.min(), values.max(), np.abs(np.diff(values))
        if low < _OIL[0] or high > _OIL[1]:
            yield warn(
                "conditions",
                f"temperature {low:.1f} to {high:.1f} degC, no oil of a rig has that. Correct the "
                'unit, units = { temperature = "degF" } in [encoder], or the column',
            )
        elif jumps.max(initial=0.0) > _JUMP:
            k = int(np.argmax(jumps))
            yield warn(
                "conditions",
                f"temperature {low:.1f} to {high:.1f} degC, it changes by {jumps[k]:.1f} K from "
                f"frame {k} to {k + 1}. Check the sensor and its cable",
            )
        else:
            yield remark("conditions", f"temperature {low:.1f} to {high:.1f} degC")

    if "joint_load" in log:
        values = np.asarray(log["joint_load"].values, float)
        low, high, joint = values.min(), values.max(), settings.joint
        stated = None if joint is None else joint.load
        factor = 1.0 if stated is None else float(np.median(values)) / stated
        if 1 / _LOAD < factor < _LOAD:
            yield remark("conditions", f"load {low:.4g} to {high:.4g} N")
        else:
            yield warn(
                "conditions",
                f"load {low:.4g} to {high:.4g} N, {factor:.2g} times the load in [joint], "
                f'{stated:.4g} N. Correct the unit, units = {{ load = "{_likeliest_unit(factor)}" '
                "} in [encoder], or the load in [joint]",
            )


def _likeliest_unit(factor: float) -> str:
    """The unit of a force in which a load has so many times its number in N."""
    return min(_FORCES, key=lambda unit: abs(np.log(factor * parse_quantity(f"1 {unit}", "N"))))


def note_energy(log: EncoderLog, frames: Sequence[int], light: Array) -> Iterator[Note]:
    """Pulse energy of the log against the light of consecutive frames."""
    energies = read_energies(log)
    numbers = np.asarray(frames)
    if energies is None or numbers.size < _FEWEST or (np.diff(numbers) != 1).any():
        return
    if not (light > 0).all() or energies[numbers].min() <= 0:
        return

    # the film changes slowly; second differences leave what is new in every pulse
    x = np.diff(np.log(energies[numbers]), n=2)
    y = np.diff(np.log(light).mean(axis=1), n=2)
    scatter = float((x * x).sum())
    if scatter == 0:
        return
    slope = float((x * y).sum()) / scatter
    std = float(np.sqrt(((y - slope * x) ** 2).sum() / max(x.size - 2, 1) / scatter))
    yield remark(
        "conditions",
        f"the light changes by {slope:.2f} ± {std:.2f} % per % of the pulse energy of the log",
        "The energies belong to other pulses: check the column and its first row"
        if slope + 3 * std < _WITHOUT_PULSE
        else "",
    )
