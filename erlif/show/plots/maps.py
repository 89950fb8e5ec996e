"""Maps of film thickness, and the axes that all images of the joint share."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.image import AxesImage

from erlif.core.arrays import AnyArray, Array, FlagImage
from erlif.core.flags import describe_share
from erlif.core.statistics import central_range
from erlif.io.files import axis_labels as axis_labels
from erlif.io.files import check_trigger, describe_trigger, region_of, settings_of
from erlif.show.plots import style
from erlif.show.plots.naming import reason_empty
from erlif.show.plots.profiles import profile_residual, sliding_profile
from erlif.show.plots.style import ONE_COLUMN, TWO_COLUMNS, AnyFigure, Limits, pt, styled

# Width of a map in a figure of one column, relative to the column; the colour bar has the rest.
MAP_WIDTH = 0.75

_BLOCKS = 48  # along x of a large map of differences, whose single pixels are noise
_EVERY = 3  # the limits need no more than every third pixel along each axis
_LEAST_SPAN = 1e-3  # um; a map of even thickness still needs a colour scale
_PIXELS = 240  # along x of a small map, about what 300 dpi and the frame of a movie resolve
_WIDE = 0.43  # of two columns, for a map beside its profile
_AROUND = 1.25  # inch above and below it, for title, labels and legend
_LEAST = 2.4  # inch, for the labels of two panels one above the other
_LABELS = 0.75  # inch above and below a single map


def common_limits(film: xr.Dataset, triggers: Iterable[int] | None = None) -> tuple[float, float]:
    """Find the thickness range of all but the 0.5 % thinnest and thickest pixels. [um]"""
    chosen = range(film.sizes["trigger"]) if triggers is None else triggers
    samples = [film.thickness.isel(trigger=k).values[::_EVERY, ::_EVERY].ravel() for k in chosen]
    low, high = central_range(np.concatenate(samples))
    return low, max(high, low + _LEAST_SPAN)


def thin_map(film: xr.Dataset, trigger: int) -> AnyArray:
    """Map of one trigger, thinned to what a sheet or a movie has room for. [um]"""
    every = max(1, film.sizes["x"] // _PIXELS)
    return np.asarray(film.thickness.isel(trigger=trigger).values[::every, ::every])


class MapBlocks(NamedTuple):
    """Means over square blocks of pixels.

    Attributes
    ----------
    values : Array
        (block row, block column); NaN where less than half of a block is valid.
    extent : tuple of float
        Left, right, bottom and top edge in mm; blocks at the edge may reach beyond the image.
    size : int
        Side of a block. [px]
    """

    values: Array
    extent: tuple[float, float, float, float]
    size: int


def average_in_blocks(
    film: xr.Dataset, values: npt.ArrayLike, *, along_x: int = _BLOCKS
) -> MapBlocks:
    """Average an image of a film in blocks, as one pixel is mostly noise.

    Parameters
    ----------
    film : xarray.Dataset
        Its positions are those of the pixels.
    values : array, (y, x)
        The image, NaN where it has no value.
    along_x : int
        Number of blocks along x, nearly.

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> film = example_film()
    >>> means = average_in_blocks(film, film.thickness.values[0])
    >>> means.size, means.values.shape == film.thickness.shape[1:]
    (1, True)
    """
    size = max(1, round(film.sizes["x"] / along_x))
    blocks = xr.DataArray(values, dims=("y", "x")).coarsen(x=size, y=size, boundary="pad")
    means = blocks.mean().where(blocks.count() >= size**2 / 2).values
    left, right, bottom, top = pixel_edges(film)
    high, wide = means.shape
    dx = size * (right - left) / film.sizes["x"]
    dy = size * (bottom - top) / film.sizes["y"]
    return MapBlocks(means, (left, left + wide * dx, top + high * dy, top), size)


def draw_blocks(ax: Axes, film: xr.Dataset, means: MapBlocks, limits: Limits) -> AxesImage:
    """Draw a map of differences in blocks, hatched where they have no value."""
    look: dict[str, Any] = {"colours": "vik", "bad": "none", "extent": means.extent}
    image = style.draw_image(ax, means.values, limits, **look)
    left, right, bottom, top = pixel_edges(film)
    ax.set(xlim=(left, right), ylim=(bottom, top))
    return image


def name_blocks(means: MapBlocks) -> str:
    """State over which blocks means are taken; nothing for single pixels."""
    return "" if means.size == 1 else f"means of {means.size} × {means.size} px"


def pixel_edges(film: xr.Dataset) -> tuple[float, float, float, float]:
    """Left, right, bottom and top edge of the image in mm; y runs down."""
    x, y = film.x.values, film.y.values
    dx = float(x[1] - x[0]) / 2
    dy = float(y[1] - y[0]) / 2
    return float(x[0]) - dx, float(x[-1]) + dx, float(y[-1]) + dy, float(y[0]) - dy


def image_height(film: xr.Dataset, width: float) -> float:
    """Height of the joint's image at a given width, both in inches."""
    left, right, bottom, top = pixel_edges(film)
    return width * (bottom - top) / (right - left)


def map_axes(ax: Axes | None, film: xr.Dataset, around: float) -> Axes:
    """Take the given axes, or those of a new figure for one map, with `around` it in inches."""
    height = image_height(film, MAP_WIDTH * ONE_COLUMN)
    return style.given_or_new(ax, film, height=height + around, text=around)


def figure_of_maps(
    figure: AnyFigure | None,
    film: xr.Dataset,
    *,
    more: str,
    width: float,
    around: float,
    least: float = 0.0,
) -> AnyFigure:
    """Take the given figure, or a new one of two columns whose maps have part of its width.

    `around` the maps and the `least` height are in inches.
    """
    height = max(image_height(film, width * TWO_COLUMNS) + around, least)
    return style.new_figure(TWO_COLUMNS, height, given=figure, text=around, named=film, more=more)


def state_reason(ax: Axes, flags: FlagImage, *, narrow: bool = True) -> None:
    """Write in a map without a valid pixel which flags take them, each on a line if `narrow`."""
    if reason := reason_empty(flags):
        lines = reason.replace(": ", "\n")
        style.state_empty(ax, lines.replace(", ", "\n") if narrow else lines)


def label_position(ax: Axes, film: xr.Dataset) -> None:
    """Label the axes of an image of the joint."""
    x, y = axis_labels(film)
    ax.set(xlabel=x, ylabel=y)


def joint_image(
    ax: Axes, film: xr.Dataset, values: npt.ArrayLike, limits: Limits, **look: Any
) -> AxesImage:
    """Draw an image of the joint on its labelled axes; `look` as for `draw_image`."""
    image = style.draw_image(ax, values, limits, extent=pixel_edges(film), **look)
    label_position(ax, film)
    return image


@styled
def thickness_map(
    film: xr.Dataset,
    *,
    trigger: int,
    ax: Axes | None = None,
    limits: tuple[float, float] | None = None,
    region: bool = True,
) -> AxesImage:
    """Draw the map of film thickness at one trigger; flagged pixels have the colour of their flag.

    Parameters
    ----------
    limits : (float, float), optional
        Ends of the colour scale [um]; default: the range of all but 1 % of the pixels of this map.
    region : bool
        Outline the region of interest.

    Returns
    -------
    AxesImage
        Film thickness [um], NaN where flagged.

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> image = thickness_map(example_film(), trigger=2, limits=(2, 8))
    >>> image.get_clim(), image.axes.get_xlabel()
    ((2.0, 8.0), 'x (sliding) [mm]')
    """
    check_trigger(film, trigger)
    ax = map_axes(ax, film, _LABELS)
    limits = limits or common_limits(film, [trigger])
    image = joint_image(ax, film, film.thickness.isel(trigger=trigger).values, limits, bad=None)

    flags = film.flags.isel(trigger=trigger).values
    _draw_flags(ax, flags, film)
    style.add_colour_bar(image, ax, "film thickness [µm]")
    state_reason(ax, flags, narrow=False)

    if region:
        _outline_region(ax, film)
    ax.set_title(describe_trigger(film, trigger), wrap=True)
    style.legend_below(ax)
    return image


def first_flag(flags: FlagImage) -> FlagImage:
    """Number the flag that is shown for each pixel: 0 valid, 1 the first of FLAG_COLOURS, ..."""
    # from the last to the first, so that the first remains
    shown = np.zeros(flags.shape, np.uint16)
    for n, flag in reversed(list(enumerate(style.FLAG_COLOURS, 1))):
        shown[(flags & int(flag)) != 0] = n
    return shown


def _draw_flags(ax: Axes, flags: FlagImage, film: xr.Dataset) -> None:
    """Draw flagged pixels over the map, with keys of the flags that occur."""
    shown = first_flag(flags)
    palette = ListedColormap(["none", *style.FLAG_COLOURS.values()])
    ends: dict[str, Any] = {"vmin": -0.5, "vmax": len(style.FLAG_COLOURS) + 0.5}
    ax.imshow(shown, cmap=palette, extent=pixel_edges(film), interpolation="none", **ends)
    edge: dict[str, Any] = {"edgecolor": "#404040", "linewidth": pt(0.4)}
    for n, (flag, colour) in enumerate(style.FLAG_COLOURS.items(), 1):
        if (share := float((shown == n).mean())) > 0:
            style.add_key(ax, f"{flag.title}, {describe_share(share)}", facecolor=colour, **edge)


def _outline_region(ax: Axes, film: xr.Dataset) -> None:
    """Outline a region of interest that is less than the image, black on white."""
    (left, right), (top, bottom) = region_of(film).x, region_of(film).y
    x, y = film.x.values, film.y.values
    if left <= x[0] and x[-1] <= right and top <= y[0] and y[-1] <= bottom:
        return
    corners = [left, right, right, left, left], [top, top, bottom, bottom, top]
    look: dict[str, Any] = {"linewidth": 1.1, "scalex": False, "scaley": False}
    style.draw_line(ax, *corners, "white", **look)
    look |= {"form": (0, (4, 3)), "label": "region of interest"}
    style.draw_line(ax, *corners, "black", **look)


@styled
def thickness_figure(
    film: xr.Dataset, *, trigger: int, figure: AnyFigure | None = None
) -> AnyFigure:
    """Draw the map at one trigger, its profile along sliding, and the difference to a rigid gap.

    Without the radii of [joint] there is no gap, and no difference to it.
    Arguments as in `erlif.plots`.

    Returns
    -------
    Figure
        Map, profile and, below it, the difference; two columns wide.

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> figure = thickness_figure(example_film(), trigger=1)
    >>> [ax.get_ylabel() for ax in figure.axes]
    ['y (axial) [mm]', 'film thickness [µm]', 'measured −\\nrigid gap [µm]']
    """
    check_trigger(film, trigger)
    more = describe_trigger(film, trigger)
    sizes = {"width": _WIDE, "around": _AROUND, "least": _LEAST}
    figure = figure_of_maps(figure, film, more=more, **sizes)
    grid: dict[str, Any] = {"mosaic": "mp"}
    if settings_of(film).joint is not None:
        grid = {"mosaic": "mp;mr", "height_ratios": (2.2, 1)}
    panels = figure.subplot_mosaic(width_ratios=(1.25, 1), **grid)
    thickness_map(film, trigger=trigger, ax=panels["m"])
    sliding_profile(film, trigger=trigger, ax=panels["p"])

    # the profile and the difference below it share the axis
    if "r" in panels:
        profile_residual(film, trigger=trigger, ax=panels["r"])
        panels["r"].lines[0].set_label(None)
        panels["p"].set_xlabel("")
        panels["p"].tick_params(labelbottom=False)

    # one legend below all panels, so that map and profiles end at one height
    style.legend_of_figure(figure)
    panels["m"].set_title("")
    style.letter_panels(*panels.values())
    return figure
