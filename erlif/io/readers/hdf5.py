"""HDF5 and netCDF-4: an array of frames by its path in the file."""

from __future__ import annotations

import importlib
import threading
from pathlib import Path
from typing import Any

import numpy as np

from erlif.core.arrays import AnyArray, Array, Mask
from erlif.core.errors import FrameError, reason_of
from erlif.core.hdf5 import (
    SIGNATURE,
    chunk_count,
    chunk_size,
    filters_of,
    find_chunks,
    open_hdf5,
    refuse_inflated,
)
from erlif.core.notes import list_some
from erlif.io.readers.base import DEFLATED, SECONDS, Format, FrameFile, FrameKind, check_claim

# Datasets that a message lists.
_MOST_LISTED = 8

# First bytes of a file of MATLAB from version 7.3 on, whose HDF5 begins at byte 512.
_MATLAB = b"MATLAB 7.3 MAT-file"

# Order of the numbers by the beginning of the name of the last axis.
_AXES = {"row": ("x", "col", "width"), "column": ("y", "row", "height")}

# Chunks of a dataset; each takes a microsecond once.
_MOST_CHUNKS = 2**24

# Objects of a file that are searched for frames.
_MOST_VISITED = 10_000

# Size of a chunk of times above which they are not read. [byte]
_LARGEST_TIMES = 64 * 2**20


class Hdf5Frames(FrameFile):
    """The frames of one dataset, (frame, y, x) or (y, x); MATLAB has x before y."""

    def __init__(self, path: Path, dataset: str = "") -> None:
        self._lock = threading.Lock()
        self._stored: Mask | None = None
        try:
            self._file = open_hdf5(path)
        except Exception as error:  # h5py raises several types on damaged bytes
            raise FrameError(f"the file is damaged or not HDF5 ({reason_of(error)})") from error
        try:
            self._data = self._find(dataset)
            self._check(path.stat().st_size)
            self.array_order = _find_order(path, self._data)
        except (FrameError, ModuleNotFoundError):
            self._file.close()
            raise
        except Exception as error:  # as above
            self._file.close()
            raise FrameError(f"the file is damaged ({reason_of(error)})") from error

    def read(self, index: int) -> AnyArray:
        """As `FrameFile.read`."""
        try:
            with self._lock:
                self._check_stored(index)
                refuse_inflated(self._data, index if self._data.ndim == 3 else slice(None))
                image = self._data[index] if self._data.ndim == 3 else self._data[()]
        except FrameError:
            raise
        except Exception as error:  # as above
            raise FrameError(f"the dataset is damaged ({reason_of(error)})") from error
        image = np.asarray(image)
        return image.astype(image.dtype.newbyteorder("="), copy=False)

    def close(self) -> None:
        """As `FrameFile.close`."""
        self._file.close()

    def _check_stored(self, index: int) -> None:
        """Refuse a frame that the file does not hold; the library would return zeros for it."""
        if self._stored is None:
            self._stored = _stored_frames(self._data)
        if not self._stored[index]:
            raise FrameError("its counts are not in the file, which is damaged or was not finished")

    def _find(self, name: str) -> Any:
        """The dataset of that path, or the only one that may hold frames."""
        import h5py

        if name:
            item = _follow(self._file, name)
            if isinstance(item, h5py.Dataset) and item.ndim in (2, 3):
                return item
            raise FrameError(f"it has no frames at dataset = {name!r}; {self._list()}")

        candidates = _candidates(self._file, 3) or _candidates(self._file, 2)
        if len(candidates) == 1:
            return self._file[candidates[0]]
        what = "several datasets" if candidates else "no dataset"
        raise FrameError(f"it has {what} that may be frames; {self._list()}")

    def _list(self) -> str:
        """The datasets that may hold frames, for a message."""
        candidates = _candidates(self._file, 3) + _candidates(self._file, 2)
        if not candidates:
            return "no dataset of two or three dimensions holds numbers. Choose another file."
        files = ((name, self._file[name]) for name in candidates)
        listed = list_some(
            (f"{name} ({' x '.join(map(str, data.shape))} {data.dtype})" for name, data in files),
            most=_MOST_LISTED,
        )
        return f'it has {listed}. Choose one with dataset, for example dataset = "{candidates[0]}".'

    def _check(self, size: int) -> None:
        """Refuse data that are no plain counts of this file, and headers with impossible sizes."""
        data = self._data
        if data.is_virtual or data.external:
            raise FrameError("its counts lie in other files. Name these files.")
        if data.dtype.kind not in "iuf":
            raise FrameError(f"its dataset {data.name} holds {data.dtype}. Save the raw counts.")
        scale, offset = data.attrs.get("scale_factor", 1), data.attrs.get("add_offset", 0)
        if np.any(np.asarray(scale) != 1) or np.any(np.asarray(offset) != 0):
            raise FrameError(
                f"its dataset {data.name} is scaled (scale_factor, add_offset) and no longer holds "
                "counts. Save the raw counts."
            )
        _check_filters(data)
        if chunk_size(data) > DEFLATED * size:
            raise FrameError("the file is damaged: a chunk is larger than the file can hold")

        frames = data.shape[0] if data.ndim == 3 else 1
        kind = FrameKind(tuple(int(n) for n in data.shape[-2:]), data.dtype.newbyteorder("=").name)
        check_claim(frames, kind, size, packing=DEFLATED)
        self.kinds = [kind] * frames
        self.times = _times(data) if data.ndim == 3 else None


def _begins(head: bytes) -> bool:
    """Whether a file is HDF5; MATLAB puts 512 bytes before it."""
    return head.startswith((SIGNATURE, _MATLAB))


def _find_order(path: Path, data: Any) -> str:
    """`FrameFile.array_order` by what MATLAB leaves, else by the name of the last axis."""
    with path.open("rb") as file:
        if file.read(len(_MATLAB)) == _MATLAB or "MATLAB_class" in data.attrs:
            return "column"
    axis = data.dims[data.ndim - 1]
    name = axis.label or (axis[0].name or "" if len(axis) else "")
    plain = str(name).rpartition("/")[2].lower()
    return next((order for order, names in _AXES.items() if plain.startswith(names)), "unknown")


def list_datasets(path: Path) -> list[str]:
    """Paths of the arrays of an HDF5 file that may hold frames.

    Returns
    -------
    list of str
        In the order of the file; empty for a file of another format, a damaged one, or one that
        erlif has written.

    Examples
    --------
    >>> list_datasets(Path("pyproject.toml"))
    []
    """
    with path.open("rb") as file:
        if not _begins(file.read(len(_MATLAB))):
            return []

    try:
        with open_hdf5(path) as file:
            own = "erlif_version" in file.attrs
            return [] if own else _candidates(file, 3) or _candidates(file, 2)
    except Exception:  # h5py raises several types on damaged bytes
        return []


def _candidates(file: Any, ndim: int) -> list[str]:
    """Paths of the datasets of that many dimensions; links are not followed."""
    import h5py

    names: list[str] = []
    visited = 0

    def visit(name: str, item: object) -> bool | None:
        nonlocal visited
        visited += 1
        hidden = name.startswith("#")  # of MATLAB
        fits = isinstance(item, h5py.Dataset) and item.ndim == ndim and item.dtype.kind in "iuf"
        if fits and not hidden:
            names.append(f"/{name}")
        return True if visited > _MOST_VISITED else None

    file.visititems(visit)
    return names


def _follow(file: Any, name: str) -> Any:
    """The object at a path within this file; None where there is none."""
    import h5py

    place: Any = file
    for part in name.strip("/").split("/"):
        if not isinstance(place, h5py.Group):
            return None
        link = place.get(part, getlink=True)
        if isinstance(link, h5py.ExternalLink):
            raise FrameError(f"dataset = {name!r} leads to {link.filename}. Name that file.")
        place = place.get(part)
    return place


def _stored_frames(data: Any) -> Mask:
    """Whether the file holds all chunks of each frame, (frame,)."""
    frames = data.shape[0] if data.ndim == 3 else 1
    if data.chunks is not None and chunk_count(data) > _MOST_CHUNKS:
        raise FrameError(f"it has {chunk_count(data)} chunks, more than {_MOST_CHUNKS}")
    chunks = find_chunks(data)
    if data.chunks is None or data.ndim == 2:
        return np.full(frames, chunks.all())
    stored: Mask = np.asarray(chunks.all(axis=(1, 2)))
    return np.repeat(stored, data.chunks[0])[:frames]


def _check_filters(data: Any) -> None:
    """Refuse a compression for which no decoder is installed."""
    import h5py

    for code in filters_of(data):
        if not h5py.h5z.filter_avail(code):
            importlib.import_module("hdf5plugin")
        if not h5py.h5z.filter_avail(code):
            raise FrameError(
                f"the installed Python package hdf5plugin has no filter {code} of HDF5. Save the "
                "frames uncompressed, or with gzip."
            )


def _times(data: Any) -> Array | None:
    """Time of each frame from the only array of times beside the frames."""
    times: list[Array] = []
    for name in data.parent:
        item = _array_beside(data, name)
        factor = None if item is None else SECONDS.get(_read_unit(item))
        if factor is None:
            continue

        # nanoseconds since 1970 are whole numbers that floating point does not resolve
        refuse_inflated(item)
        stamps = np.asarray(item[()])
        stamps = stamps.astype(np.int64 if stamps.dtype.kind in "iu" else np.float64)
        times.append(factor * (stamps - stamps[0]))
    return times[0] if len(times) == 1 else None


def _read_unit(item: Any) -> str:
    """Unit of an array in lower case, without the day from which times count."""
    unit = item.attrs.get("units", "")
    text = unit.decode("utf-8", "replace") if isinstance(unit, bytes) else str(unit)
    return text.split(" since ")[0].strip().lower()


def _array_beside(data: Any, name: str) -> Any:
    """An array of numbers with one for each frame, stored in this file; else None."""
    import h5py

    # a link may lead to another file
    if not isinstance(data.parent.get(name, getlink=True), h5py.HardLink):
        return None
    item = data.parent[name]
    if not isinstance(item, h5py.Dataset) or item.shape != data.shape[:1]:
        return None
    if item.is_virtual or item.external or item.dtype.kind not in "iuf":
        return None

    # times are no reason to refuse the frames: what cannot be decoded is left out
    decodable = all(h5py.h5z.filter_avail(code) for code in filters_of(item))
    return item if decodable and chunk_size(item) <= _LARGEST_TIMES else None


HDF5 = Format(
    "HDF5, netCDF-4",
    (".h5", ".hdf5", ".he5", ".nc", ".nc4"),
    lambda path, head: _begins(head),
    Hdf5Frames,
    extra="formats",
    open_dataset=Hdf5Frames,
)
