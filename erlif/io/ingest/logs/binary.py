"""Logs in binary files: NI TDMS, MATLAB 5 and 7.3, HDF5."""

from __future__ import annotations

import stat
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

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
from erlif.io.ingest.logs.tdms import read_tdms

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


def _read_tdms(path: Path) -> tuple[list[_Column], list[str]]:
    """Channels of numbers, with their units, and remarks on their times."""
    found, remarks = read_tdms(path)
    channels = [
        column
        for name, values, properties in found
        for column in _vectors(name, values, _unit(properties))
    ]
    return channels, remarks


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
