"""Channels of NI TDMS files, those of several tasks at common times."""

from __future__ import annotations

import io
import logging
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from erlif.core.arrays import AnyArray
from erlif.core.errors import EncoderError
from erlif.io.ingest.logs.table import check_cells

_SECOND = np.timedelta64(1, "s")

_ROUNDING = 1e-6  # of starts in steps

# Name, numbers and properties of a channel.
TdmsChannel = tuple[str, AnyArray, Mapping[str, Any]]


class _Rows(NamedTuple):
    """Rows of one time in the waveforms of a file.

    Attributes
    ----------
    step : float
        Time between rows; 0 where the waveforms have no common step. [s]
    begin : float
        Time of the first row. [s]
    number : int
        Of rows.
    apart : float
        Time between the starts of the first and of the last task. [s]
    before : Mapping[str, float]
        Samples of each channel before the first row, by its path; empty where all start together.
    """

    step: float
    begin: float
    number: int
    apart: float
    before: Mapping[str, float]


def read_tdms(path: Path) -> tuple[list[TdmsChannel], list[str]]:
    """Read the channels of a TDMS file; waveforms without a channel of times get one.

    Tasks that start one after the other are taken from the start of the last one.

    Returns
    -------
    list of TdmsChannel
        Name, numbers and properties of each.
    list of str
        Remarks on their times.

    Raises
    ------
    EncoderError
        If the package is missing, or the header states too many numbers.
    ValueError
        If the file is damaged, or its tasks have no time in common; the package raises errors of
        many classes.
    """
    try:
        from nptdms import TdmsFile
        from nptdms.log import log_manager
    except ImportError as error:
        raise EncoderError(
            f"Expected the package npTDMS, which reads {path.name}; it is not installed. Install "
            'it with: pip install "erlif[logs]"'
        ) from error

    # the package logs a truncated or damaged file as a warning and reads what is left
    text, handler, level = io.StringIO(), log_manager.console_handler, log_manager.log_level
    usual = handler.setStream(text)
    handler.setFormatter(None)
    log_manager.set_level(logging.WARNING)
    try:
        # it leaves a file open that it refuses, but not one that it is given
        with path.open("rb") as raw, TdmsFile.open(raw) as file:
            channels = [channel for group in file.groups() for channel in group.channels()]
            check_cells(sum(len(channel) for channel in channels), path.name)
            found = _read_channels(channels)
    finally:
        log_manager.set_level(level)
        handler.setFormatter(log_manager.formatter)
        handler.setStream(usual)
    if text.getvalue():
        raise ValueError(text.getvalue().strip())
    return found


def _read_channels(channels: Sequence[Any]) -> tuple[list[TdmsChannel], list[str]]:
    """As `read_tdms`, of channels of the package."""
    short = [channel.name for channel in channels]
    longest = max((len(channel) for channel in channels), default=0)
    compared = [one for one in channels if len(one) == longest and "time" not in short]
    rows = _find_rows(compared, longest)

    found: list[TdmsChannel] = []
    for channel in channels:
        values = np.asarray(channel[:])
        if channel.path in rows.before:
            values = _take(values, np.arange(rows.number) + rows.before[channel.path])
        if values.dtype.kind == "M" and values.size:  # time stamps, from the first one
            values = (values - values[0]) / _SECOND
        unique = short.count(channel.name) == 1
        name = channel.name if unique else f"{channel.group_name}/{channel.name}"
        found.append((name, values, channel.properties))
    if rows.step:
        found.append(("time", rows.begin + rows.step * np.arange(rows.number), {"unit": "s"}))

    if not rows.before:
        return found, []
    text = f"its tasks start {rows.apart:.6g} s apart; the rows that all have are taken"
    return found, [text]


def _find_rows(channels: Sequence[Any], longest: int) -> _Rows:
    """Rows that all waveforms have, of the longest channels."""
    step, starts = _find_starts(channels)
    first, last = min(starts.values(), default=0.0), max(starts.values(), default=0.0)
    apart = last - first
    if apart <= step / 2 or len(starts) < len(channels):
        return _Rows(step, first, longest, apart, {})

    count = longest - math.ceil(apart / step - _ROUNDING)
    if count < 1:
        raise ValueError(f"its tasks start {apart:g} s apart and have no time in common")
    before = {path: (last - start) / step for path, start in starts.items()}
    return _Rows(step, last, count, apart, before)


def _find_starts(channels: Sequence[Any]) -> tuple[float, dict[str, float]]:
    """Step of waveforms, 0 where they differ, and the start of each after the first task. [s]"""
    waves = {one.path: one.properties for one in channels if "wf_increment" in one.properties}
    steps = {float(one["wf_increment"]) for one in waves.values()}
    if len(steps) != 1 or min(steps) <= 0:
        return 0.0, {}
    starts = {path: float(one.get("wf_start_offset", 0.0)) for path, one in waves.items()}
    clocks = {path: one.get("wf_start_time") for path, one in waves.items()}
    if None not in clocks.values():
        first = min(clocks.values())
        starts = {path: starts[path] + (clocks[path] - first) / _SECOND for path in starts}
    return steps.pop(), starts


def _take(values: AnyArray, places: AnyArray) -> AnyArray:
    """Numbers between rows; of counts and states the nearest, because their mean is none."""
    if values.dtype.kind != "f":
        return np.asarray(values[np.rint(places).astype(int)])
    return np.asarray(np.interp(places, np.arange(values.size), values))
