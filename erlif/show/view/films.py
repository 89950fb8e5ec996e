"""Films opened for looking: maps are read trigger by trigger, a few are kept."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import ExitStack, closing
from functools import lru_cache
from itertools import zip_longest
from pathlib import Path
from threading import Lock
from typing import Any

import numpy as np
import xarray as xr

from erlif.core.arrays import AnyArray, FlagImage, Image
from erlif.core.errors import ErlifError, FrameError
from erlif.io import files
from erlif.show.view.layers import LAYERS

# Size of the maps that stay in memory, as 4 bytes a pixel, and at least so many of them. [byte]
KEPT, _FEWEST = 96 * 2**20, 4
_RESTORED = 2  # triggers whose images stay in memory

_OF_THEORY = ("predicted", "residual")  # layers of a film with a prediction
_IMAGES = ("log_ratio", "camera1", "camera2")  # layers of `erlif.pipeline.restore_images`

# variables that `erlif.io.files.describe_trigger` uses
_DESCRIBING = ("crank_angle", "encoder_angle", "time", "stroke", "rocker_speed", "sliding_speed")


class FilmReader:
    """A film whose maps are read one by one, from any thread.

    Parameters
    ----------
    path : Path
        ``film.nc`` or ``film.zarr``.
    run_dir : Path, optional
        Run directory that the film was made from; default: the directory of the film, where it
        holds a run.toml.

    Raises
    ------
    ErlifError
        If there is no such film, or no run.toml in `run_dir`.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> from erlif.show.plots.example import write_example
    >>> with TemporaryDirectory() as folder:
    ...     reader = FilmReader(write_example(Path(folder, "film.nc")))
    ...     maps, flags = reader.read("thickness", 2)
    ...     reader.close()
    >>> maps.shape, reader.layers[-2:]
    ((24, 64), ['predicted', 'residual'])
    """

    def __init__(self, path: Path, run_dir: Path | None = None) -> None:
        self.path = path
        self.film: xr.Dataset = files.open_film(path)
        self.name = files.settings_of(self.film).name
        self.run_dir = _find_run(path, run_dir)
        # the few numbers of a description, in memory: to select from the film takes much longer
        names = [name for name in _DESCRIBING if name in self.film]
        self._numbers = self.film[names].load()
        kept = max(KEPT // (4 * self.shape[0] * self.shape[1]), _FEWEST)
        self._read = lru_cache(kept)(self._load)
        self._images = lru_cache(_RESTORED)(self._restore)
        self._computing = Lock()

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns of a map."""
        return int(self.film.sizes["y"]), int(self.film.sizes["x"])

    @property
    def layers(self) -> list[str]:
        """Names of the layers that can be read."""
        lacking = {*_OF_THEORY} if "film_predicted_min" not in self.film else set()
        lacking |= {*_IMAGES} if self.run_dir is None else set()
        return [name for name in LAYERS if name not in lacking]

    def describe(self, trigger: int) -> str:
        """Describe a trigger in one line."""
        files.check_trigger(self.film, trigger)
        return files.describe_trigger(self._numbers, trigger)

    def read(self, layer: str, trigger: int) -> tuple[Image, FlagImage]:
        """Read one layer at one trigger.

        Parameters
        ----------
        layer : str
            A name of `erlif.show.view.layers.LAYERS`.
        trigger : int
            Number of the trigger, from 0.

        Returns
        -------
        tuple of array
            Values (y, x) in the unit of the layer, NaN where it has none; and flags (y, x). Light
            of a camera and a predicted film have values in flagged pixels, and no flags.

        Raises
        ------
        ErlifError
            If there is no such layer or trigger, or if the run cannot be read.
        """
        files.check_trigger(self.film, trigger)
        if layer not in LAYERS:
            raise ErlifError(
                f"Expected a layer of {', '.join(LAYERS)}; got {layer!a}. Choose one of them."
            )
        flags = self._read("flags", trigger)
        if layer in _IMAGES:
            # one computation at a time: a second request for the same trigger finds it finished
            with self._computing:
                image = self._images(trigger)[layer]
            return image, flags if layer == "log_ratio" else np.zeros_like(flags)
        if layer in _OF_THEORY:
            from erlif.show.plots.prediction import predicted_map  # loads matplotlib

            predicted = predicted_map(self.film, trigger=trigger).astype(np.float32)
            if layer == "predicted":
                return predicted, np.zeros_like(flags)
            return self._read("thickness", trigger) - predicted, flags
        return self._read(layer, trigger), flags

    def _load(self, name: str, trigger: int) -> AnyArray:
        """A map of the film."""
        with files.reading_film(self.path):
            return self.film[name].isel(trigger=trigger).values

    def _restore(self, trigger: int) -> dict[str, Image]:
        """The layers that are computed from the frames."""
        if self.run_dir is None:
            raise FrameError(
                f"Expected the run of {self.path.name} to compute its images; there is no run.toml "
                "beside it. Name its directory with --run-dir."
            )
        from erlif.pipeline import restore_images

        images = restore_images(self.path, self.run_dir, trigger=trigger)
        computed = images.log_ratio.values, *images.light.values
        return dict(zip(_IMAGES, (one.astype(np.float32) for one in computed), strict=True))

    def close(self) -> None:
        """Release the file."""
        self.film.close()


def axis_of(film: xr.Dataset, name: str) -> tuple[float, float]:
    """Position of the first pixel along "x" or "y", and the distance of two. [mm]"""
    values = film[name].values
    return float(values[0]), float(values[-1] - values[0]) / (values.size - 1)


def _find_run(path: Path, run_dir: Path | None) -> Path | None:
    """Directory of the run.toml of a film."""
    if run_dir is None:
        beside = path.resolve().parent
        return beside if (beside / "run.toml").is_file() else None
    if not (run_dir / "run.toml").is_file():
        raise FrameError(
            f"Expected a run directory with a run.toml; {run_dir} has none. Name the directory "
            "that the film was made from with --run-dir."
        )
    return run_dir


def open_films(paths: Sequence[Path], run_dirs: Sequence[Path] = ()) -> list[FilmReader]:
    """Open several films.

    Parameters
    ----------
    paths : sequence of Path
        Films.
    run_dirs : sequence of Path
        Their run directories in the same order; may be shorter.

    Returns
    -------
    list of FilmReader

    Raises
    ------
    ErlifError
        If one of them is no film; the others are then closed.

    Examples
    --------
    >>> open_films([Path("no such film.nc")])  # doctest: +ELLIPSIS
    Traceback (most recent call last):
        ...
    erlif.core.errors.OutputError: Expected a film file; no such film.nc does not exist. ...
    """
    if len(run_dirs) > len(paths):
        raise ErlifError(
            f"Expected at most one --run-dir for each film; got {len(run_dirs)} for {len(paths)} "
            "films. Name them in the order of the films."
        )
    # films that are open are closed again where a later one cannot be opened
    with ExitStack() as opened:
        readers = [
            opened.enter_context(closing(FilmReader(path, run_dir)))
            for path, run_dir in zip_longest(paths, run_dirs)
        ]
        opened.pop_all()
    labels = files.label_films([one.name for one in readers], paths)
    for reader, label in zip(readers, labels, strict=True):
        reader.name = label
    return readers


def check_one_grid(one: FilmReader, other: FilmReader) -> None:
    """Refuse two films whose pixels do not lie on each other.

    Parameters
    ----------
    one, other : FilmReader
        Open films.

    Raises
    ------
    ErlifError
        If size, first position or pitch differ.
    """

    def grid(reader: FilmReader) -> tuple[Any, ...]:
        return (*reader.shape, *axis_of(reader.film, "x"), *axis_of(reader.film, "y"))

    if not (one.shape == other.shape and np.allclose(grid(one), grid(other), rtol=1e-6)):
        first, second = (f"{each.name}, {_describe_grid(each)}" for each in (one, other))
        raise ErlifError(
            f"Expected two films on one grid for a difference; got {first}, and {second}. Choose "
            "two of one camera and region."
        )


def _describe_grid(reader: FilmReader) -> str:
    """Size and pitch of the pixels of a film."""
    rows, columns = reader.shape
    return f"{columns} x {rows} px at {axis_of(reader.film, 'x')[1]:.5g} mm"
