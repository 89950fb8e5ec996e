"""A run or its film to maps of the film that theory predicts, on the grid of the camera."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray as xr

from erlif.core.errors import EncoderError, OutputError
from erlif.core.format import describe_origin, identify
from erlif.core.progress import Progress, ShowProgress, choose_progress
from erlif.core.variables import FRAMES, PREDICTION
from erlif.io.files import (
    MapVariable,
    PartialFilm,
    describe_hashes,
    expect_folder,
    open_film,
    open_netcdf,
    refuse_existing,
    remove_remains,
    settings_of,
    takes,
    write_film,
)
from erlif.io.ingest import hash_files_beside_frames, open_run
from erlif.io.settings import RunSettings, count_keys, to_toml
from erlif.pipeline.physics.clock import fit_start
from erlif.pipeline.physics.joint import locate_run, missing_load
from erlif.pipeline.physics.prediction import (
    Prediction,
    describe_sideways,
    film_along_sliding,
    frames_of_run,
    predict_run,
    swinging_joint,
)
from erlif.pipeline.plane import ObjectPlane
from erlif.prediction.triggers import CELLS

# The map of prediction.nc.
MAP = MapVariable(
    "film_predicted",
    "float32",
    PREDICTION["film_predicted"].attrs,
    bits=14,  # at most 0.003 %: far below the error of the solution
)

# Variables of a film that prediction.nc repeats, so that both are compared without it.
_OF_FILM = (
    *("film_min", "film_min_std", "film_min_std_random", "film_min_x", "film_min_y"),
    *("film_mean", "film_mean_std", "film_mean_std_random", "share_beyond_range"),
    "pin_displacement",
    "encoder_angle",
    "crank_angle",
    "stroke",
    "time",
    "rocker_speed",
    "joint_load",
)


@dataclass(frozen=True)
class PredictionInputs:
    """Input of a prediction.

    Attributes
    ----------
    settings : RunSettings
        Those of run.toml, or those that the film holds.
    film : xr.Dataset
        What is measured and logged at each trigger.
    frames : xr.Dataset
        As `erlif.pipeline.physics.prediction.frames_of_run` returns them.
    shape : tuple[int, int]
        Rows and columns of the image.
    hashes : Mapping[str, str]
        Of the inputs.
    """

    settings: RunSettings
    film: xr.Dataset
    frames: xr.Dataset
    shape: tuple[int, int]
    hashes: Mapping[str, str]


@takes(path="run or film", output="path")
def predict(
    path: str | Path,
    *,
    output: str | Path | None = None,
    overwrite: bool = False,
    allow_outside: bool = False,
    progress: ShowProgress = None,
) -> xr.Dataset:
    """Predict the film of an oscillating joint over the cycle, as its camera would see it.

    Parameters
    ----------
    path : path
        A run directory: its settings and log, and film.nc or film.zarr in it for the start film.
        Or a film, with the settings that it holds.
    output : path, optional
        Where to write the prediction, netCDF. Default: nowhere, it is only returned.
    overwrite : bool
        Replace an existing output.
    allow_outside : bool
        Follow links and names of files that leave the run directory.
    progress : "bar", bool or callable, optional
        As for `erlif.process`.

    Returns
    -------
    xarray.Dataset
        The prediction, as docs/other_files.md describes it; with `output`, maps are read from it
        when used.

    Raises
    ------
    ErlifError
        If an input cannot be used, the film cannot be predicted, or the output exists.

    Examples
    --------
    >>> prediction = predict("data_samples/straight_bushing")  # doctest: +SKIP
    >>> prediction.film_predicted.dims  # doctest: +SKIP
    ('trigger', 'y', 'x')
    """
    progress = choose_progress(progress)
    if output is not None:
        _write_prediction(Path(path), Path(output), overwrite, allow_outside, progress)
        return open_netcdf(Path(output))
    with tempfile.TemporaryDirectory(prefix="erlif-") as scratch:
        place = Path(scratch) / "prediction.nc"
        _write_prediction(Path(path), place, True, allow_outside, progress)
        with open_netcdf(place) as prediction:
            return prediction.load()


def is_film(path: Path) -> bool:
    """Whether a path is that of a film, and not that of a run directory."""
    return path.suffix in (".nc", ".zarr") or path.is_file()


def film_beside(run_dir: Path) -> Path | None:
    """The film of a run directory; None where none was made."""
    paths = (run_dir / name for name in ("film.nc", "film.zarr"))
    return next((path for path in paths if path.exists()), None)


def _write_prediction(
    path: Path, output: Path, overwrite: bool, allow_outside: bool, progress: Progress
) -> None:
    """Predict and write trigger by trigger; parameters as for `predict`."""
    remove_remains(output)
    refuse_existing(output, overwrite=overwrite, holds=MAP.name)
    source = read_film(path) if is_film(path) else _read_run(path, allow_outside)
    expect_folder(output)
    plane = ObjectPlane(source.settings, source.shape)
    prediction = predict_run(plane, source.film, source.frames)

    grid = plane.grid(int(source.frames.trigger.max()) + 1)
    key = identify(to_toml(source.settings), describe_hashes(source.hashes))
    with PartialFilm(output, key, grid, [MAP]) as unfinished:
        gaps = film_along_sliding(source.settings, prediction.triggers, plane.along)
        for trigger, gap in enumerate(gaps):
            if not unfinished.has(trigger):
                chunks = unfinished.maps.encode({MAP.name: plane.spread(gap)})
                unfinished.put(trigger, chunks, {})
            progress("prediction", trigger + 1, len(gaps))
        described = _predicted_triggers(source, prediction).assign_coords(grid.coords)
        write_film(unfinished, described, {"frames": _predicted_frames(source, prediction)})


def read_film(path: Path) -> PredictionInputs:
    """The settings, statistics and frames that a film holds."""
    with open_film(path) as film, closing(open_film(path, group="frames")) as group:
        settings = settings_of(film)
        swinging_joint(settings)
        kept = film[[name for name in _OF_FILM if name in film]].load()
        trigger = group.trigger.values
        frames = xr.Dataset(
            {
                "trigger": ("frame", trigger),
                "cycle": ("frame", group["cycle"].values),
                "used": ("frame", np.ones(trigger.size, bool)),
            }
        )
        # the film has the means of its triggers; with one cycle they are those of the frames
        for name in ("crank_angle", "joint_load", "temperature"):
            if name in film:
                frames[name] = ("frame", film[name].values[trigger])
        if "time" in group and np.isfinite(group["time"].values).all():
            frames["time"] = ("frame", group["time"].values)
        shape = film.sizes["y"], film.sizes["x"]
        hashes = {path.name: str(film.attrs.get("identity", ""))}
    return PredictionInputs(settings, kept, frames, shape, hashes)


def _read_run(run_dir: Path, allow_outside: bool) -> PredictionInputs:
    """Read the input of a prediction from a run directory, with its film if there is one."""
    run = open_run(run_dir, find_start=fit_start, allow_outside=allow_outside)
    swinging_joint(run.settings)
    cycle = locate_run(run)
    frames = frames_of_run(run, cycle)
    if "joint_load" not in frames:
        raise missing_load()
    logged = hash_files_beside_frames(run)
    hashes = {path.name: digest for path, digest in logged.items() if path.suffix != ".tif"}

    film_path = film_beside(run_dir)
    if film_path is None:
        if run.settings.prediction.start_film == "fit":
            raise OutputError(
                f"Expected film.nc in {run_dir}, from which the film at the first frame is found; "
                'there is none. Make it with erlif process, or give start_film = "20 um" in '
                "[prediction] of run.toml."
            )
        return PredictionInputs(run.settings, xr.Dataset(), frames, run.pairs.shape, hashes)
    with open_film(film_path) as film:
        if film.sizes["trigger"] != int(frames.trigger.max()) + 1:
            raise EncoderError(
                f"Expected {film_path} to have the triggers of the log, "
                f"{int(frames.trigger.max()) + 1}; it has {film.sizes['trigger']}. Make it again "
                "with erlif process --overwrite."
            )
        kept = film[[name for name in _OF_FILM if name in film]].load()
        hashes[film_path.name] = str(film.attrs.get("identity", ""))
    return PredictionInputs(run.settings, kept, frames, run.pairs.shape, hashes)


def _predicted_triggers(source: PredictionInputs, prediction: Prediction) -> xr.Dataset:
    """Dataset of the predicted triggers, with the record of its inputs."""
    settings = source.settings
    start = prediction.triggers.film_predicted_min.attrs
    # coordinates of the film are those of the grid already; the position gave the load line
    apart = [*source.film.xindexes, "pin_displacement"]
    kept = source.film.drop_vars(apart, errors="ignore")
    kept = kept.drop_attrs(deep=False)
    return kept.assign(prediction.triggers).assign_attrs(
        **describe_origin(
            f"predicted oil-film thickness, {settings.name}", f"predict {settings.name}"
        ),
        settings=to_toml(settings),
        settings_version=count_keys(RunSettings),
        input_hashes=describe_hashes(source.hashes),
        model=f"transient Reynolds, {describe_sideways(settings.prediction)}",
        cells=list(CELLS),
        start_film=start["start_film"],
        start_film_fitted=start["start_film_fitted"],
    )


def _predicted_frames(source: PredictionInputs, prediction: Prediction) -> xr.Dataset:
    """The positions of the frames: those averaged in a trigger each have their own film."""
    belong = source.frames[["trigger", "cycle"]].copy()
    for name in ("trigger", "cycle"):
        belong[name].attrs = dict(FRAMES[name].attrs)
    number = np.arange(belong.sizes["frame"])
    return belong.assign(prediction.frames).assign_coords(frame=number)
