"""The maps of a cycle on one sheet, stroke by stroke."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.image import AxesImage

from erlif.core.arrays import Mask
from erlif.show.plots import style
from erlif.show.plots.maps import Limits, common_limits, pixel_edges, thin_map
from erlif.show.plots.naming import name_film
from erlif.show.plots.style import TWO_COLUMNS, AnyFigure, pt, styled

_SHEET_COLUMNS = (7, 10)  # fewest and most maps in a row of a sheet
_SHEET_MOST = 60  # maps on one sheet; with more triggers, evenly chosen ones are shown
_FOOT = 0.35  # inch for the texts above and below a sheet
_TITLE = 0.17  # inch for the angle above a map of a sheet
_BAR = 0.75  # inch beside a sheet for its colour bar


@styled
def map_sheet_figure(film: xr.Dataset, *, figure: AnyFigure | None = None) -> AnyFigure:
    """Draw the maps of a cycle on one sheet with one colour scale, outward stroke first.

    Each stroke begins at its first trigger after the dead point. With more than sixty triggers,
    sixty evenly chosen ones are shown. Arguments as in `erlif.plots`.

    Returns
    -------
    Figure
        As many rows as the strokes take, over the width of two columns.

    Examples
    --------
    Six maps and the colour bar:

    >>> from erlif.show.plots import example_film
    >>> len(map_sheet_figure(example_film()).axes)
    7
    """
    groups = sheet_groups(film)
    columns = best_columns([members.size for _, members in groups])
    rows = [math.ceil(members.size / columns) for _, members in groups]
    left, right, bottom, top = pixel_edges(film)
    height = (TWO_COLUMNS - _BAR) / columns * (bottom - top) / (right - left) + _TITLE
    text = sum(rows) * _TITLE + _FOOT
    figure = style.given_figure(figure, TWO_COLUMNS, sum(rows) * height + _FOOT, text=text)
    panels = figure.subplots(sum(rows), columns, squeeze=False)

    # a dozen maps are enough for the limits, and are read much faster than all
    chosen = np.sort(np.concatenate([members for _, members in groups]))
    limits = common_limits(film, chosen.tolist()[:: max(1, chosen.size // 12)])

    # each stroke starts a row; panels without a map are hidden
    first = 0
    for (name, members), count in zip(groups, rows, strict=True):
        grid = panels[first : first + count]
        first += count
        for ax, trigger in zip(grid.ravel().tolist(), members.tolist(), strict=False):
            image = _draw_small_map(ax, film, trigger, limits)

        # hidden axes are left out of the layout, the longest part of drawing a sheet
        for ax in grid.ravel():
            ax.set(xticks=[], yticks=[])
            ax.xaxis.set_visible(False)
            ax.yaxis.set_visible(ax in grid[:, 0])
        for ax in grid[:, 0]:
            ax.set_ylabel(name, labelpad=pt(2))
        for ax in grid.ravel()[members.size :]:
            ax.set_axis_off()

    # one row of maps is lower than the label is long
    label = "film thickness [µm]" + ("; " if sum(rows) > 1 else "\n") + "grey: flagged"
    # beside all panels, the layout would measure it once for each; pad in widths of a column
    place: dict[str, Any] = {"ax": panels[:, -1].tolist(), "pad": 0.01 * columns}
    figure.colorbar(image, label=label, extend="both", aspect=40, shrink=0.9, **place)
    size = f"{right - left:.1f} mm × {bottom - top:.1f} mm, x to the right, y down"
    foot = f"{_small_title(film, 0)[0]} above each map; each map {size}"
    figure.supxlabel(foot, fontsize=pt(6.5))
    shown = "" if chosen.size == film.sizes["trigger"] else f"{chosen.size} of "
    name_film(figure, film, f"{shown}{film.sizes['trigger']} triggers")
    return figure


def sheet_groups(film: xr.Dataset) -> list[tuple[str, npt.NDArray[np.intp]]]:
    """Triggers of a sheet, by stroke, each from the start of the stroke."""
    count = film.sizes["trigger"]
    chosen = np.unique(np.linspace(0, count - 1, min(count, _SHEET_MOST)).round().astype(np.intp))
    if "stroke" not in film:
        return [("", chosen)]
    strokes = film.stroke.values[chosen]
    start = _from_start if _is_one_cycle(film) else np.flatnonzero
    groups = [
        (name, chosen[start(strokes == sign)]) for name, sign in (("outward", 1), ("return", -1))
    ]
    return [(name, members) for name, members in groups if members.size]


def _is_one_cycle(film: xr.Dataset) -> bool:
    """Whether the triggers are those of one turn of the drive, after which the first follows."""
    if "crank_angle" not in film:
        return False
    return bool((np.diff(film.crank_angle.values) % 360).sum() < 360)


def _from_start(members: Mask) -> npt.NDArray[np.intp]:
    """Positions of a stroke in a cycle, from its start; the cycle may begin within the stroke."""
    starts = np.flatnonzero(members & ~np.roll(members, 1))
    places = np.flatnonzero(members)
    if starts.size != 1:
        return places
    return np.roll(places, -int(np.searchsorted(places, starts[0])))


def best_columns(sizes: list[int]) -> int:
    """Number of columns with the fewest gaps where every group starts a new row."""
    most = min(_SHEET_COLUMNS[1], max(sizes))
    fewest = min(_SHEET_COLUMNS[0], most)
    return min(
        range(most, fewest - 1, -1), key=lambda columns: sum(-size % columns for size in sizes)
    )


def _draw_small_map(ax: Axes, film: xr.Dataset, trigger: int, limits: Limits) -> AxesImage:
    """Draw one map of a sheet, thinned to the resolution of print."""
    values = thin_map(film, trigger)
    colours = style.colour_map("batlow", bad=style.FLAGGED)
    ends: dict[str, Any] = {"vmin": limits[0], "vmax": limits[1]}
    image = ax.imshow(values, cmap=colours, extent=pixel_edges(film), **ends)
    if not np.isfinite(values).any():
        ax.text(0.5, 0.5, "no valid\npixel", transform=ax.transAxes, ha="center", va="center")
    ax.set_title(_small_title(film, trigger)[1], fontsize=pt(6), pad=pt(1.5))
    style.close_frame(ax)
    return image


def _small_title(film: xr.Dataset, trigger: int) -> tuple[str, str]:
    """What stands above the maps of a sheet, and its value for one of them."""
    for name in ("crank_angle", "encoder_angle"):
        if name in film:
            return name.replace("_", " "), f"{float(film[name][trigger]):.2f}°"
    if "time" in film:
        return "time", f"{float(film.time[trigger]):.3g} s"
    return "trigger", f"{trigger}"
