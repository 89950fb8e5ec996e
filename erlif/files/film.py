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
from erlif.files.compression import DEFLATE_LEVEL, MapVariable, decompress
from erlif.files.netcdf import open_netcdf
from erlif.files.replacing import replacing
from erlif.files.unfinished import PartialFilm

_DIMS = ("trigger", "y", "x")
"""Dims of a map."""

_SPARE = 2**20
"""Room for headers and attributes, beyond the data, that must be free on the disk. [byte]"""


def write_dataset(
    dataset: xr.Dataset, output: Path, *, groups: Mapping[str, xr.Dataset] | None = None
) -> None:
    """Write a small dataset, and others as groups, as one netCDF-4 file.

    Parameters
    ----------
    dataset : Dataset
        Root group of the file.
    output : Path
        File to write.
    groups : mapping of str to Dataset, optional
        Further groups by name.

    Raises
    ------
    OutputError
        If the file cannot be written; the previous one is then intact.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     path = Path(folder, "calibration.nc")
    ...     write_dataset(xr.Dataset({"ratio_at_zero": 0.65}), path)
    ...     with open_netcdf(path) as dataset:
    ...         float(dataset.ratio_at_zero)
    0.65
    """
    tree = xr.DataTree.from_dict(
        {"/": dataset, **{f"/{name}": group for name, group in (groups or {}).items()}}
    )

    # The bytes are made in memory and written at once: HDF5 does not survive a full disk.
    with replacing(output) as scratch:
        scratch.write_bytes(tree.to_netcdf(engine="h5netcdf"))


def write_film(
    output: Path,
    film: xr.Dataset,
    groups: Mapping[str, xr.Dataset],
    partial: PartialFilm,
    variables: list[MapVariable],
) -> None:
    """Write a film from its finished triggers.

    Parameters
    ----------
    output : Path
        ``film.nc``, or ``film.zarr`` for zarr.
    film : Dataset
        Everything on the triggers and the coordinates; small.
    groups : mapping of str to Dataset
        Further groups by name.
    partial : PartialFilm
        The maps, all triggers finished.
    variables : list of MapVariable
        Maps to write.

    Raises
    ------
    OutputError
        If the film cannot be written; the previous one is then intact.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> variables = [MapVariable("thickness", "float32", {"units": "um"})]
    >>> film = xr.Dataset(coords={"trigger": [0], "y": [0.0, 0.1], "x": [0.0, 0.1, 0.2]})
    >>> with TemporaryDirectory() as folder, PartialFilm(Path(folder, "film.nc"), "key") as work:
    ...     work.put(0, {"thickness": np.full((2, 3), 5.0, np.float32)}, variables, {})
    ...     write_film(work.output, film, {}, work, variables)
    ...     with open_film(work.output) as found:
    ...         float(found.thickness[0, 1, 2])
    5.0
    """
    unfinished = partial.directory / f"output.unfinished{output.suffix}"
    with replacing(output, scratch=unfinished) as scratch:
        if output.suffix == ".zarr":
            _write_zarr(scratch, film, groups, partial, variables)
            return
        small = film.nbytes + sum(group.nbytes for group in groups.values())
        _make_room(scratch, partial.size() + small + _SPARE)
        _write_netcdf(scratch, film, groups, partial, variables)


def _make_room(path: Path, size: int) -> None:
    """Raise OSError where a file would not fit: HDF5 may crash when the disk becomes full."""
    if shutil.disk_usage(path.parent).free < size:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    # a quota may be smaller than the free space, and shows only when space is allocated
    if hasattr(os, "posix_fallocate"):
        with path.open("wb") as file:
            os.posix_fallocate(file.fileno(), 0, size)


def _write_netcdf(
    path: Path,
    film: xr.Dataset,
    groups: Mapping[str, xr.Dataset],
    partial: PartialFilm,
    variables: list[MapVariable],
) -> None:
    """Small variables by xarray, then the maps as compressed chunks, byte by byte."""
    import h5netcdf
    import h5py

    film.to_netcdf(path, engine="h5netcdf")
    for name, group in groups.items():
        group.to_netcdf(path, engine="h5netcdf", mode="a", group=name)

    # one chunk holds the map of one trigger
    shape = tuple(film.sizes[dim] for dim in _DIMS)
    with h5netcdf.File(path, "a") as file:
        for variable in variables:
            created = file.create_variable(
                variable.name,
                _DIMS,
                np.dtype(variable.dtype),
                fillvalue=np.float32(np.nan) if variable.dtype == "float32" else None,
                chunks=(1, *shape[1:]),
                compression="gzip",
                compression_opts=DEFLATE_LEVEL,
                shuffle=True,
            )
            created.attrs.update(variable.attrs)

    # the triggers were compressed when they were finished
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
    """The same as zarr of format 3."""
    import zarr

    _free_text(film).to_zarr(path, consolidated=False, zarr_format=3)
    for name, group in groups.items():
        _free_text(group).to_zarr(path, group=name, mode="a", consolidated=False, zarr_format=3)

    shape = tuple(film.sizes[dim] for dim in _DIMS)
    root = zarr.open_group(path, mode="r+")
    for variable in variables:
        array = root.create_array(
            variable.name,
            shape=shape,
            chunks=(1, *shape[1:]),
            dtype=variable.dtype,
            fill_value=np.nan if variable.dtype == "float32" else 0,
            dimension_names=_DIMS,
            attributes={
                key: value.tolist() if isinstance(value, np.ndarray) else value
                for key, value in variable.attrs.items()
            },
        )
        for trigger in range(shape[0]):
            array[trigger] = decompress(partial.chunk(trigger, variable), variable.dtype, shape[1:])


def _free_text(dataset: xr.Dataset) -> xr.Dataset:
    """Text of any length: format 3 of zarr has no text of a fixed length."""
    fixed = [name for name in dataset if dataset[name].dtype.kind == "U"]
    return dataset.assign({name: dataset[name].astype(object) for name in fixed})


def open_film(path: str | Path, *, group: str | None = None) -> xr.Dataset:
    """Open a film that `erlif process` wrote.

    Parameters
    ----------
    path : path
        ``film.nc`` or ``film.zarr``.
    group : str, optional
        ``"frames"`` or ``"registration"`` in place of the film itself.

    Returns
    -------
    Dataset
        Maps are read when they are used; close it, or use it in a ``with`` block.

    Raises
    ------
    OutputError
        If there is no such file, or if it is not a film.

    Examples
    --------
    >>> open_film("no such film.nc")  # doctest: +ELLIPSIS
    Traceback (most recent call last):
        ...
    erlif.core.errors.OutputError: Expected a film file; no such film.nc does not exist. ...
    """
    path = Path(path)
    make_one = "Make one with: erlif process RUN_DIR"
    if not path.exists():
        raise OutputError(f"Expected a film file; {path} does not exist. {make_one}")
    if path.is_dir() and path.suffix != ".zarr":
        hint = f". {make_one}"
        if (path / "film.nc").is_file():
            hint = f"; did you mean {path / 'film.nc'}?"
        raise OutputError(f"Expected a film file; {path} is a directory{hint}")

    try:
        if path.suffix == ".zarr":
            dataset: xr.Dataset = xr.open_zarr(path, group=group, consolidated=False, chunks=None)
        else:
            dataset = open_netcdf(path, group=group)
    except Exception as error:  # damaged bytes raise exceptions of many kinds in HDF5 and zarr
        raise OutputError(
            f"Expected a film as erlif process writes it; {path} is damaged or something else "
            f"({error}). {make_one}"
        ) from error

    if group is None and "thickness" not in dataset:
        names = ", ".join(map(str, dataset.variables))
        raise OutputError(f"Expected a film with a variable thickness; {path} holds {names}.")
    return dataset


def describe_hashes(hashes: Mapping[str, str]) -> str:
    """Write the hashes of the inputs as one attribute.

    Parameters
    ----------
    hashes : mapping of str to str
        SHA-256 by the relative name of the input.

    Returns
    -------
    str
        JSON with sorted keys.

    Examples
    --------
    >>> describe_hashes({"run.toml": "5a", "encoder.csv": "0f"})
    '{"encoder.csv": "0f", "run.toml": "5a"}'
    """
    return json.dumps(dict(hashes), sort_keys=True)
