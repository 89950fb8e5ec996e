"""Films written as netCDF or zarr, and read back."""

from __future__ import annotations

import json
import traceback
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from io import BytesIO
from os import PathLike
from pathlib import Path

import xarray as xr

from erlif.core.errors import OutputError, reason_of
from erlif.core.format import LaterVersionError
from erlif.core.guarded import mark_written
from erlif.core.version import __version__
from erlif.io.files.coordinates import set_coordinates
from erlif.io.files.headers import check_netcdf, check_zarr
from erlif.io.files.kinds import KINDS, kind_of
from erlif.io.files.netcdf import open_netcdf, write_netcdf
from erlif.io.files.replacement import take_name, write_error, write_file
from erlif.io.files.soundness import check_film, check_frames, check_registration
from erlif.io.files.unfinished import PartialFilm

_MAKE_ONE = "Make one with: erlif process RUN_DIR"


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
    # The bytes are made in memory and written at once: HDF5 does not survive a full disk.
    buffer = BytesIO()
    named = {name: set_coordinates(group) for name, group in (groups or {}).items()}
    write_netcdf(set_coordinates(dataset), buffer, groups=named)
    write_file(output, buffer.getvalue())
    mark_written(output)


def write_film(partial: PartialFilm, film: xr.Dataset, groups: Mapping[str, xr.Dataset]) -> None:
    """Complete a film whose triggers are finished, and give it its name.

    The maps are in the unfinished file already, so this takes no longer for more of them.

    Parameters
    ----------
    partial : PartialFilm
        The maps, all triggers finished.
    film : Dataset
        Everything on the triggers and the coordinates; small.
    groups : mapping of str to Dataset
        Further groups by name.

    Raises
    ------
    OutputError
        If the film cannot be written; the previous one and the finished triggers are then intact.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> import numpy as np
    >>> from erlif.io.files import MapVariable
    >>> variables = [MapVariable("thickness", "float32", {"units": "um"})]
    >>> film = xr.Dataset(coords={"trigger": [0], "y": [0.0, 0.1], "x": [0.0, 0.1, 0.2]})
    >>> with TemporaryDirectory() as folder:
    ...     output = Path(folder, "film.nc")
    ...     with PartialFilm(output, "key", film, variables) as work:
    ...         chunks = work.maps.encode({"thickness": np.full((2, 3), 5.0, np.float32)})
    ...         work.put(0, chunks, {})
    ...         write_film(work, film, {})
    ...     with open_netcdf(output) as found:
    ...         float(found.thickness[0, 1, 2])
    5.0
    """
    try:
        placed = {name: set_coordinates(group) for name, group in groups.items()}
        partial.maps.finish(set_coordinates(film), placed)
        partial.maps.close()
        take_name(partial.maps.path, partial.output)
    except OSError as error:
        raise write_error(partial.output, error) from error
    if partial.output.is_file():
        mark_written(partial.output)
    partial.discard()


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
        If there is no such file, or if it is not a film: its variables, attributes, settings and
        format version are checked, its maps are not read.

    Examples
    --------
    >>> open_film("no such film.nc")  # doctest: +ELLIPSIS
    Traceback (most recent call last):
        ...
    erlif.core.errors.OutputError: Expected a film file; no such film.nc does not exist. ...
    """
    if not isinstance(path, str | PathLike):
        raise OutputError(
            f"Expected the path of a film, got {_name_of(path)}. Name its file; a film in memory "
            "is open already."
        )
    path = Path(path)
    if not path.exists():
        raise OutputError(f"Expected a film file; {path} does not exist. {_MAKE_ONE}")
    if path.is_dir() and path.suffix != ".zarr":
        hint = f". {_MAKE_ONE}"
        if (path / "film.nc").is_file():
            hint = f". Name its file: {path / 'film.nc'}"
        raise OutputError(f"Expected a film file; {path} is a directory{hint}")

    try:
        return _open_checked(path, group)
    except OutputError:
        raise
    except Exception as error:  # damaged bytes raise exceptions of many kinds in HDF5 and zarr
        raise _damaged(path, error) from error


def _name_of(thing: object) -> str:
    """What was given in place of a path."""
    kind = kind_of(thing)
    return KINDS[kind].words if kind in KINDS else type(thing).__name__


def _open_checked(path: Path, group: str | None) -> xr.Dataset:
    """The root or a group of a film; ValueError or another exception where it is none."""
    if path.suffix == ".zarr":
        from erlif.io.files.bounded_store import BoundedStore  # zarr loads slowly

        store = BoundedStore(path, held=check_zarr(path))
        dataset: xr.Dataset = xr.open_zarr(store, group=group, consolidated=False, chunks=None)
        # text as objects, as in a netCDF file
        texts = [name for name, one in dataset.variables.items() if one.dtype.kind == "T"]
        dataset = dataset.assign({name: dataset[name].astype(object) for name in texts})
        dataset.encoding["source"] = str(path.absolute())
    else:
        if not path.is_file():
            raise ValueError("it is not a regular file")
        check_netcdf(path)
        try:
            dataset = open_netcdf(path, group=group)
        except OSError:
            if group is not None:  # another product has no such group
                _open_checked(path, None).close()
            raise

    kind = kind_of(dataset)
    if group is None and kind in KINDS and KINDS[kind].opener:
        dataset.close()
        held = KINDS["calibration" if kind == "calibration file" else kind].words
        raise OutputError(
            f"Expected a film as erlif process writes it; {path} holds {held}, which "
            f"{KINDS[kind].opener} opens. Name the film in its place. {_MAKE_ONE}"
        )

    check = {None: check_film, "frames": check_frames, "registration": check_registration}
    try:
        if group in check:
            check[group](dataset)
        return set_coordinates(dataset)
    except BaseException:
        dataset.close()
        raise


@contextmanager
def reading_film(path: str | Path) -> Iterator[None]:
    """Name the film where a part of it turns out to be damaged while it is read.

    Parameters
    ----------
    path : path
        The film that is used in the block.

    Returns
    -------
    context manager

    Raises
    ------
    OutputError
        In place of the error of HDF5 or zarr.

    Examples
    --------
    >>> with reading_film("film.nc"):
    ...     raise OSError("Can't synchronously read data")
    Traceback (most recent call last):
        ...
    erlif.core.errors.OutputError: Expected a film as erlif process writes it; film.nc is damaged \
or something else (its values cannot be read). Make one with: erlif process RUN_DIR
    """
    try:
        yield
    except (OSError, RuntimeError, ValueError) as error:
        # an error of the system has a number, one of HDF5 has none
        if isinstance(error, OSError) and error.errno is not None:
            raise
        if isinstance(error, OSError) or _is_from_zarr(error):
            raise _damaged(Path(path), error) from error
        raise


def _is_from_zarr(error: BaseException) -> bool:
    """Whether an exception was raised while zarr or a codec of it read a chunk."""
    frames = (frame for frame, _ in traceback.walk_tb(error.__traceback__))
    modules = (str(frame.f_globals.get("__name__", "")) for frame in frames)
    return any(module.startswith(("zarr.", "numcodecs.")) for module in modules)


def _damaged(path: Path, error: Exception) -> OutputError:
    if isinstance(error, LaterVersionError):
        return OutputError(
            f"Expected a film of erlif {__version__} or earlier in {path}; {error}. Install a "
            "later one, or make the film again with: erlif process RUN_DIR"
        )
    return OutputError(
        f"Expected a film as erlif process writes it; {path} is damaged or something else "
        f"({reason_of(error)}). {_MAKE_ONE}"
    )


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
