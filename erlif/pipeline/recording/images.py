"""The images behind a map: the light of both cameras and their ratio, computed again from the run.

A film stores its maps and no images. This module repeats the stages from counts to ratio with what
the film stores of them: settings, camera map, drift of each frame, and difference of sharpness. The
cameras are not registered anew, so that the ratio is the one that the map was inverted from.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import numpy.typing as npt
import xarray as xr

from erlif.core.arrays import Array
from erlif.core.errors import FrameError, OutputError
from erlif.core.products import RatioImages
from erlif.correction import CAMERA_NOISE, CameraNoise
from erlif.io.files import check_trigger, open_film, settings_of, takes
from erlif.io.ingest import Run, open_run
from erlif.io.settings import RunSettings
from erlif.pipeline.chain import FrameChain, one_thread_per_frame
from erlif.pipeline.physics.clock import fit_start
from erlif.pipeline.recording.prepare import restore_chain
from erlif.ratio import BlurDifference, RatioSum, smooth_ratio
from erlif.registration import CameraMap

_RATIO = ("log_ratio", "log_ratio_var", "log_ratio_var_fixed", "log_ratio_var_shared")


@takes(film_path="film file", run_dir="run")
def restore_images(
    film_path: str | Path, run_dir: str | Path, *, trigger: int, allow_outside: bool = False
) -> xr.Dataset:
    """Compute the images behind the map of one trigger.

    Parameters
    ----------
    film_path : path
        ``film.nc`` or ``film.zarr``.
    run_dir : path
        Run directory that the film was made from.
    trigger : int
        Number of the trigger, counted from 0.
    allow_outside : bool
        Follow links and names of files that leave the run directory.

    Returns
    -------
    xarray.Dataset
        light (camera, y, x), corrected and on the pixel grid of camera 1, the mean over the frames
        of the trigger [DN]; log_ratio (y, x), camera 2 over camera 1, with log_ratio_var (random)
        and log_ratio_var_shared [1]; flags (y, x). Coordinates x and y [mm]. Attributes trigger,
        and frames, the numbers of the frame pairs.

    Raises
    ------
    ErlifError
        If the film has no such trigger or no frame of it, or the directory cannot be read or holds
        another run.

    Examples
    --------
    The ratio of a film that `erlif.process` made in its run directory:

    >>> images = restore_images("run/film.nc", "run", trigger=2)  # doctest: +SKIP
    >>> images.log_ratio.dims, images.light.dims  # doctest: +SKIP
    (('y', 'x'), ('camera', 'y', 'x'))

    The film is needed for the displacement and the drift of camera 2:

    >>> restore_images("nowhere.nc", "run", trigger=2)  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    erlif.core.errors.OutputError: Expected a film file; nowhere.nc does not exist...
    """
    film_path, run_dir = Path(film_path), Path(run_dir)
    stored = _read_stored(film_path, trigger)
    opened = open_run(
        run_dir, skip_bad_frames=True, find_start=fit_start, allow_outside=allow_outside
    )
    run = replace(opened, settings=stored.settings)
    _check_run(run, stored)
    frames = [k for k in run.pairs.usable if stored.trigger_of[k] == trigger]
    if not frames:
        raise FrameError(
            f"Expected a frame pair of trigger {trigger}; all of them were left out when the film "
            "was made. Name another trigger."
        )

    chain = restore_chain(run, stored.camera_map, stored.blur, stored.noise)
    chain = replace(chain, ratio_change=stored.ratio_change)
    if chain.correct.energies is None:
        chain = replace(chain, correct=replace(chain.correct, energies=stored.energies))
    return _combine_frames(chain, stored, frames, trigger)


@dataclass(frozen=True)
class _Stored:
    """Results of the stages before the maps, as a film stores them."""

    settings: RunSettings  # settings of the run
    camera_map: CameraMap  # camera map, with the mean drift taken up
    blur: BlurDifference  # difference of sharpness. [px2]
    noise: Sequence[CameraNoise]  # of both cameras, as it was in use
    trigger_of: npt.NDArray[np.int64]  # (frame,): trigger of each frame
    # (frame, axis x y): drift on top of the camera map; NaN where it is not known. [px]
    drift: Array
    energies: Array  # (frame,): pulse energy over the mean of the run. [1]
    ratio_change: Array | None  # (frame,): what was taken out of the log ratio. [1]
    files: tuple[list[str], list[str]]  # file of each frame, camera 1 and camera 2
    x: xr.DataArray  # columns in the object plane. [mm]
    y: xr.DataArray  # rows in the object plane. [mm]


def _read_stored(film_path: Path, trigger: int) -> _Stored:
    with open_film(film_path) as film:
        check_trigger(film, trigger)
        settings, x, y = settings_of(film), film.x.load(), film.y.load()

    with open_film(film_path, group="registration") as registration:
        camera_map = CameraMap.from_dataset(registration)
        try:
            difference = registration.attrs["blur_difference"]
            std = registration.attrs["blur_difference_std"]
            numbers = [registration.attrs[f"camera_{name}"] for name in CAMERA_NOISE]
            # a film of an earlier version has none taken out
            excess = [registration.attrs.get(f"ratio_excess{end}", 0.0) for end in ("", "_std")]
        except KeyError as missing:
            raise OutputError(
                f"Expected the attribute {missing.args[0]} in the group registration of "
                f"{film_path.name}; there is none. Make the film again with: erlif process RUN_DIR"
            ) from missing

    with open_film(film_path, group="frames") as frames:
        if "file_camera1" not in frames or "file_camera2" not in frames:
            raise OutputError(
                f"Expected the names of the frames in the group frames of {film_path.name}; there "
                "are none. Make the film again with: erlif process RUN_DIR"
            )
        drift = np.column_stack([frames.drift_x.values, frames.drift_y.values])
        files = [[str(name) for name in frames[f"file_camera{n}"].values] for n in (1, 2)]
        energies = np.nan_to_num(frames.pulse_energy.values, nan=1.0)
        change = frames.ratio_change.values if "ratio_change" in frames else None
        trigger_of = frames.trigger.values.astype(np.int64)

    blur = BlurDifference(*map(float, (*difference, *std, *excess)))
    noise = [
        CameraNoise(float(gain), 0.0, float(read), 0.0, float(spread))
        for gain, read, spread in zip(*numbers, strict=True)
    ]
    return _Stored(
        settings,
        camera_map,
        blur,
        noise,
        trigger_of,
        drift,
        energies,
        change,
        (files[0], files[1]),
        x,
        y,
    )


def _check_run(run: Run, stored: _Stored) -> None:
    """Refuse a run directory whose frames are not those of the film."""
    shape = (stored.y.size, stored.x.size)
    count = len(stored.trigger_of)
    total = len(run.pairs.pages[0])
    if run.pairs.shape != shape or total != count:
        raise FrameError(
            f"Expected the run that the film was made from, {count} frames of {shape[1]} x "
            f"{shape[0]} px; {run.directory.name} has {total} of {run.pairs.shape[1]} x "
            f"{run.pairs.shape[0]} px. Name the right one as run_dir."
        )

    names = tuple([page.name for page in pages] for pages in run.pairs.pages)
    if names != stored.files:
        raise FrameError(
            f"Expected the run that the film was made from, with {stored.files[0][0]} to "
            f"{stored.files[0][-1]} of camera 1; {run.directory.name} has {names[0][0]} to "
            f"{names[0][-1]}. Name the right one as run_dir."
        )


def _combine_frames(
    chain: FrameChain, stored: _Stored, frames: list[int], trigger: int
) -> xr.Dataset:
    """Mean light and combined ratio of the frames of a trigger."""
    shape = chain.pairs.shape
    total = RatioSum(shape)
    light = np.zeros((2, *shape))
    count = np.zeros_like(light)
    with one_thread_per_frame():
        for frame in frames:
            drift_x, drift_y = stored.drift[frame].tolist()
            pair, signal = chain.restore(frame, (drift_x, drift_y))
            if len(frames) > 1:  # the ratio of a single frame is the one behind the map
                total.add(pair)

            # camera 2 sees the edge of the image in some frames only, as it drifts
            light += np.nan_to_num(signal, nan=0.0)
            count += np.isfinite(signal)

    combined = pair if len(frames) == 1 else total.mean()
    ratio = RatioImages(combined.to_images().isel(frame=0))

    # a single frame holds numbers in flagged pixels, which mean nothing
    sound = ratio.flags == 0
    ratio = RatioImages(ratio.assign({name: ratio[name].where(sound) for name in _RATIO}))
    smoothing = stored.settings.thickness.smoothing
    if smoothing is not None:
        ratio = smooth_ratio(ratio, resolution=smoothing)

    mean = np.divide(light, count, out=np.full_like(light, np.nan), where=count > 0)
    images = xr.Dataset(
        {"light": (("camera", "y", "x"), mean.astype(np.float32), {"units": "DN"})},
        {"camera": [1, 2], "x": stored.x, "y": stored.y},
        {"trigger": trigger, "frames": frames},
    )
    names = ("log_ratio", "log_ratio_var", "log_ratio_var_shared", "flags")
    return images.assign({name: ratio[name].variable for name in names})
