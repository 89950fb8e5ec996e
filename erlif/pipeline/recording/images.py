"""The images behind a map: the light of both cameras and their ratio, computed again from the run.

A film stores its maps and no images. This module repeats the stages from counts to ratio with what
the film stores of them: settings, camera map, drift of each frame, and difference of sharpness. The
cameras are not registered anew, so that the ratio is the one that the map was inverted from.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from erlif.core.errors import FrameError, OutputError
from erlif.core.products import RatioImages
from erlif.correction import CAMERA_NOISE, CameraNoise
from erlif.io.files import check_trigger, open_film, settings_of, takes
from erlif.io.ingest import Run, open_run
from erlif.pipeline.chain import FrameChain, one_thread_per_frame
from erlif.pipeline.physics.clock import fit_start
from erlif.pipeline.recording.prepare import restore_chain
from erlif.ratio import BlurDifference, RatioSum, smooth_ratio
from erlif.registration import CameraMap
from erlif.thickness import flag_steps
from erlif.trend.pattern import Pattern

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

    # results of the stages before the maps, as the film stores them
    with open_film(film_path) as film:
        check_trigger(film, trigger)
        settings, image = settings_of(film), film[["x", "y"]].load()
        pattern = _read_pattern(film)
    with open_film(film_path, group="registration") as registration:
        camera_map = CameraMap.from_dataset(registration)
        blur, noise = _read_cameras(registration.attrs, film_path.name)
    with open_film(film_path, group="frames") as group:
        stored = group.load()

    opened = open_run(
        run_dir, skip_bad_frames=True, find_start=fit_start, allow_outside=allow_outside
    )
    run = replace(opened, settings=settings)
    _check_run(run, stored, (image.sizes["y"], image.sizes["x"]), film_path.name)
    frames = [k for k in run.pairs.usable if stored.trigger.values[k] == trigger]
    if not frames:
        raise FrameError(
            f"Expected a frame pair of trigger {trigger}; all of them were left out when the film "
            "was made. Name another trigger."
        )

    change = stored.ratio_change.values if "ratio_change" in stored else None
    chain = restore_chain(run, camera_map, blur, noise)
    chain = replace(chain, ratio_change=change, pattern=pattern)
    if chain.correct.energies is None:
        energies = np.nan_to_num(stored.pulse_energy.values, nan=1.0)
        chain = replace(chain, correct=replace(chain.correct, energies=energies))
    images = _combine_frames(chain, stored, frames, settings.thickness.smoothing)
    return images.assign_coords(image.coords).assign_attrs(trigger=trigger, frames=frames)


def _read_pattern(film: xr.Dataset) -> Pattern | None:
    """What was taken out of the ratio, its error apart; None where nothing was."""
    if "ratio_pattern" not in film:
        return None
    image = film["ratio_pattern"]
    std, acts = np.zeros_like(image.values), (image.attrs[key] for key in ("ratios", "acts"))
    return Pattern(image.values, std, *acts)


def _read_cameras(attrs: Mapping[str, Any], film: str) -> tuple[BlurDifference, list[CameraNoise]]:
    """Sharpness of the cameras, and the noise of both as it was in use."""
    try:
        difference, std = attrs["blur_difference"], attrs["blur_difference_std"]
        numbers = [attrs[f"camera_{name}"] for name in CAMERA_NOISE]
    except KeyError as missing:
        raise OutputError(
            f"Expected the attribute {missing.args[0]} in the group registration of {film}; there "
            "is none. Make the film again with: erlif process RUN_DIR"
        ) from missing
    # a film of an earlier version has none taken out
    excess = [attrs.get(f"ratio_excess{end}", 0.0) for end in ("", "_std")]
    return BlurDifference(*map(float, (*difference, *std, *excess))), [
        CameraNoise(float(gain), 0.0, float(read), 0.0, float(spread))
        for gain, read, spread in zip(*numbers, strict=True)
    ]


def _check_run(run: Run, stored: xr.Dataset, shape: tuple[int, int], film: str) -> None:
    """Refuse a run directory whose frames are not those of the film."""
    if "file_camera1" not in stored or "file_camera2" not in stored:
        raise OutputError(
            f"Expected the names of the frames in the group frames of {film}; there are none. Make "
            "the film again with: erlif process RUN_DIR"
        )
    count, total = stored.sizes["frame"], len(run.pairs.pages[0])
    if run.pairs.shape != shape or total != count:
        raise FrameError(
            f"Expected the run that the film was made from, {count} frames of {shape[1]} x "
            f"{shape[0]} px; {run.directory.name} has {total} of {run.pairs.shape[1]} x "
            f"{run.pairs.shape[0]} px. Name the right one as run_dir."
        )

    names = [[page.name for page in pages] for pages in run.pairs.pages]
    files = [[str(name) for name in stored[f"file_camera{n}"].values] for n in (1, 2)]
    if names != files:
        raise FrameError(
            f"Expected the run that the film was made from, with {files[0][0]} to {files[0][-1]} "
            f"of camera 1; {run.directory.name} has {names[0][0]} to {names[0][-1]}. Name the "
            "right one as run_dir."
        )


def _combine_frames(
    chain: FrameChain, stored: xr.Dataset, frames: list[int], smoothing: float | None
) -> xr.Dataset:
    """Mean light and combined ratio of the frames of a trigger."""
    shape = chain.pairs.shape
    total = RatioSum(shape)
    light = np.zeros((2, *shape))
    count = np.zeros_like(light)
    with one_thread_per_frame():
        for frame in frames:
            drift = float(stored.drift_x[frame]), float(stored.drift_y[frame])
            pair, signal = chain.restore(frame, drift)
            if len(frames) > 1:  # the ratio of a single frame is the one behind the map
                total.add(pair)

            # camera 2 sees the edge of the image in some frames only, as it drifts
            light += np.nan_to_num(signal, nan=0.0)
            count += np.isfinite(signal)

    combined = pair if len(frames) == 1 else total.mean()
    flag_steps(combined.log_ratio, combined.variance, combined.flags)
    ratio = RatioImages(combined.to_images().isel(frame=0))

    # a single frame holds numbers in flagged pixels, which mean nothing
    sound = ratio.flags == 0
    ratio = RatioImages(ratio.assign({name: ratio[name].where(sound) for name in _RATIO}))
    if smoothing is not None:
        ratio = smooth_ratio(ratio, resolution=smoothing)

    mean = np.divide(light, count, out=np.full_like(light, np.nan), where=count > 0)
    images = xr.Dataset(
        {"light": (("camera", "y", "x"), mean.astype(np.float32), {"units": "DN"})},
        {"camera": [1, 2]},
    )
    names = ("log_ratio", "log_ratio_var", "log_ratio_var_shared", "flags")
    return images.assign({name: ratio[name].variable for name in names})
