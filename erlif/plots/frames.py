"""What lies before the film: the corrected images of both bands and their ratio, made again from the run directory."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.image import AxesImage

from erlif.core.errors import FrameError
from erlif.correction import correct_frames, measure_references
from erlif.files import check_trigger, describe_trigger, open_film, settings_of
from erlif.ingest import open_run, read_frames
from erlif.plots.maps import bare_image, image_height, label_position, pixel_edges
from erlif.plots.style import (
    ONE_COLUMN,
    TWO_COLUMNS,
    add_colour_bar,
    colour_map,
    given_or_new,
    letter,
    new_figure,
    styled,
)
from erlif.ratio import compute_ratio
from erlif.registration import CameraMap, align_frames


def restore_frames(film_path: Path, run_dir: Path, *, trigger: int) -> xr.Dataset:
    """Take the first frame of a trigger through correction, alignment and ratio again.

    Displacement field and drift come from the film; the cameras are not registered anew.

    Parameters
    ----------
    film_path : Path
        The film.
    run_dir : Path
        The run directory it was made from.
    trigger : int

    Returns
    -------
    xarray.Dataset
        signal (camera, y, x) [DN], both on the pixel grid of camera 1; ratio (y, x) [1], NaN where flagged; attribute frame,
        its number.

    Raises
    ------
    ErlifError
        If the film has no such trigger, or the directory cannot be read or is another run's.
    """
    with open_film(film_path) as film:
        check_trigger(film, trigger)
        shape = (film.sizes["y"], film.sizes["x"])
    with (
        open_film(film_path, group="frames") as frames,
        open_film(film_path, group="registration") as registration,
    ):
        camera_map = CameraMap.from_dataset(registration)
        usable = (frames.trigger.values == trigger) & np.isfinite(frames.drift_x.values)
        if not usable.any():
            raise FrameError(
                f"Expected a frame of trigger {trigger}; all of them were left out when the film was made."
            )
        number = int(np.argmax(usable))
        drift = np.array([[float(frames.drift_x[number]), float(frames.drift_y[number])]])
        count = frames.sizes["frame"]
    recording = open_run(run_dir, skip_bad_frames=True)
    if recording.shape != shape or len(recording.pages[0]) != count:
        raise FrameError(
            f"Expected the run that the film was made from, {count} frames of {shape[1]} x {shape[0]} px; {run_dir.name} has "
            f"{len(recording.pages[0])} of {recording.shape[1]} x {recording.shape[0]} px. Name the right one as run_dir."
        )
    options = recording.settings.thickness
    corrected = correct_frames(
        read_frames(recording, [number]),
        measure_references(recording),
        least_signal=options.least_signal,
    )
    aligned = align_frames(corrected, camera_map, drift=drift)
    ratios = compute_ratio(aligned, no_film_below=options.no_film_below)
    good = ratios.flags.values[0] == 0
    return xr.Dataset(
        {
            "signal": (("camera", "y", "x"), aligned.signal.values[:, 0], {"units": "DN"}),
            "ratio": (
                ("y", "x"),
                np.exp(np.where(good, ratios.log_ratio.values[0], np.nan)),
                {"units": "1"},
            ),
        },
        attrs={"frame": number},
    )


@styled
def band_images(
    restored: xr.Dataset, film: xr.Dataset, *, camera: int, ax: Axes | None = None
) -> AxesImage:
    """Draw the corrected image of one camera.

    Parameters
    ----------
    restored : xarray.Dataset
        From `restore_frames`.
    film : xarray.Dataset
        The film, for positions and bands.
    camera : int
        1 or 2.
    ax : Axes, optional

    Returns
    -------
    AxesImage
    """
    ax = given_or_new(ax)
    signal = restored.signal.values[camera - 1]
    low, high = np.nanpercentile(signal[np.isfinite(restored.ratio.values)], [0.5, 99.5])
    image = ax.imshow(
        signal,
        cmap=colour_map("batlow", bad="#D9D9D9"),
        vmin=float(low),
        vmax=float(high),
        extent=pixel_edges(film),
        interpolation="none",
    )
    settings = settings_of(film)
    band = (settings.camera1, settings.camera2)[camera - 1].band
    add_colour_bar(image, ax, "corrected signal [DN]")
    ax.set_title(f"camera {camera}, {band:g} nm")
    label_position(ax, film)
    bare_image(ax)
    return image


@styled
def band_images_figure(restored: xr.Dataset, film: xr.Dataset, *, trigger: int) -> Figure:
    """The processed images of both cameras on the grid of camera 1, two columns wide."""
    figure = new_figure(TWO_COLUMNS, image_height(film, 0.37 * TWO_COLUMNS) + 0.62)
    left, right = figure.subplots(1, 2, sharey=True)
    band_images(restored, film, camera=1, ax=left)
    band_images(restored, film, camera=2, ax=right)
    right.set_ylabel("")
    letter(left, "a")
    letter(right, "b")
    figure.suptitle(f"{describe_trigger(film, trigger)}, frame {restored.attrs['frame']}")
    return figure


@styled
def ratio_image(restored: xr.Dataset, film: xr.Dataset, *, ax: Axes | None = None) -> AxesImage:
    """Draw the ratio camera 2 / camera 1; pixels without an answer are grey. Parameters as in `band_images`."""
    ax = given_or_new(ax, height=image_height(film, 0.75 * ONE_COLUMN) + 0.5)
    ratio = restored.ratio.values
    low, high = np.nanpercentile(ratio, [0.5, 99.5])
    image = ax.imshow(
        ratio,
        cmap=colour_map("batlow", bad="#D9D9D9"),
        vmin=float(low),
        vmax=float(high),
        extent=pixel_edges(film),
        interpolation="none",
    )
    settings = settings_of(film)
    label = f"ratio {settings.camera2.band:g} nm / {settings.camera1.band:g} nm [1]; grey: flagged"
    add_colour_bar(image, ax, label)
    label_position(ax, film)
    bare_image(ax)
    return image
