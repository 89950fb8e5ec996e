"""The motion of the joint from the first frame to the last, in the steps of the solver."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import xarray as xr

from erlif.core.arrays import Array
from erlif.core.errors import EncoderError
from erlif.core.products import require
from erlif.kinematics.folding import crank_steps
from erlif.models.mechanism import CrankRocker
from erlif.models.reynolds import Motion

# Steps of a turn of the crank, for the film within 0.1 %, beside one for every frame. A run of many
# turns has fewer; with the fewest, a guided film is within 2 % near a dead point
# (docs/prediction.md).
STEPS_PER_CYCLE, FEWEST_STEPS = 50, 24

# Steps of a run from which a turn has fewer of them, and from which it is refused.
MANY_STEPS, MOST_STEPS = 5_000, 40_000

# Rms deviation from the link angles of a crank at constant speed, in parts of the swing, up to
# which the crank is taken as one.
STEADY_CRANK = 0.02

# Whole turns between most frames, from which their times must be those of an even crank.
_WHOLE = 0.9

_TURN = 2 * math.pi


@dataclass(frozen=True)
class FrameMotion:
    """Motion of the joint under its load, and the steps at which the frames were taken.

    Attributes
    ----------
    motion : Motion
        Times from the first frame on, rotation of the bushing and load.
    steps : numpy.ndarray
        Step of each frame. (frame,)
    crank : Array
        Crank angle, counted on from turn to turn. (step,) [rad]
    viscosity : float
        Viscosity to which the times are scaled, that of the frames in the mean. [Pa s]
    lead : Motion | None
        One turn of the crank before the first frame, at the mean crank speed and the first load,
        with times from zero; its end is the first frame. None where it is not known.
    """

    motion: Motion
    steps: npt.NDArray[np.int64]
    crank: Array
    viscosity: float
    lead: Motion | None = None

    def with_lead(self) -> FrameMotion:
        """Prepend the lead, in which cavities form before the first frame, to the motion."""
        lead, own = self.lead, self.motion
        assert lead is not None  # `follow_motion` has made one
        before = lead.time.size - 1
        whole = Motion(
            np.append(lead.time[:-1], lead.time[-1] + own.time),
            np.append(lead.angle[:-1], own.angle),
            np.append(lead.load[:-1], own.load),
        )
        turn = self.crank[0] + _TURN * (np.arange(before) / before - 1)
        return FrameMotion(whole, self.steps + before, np.append(turn, self.crank), self.viscosity)

    @property
    def cycles(self) -> Array:
        """Turns of the crank since the first frame, at each frame. (frame,)"""
        turned = self.crank[self.steps] - self.crank[0]
        return np.asarray(turned / _TURN)


def follow_motion(
    frames: xr.Dataset,
    linkage: CrankRocker,
    *,
    crank_speed: float,
    viscosity: Array | float,
    direction: int = 1,
) -> FrameMotion:
    """Follow the bushing from the first frame to the last.

    Times are those of the log where they rise, else they follow from the turns of the crank. A
    crank whose logged times fit one speed turns at that speed; another one turns evenly from frame
    to frame. Where the viscosity changes, the times are scaled by its inverse: without entrainment
    the film is a function of the integral of dt / viscosity alone.

    Parameters
    ----------
    frames : xarray.Dataset
        In the order of the recording: crank_angle [degree], cycle and load [N]; time [s] where it
        is logged; dim frame.
    linkage : CrankRocker
        Its rocker turns the bushing.
    crank_speed : float
        As set. [rad s-1]
    viscosity : array, (frame,), or float
        [Pa s]
    direction : int
        +1 where the bushing moves along image x while the rocker angle rises, -1 where against it.

    Returns
    -------
    FrameMotion

    Raises
    ------
    EncoderError
        If the frames were taken at one time, over too many turns, or at times that no crank of this
        speed has.

    Examples
    --------
    Three frames, a quarter of a turn apart:

    >>> rig = CrankRocker(0.055, 0.44, 0.26, 0.51)
    >>> frames = xr.Dataset({"crank_angle": ("frame", [350.0, 80.0, 170.0]),
    ...                      "cycle": ("frame", [0, 0, 0]), "joint_load": ("frame", [222.4] * 3)})
    >>> moved = follow_motion(frames, rig, crank_speed=10.0, viscosity=0.12)
    >>> moved.steps.tolist(), round(float(moved.motion.time[-1]), 4)
    ([0, 13, 26], 0.3142)
    """
    require(frames, "crank_angle", "cycle", "joint_load")
    time, crank = _clock(frames, linkage, crank_speed)
    nodes, steps = np.unique(time, return_inverse=True)
    if nodes.size < 2:
        raise EncoderError(
            "Expected two or more frames at different crank angles, between which the film "
            "changes; all were taken at one. Record frames over the cycle."
        )

    # a frame is a step, and between frames no step is longer than that of an even cycle
    turned = np.interp(nodes, time, crank)
    turns = float(np.ptp(turned)) / _TURN
    per_turn = min(STEPS_PER_CYCLE, max(MANY_STEPS / max(turns, 1.0), FEWEST_STEPS))
    parts = np.ceil(np.diff(turned) / _TURN * per_turn - 1e-6)
    parts = np.maximum(parts, 1).astype(np.int64)
    if parts.sum() > MOST_STEPS:
        raise EncoderError(
            f"Expected a recording of at most {MOST_STEPS // FEWEST_STEPS} turns of the crank for "
            f"the prediction; it covers {turns:.0f}. Use runs of fewer turns."
        )
    place = np.concatenate([[0], np.cumsum(parts)])
    at = np.interp(np.arange(place[-1] + 1), place, nodes)
    fine = np.interp(at, nodes, turned)

    middle = float(np.mean(linkage.limits()))
    angle = direction * (np.asarray(linkage.rocker_angle(fine)) - middle)
    load = np.interp(at, time, frames["joint_load"].values)
    mean, since = scaled_time(at, time, np.broadcast_to(viscosity, time.shape))
    motion = Motion(since, angle=angle, load=load)

    # the turn before, by which a held pin has its cavities
    before = fine[0] + _TURN * np.linspace(-1.0, 0.0, math.ceil(per_turn) + 1)
    earlier = direction * (np.asarray(linkage.rocker_angle(before)) - middle)
    period = _TURN * float(since[-1]) / float(fine[-1] - fine[0])
    lead = Motion(np.linspace(0.0, period, before.size), angle=earlier, load=float(load[0]))
    return FrameMotion(motion, place[steps], fine, mean, lead)


def _clock(frames: xr.Dataset, linkage: CrankRocker, crank_speed: float) -> tuple[Array, Array]:
    """Time since the first frame, rising, and crank angle counted on. [s; rad]"""
    crank = np.radians(frames.crank_angle.values.astype(float))
    time = frames["time"].values.astype(float) if "time" in frames else None
    if time is None or not (np.diff(time) > 0).all():
        # noise about a dead point may hold the crank
        missed = np.maximum(np.diff(frames["cycle"].values) - 1, 0)
        steps = crank_steps(crank) + _TURN * missed
        turned = np.maximum.accumulate(crank[0] + np.concatenate([[0.0], np.cumsum(steps)]))
        return (turned - turned[0]) / crank_speed, turned

    # between two frames the crank turns by whole turns more, as many as fit its speed best
    time = time - time[0]
    step = np.diff(crank)
    step += _TURN * np.rint((crank_speed * np.diff(time) - step) / _TURN)
    turned = crank[0] + np.concatenate([[0.0], np.cumsum(step)])
    even = _even_turning(time, turned, linkage)

    # a camera may show every tenth turn; then its times fit that
    added = float(np.median(np.diff(turned) - np.diff(crank) % _TURN)) / _TURN
    if even is None and added > _WHOLE:
        raise EncoderError(
            "Expected times of a crank at crank_speed; from frame to frame it would turn by "
            f"{added:.3g} whole turns more than the angles show, and they do not follow it. "
            "Correct crank_speed, or the unit of the times."
        )
    return time, np.maximum.accumulate(turned) if even is None else even


def _even_turning(time: Array, turned: Array, linkage: CrankRocker) -> Array | None:
    """The crank at constant speed through the frames; None where it turns unevenly. [rad]"""
    if time.size < 2:
        return None
    # near a dead point the angle of the rocker hardly determines that of the crank
    weight = np.abs(np.asarray(linkage.rocker_speed(turned, crank_speed=1.0))) + 1e-3
    speed, start = np.polyfit(time, turned, 1, w=weight)
    even = start + speed * time
    low, high = linkage.limits()
    off = np.asarray(linkage.rocker_angle(even)) - np.asarray(linkage.rocker_angle(turned))
    if speed <= 0 or math.sqrt(float(np.mean(off**2))) > STEADY_CRANK * (high - low):
        return None
    return np.asarray(even)


def scaled_time(at: Array, time: Array, viscosity: Array) -> tuple[float, Array]:
    """Mean viscosity, and time rescaled so that the film moves as at this viscosity.

    Parameters
    ----------
    at : array, (step,)
        Times, rising. [s]
    time : array, (frame,)
        Times of the viscosities. [s]
    viscosity : array, (frame,)
        [Pa s]

    Returns
    -------
    mean : float
        Of the frames. [Pa s]
    since : array, (step,)
        Integral of dt over the relative viscosity. [s]

    Examples
    --------
    >>> scaled_time(np.array([0.0, 1.0, 2.0]), np.array([0.0, 2.0]), np.array([0.1, 0.1]))
    (0.1, array([0., 1., 2.]))
    """
    mean = float(viscosity.mean())
    if np.ptp(viscosity) == 0:
        return mean, at - at[0]
    rate = mean / np.interp(at, time, viscosity)
    since = np.cumsum(0.5 * (rate[1:] + rate[:-1]) * np.diff(at))
    return mean, np.concatenate([[0.0], since])
