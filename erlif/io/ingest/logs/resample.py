"""A continuous log at the times of the frames."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import xarray as xr

from erlif.core.arrays import Array
from erlif.core.errors import EncoderError
from erlif.core.products import EncoderLog
from erlif.core.statistics import robust_rms

# Time without rows, in usual steps, across which nothing is interpolated.
LONGEST_GAP = 10.0

# Change of the angle over which its direction is taken, in standard deviations of a reading.
SLOPE_NOISE = 10.0

# Rows of a log in time below which no motion can be seen.
FEWEST_SAMPLES = 4

_TURN = 360.0


@dataclass(frozen=True)
class ContinuousLog:
    """A log in time, not yet at the frames.

    Attributes
    ----------
    file : str
        Name of the file, for messages.
    samples : xr.Dataset
        On dim sample: time [s, rising], angle [degree, counted on beyond a turn], and the other
        columns.
    """

    file: str
    samples: xr.Dataset

    @property
    def span(self) -> tuple[float, float]:
        """First and last time. [s]"""
        time = self.samples["time"].values
        return float(time[0]), float(time[-1])


def unwrap_angle(angle: Array, file: str) -> Array:
    """Angles of a continuous log, counted on where the encoder starts again at 0.

    Parameters
    ----------
    angle : array, (sample,)
        [degree]
    file : str
        Name of the file, for messages.

    Returns
    -------
    array, (sample,)
        [degree]

    Raises
    ------
    EncoderError
        If the reading jumps by more than a turn and a half: a counter has overflowed.

    Examples
    --------
    >>> unwrap_angle(np.array([358.0, 359.5, 1.0]), "log.csv")
    array([358. , 359.5, 361. ])
    """
    jump = np.abs(np.diff(angle))
    if jump.size and jump.max() > 1.5 * _TURN:
        n = int(np.argmax(jump)) + 1
        before, after = angle[n - 1], angle[n]
        raise EncoderError(
            f"Expected the encoder to move on or to start again after a turn; {file} jumps from "
            f"{before:.2f} to {after:.2f} deg between values {n} and {n + 1}. Check ticks_per_turn "
            "in [encoder], or take out the rows before the counter was reset."
        )
    return np.asarray(np.unwrap(angle, period=_TURN))


def find_pulses(log: ContinuousLog, signal: Array, frames: int) -> Array:
    """Times of the frames from a column with the trigger of the cameras.

    Parameters
    ----------
    log : ContinuousLog
    signal : array, (sample,)
        A voltage that rises once for each frame, or a count of the frames.
    frames : int
        Number of frames.

    Returns
    -------
    array, (frame,)
        The middle between the two rows of each rise. [s]

    Raises
    ------
    EncoderError
        If the signal does not rise once for each frame.
    """
    times = find_rises(log, signal)
    if times.size != frames:
        where = f", from {times[0]:.6g} to {times[-1]:.6g} s" if times.size else ""
        raise EncoderError(
            f"Expected one pulse for each frame in {log.file}; it has {times.size} pulses{where}, "
            f"the cameras have {frames} frames each. Take out the frames or the rows before the "
            "first common pulse, or choose another column as pulse in [encoder]."
        )
    return times


def find_rises(log: ContinuousLog, signal: Array) -> Array:
    """Times at which a signal rises, or counts one more; as `find_pulses`, for any number of them.

    Examples
    --------
    >>> rows = xr.Dataset({"time": ("sample", [0.0, 1.0, 2.0, 3.0])})
    >>> find_rises(ContinuousLog("log.csv", rows), np.array([0.0, 5.0, 0.0, 5.0]))
    array([0.5, 2.5])
    """
    low, high = float(signal.min()), float(signal.max())
    is_count = np.array_equal(signal, np.round(signal)) and bool((np.diff(signal) >= 0).all())
    if is_count and high - low > 1:
        rises = np.flatnonzero(np.diff(signal) > 0)
        jump = np.flatnonzero(np.diff(signal)[rises] > 1)
        if jump.size:
            n = int(rises[jump[0]]) + 1
            when = log.samples["time"].values[n]
            raise EncoderError(
                f"Expected the count of frames in {log.file} to rise by one; it rises from "
                f"{signal[n - 1]:g} to {signal[n]:g} at {when:.6g} s. Log faster than the cameras "
                "record."
            )
    else:
        above = signal > (low + high) / 2
        rises = np.flatnonzero(~above[:-1] & above[1:])

    time = log.samples["time"].values
    return np.asarray((time[rises] + time[rises + 1]) / 2)


def sample_log(log: ContinuousLog, times: Array) -> EncoderLog:
    """Take a continuous log at the times of the frames.

    Angle and other numbers are interpolated linearly; a text is that of the row before.

    Parameters
    ----------
    log : ContinuousLog
    times : array, (frame,)
        Times of the frames on the clock of the log. [s]

    Returns
    -------
    EncoderLog
        Also angle_rate (frame), the slope of the angle over the rows about each frame [degree/s].

    Raises
    ------
    EncoderError
        If frames lie outside the log or in a gap of it.

    Examples
    --------
    >>> rows = xr.Dataset({"time": ("sample", [0.0, 1.0, 2.0, 3.0]),
    ...                    "angle": ("sample", [0.0, 10.0, 20.0, 30.0])})
    >>> log = sample_log(ContinuousLog("log.csv", rows), np.array([0.5, 2.25]))
    >>> log.angle.values, log.angle_rate.values
    (array([ 5. , 22.5]), array([10., 10.]))
    """
    time = log.samples["time"].values
    _check_inside(log, times)

    sampled = xr.Dataset({"number": ("frame", np.arange(times.size))})
    before = np.clip(np.searchsorted(time, times, side="right") - 1, 0, time.size - 2)
    for name, column in log.samples.items():
        values = column.values
        if name == "time":
            values = times
        elif values.dtype.kind in "fiu":
            values = np.interp(times, time, values)
        else:
            values = values[before]
        sampled[name] = ("frame", values, column.attrs)

    if "angle" in log.samples:
        rate = _slopes(time, log.samples["angle"].values, times)
        attrs = {"units": "degree s-1", "long_name": "rate of the encoder angle"}
        sampled["angle_rate"] = ("frame", rate, attrs)
    return EncoderLog(sampled)


def _check_inside(log: ContinuousLog, times: Array) -> None:
    """Refuse frames before, after and in a gap of the log."""
    first, last = log.span
    outside = np.flatnonzero((times < first) | (times > last))
    if outside.size:
        k = int(outside[0])
        raise EncoderError(
            f"Expected all frames within the log {log.file}, {first:.6g} to {last:.6g} s; frame "
            f"{k} is at {times[k]:.6g} s, the last one at {times[-1]:.6g} s ({outside.size} "
            "outside). Correct start or frame_rate in [encoder], or take these frames out."
        )

    time = log.samples["time"].values
    step = np.diff(time)
    place = np.clip(np.searchsorted(time, times, side="right") - 1, 0, step.size - 1)
    on_row = (times == time[place]) | (times == time[place + 1])
    in_gap = np.flatnonzero((step[place] > LONGEST_GAP * np.median(step)) & ~on_row)
    if in_gap.size:
        k = int(in_gap[0])
        start, end = time[place[k] : place[k] + 2]
        raise EncoderError(
            f"Expected rows about every frame in {log.file}; it has none from {start:.6g} to "
            f"{end:.6g} s, where frame {k} was taken. Take out the frames of this gap "
            f"({in_gap.size}), or record again."
        )


def _slopes(time: Array, angle: Array, times: Array) -> Array:
    """Slope of the angle about each time, over enough rows to exceed the noise. [degree/s]"""
    # noise from second differences, which a smooth motion leaves near zero
    noise = robust_rms(np.diff(angle, 2)) / np.sqrt(6)
    usual = float(np.sqrt(np.mean(np.diff(angle) ** 2)))
    rows = 1 if usual == 0 else int(np.ceil(max(1.0, SLOPE_NOISE * noise / usual)))

    middle = np.searchsorted(time, times)
    low = np.clip(middle - rows, 0, time.size - 2)
    high = np.clip(middle + rows - 1, low + 1, time.size - 1)
    return np.asarray((angle[high] - angle[low]) / (time[high] - time[low]))
