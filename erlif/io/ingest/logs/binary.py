"""Logs in binary files: NI TDMS, MATLAB 5 and 7.3, HDF5."""

from __future__ import annotations

import io
import logging
import math
import stat
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from erlif.core.arrays import AnyArray
from erlif.core.errors import EncoderError, reason_of
from erlif.core.guarded import read_matlab
from erlif.core.hdf5 import (
    SIGNATURE,
    chunk_size,
    find_chunks,
    open_hdf5,
    refuse_elsewhere,
    refuse_inflated,
)
from erlif.io.ingest.logs.table import LARGEST_FILE, LogColumn, LogTable, check_cells, split_unit

_TDMS = b"TDSm"
_MATLAB_5 = b"MATLAB 5.0 MAT-file"

# Where the signature of HDF5 may stand; MATLAB 7.3 has a header of 512 bytes. [byte]
_HDF5_PLACES = (0, 512)

# Attributes that hold the unit of a column.
_UNIT_NAMES = ("units", "unit", "Unit", "unit_string", "NI_UnitDescription")

# Length of a unit that is kept; a message shows it. [character]
_LONGEST_UNIT = 80

# Name, unit and numbers of each column.
_Column = tuple[str, str, AnyArray]
_Found = Iterator[_Column]


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
    try:
        if kind == "TDMS":
            channels, remarks = _read_tdms(path)
        else:
            channels = list(_read_matlab(path) if kind == "MATLAB" else _read_hdf5(path))
    except EncoderError:
        raise
    except Exception as error:  # the packages raise errors of many classes for a damaged file
        raise EncoderError(
            f"Expected {path.name} to be a {kind} file; it cannot be read: {reason_of(error)}. "
            "Export the log again."
        ) from error
    return _make_table(path, kind, channels, remarks)


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


def _make_table(path: Path, kind: str, channels: list[_Column], own: list[str]) -> LogTable:
    """The table of the longest channels; `own` are remarks of the reader."""
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
    return LogTable(path.name, columns, range(1, length + 1), (*remarks, *own))


def _texts(values: AnyArray) -> tuple[Any, Mapping[int, str]]:
    """Numbers, and the places of those that are not finite."""
    numbers = np.array(values, np.float64)
    off = np.flatnonzero(~np.isfinite(numbers))
    texts = {int(place): str(numbers[place]) for place in off}
    numbers[off] = np.nan
    return numbers, texts


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
        check_cells(sum(int(item.size) for _, item in datasets), path.name)
        for name, item in datasets:
            if item.dtype.kind in "fiubV":
                refuse_elsewhere(name, item)
                if chunk_size(item) > LARGEST_FILE:
                    held = f"a chunk of {chunk_size(item) / 1e6:.0f} MB"
                    raise ValueError(f"numbers of {name} are in {held}")
                if item.size and not find_chunks(item).all():
                    raise ValueError(f"numbers of {name} are not in the file")
                refuse_inflated(item)
                yield from _vectors(name, item[()], _unit(item.attrs))


def _unit(attributes: Mapping[str, Any]) -> str:
    for name in _UNIT_NAMES:
        if name in attributes:
            value = attributes[name]
            text = value.decode("utf-8", "replace") if isinstance(value, bytes) else str(value)
            return text[:_LONGEST_UNIT]
    return ""


# channels of TDMS files, those of several tasks at common times

_SECOND = np.timedelta64(1, "s")

_ROUNDING = 1e-6  # of starts in steps


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


def _read_tdms(path: Path) -> tuple[list[_Column], list[str]]:
    """Read the channels of a TDMS file; waveforms without a channel of times get one.

    Tasks that start one after the other are taken from the start of the last one.

    Returns
    -------
    list of _Column
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


def _read_channels(channels: Sequence[Any]) -> tuple[list[_Column], list[str]]:
    """As `_read_tdms`, of channels of the package."""
    short = [channel.name for channel in channels]
    longest = max((len(channel) for channel in channels), default=0)
    compared = [one for one in channels if len(one) == longest and "time" not in short]
    rows = _find_rows(compared, longest)

    found: list[_Column] = []
    for channel in channels:
        values = np.asarray(channel[:])
        if channel.path in rows.before:
            values = _take(values, np.arange(rows.number) + rows.before[channel.path])
        if values.dtype.kind == "M" and values.size:  # time stamps, from the first one
            values = (values - values[0]) / _SECOND
        unique = short.count(channel.name) == 1
        name = channel.name if unique else f"{channel.group_name}/{channel.name}"
        found += _vectors(name, values, _unit(channel.properties))
    if rows.step:
        found += _vectors("time", rows.begin + rows.step * np.arange(rows.number), "s")

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
