"""The path of a guided pin where no trigger was recorded: predicted, and joined to positions."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from erlif.core.arrays import Array
from erlif.core.errors import ModelError
from erlif.core.statistics import covariance_root
from erlif.models.reynolds import Journal
from erlif.prediction.comparison import DESCRIBED
from erlif.prediction.fit import fit_motion
from erlif.prediction.given import GivenErrors
from erlif.prediction.measured import MeasuredMotion
from erlif.prediction.motion import FrameMotion
from erlif.prediction.pin_motion import PinMotion, find_pin_motion

# Part of a turn without a trigger above which cavities close and open unseen.
LARGEST_GAP = 0.05

# Longest gap that a predicted motion fills, over a turn.
MOST_FILLED = 0.15

_PLACE = slice(2)  # the displacements among the numbers of a position


def find_motion_in_gaps(
    journal: Journal,
    moved: FrameMotion,
    *,
    time: Array,
    turning: Array,
    position: Array,
    random_cov: Array,
    surface_cov: Array,
    gradient: Array,
    calibration_cov: Array,
    load_line_std: float | None = None,
) -> PinMotion | None:
    """Find the motion of a guided pin at its triggers, and at moments in the gaps between them.

    The transient film of a guided pin is fitted to the positions. In a gap the pin moves as this
    predicts, and linearly by what the prediction misses at both ends. An error of it is the
    difference from the smooth path through the triggers alone, and what the prediction misses at
    all triggers (rms).

    Parameters
    ----------
    journal : Journal
        With the expected viscosity.
    moved : FrameMotion
        Of one turn: its frames are the triggers, and the first of them a turn later.
    time : array, (frame,)
        Times of the frames, as logged. [s]
    turning, position, random_cov, surface_cov, gradient, calibration_cov
        As for `find_pin_motion`, (trigger, ...).
    load_line_std : float, optional
        Of a given load line; by default the line is fitted. [m]

    Returns
    -------
    PinMotion or None
        With `recorded` and `otherwise`. None where a gap is longer than `MOST_FILLED`, or where the
        film of a guided pin does not describe the positions.

    Raises
    ------
    ModelError
        As `find_pin_motion`.
    """
    period, gaps = float(time[-1] - time[0]), np.diff(time)
    if gaps.max() > MOST_FILLED * period:
        return None

    # marks and calibration are the same at all triggers
    marks = covariance_root(surface_cov.mean(axis=0)[_PLACE, _PLACE])
    calibration = gradient[:, _PLACE] @ covariance_root(calibration_cov)
    shared = [calibration, np.tile(marks, (len(position), 1, 1))]
    measured = MeasuredMotion(
        position[:, _PLACE], random_cov[:, _PLACE, _PLACE], np.concatenate(shared, axis=2)
    )
    trigger = np.full(moved.motion.time.size, -1)
    trigger[moved.steps[:-1]] = np.arange(len(position))
    try:
        fit = fit_motion(
            measured,
            journal,
            replace(moved, steps=np.arange(trigger.size)),
            trigger=trigger,
            sideways="guided",
            given=GivenErrors(load_line=load_line_std),
            profiles=False,
        )
    except ModelError:
        return None
    if fit.inflation > DESCRIBED:
        return None

    # steps in the gaps, and the triggers; those of the motion follow the oil, not the clock
    within = np.repeat(gaps > LARGEST_GAP * period, np.diff(moved.steps))
    moments = np.flatnonzero((trigger[:-1] >= 0) | within)
    clock = np.interp(np.arange(trigger.size), moved.steps, time)
    recorded = trigger[moments] >= 0
    speed = np.gradient(moved.motion.angle, clock)[moments]
    speed[recorded] = turning
    bushing = clock[moments], np.asarray(moved.motion.angle)[moments], speed
    errors = {"random_cov": random_cov, "surface_cov": surface_cov, "gradient": gradient}
    find: Callable[..., PinMotion] = partial(
        find_pin_motion, calibration_cov=calibration_cov, period=period
    )
    alone = find(*(one[recorded] for one in bushing), position, **errors)
    smooth, rate = alone.at(bushing[0])

    def spread(values: Array) -> Array:
        """Values of the triggers at all moments, linear between them."""
        flat = values.reshape(len(values), -1).T
        each = [np.interp(bushing[0], bushing[0][recorded], one) for one in flat]
        return np.stack(each, axis=1).reshape(-1, *values.shape[1:])

    predicted = fit.frames[moments]
    filled = spread(position)
    missed = position[:, _PLACE] - predicted[recorded]
    filled[:, _PLACE] = predicted + spread(missed)
    doubt = np.zeros_like(filled)  # no tilt is predicted
    doubt[:, _PLACE] = np.hypot((filled - smooth)[:, _PLACE], missed.std(axis=0))
    doubt[recorded] = 0.0
    errors = {name: spread(values) for name, values in errors.items()}
    errors["random_cov"] += doubt[:, :, np.newaxis] ** 2 * np.eye(doubt.shape[1])
    found = find(*bushing, filled, **errors)
    return replace(found, recorded=recorded, otherwise=replace(found, position=smooth, rate=rate))
