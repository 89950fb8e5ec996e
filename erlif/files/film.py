"""Films written as netCDF or zarr, and read back."""

from __future__ import annotations

import errno
import json
import os
import shutil
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import xarray as xr

from erlif.core.errors import OutputError
from erlif.files.compression import _LEVEL, MapVariable, decompress
from erlif.files.netcdf import _free_text, open_netcdf
from erlif.files.replacing import replacing
from erlif.files.unfinished import PartialFilm


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
