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
from erlif.io.files import driven_link, region_of
from erlif.show.plots import maps, style
from erlif.show.plots.naming import name_film
from erlif.show.plots.style import TWO_COLUMNS, AnyFigure, Limits, pt, styled

_SHEET_COLUMNS = (6, 10)  # fewest and most maps in a row of a sheet
_SHEET_MOST = 60  # maps on one sheet; with more triggers, evenly chosen ones are shown
_FOOT = 0.35  # inch for the texts above and below a sheet
_TITLE = 0.17  # inch for the angle above a map of a sheet
_WITHIN = 95.0  # percentile of the departures from the gap at the ends of their colour scale
_LEAST_REACH = 0.01  # um; a film that is its gap still needs a scale
_BLOCKS = 24  # along x of such a map
_SHAPES = 5  # of the gap: constant, and slope and curvature along x and y
_HUNDREDTH = 0.005  # half of one; degree
_MEAN = -1  # key of the mean over the triggers
_LESS_GAP = "film less the quadratic surface in x and y that fits its region of interest"
_BAR = 0.75  # inch beside a sheet for its colour bar


@styled
def map_sheet_figure(
    film: xr.Dataset, *, less_gap: bool = False, figure: AnyFigure | None = None
) -> AnyFigure:
    """Draw the maps of a cycle on one sheet with one colour scale, outward stroke first.

    Each stroke begins at its first trigger after the dead point. With more than sixty triggers,
    sixty evenly chosen ones are shown. Arguments that are not listed are those of `erlif.plots`.

    Parameters
    ----------
    less_gap : bool
        Draw the film less a smooth gap, which otherwise takes most of the colours: at each trigger
        the quadratic surface that fits the region of interest. Means over blocks of pixels.

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
    chosen = np.sort(np.concatenate([members for _, members in groups]))
    departures = {k: depart_from_gap(film, k) for k in chosen.tolist()} if less_gap else {}
    if less_gap and chosen.size > 1:
        departures[_MEAN] = _mean_departure(list(departures.values()))
        groups.append(("mean", np.array([_MEAN])))
    columns = best_columns([members.size for _, members in groups])
    rows = [math.ceil(members.size / columns) for _, members in groups]
    left, right, bottom, top = maps.pixel_edges(film)
    height = (TWO_COLUMNS - _BAR) / columns * (bottom - top) / (right - left) + _TITLE
    text = sum(rows) * _TITLE + _FOOT
    figure = style.new_figure(TWO_COLUMNS, sum(rows) * height + _FOOT, given=figure, text=text)
    panels = figure.subplots(sum(rows), columns, squeeze=False)

    quantity, titles = _small_titles(film, chosen)
    titles[_MEAN] = f"{chosen.size} triggers"
    if less_gap:
        every = np.concatenate([one.values.ravel() for one in departures.values()])
        limits = style.even_limits(every, within=_WITHIN, least=_LEAST_REACH)
    else:
        # a dozen maps are enough for the limits, and are read much faster than all
        limits = maps.common_limits(film, chosen.tolist()[:: max(1, chosen.size // 12)])

    # each stroke starts a row; panels without a map are hidden
    first = 0
    for (name, members), count in zip(groups, rows, strict=True):
        grid = panels[first : first + count]
        first += count
        for ax, trigger in zip(grid.ravel().tolist(), members.tolist(), strict=False):
            image = _draw_small_map(ax, film, trigger, limits, departures.get(trigger))
            ax.set_title(titles[trigger], fontsize=pt(6), pad=pt(1.5))

        # hidden axes are left out of the layout, the longest part of drawing a sheet
        for ax in grid.ravel():
            ax.set(xticks=[], yticks=[])
            ax.xaxis.set_visible(False)
            ax.yaxis.set_visible(ax in grid[:, 0])
        for ax in grid[:, 0]:
            ax.set_ylabel(name, labelpad=pt(2))
        for ax in grid.ravel()[members.size :]:
            ax.set_axis_off()

    # one line of the label is as long as two rows of maps are high, or three less their gap
    shown_as, missing = ("film less gap", "hatched") if less_gap else ("film thickness", "grey")
    between = "; " if sum(rows) >= (3 if less_gap else 2) else "\n"
    label = f"{shown_as} [µm]{between}{missing}: flagged"
    # beside all panels, the layout would measure it once for each; pad in widths of a column
    place: dict[str, Any] = {"ax": panels[:, -1].tolist(), "pad": 0.01 * columns}
    figure.colorbar(image, label=label, extend="both", aspect=40, shrink=0.9, **place)
    size = f"{right - left:.1f} mm × {bottom - top:.1f} mm, x to the right, y down"
    foot = f"{quantity} above each map; each map {size}"
    if less_gap:
        parts = (_LESS_GAP, maps.name_blocks(departures[int(chosen[0])]))
        foot += "\n" + "; ".join(part for part in parts if part)
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


def depart_from_gap(film: xr.Dataset, trigger: int) -> maps.MapBlocks:
    """Map of one trigger less the quadratic surface that fits its region of interest. [um]

    Examples
    --------
    The gap of this film is that of circles, which is a parabola to 0.02 um:

    >>> from erlif.show.plots import example_film
    >>> departure = depart_from_gap(example_film(), 1).values
    >>> bool(np.nanstd(departure) < 0.1)
    True
    """
    means = maps.average_in_blocks(
        film, film.thickness.isel(trigger=trigger).values, along_x=_BLOCKS
    )
    left, right, bottom, top = means.extent
    high, wide = means.values.shape
    x = left + (np.arange(wide) + 0.5) * (right - left) / wide
    y = top + (np.arange(high) + 0.5) * (bottom - top) / high
    x, y = (each.ravel() for each in np.meshgrid(x, y))
    h = means.values.ravel()

    region, known = region_of(film), np.isfinite(h)
    inside = known & (region.x[0] <= x) & (x <= region.x[1])
    inside &= (region.y[0] <= y) & (y <= region.y[1])
    use = inside if inside.sum() > _SHAPES else known
    shapes = np.stack([np.ones_like(x), x, y, x**2, y**2], axis=1)
    gap = shapes @ np.linalg.lstsq(shapes[use], h[use], rcond=None)[0]
    return means._replace(values=(h - gap).reshape(means.values.shape))


def _mean_departure(departures: list[maps.MapBlocks]) -> maps.MapBlocks:
    """Mean of the departures of all triggers, where half of them are known: marks of the wall."""
    values = np.stack([one.values for one in departures])
    known = np.isfinite(values).sum(axis=0)
    total = np.nansum(values, axis=0)
    half = len(departures) / 2
    return departures[0]._replace(values=np.where(known >= half, total / np.fmax(known, 1), np.nan))


def _draw_small_map(
    ax: Axes, film: xr.Dataset, trigger: int, limits: Limits, departure: maps.MapBlocks | None
) -> AxesImage:
    """Draw one map of a sheet, thinned to the resolution of print, or what departs from its gap."""
    if departure is not None:
        values = departure.values
        image = maps.draw_blocks(ax, film, departure, limits)
        style.hatch_missing(ax)
    else:
        values = maps.thin_map(film, trigger)
        image = style.draw_image(ax, values, limits, extent=maps.pixel_edges(film))
    if not np.isfinite(values).any():
        ax.text(0.5, 0.5, "no valid\npixel", transform=ax.transAxes, ha="center", va="center")
    return image


def _small_titles(film: xr.Dataset, chosen: npt.NDArray[np.intp]) -> tuple[str, dict[int, str]]:
    """Quantity in the titles of the maps of a sheet, and its value for each map."""
    for name, link in (("crank_angle", driven_link(film)), ("encoder_angle", "encoder")):
        if name in film:
            angles = film[name].values[chosen]
            # as many decimals as the angles have, up to two
            rest = [np.abs(angles - angles.round(n)).max() for n in range(2)]
            digits = next((n for n, most in enumerate(rest) if most < _HUNDREDTH), 2)
            texts = [f"{angle:.{digits}f}°" for angle in angles]
            return f"{link} angle", dict(zip(chosen.tolist(), texts, strict=True))
    if "time" in film:
        return "time", {k: f"{float(film.time[k]):.3g} s" for k in chosen.tolist()}
    return "trigger", {k: f"{k}" for k in chosen.tolist()}
