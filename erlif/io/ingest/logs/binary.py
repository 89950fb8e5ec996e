"""Logs in binary files: NI TDMS, MATLAB 5 and 7.3, HDF5."""

from __future__ import annotations

import io
import logging
import math
import stat
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from erlif.core.arrays import AnyArray
from erlif.core.errors import EncoderError, reason_of
from erlif.core.guarded import read_matlab
from erlif.core.hdf5 import SIGNATURE, chunk_size, find_chunks, open_hdf5, refuse_elsewhere
from erlif.io.ingest.logs.table import LARGEST_FILE, MOST_CELLS, LogColumn, LogTable, split_unit

_TDMS = b"TDSm"
_MATLAB_5 = b"MATLAB 5.0 MAT-file"

# Where the signature of HDF5 may stand; MATLAB 7.3 has a header of 512 bytes. [byte]
_HDF5_PLACES = (0, 512)

# Attributes that hold the unit of a column.
_UNIT_NAMES = ("units", "unit", "Unit", "unit_string", "NI_UnitDescription")

# Length of a unit that is kept; a message shows it. [character]
_LONGEST_UNIT = 80

_SECOND = np.timedelta64(1, "s")

_ROUNDING = 1e-6  # of starts in steps

# Name, unit and numbers of each column.
_Found = Iterator[tuple[str, str, AnyArray]]


def read_binary_table(path: Path) -> LogTable | None:
    """Read a binary file of a data logger.

    A column is a channel of a TDMS file, a vector or the column of a matrix in a MATLAB or HDF5
    file, by its path. Of columns that differ in length the longest are taken.

    Returns
    -------
    LogTable or None
        Rows are counted from 1. None for a file of another format by its first bytes, and for one
        that cannot be read: the reader of text states the reason.

    Raises
    ------
    EncoderError
        If the file cannot be read, holds no columns or too many numbers, or its package is missing.

    Examples
    --------
    >>> import tempfile
    >>> from scipy.io import savemat
    >>> path = Path(tempfile.mkdtemp(), "log.mat")
    >>> savemat(path, {"angle": [1.0, 2.0], "time": [0.0, 0.1]})
    >>> [(column.name, column.values.tolist()) for column in read_binary_table(path).columns]
    [('angle', [1.0, 2.0]), ('time', [0.0, 0.1])]
    """
    kind = _kind(path)
    if kind is None:
        return None
    size = path.stat().st_size
    if size > LARGEST_FILE:
        raise EncoderError(
            f"Expected a log of at most {LARGEST_FILE / 1e6:.0f} MB; {path.name} has "
            f"{size / 1e6:.0f} MB. Export the part that belongs to the run."
        )

    remarks: list[str] = []
    readers: dict[str, Callable[[Path], _Found]] = {
        "TDMS": partial(_read_tdms, remarks),
        "MATLAB": _read_matlab,
        "HDF5": _read_hdf5,
    }
    try:
        channels = list(readers[kind](path))
    except EncoderError:
        raise
    except Exception as error:  # the packages raise errors of many classes for a damaged file
        raise EncoderError(
            f"Expected {path.name} to be a {kind} file; it cannot be read: {reason_of(error)}. "
            "Export the log again."
        ) from error
    table = _make_table(path, kind, channels)
    return replace(table, remarks=(*table.remarks, *remarks))


def _kind(path: Path) -> str | None:
    """Format of a file by its signature."""
    try:
        if not stat.S_ISREG(path.stat().st_mode):
            return None
        with path.open("rb") as file:
            head = file.read(max(_HDF5_PLACES) + len(SIGNATURE))
    except OSError:
        return None
    if head.startswith(_TDMS):
        return "TDMS"
    if any(head[place:].startswith(SIGNATURE) for place in _HDF5_PLACES):
        return "HDF5"
    return "MATLAB" if head.startswith(_MATLAB_5) else None


def _make_table(path: Path, kind: str, channels: list[tuple[str, str, AnyArray]]) -> LogTable:
    if not channels:
        raise EncoderError(
            f"Expected columns of numbers in {path.name}; it holds none. Export time and angle as "
            "vectors of one length."
        )
    length = max(values.size for _, _, values in channels)
    kept = [one for one in channels if one[2].size == length]
    remarks = [f"a {kind} file of {length} rows"]
    if len(kept) < len(channels):
        others = ", ".join(repr(name) for name, _, values in channels if values.size != length)
        remarks.append(f"columns of another length left out: {others}")
    columns = tuple(
        LogColumn(name, unit or split_unit(name)[1], *_texts(values)) for name, unit, values in kept
    )
    return LogTable(path.name, columns, range(1, length + 1), tuple(remarks))


def _texts(values: AnyArray) -> tuple[Any, Mapping[int, str]]:
    """Numbers, and the places of those that are not finite."""
    numbers = np.array(values, np.float64)
    off = np.flatnonzero(~np.isfinite(numbers))
    texts = {int(place): str(numbers[place]) for place in off}
    numbers[off] = np.nan
    return numbers, texts


def _check_size(count: int, path: Path) -> None:
    """Refuse a file whose headers claim more numbers than are read."""
    if count > MOST_CELLS:
        raise EncoderError(
            f"Expected at most {MOST_CELLS} numbers in {path.name}; its header states {count}. "
            "Export the part of the log that belongs to the run."
        )


def _vectors(name: str, values: AnyArray, unit: str = "") -> _Found:
    """A vector, or the columns of a matrix."""
    if values.dtype.names:
        for field in values.dtype.names:
            yield from _vectors(f"{name}/{field}", values[field].ravel(), unit)
        return
    if values.dtype.kind not in "fiub" or values.size < 2:
        return
    if values.ndim <= 2 and max(values.shape) == values.size:
        yield name, unit, values.ravel()
    elif values.ndim == 2:
        # rows are times: a logger takes more samples than it has channels
        table = values if values.shape[0] >= values.shape[1] else values.T
        for place in range(table.shape[1]):
            yield f"{name}({place + 1})", unit, table[:, place]


# formats


def _read_tdms(remarks: list[str], path: Path) -> _Found:
    """Channels; a waveform without a channel of times gets one from its properties."""
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
            channels = list(_list_channels(file, path, remarks))
    finally:
        log_manager.set_level(level)
        handler.setFormatter(log_manager.formatter)
        handler.setStream(usual)
    if text.getvalue():
        raise ValueError(text.getvalue().strip())
    yield from channels


def _list_channels(file: Any, path: Path, remarks: list[str]) -> _Found:
    """Channels; waveforms of tasks that start one after the other at the times of the last one."""
    channels = [channel for group in file.groups() for channel in group.channels()]
    _check_size(sum(len(channel) for channel in channels), path)
    short = [channel.name for channel in channels]
    longest = max((len(channel) for channel in channels), default=0)
    compared = [one for one in channels if len(one) == longest and "time" not in short]
    step, starts = _find_starts(compared)
    first, last = min(starts.values(), default=0.0), max(starts.values(), default=0.0)
    rows, begin = longest, first

    # rows of one time, from the start of the last task on
    apart = last - first
    is_shifted = apart > step / 2 and len(starts) == len(compared)
    if is_shifted:
        rows, begin = longest - math.ceil(apart / step - _ROUNDING), last
        if rows < 1:
            raise ValueError(f"its tasks start {apart:g} s apart and have no time in common")
        remarks.append(f"its tasks start {apart:.6g} s apart; the rows that all have are taken")

    for channel in channels:
        values = np.asarray(channel[:])
        if is_shifted and channel.path in starts:
            values = _take(values, np.arange(rows) + (last - starts[channel.path]) / step)
        if values.dtype.kind == "M" and values.size:  # time stamps, from the first one
            values = (values - values[0]) / np.timedelta64(1, "s")
        unique = short.count(channel.name) == 1
        name = channel.name if unique else f"{channel.group_name}/{channel.name}"
        yield from _vectors(name, values, _unit(channel.properties))
    if step:
        yield "time", "s", begin + step * np.arange(rows)


def _take(values: AnyArray, places: AnyArray) -> AnyArray:
    """Numbers between rows; of counts and states the nearest, because their mean is none."""
    if values.dtype.kind != "f":
        return np.asarray(values[np.rint(places).astype(int)])
    return np.asarray(np.interp(places, np.arange(values.size), values))


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


def _read_matlab(path: Path) -> _Found:
    """Vectors, matrices and the fields of structures of a MATLAB 5 file."""
    for name, values in read_matlab(path):
        yield from _vectors(name, values)


def _read_hdf5(path: Path) -> _Found:
    """Datasets of numbers in an HDF5 or MATLAB 7.3 file, by their paths."""
    import h5py

    with open_hdf5(path) as file:
        datasets: list[Any] = []

        def collect(name: str, item: object) -> None:
            hidden = any(part.startswith("#") for part in name.split("/"))  # of MATLAB
            if isinstance(item, h5py.Dataset) and not hidden and 1 <= item.ndim <= 2:
                datasets.append((name, item))

        file.visititems(collect)
        _check_size(sum(int(item.size) for _, item in datasets), path)
        for name, item in datasets:
            if item.dtype.kind in "fiubV":
                refuse_elsewhere(name, item)
                if chunk_size(item) > LARGEST_FILE:
                    held = f"a chunk of {chunk_size(item) / 1e6:.0f} MB"
                    raise ValueError(f"numbers of {name} are in {held}")
                if item.size and not find_chunks(item).all():
                    raise ValueError(f"numbers of {name} are not in the file")
                yield from _vectors(name, item[()], _unit(item.attrs))


def _unit(attributes: Mapping[str, Any]) -> str:
    for name in _UNIT_NAMES:
        if name in attributes:
            value = attributes[name]
            text = value.decode("utf-8", "replace") if isinstance(value, bytes) else str(value)
            return text[:_LONGEST_UNIT]
    return ""
