"""Products to files: netCDF or zarr, whole or not at all, and resumable while they grow.

Maps are rounded to the bits that their noise leaves meaningful, so that they compress; a NaN stays a NaN. Each trigger is
compressed by the thread that made it and kept in a file of its own next to the output. The output is put together from these
files at the end and takes its name in one step: it is complete or it is the previous one.
"""

from __future__ import annotations

import errno
import json
import os
import shutil
import zipfile
import zlib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import IO, Any, Self

import numpy as np
import numpy.typing as npt
import xarray as xr

from erlif.core.errors import OutputError

_OUR_FORMATS = (b"\x89HDF\r\n\x1a\n", b"\x89PNG\r\n\x1a\n", b"%PDF", b"<!DOCTYP", b"<!doctyp")

_LEVEL = 1  # of zlib: higher ones cost much and gain little on noise


@dataclass(frozen=True)
class MapVariable:
    """A variable (trigger, y, x) that is written trigger by trigger."""

    name: str
    dtype: str
    attrs: Mapping[str, Any]
    bits: int = 23
    """Bits of the mantissa that are kept."""


def round_bits(values: npt.NDArray[np.float32], bits: int) -> npt.NDArray[np.float32]:
    """Round float32 values to `bits` bits of mantissa; the largest relative error is 2**-(bits + 1)."""
    drop = 23 - bits
    if drop <= 0:
        return values
    whole = np.ascontiguousarray(values, np.float32).view(np.uint32)
    rounded = (whole + ((1 << (drop - 1)) - 1) + ((whole >> drop) & 1)) & np.uint32(
        ~((1 << drop) - 1) & 0xFFFFFFFF
    )
    return np.where(np.isfinite(values), rounded.view(np.float32), np.float32(np.nan))


def compress(values: npt.NDArray[Any]) -> bytes:
    """Bytes of an array as HDF5's shuffle and deflate filters write a chunk."""
    data = np.ascontiguousarray(values)
    shuffled = data.view(np.uint8).reshape(-1, data.itemsize).T
    # noise holds no repeats to look for: run lengths and Huffman codes alone are twice as fast and no larger
    deflate = zlib.compressobj(
        _LEVEL, zlib.DEFLATED, zlib.MAX_WBITS, zlib.DEF_MEM_LEVEL, zlib.Z_RLE
    )
    return deflate.compress(np.ascontiguousarray(shuffled).tobytes()) + deflate.flush()


def decompress(chunk: bytes, dtype: str, shape: tuple[int, ...]) -> npt.NDArray[Any]:
    """Reverse of `compress`."""
    item = np.dtype(dtype).itemsize
    planes = np.frombuffer(zlib.decompress(chunk), np.uint8).reshape(item, -1)
    return np.ascontiguousarray(planes.T).view(dtype).reshape(shape)


class _Lock:
    """Keeps a second process off an output that is being made; it ends with its process, however that ends.

    Where the system has no advisory locks, processes are not told apart.
    """

    def __init__(self, output: Path) -> None:
        self.path = output.with_name(f".{output.name}.lock")
        self.file: IO[str] | None = None
        try:
            import fcntl
        except ImportError:
            return
        try:
            with suppress(FileExistsError):  # where a file stands in the way, the next line says so
                self.path.parent.mkdir(parents=True, exist_ok=True)
            file = self.path.open("w")
        except OSError as error:
            raise _not_written(output, error) from error
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            file.close()
            raise OutputError(
                f"Expected {output} to be free; another erlif process is making it. Wait for it, or use -o for another name."
            ) from error
        self.file = file

    def release(self) -> None:
        """Let others come."""
        if self.file is not None:
            self.path.unlink(missing_ok=True)
            self.file.close()
            self.file = None


class PartialFilm:
    """The triggers of a film that is being made, each in a file beside the output.

    Parameters
    ----------
    output : Path
        File or directory to be.
    key : str
        Identifies inputs and settings; a partial film of another key is thrown away, one of the same key is resumed.
    """

    def __init__(self, output: Path, key: str) -> None:
        self.output = output
        self.directory = output.with_name(output.name + ".partial")
        self.lock = _Lock(output)
        marker = self.directory / "key"
        try:
            if (
                self.directory.exists()
                and not marker.is_file()
                and (self.directory.is_file() or any(self.directory.iterdir()))
            ):
                raise OutputError(
                    f"Expected {self.directory} to be free for the work in progress; something else stands there. Move it away, or use -o for "
                    "another name."
                )
            if marker.is_file() and marker.read_bytes() != key.encode():
                shutil.rmtree(self.directory)
            self.directory.mkdir(parents=True, exist_ok=True)
            marker.write_bytes(key.encode())
            for stray in self.directory.glob("*.unfinished"):
                _remove(stray)
        except OSError as error:
            self.lock.release()
            raise _not_written(output, error) from error
        except OutputError:
            self.lock.release()
            raise

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Leave nothing behind where no trigger was finished."""
        if not any(self.directory.glob("trigger_*.npz")):
            self.discard()
        self.lock.release()

    def has(self, trigger: int) -> bool:
        """Whether this trigger is finished."""
        return zipfile.is_zipfile(self._path(trigger))

    def put(
        self,
        trigger: int,
        maps: Mapping[str, npt.NDArray[Any]],
        variables: list[MapVariable],
        numbers: Mapping[str, npt.ArrayLike],
    ) -> None:
        """Keep the maps (y, x) and small numbers of one trigger; raises OutputError, and keeps what was put before."""
        record: dict[str, npt.ArrayLike] = {
            f"number_{name}": np.asarray(value) for name, value in numbers.items()
        }
        for variable in variables:
            values = maps[variable.name]
            if variable.dtype == "float32":
                values = round_bits(values, variable.bits)
            record[f"map_{variable.name}"] = np.frombuffer(
                compress(values.astype(variable.dtype)), np.uint8
            )
        scratch = self._path(trigger).with_suffix(".unfinished")
        try:
            with scratch.open("wb") as file:
                np.savez(file, **record)  # type: ignore[arg-type]
            scratch.replace(self._path(trigger))
        except OSError as error:
            scratch.unlink(missing_ok=True)
            raise _not_written(self.output, error) from error

    def chunk(self, trigger: int, variable: MapVariable) -> bytes:
        """Compressed map of one trigger."""
        with np.load(self._path(trigger)) as record:
            return bytes(record[f"map_{variable.name}"])

    def size(self) -> int:
        """Bytes of what was kept."""
        return sum(path.stat().st_size for path in self.directory.glob("trigger_*.npz"))

    def numbers(self, trigger: int) -> dict[str, npt.NDArray[Any]]:
        """Small numbers of one trigger."""
        with np.load(self._path(trigger)) as record:
            return {
                name.removeprefix("number_"): record[name]
                for name in record
                if name.startswith("number_")
            }

    def discard(self) -> None:
        """Remove what was kept, once the output stands."""
        shutil.rmtree(self.directory, ignore_errors=True)

    def _path(self, trigger: int) -> Path:
        return self.directory / f"trigger_{trigger:05d}.npz"


def refuse_existing(output: Path, *, overwrite: bool) -> None:
    """Raise OutputError if `output` exists and may not be replaced, or is something that erlif has not written."""
    if not output.exists():
        return
    if not overwrite:
        raise OutputError(
            f"{output} exists already; use --overwrite to replace it, or -o for another name."
        )
    if output.is_dir():
        ours = output.suffix == ".zarr" and (
            (output / "zarr.json").is_file() or not any(output.iterdir())
        )
    else:
        with output.open("rb") as file:
            start = file.read(8)
        ours = not start or start.startswith(_OUR_FORMATS)
    if not ours:
        raise OutputError(
            f"Expected {output} to be an output of before; it is something else, which --overwrite does not replace. Use -o for "
            "another name."
        )


@contextmanager
def replacing(output: Path, *, scratch: Path | None = None) -> Iterator[Path]:
    """Give a name to write to; it takes the place of `output` in one step when the block ends without error.

    `scratch` is that name, on the same disk; by default a hidden one beside `output`.
    """
    scratch = scratch or output.with_name(f".{output.name}.unfinished")
    try:
        output.parent.mkdir(parents=True, exist_ok=True)
        _remove(scratch)
        yield scratch
        if scratch.is_dir() and output.exists():
            _exchange(scratch, output)
        else:
            scratch.replace(output)
    except OSError as error:
        raise _not_written(output, error) from error
    finally:
        _remove(scratch)


def _exchange(scratch: Path, output: Path) -> None:
    """Put a directory in the place of another; only files can be replaced in one step."""
    old = output.with_name(f".{output.name}.old")
    _remove(old)
    output.rename(old)
    try:
        scratch.rename(output)
    except BaseException:
        old.rename(output)
        raise
    _remove(old)


def _not_written(output: Path, error: OSError) -> OutputError:
    return OutputError(
        f"{output} could not be written: {os.strerror(error.errno) if error.errno else error}. What stood there before is as it was. Make room or choose another place "
        "with -o, and start again."
    )


def _remove(path: Path) -> None:
    if path.is_dir():
        shutil.rmtree(path, ignore_errors=True)
    else:
        with suppress(OSError):
            path.unlink()


def write_dataset(
    dataset: xr.Dataset, output: Path, *, groups: Mapping[str, xr.Dataset] | None = None
) -> None:
    """Write a small dataset, and others as groups of the file, as netCDF-4, whole or not at all; raises OutputError."""
    tree = xr.DataTree.from_dict(
        {"/": dataset, **{f"/{name}": group for name, group in (groups or {}).items()}}
    )
    with replacing(output) as scratch:
        scratch.write_bytes(
            tree.to_netcdf(engine="h5netcdf")
        )  # as a whole: HDF5 does not survive a full disk


def write_film(
    output: Path,
    film: xr.Dataset,
    groups: Mapping[str, xr.Dataset],
    partial: PartialFilm,
    variables: list[MapVariable],
) -> None:
    """Put a film together: `film` holds what is small, `partial` the maps; zarr by the suffix of `output`.

    Raises
    ------
    OutputError
        If it cannot be written; the previous output is then as it was.
    """
    with replacing(
        output, scratch=partial.directory / f"output.unfinished{output.suffix}"
    ) as scratch:
        if output.suffix == ".zarr":
            _write_zarr(scratch, film, groups, partial, variables)
        else:
            _make_room(
                scratch,
                partial.size()
                + film.nbytes
                + sum(group.nbytes for group in groups.values())
                + 2**20,
            )
            _write_netcdf(scratch, film, groups, partial, variables)


def _make_room(path: Path, size: int) -> None:
    """Raise OSError where a file would not fit: HDF5 may crash when the disk fills up under it."""
    if shutil.disk_usage(path.parent).free < size:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
    if hasattr(os, "posix_fallocate"):
        with path.open("wb") as file:
            os.posix_fallocate(file.fileno(), 0, size)  # sees a quota too


def _write_netcdf(
    path: Path,
    film: xr.Dataset,
    groups: Mapping[str, xr.Dataset],
    partial: PartialFilm,
    variables: list[MapVariable],
) -> None:
    import h5netcdf
    import h5py

    film.to_netcdf(path, engine="h5netcdf")
    for name, group in groups.items():
        group.to_netcdf(path, engine="h5netcdf", mode="a", group=name)
    shape = tuple(film.sizes[dim] for dim in ("trigger", "y", "x"))
    with h5netcdf.File(path, "a") as file:
        for variable in variables:
            created = file.create_variable(
                variable.name,
                ("trigger", "y", "x"),
                np.dtype(variable.dtype),
                fillvalue=np.float32(np.nan) if variable.dtype == "float32" else None,
                chunks=(1, *shape[1:]),
                compression="gzip",
                compression_opts=_LEVEL,
                shuffle=True,
            )
            created.attrs.update(variable.attrs)
    with h5py.File(path, "r+") as file:
        for variable in variables:
            target = file[variable.name].id
            for trigger in range(shape[0]):
                target.write_direct_chunk((trigger, 0, 0), partial.chunk(trigger, variable))


def _write_zarr(
    path: Path,
    film: xr.Dataset,
    groups: Mapping[str, xr.Dataset],
    partial: PartialFilm,
    variables: list[MapVariable],
) -> None:
    import zarr

    _free_text(film).to_zarr(path, consolidated=False, zarr_format=3)
    for name, group in groups.items():
        _free_text(group).to_zarr(path, group=name, mode="a", consolidated=False, zarr_format=3)
    shape = tuple(film.sizes[dim] for dim in ("trigger", "y", "x"))
    root = zarr.open_group(path, mode="r+")
    for variable in variables:
        array = root.create_array(
            variable.name,
            shape=shape,
            chunks=(1, *shape[1:]),
            dtype=variable.dtype,
            fill_value=np.nan if variable.dtype == "float32" else 0,
            dimension_names=("trigger", "y", "x"),
            attributes={
                key: value.tolist() if isinstance(value, np.ndarray) else value
                for key, value in variable.attrs.items()
            },
        )
        for trigger in range(shape[0]):
            array[trigger] = decompress(partial.chunk(trigger, variable), variable.dtype, shape[1:])


def open_netcdf(path: Path, *, group: str | None = None) -> xr.Dataset:
    """Open a netCDF-4 file or one of its groups with xarray."""
    import h5py

    with h5py.File(
        path, "r"
    ) as file:  # where this fails, h5netcdf would leave a complaint of its own on the terminal
        list(file.attrs.items())
        file.visititems(lambda name, item: None)
    return xr.open_dataset(path, engine="h5netcdf", group=group)


def has_group(path: Path, group: str) -> bool:
    """Whether a netCDF-4 file has a group of this name."""
    import h5py

    with h5py.File(path, "r") as file:
        return isinstance(file.get(group), h5py.Group)


def _free_text(dataset: xr.Dataset) -> xr.Dataset:
    """Text as strings of any length: zarr's format 3 does not know text of a fixed length."""
    return dataset.assign(
        {name: dataset[name].astype(object) for name in dataset if dataset[name].dtype.kind == "U"}
    )


def open_film(path: str | Path, *, group: str | None = None) -> xr.Dataset:
    """Open a film that `erlif process` wrote; maps are read when they are used.

    Parameters
    ----------
    path : path
        ``film.nc`` or ``film.zarr``.
    group : str, optional
        ``"frames"`` or ``"registration"`` in place of the film itself.

    Raises
    ------
    OutputError
        If there is no such file, or it is no film.
    """
    path = Path(path)
    if not path.exists():
        raise OutputError(
            f"Expected a film file; {path} does not exist. Make one with: erlif process RUN_DIR"
        )
    if path.is_dir() and path.suffix != ".zarr":
        inside = f"; did you mean {path / 'film.nc'}?" if (path / "film.nc").is_file() else ""
        raise OutputError(
            f"Expected a film file; {path} is a directory{inside or '. Make a film with: erlif process RUN_DIR'}"
        )
    try:
        if path.suffix == ".zarr":
            dataset: xr.Dataset = xr.open_zarr(path, group=group, consolidated=False, chunks=None)
        else:
            dataset = open_netcdf(path, group=group)
    except Exception as error:  # HDF5 and zarr raise whatever the damaged bytes lead them to
        raise OutputError(
            f"Expected a film as erlif process writes it; {path} is damaged or something else ({error}). Make one with: erlif process "
            "RUN_DIR"
        ) from error
    if group is None and "thickness" not in dataset:
        raise OutputError(
            f"Expected a film with a variable thickness; {path} holds {', '.join(map(str, dataset.variables))}."
        )
    return dataset


def describe_hashes(hashes: Mapping[str, str]) -> str:
    """Input hashes as one attribute, JSON with sorted keys."""
    return json.dumps(dict(hashes), sort_keys=True)
