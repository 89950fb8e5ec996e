"""Maps written into one netCDF-4 file while they are computed, with a journal to resume from.

The chunk of a trigger is written as soon as the trigger is finished, in the order of the triggers.
A killed process leaves the chunks in the file but no trustworthy index of them, so a journal beside
the file keeps place, size and checksum of each. A resumed run starts a new file with the same calls
of HDF5 and copies the chunks, so that its bytes are those of an uninterrupted run.
"""

from __future__ import annotations

import errno
import os
import shutil
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import xarray as xr

from erlif.core.arrays import AnyArray
from erlif.core.hdf5 import with_locks
from erlif.io.files.compression import DEFLATE_LEVEL, MapVariable, checksum, encode_netcdf
from erlif.io.files.coordinates import name_coordinates
from erlif.io.files.netcdf import fix_attributes, write_netcdf
from erlif.io.files.records import Record, read_record, write_record
from erlif.io.files.replacement import remove

# Dims of a map.
_DIMS = ("trigger", "y", "x")

# Room for headers, indices and attributes that is kept free beyond the chunks. [byte]
_SPARE = 2**20

# The unfinished file; a resumed run copies from one to the other.
_NAMES = ("maps_0.nc", "maps_1.nc")


class NetcdfMaps:
    """The maps of a film in the making, as a netCDF-4 file and a journal in a directory.

    Parameters
    ----------
    directory : Path
        Directory of the unfinished work. Triggers that an earlier process finished there are kept.
    grid : Dataset
        Coordinates trigger, y and x of the maps.
    variables : sequence of MapVariable
        The maps.

    Raises
    ------
    OSError
        If the files cannot be written.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> grid = xr.Dataset(coords={"trigger": [0, 1], "y": [0.0, 0.1], "x": [0.0, 0.1, 0.2]})
    >>> variables = [MapVariable("flags", "uint16", {"units": "1"})]
    >>> with TemporaryDirectory() as folder:
    ...     maps = NetcdfMaps(Path(folder), grid, variables)
    ...     chunks = maps.encode({"flags": np.zeros((2, 3), np.uint16)})
    ...     maps.put(0, chunks, {"frames_used": 1})
    ...     maps.close()
    ...     again = NetcdfMaps(Path(folder), grid, variables)
    ...     found = again.has(0), again.has(1)
    ...     again.close()
    >>> found
    (True, False)
    """

    any_order = False
    """Triggers are put in their order."""

    def __init__(self, directory: Path, grid: xr.Dataset, variables: Sequence[MapVariable]) -> None:
        self.variables = tuple(variables)
        """The maps."""
        self._directory, self._grid = directory, grid
        self._lines: list[int] = []  # where that of each finished trigger begins in the journal

        earlier = _read_journal(directory / "journal")
        name = next(name for name in _NAMES if earlier is None or name != earlier[0])
        self.path = directory / name
        """The unfinished file."""
        self._create()
        try:
            self._resume(earlier)
        except BaseException:
            self.close()
            raise

    def __getstate__(self) -> dict[str, Any]:
        """A copy in another process encodes maps; it holds no file."""
        return {"variables": self.variables}

    def _create(self) -> None:
        """Begin the file: coordinates first, then the maps without chunks."""
        import h5netcdf
        import h5py

        write_netcdf(self._grid, self.path)
        shape = tuple(self._grid.sizes[dim] for dim in _DIMS)
        with with_locks(h5netcdf.File, self.path, "a") as file:
            for variable in self.variables:
                created = file.create_variable(
                    variable.name,
                    _DIMS,
                    np.dtype(variable.dtype),
                    fillvalue=np.float32(np.nan) if variable.dtype == "float32" else None,
                    chunks=(1, *shape[1:]),  # one chunk holds the map of one trigger
                    compression="gzip",
                    compression_opts=DEFLATE_LEVEL,
                    shuffle=True,
                )
                created.attrs.update(fix_attributes(variable.attrs))
        self._file: Any = with_locks(h5py.File, self.path, "r+")
        self._reader = self.path.open("rb", buffering=0)
        self._targets = {one.name: self._file[one.name].id for one in self.variables}

    def _resume(self, earlier: tuple[str, list[Record]] | None) -> None:
        """Copy the finished triggers of an earlier process, then let the journal name this file."""
        fresh = self._directory / "journal.unfinished"
        self._journal = fresh.open("wb", buffering=0)
        self._journal.write(self.path.name.encode() + b"\n")
        if earlier is not None and (self._directory / earlier[0]).is_file():
            with (self._directory / earlier[0]).open("rb") as old:
                for record in earlier[1]:
                    chunks = _read_chunks(old, record)
                    if chunks is None:
                        break
                    self.put(record.trigger, chunks, record.numbers)

        # Until this step the earlier file counts, from here on the new one.
        self._journal.close()  # Windows renames no open file
        fresh.replace(self._directory / "journal")
        self._journal = (self._directory / "journal").open("ab", buffering=0)
        for name in _NAMES:
            if name != self.path.name:
                remove(self._directory / name)

    def encode(self, maps: Mapping[str, AnyArray]) -> dict[str, bytes]:
        """Round and compress maps (y, x) of one trigger; any thread may call it."""
        return encode_netcdf(maps, [one for one in self.variables if one.name in maps])

    def has(self, trigger: int) -> bool:
        """Check whether a trigger is finished."""
        return trigger < len(self._lines)

    def put(
        self, trigger: int, chunks: Mapping[str, bytes], numbers: Mapping[str, npt.ArrayLike]
    ) -> None:
        """Keep the chunks and the small arrays of the next trigger.

        Parameters
        ----------
        trigger : int
            Number of the trigger, one more than that of the last.
        chunks : mapping of str to bytes
            From `encode`.
        numbers : mapping of str to array
            Small arrays by name.

        Raises
        ------
        OSError
            If the chunks cannot be written; the triggers put before are intact.
        """
        self._reserve(sum(map(len, chunks.values())))

        places: dict[str, list[int]] = {}
        for name, target in self._targets.items():
            chunk = chunks[name]
            offset = self._write(target, (trigger, 0, 0), chunk)
            places[name] = [offset, len(chunk), checksum(chunk)]

        # the trigger is finished when its line is complete, and not before
        self._lines.append(self._journal.tell())
        self._journal.write(write_record(trigger, numbers, places))

    def _write(self, target: Any, place: tuple[int, int, int], chunk: bytes) -> int:
        """Write a chunk, and find where it is in the file."""
        offset = int(self._file.id.get_filesize())
        target.write_direct_chunk(place, chunk)

        # HDF5 appends chunks at the end of the file, but may put a node of its index there first.
        # It looks a place up in a time that grows with the number of chunks, so that is the rare
        # way.
        self._reader.seek(offset)
        if self._reader.read(len(chunk)) == chunk:
            return offset
        return int(target.get_chunk_info_by_coord(place).byte_offset)

    def numbers(self, trigger: int) -> dict[str, AnyArray]:
        """Small arrays of a finished trigger, by the names given to `put`."""
        with (self._directory / "journal").open("rb") as journal:
            journal.seek(self._lines[trigger])
            record = read_record(journal.readline())
        assert record is not None  # this process has written it
        return record.numbers

    def read(self, trigger: int, name: str) -> AnyArray:
        """One map of a finished trigger, (y, x); any thread may call it."""
        return np.asarray(self._file[name][trigger])

    def revise(self, trigger: int, chunks: Mapping[str, bytes]) -> None:
        """Replace maps of a finished trigger; resumed work begins from those before it.

        Parameters
        ----------
        trigger : int
        chunks : mapping of str to bytes
            From `encode`.
        """
        for name, chunk in chunks.items():
            self._reserve(len(chunk))
            self._targets[name].write_direct_chunk((trigger, 0, 0), chunk)

    def finish(self, film: xr.Dataset, groups: Mapping[str, xr.Dataset]) -> None:
        """Add the small variables, the groups and the attributes.

        Parameters
        ----------
        film : Dataset
            Everything on the triggers; coordinates of the maps are in the file already.
        groups : mapping of str to Dataset
            Further groups by name.

        Raises
        ------
        OSError
            If they cannot be written; the finished triggers are intact.
        """
        # coordinates of the maps have been there since the file was begun
        small = film.drop_vars(list(self._grid.coords), errors="ignore")
        self._reserve(sum(one.nbytes for one in (small, *groups.values())))
        self._file.close()
        write_netcdf(small, self.path, mode="a", groups=groups)
        self._name_coordinates(name_coordinates(film))

    def _name_coordinates(self, names: str) -> None:
        """Add the attribute `coordinates` to all maps, which were created without it."""
        import h5py

        if names:
            attrs = fix_attributes({"coordinates": names})
            with with_locks(h5py.File, self.path, "r+") as file:
                for variable in self.variables:
                    file[variable.name].attrs.update(attrs)

    def close(self) -> None:
        """Release the files."""
        self._file.close()
        self._reader.close()
        if hasattr(self, "_journal"):
            self._journal.close()

    def _reserve(self, size: int) -> None:
        """Take room on the disk for more bytes, or raise OSError.

        HDF5 may crash when the disk becomes full, so it never writes where there is no room yet. A
        quota may be smaller than the free space, and shows only when space is allocated.
        """
        if shutil.disk_usage(self._directory).free < size + _SPARE:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        if not hasattr(os, "posix_fallocate"):
            return

        with self.path.open("r+b") as file:
            there = file.seek(0, os.SEEK_END)
            used = self._file.id.get_filesize() if self._file else there
            if used + size + _SPARE > there:
                os.posix_fallocate(file.fileno(), there, used + size + _SPARE - there)


def _read_journal(path: Path) -> tuple[str, list[Record]] | None:
    """Name of the unfinished file and its finished triggers; None where there is no journal."""
    if not path.is_file():
        return None
    name, *lines = path.read_bytes().splitlines(keepends=True) or [b""]
    records: list[Record] = []
    for line in lines:
        record = read_record(line)
        if record is None or record.trigger != len(records):
            break
        records.append(record)
    return name.decode(errors="replace").strip(), records


def _read_chunks(file: Any, record: Record) -> dict[str, bytes] | None:
    """Chunks of a trigger from an unfinished file; None where one is damaged."""
    chunks = {}
    for name, (offset, size, expected) in record.chunks.items():
        file.seek(offset)
        chunks[name] = file.read(size)
        if len(chunks[name]) != size or checksum(chunks[name]) != expected:
            return None
    return chunks
