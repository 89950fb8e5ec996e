"""The images behind a map: the light of both cameras, and its ratio."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.image import AxesImage

from erlif.core.statistics import central_range
from erlif.io.files import describe_trigger, settings_of
from erlif.show.plots import style
from erlif.show.plots.maps import figure_of_maps, joint_image, map_axes, state_reason
from erlif.show.plots.style import AnyFigure, styled

_LIGHT = 0.37  # of two columns, for one of two images of light beside their colour bars
_AROUND_LIGHT = 0.62  # inch above and below an image of light or ratio, for title and labels


@styled
def band_images(
    images: xr.Dataset,
    film: xr.Dataset,
    *,
    camera: int,
    ax: Axes | None = None,
    limits: tuple[float, float] | None = None,
) -> AxesImage:
    """Draw the corrected image of one camera.

    Parameters
    ----------
    images : xarray.Dataset
        From `erlif.pipeline.restore_images`.
    film : xarray.Dataset
        The film, for positions and bands.
    camera : int
        1 or 2.
    limits : (float, float), optional
        Ends of the colour scale [DN]; default: the range of all but 1 % of the pixels that are
        valid.

    Returns
    -------
    AxesImage
        Light of the camera on the pixel grid of camera 1 [DN], grey where it does not see.

    Examples
    --------
    >>> from erlif.show.plots import example_film, example_images
    >>> film = example_film()
    >>> image = band_images(example_images(film, trigger=1), film, camera=1)
    >>> image.axes.get_title()
    'camera 1, 580 nm'
    """
    ax = map_axes(ax, film, _AROUND_LIGHT)

    # bubbles and the dark edge of camera 2 would take most of the scale, so valid pixels set it
    light = images.light.sel(camera=camera).values
    found = central_range(light[images.flags.values == 0])
    image = joint_image(ax, film, light, limits or found)
    style.add_colour_bar(image, ax, "corrected light [DN]")

    settings = settings_of(film)
    band = (settings.camera1, settings.camera2)[camera - 1].band
    ax.set_title(f"camera {camera}, {band:g} nm")
    return image


@styled
def band_images_figure(
    images: xr.Dataset, film: xr.Dataset, *, trigger: int, figure: AnyFigure | None = None
) -> AnyFigure:
    """Draw the images of both cameras side by side, on the pixel grid of camera 1 and one scale.

    Arguments that are not listed are those of `band_images`.

    Parameters
    ----------
    trigger : int
        Number of the trigger that the images belong to, for the title.

    Returns
    -------
    Figure
        Camera 1 at the left, camera 2 at the right, over two columns.

    Examples
    --------
    >>> from erlif.show.plots import example_film, example_images
    >>> film = example_film()
    >>> figure = band_images_figure(example_images(film, trigger=1), film, trigger=1)
    >>> title = figure.get_suptitle().split(", ")
    >>> title[0], title[-1]
    ('example', 'frame pair 1')
    """
    more = f"{describe_trigger(film, trigger)}, {_describe_frames(images)}"
    figure = figure_of_maps(figure, film, width=_LIGHT, around=_AROUND_LIGHT, more=more)
    left, right = figure.subplots(1, 2, sharey=True)
    limits = central_range(images.light.values[:, images.flags.values == 0])
    for camera, ax in enumerate((left, right), 1):
        band_images(images, film, camera=camera, ax=ax, limits=limits)

    # both images have one axis along y
    right.set_ylabel("")
    style.letter_panels(left, right)
    return figure


def _describe_frames(images: xr.Dataset) -> str:
    """The frame pair of the images, or the number of them."""
    frames = np.atleast_1d(images.attrs["frames"])
    return f"frame pair {frames[0]}" if frames.size == 1 else f"mean of {frames.size} frame pairs"


@styled
def ratio_image(images: xr.Dataset, film: xr.Dataset, *, ax: Axes | None = None) -> AxesImage:
    """Draw the ratio of camera 2 to camera 1, which rises with film thickness.

    Arguments as in `band_images`.

    Returns
    -------
    AxesImage
        The ratio [1]; flagged pixels are grey.

    Examples
    --------
    >>> from erlif.show.plots import example_film, example_images
    >>> film = example_film()
    >>> image = ratio_image(example_images(film, trigger=1), film)
    >>> image.axes.child_axes[0].get_ylabel().split()[0]
    'ratio'
    """
    ax = map_axes(ax, film, _AROUND_LIGHT)
    valid = images.flags.values == 0
    ratio = np.where(valid, np.exp(images.log_ratio.values), np.nan)
    settings = settings_of(film)
    label = f"ratio {settings.camera2.band:g} nm / {settings.camera1.band:g} nm [1]\ngrey: flagged"
    image = joint_image(ax, film, ratio, central_range(ratio))
    style.add_colour_bar(image, ax, label)
    state_reason(ax, images.flags.values)
    return image
