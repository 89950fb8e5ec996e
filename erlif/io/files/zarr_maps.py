"""Maps written into one zarr store, each map of a trigger as a file of its own."""

from __future__ import annotations

import errno
import uuid
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import numpy as np
import numpy.typing as npt
import xarray as xr

from erlif.core.arrays import AnyArray
from erlif.io.files.compression import BLOSC_CODEC, BLOSC_LEVEL, MapVariable, checksum, encode_zarr
from erlif.io.files.coordinates import name_coordinates
from erlif.io.files.records import Record, read_record, write_record
from erlif.io.files.replacement import remove, write_error

# Dims of a map.
_DIMS = ("trigger", "y", "x")


@dataclass(frozen=True)
class ZarrMaps:
    """The maps of a film in the making, as a zarr store and one record for each trigger.

    It holds nothing but names, so it can be sent to other processes and machines that see the same
    directory; each may `put` any trigger. The record takes its name last, after the chunks of its
    trigger, so a trigger whose process was killed is not finished. Two processes that put the same
    trigger write the same bytes.

    Attributes
    ----------
    directory : Path
        Directory of the unfinished work.
    variables : tuple[MapVariable, ...]
        The maps.
    shape : tuple[int, int, int]
        Number of triggers, rows and columns.
    key : str
        Identity of the work, as the file ``key`` of the directory holds it; empty: not compared. A
        process that returns late must not write into work that has taken the place of its own.
    any_order : bool
        True: triggers may be put in any order, by several threads and processes.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> variables = (MapVariable("flags", "uint16", {"units": "1"}),)
    >>> with TemporaryDirectory() as folder:
    ...     maps = ZarrMaps(Path(folder), variables, (2, 2, 3))
    ...     maps.create()
    ...     chunks = maps.encode({"flags": np.zeros((2, 3), np.uint16)})
    ...     maps.put(1, chunks, {"frames_used": 1})
    ...     maps.has(0), maps.has(1), int(maps.numbers(1)["frames_used"])
    (False, True, 1)
    """

    directory: Path
    variables: tuple[MapVariable, ...]
    shape: tuple[int, int, int]
    key: str = ""
    any_order: ClassVar[bool] = True

    @property
    def path(self) -> Path:
        """The unfinished store."""
        return self.directory / "maps.zarr"

    def create(self) -> None:
        """Begin the store, in one step; the intact triggers of one that exists are kept.

        Raises
        ------
        OSError
            If it cannot be written.
        """
        scratch = self.directory / "maps.unfinished"
        remove(scratch)
        self._create(scratch)
        if not self.path.is_dir():
            scratch.rename(self.path)
            return

        # descriptions are written again, whatever stands there; triggers are kept by their checksum
        for description in sorted(scratch.rglob("zarr.json")):
            kept = self.path / description.relative_to(scratch)
            kept.parent.mkdir(exist_ok=True)
            description.replace(kept)
        remove(scratch)
        for trigger in range(self.shape[0]):
            if not self._is_intact(trigger):
                for path in (self._record(trigger), *self._chunks(trigger).values()):
                    remove(path)

    def _create(self, scratch: Path) -> None:
        """Write a store without triggers."""
        import zarr
        from zarr.codecs import BloscCodec

        root = zarr.open_group(scratch, mode="w", zarr_format=3)
        for variable in self.variables:
            root.create_array(
                variable.name,
                shape=self.shape,
                chunks=(1, *self.shape[1:]),
                dtype=variable.dtype,
                compressors=BloscCodec(
                    cname=BLOSC_CODEC,
                    clevel=BLOSC_LEVEL,
                    shuffle="bitshuffle",
                    typesize=np.dtype(variable.dtype).itemsize,
                ),
                # one directory for each map, in place of three more for each trigger
                chunk_key_encoding={"name": "default", "separator": "."},
                fill_value=np.nan if variable.dtype == "float32" else 0,
                dimension_names=_DIMS,
                attributes={
                    key: value.tolist() if isinstance(value, np.ndarray) else value
                    for key, value in variable.attrs.items()
                },
            )

    def encode(self, maps: Mapping[str, AnyArray]) -> dict[str, bytes]:
        """Round and compress maps (y, x) of one trigger; any thread may call it."""
        return encode_zarr(maps, [one for one in self.variables if one.name in maps])

    def has(self, trigger: int) -> bool:
        """Check whether a trigger is finished and its chunks have their sizes."""
        record = self._read(trigger)
        return record is not None and all(
            name in record.chunks
            and chunk.is_file()
            and chunk.stat().st_size == record.chunks[name][0]
            for name, chunk in self._chunks(trigger).items()
        )

    def put(
        self, trigger: int, chunks: Mapping[str, bytes], numbers: Mapping[str, npt.ArrayLike]
    ) -> None:
        """Keep the chunks and the small arrays of one trigger.

        Arguments as in `NetcdfMaps.put`; triggers come in any order.

        Raises
        ------
        OutputError
            If they cannot be written; the triggers put before are intact.
        """
        sums = {name: [len(chunk), checksum(chunk)] for name, chunk in chunks.items()}
        try:
            if self.key and (self.directory / "key").read_text(encoding="utf-8") != self.key:
                raise FileNotFoundError(errno.ENOENT, "the work has ended")
            for name, path in self._chunks(trigger).items():
                self._write(path, chunks[name])
            self._write(self._record(trigger), write_record(trigger, numbers, sums))
        except OSError as error:
            output = self.directory.with_name(self.directory.name.removesuffix(".partial"))
            raise write_error(output, error) from error

    def numbers(self, trigger: int) -> dict[str, AnyArray]:
        """Small arrays of a finished trigger, by the names given to `put`; KeyError without it."""
        record = self._read(trigger)
        if record is None:
            raise KeyError(trigger)
        return record.numbers

    def read(self, trigger: int, name: str) -> AnyArray:
        """One map of a finished trigger, (y, x)."""
        import zarr

        return np.asarray(zarr.open_array(self.path / name, mode="r")[trigger])

    def revise(self, trigger: int, chunks: Mapping[str, bytes]) -> None:
        """Replace maps of a finished trigger, as `NetcdfMaps.revise` does."""
        for name, chunk in chunks.items():
            self._write(self._chunks(trigger)[name], chunk)

    def finish(self, film: xr.Dataset, groups: Mapping[str, xr.Dataset]) -> None:
        """Add the coordinates, the small variables, the groups and the attributes.

        Arguments and errors as in `NetcdfMaps.finish`.
        """
        import zarr

        # what a killed process had begun to add
        own = {variable.name for variable in self.variables} | {"zarr.json"}
        for entry in self.path.iterdir():
            if entry.name not in own:
                remove(entry)

        self._name_coordinates(name_coordinates(film))
        _free_text(film).to_zarr(self.path, mode="a", consolidated=False, zarr_format=3)
        for name, group in groups.items():
            _free_text(group).to_zarr(
                self.path, group=name, mode="a", consolidated=False, zarr_format=3
            )

        # One description of all arrays, for which xarray looks first. zarr warns that its format 3
        # does not have it; a program that does not know it passes it over.
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UserWarning)
            zarr.consolidate_metadata(self.path, zarr_format=3)

    def _name_coordinates(self, names: str) -> None:
        """Add the attribute `coordinates` to all maps, which were created without it."""
        import zarr

        if names:
            root = zarr.open_group(self.path, mode="r+", zarr_format=3)
            for variable in self.variables:
                root[variable.name].update_attributes({"coordinates": names})

    def close(self) -> None:
        """Do nothing: the store holds no open file."""

    def _chunks(self, trigger: int) -> dict[str, Path]:
        """File of the chunk of each map."""
        return {one.name: self.path / one.name / f"c.{trigger}.0.0" for one in self.variables}

    def _record(self, trigger: int) -> Path:
        return self.directory / f"trigger_{trigger:05d}.json"

    def _read(self, trigger: int) -> Record | None:
        """Record of a trigger; None where it is missing, damaged or that of another trigger."""
        try:
            record = read_record(self._record(trigger).read_bytes())
        except OSError:
            return None
        return record if record is not None and record.trigger == trigger else None

    def _is_intact(self, trigger: int) -> bool:
        """Whether a trigger is finished and its chunks are those that were put."""
        record = self._read(trigger)
        if record is None or record.chunks.keys() != self._chunks(trigger).keys():
            return False
        try:
            return all(
                [len(content := chunk.read_bytes()), checksum(content)] == record.chunks[name]
                for name, chunk in self._chunks(trigger).items()
            )
        except OSError:
            return False

    def _write(self, path: Path, content: bytes) -> None:
        """Write a file under a temporary name and rename it, so that it is never incomplete."""
        scratch = self.directory / f"{uuid.uuid4().hex}.unfinished"
        try:
            scratch.write_bytes(content)
            scratch.replace(path)
        except OSError:
            scratch.unlink(missing_ok=True)
            raise


def _free_text(dataset: xr.Dataset) -> xr.Dataset:
    """Text of any length: format 3 of zarr has no text of a fixed length."""
    fixed = [name for name in dataset.variables if dataset[name].dtype.kind == "U"]
    return dataset.assign({name: dataset[name].astype(object) for name in fixed})
