"""Runs compared: film against duty parameter, difference map, control chart."""

from __future__ import annotations

from itertools import cycle
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.container import Container
from matplotlib.image import AxesImage

from erlif.core.arrays import Array
from erlif.core.errors import ErlifError
from erlif.core.variables import FILM
from erlif.show.plots import style
from erlif.show.plots.maps import image_height, pixel_edges
from erlif.show.plots.style import MEAN, MINIMUM, MUTED, OUTWARD, RETURN, TWO_COLUMNS, styled
from erlif.trend import SLOWEST

_COLOURS = (OUTWARD, RETURN, MEAN, "#CC79A7", "#E69F00", "#56B4E9", MINIMUM, MUTED)
_MARKERS = "osD^vPX*"
_PREFIXES = {0: "", -3: "m", -6: "µ", -9: "n", -12: "p"}
_MAP_WIDTH = 0.75  # of a column; the colour bar has the rest
_LABELS = 0.75  # inch above and below a map
_TALL = 0.48  # height by width of a figure of two panels
_SIDE_BY_SIDE = 3  # most pairs whose names stand side by side
_PAIR = 0.15  # width of a pair, over that of the other panel
_LEAST_LIMIT = 1e-3  # um, of the colours of a difference


@styled
def film_against_duty(
    comparison: xr.Dataset, *, statistic: str = "film_min", ax: Axes | None = None
) -> list[Artist | Container]:
    """Draw a film statistic of all runs against the duty parameter, with powers and theory.

    Parameters
    ----------
    comparison : xarray.Dataset
        As `erlif.compare` returns it.
    statistic : str
        "film_min" or "film_mean".
    ax : Axes, optional
        Default: those of a new figure, one column wide. Both scales become logarithmic.

    Returns
    -------
    list of Artist or Container
        Points of each run with bars of one standard deviation, then the joint power where it is
        known, then the theory of each run where it is known.

    Raises
    ------
    ErlifError
        If the runs have no speed or no load.

    Examples
    --------
    >>> import erlif
    >>> from erlif.show.plots import example_film
    >>> film = example_film()
    >>> comparison = erlif.compare([film, film.assign(film_min=film.film_min + 0.5)])
    >>> first, *_ = film_against_duty(comparison)
    >>> first.get_label()
    '1  example (1), n = 0.600 ± 0.004'
    """
    if "duty" not in comparison:
        raise ErlifError(
            "Expected runs with speed and load; one of them has none. Compare runs whose log has "
            "them."
        )
    ax = style.given_or_new(ax, height=style.ONE_COLUMN)
    ax.set(xscale="log", yscale="log")
    scale, unit = _prefixed(comparison.duty.values, str(comparison.duty.attrs["units"]))
    artists: list[Artist | Container] = []
    theories: list[Artist | Container] = []
    looks = zip(cycle(_COLOURS), cycle(_MARKERS), strict=False)
    for k, (colour, marker) in zip(range(comparison.sizes["run"]), looks, strict=False):
        run = comparison.isel(run=k).sel(statistic=statistic)
        # the scales are logarithmic
        use = (run[statistic].values > 0) & (run.duty.values > 0)
        columns = scale * run.duty, run[statistic], run[f"{statistic}_std"]
        x, film, error = (one.values[use] for one in columns)
        look: dict[str, Any] = {"fmt": marker, "color": colour, "elinewidth": 0.7}
        look["markerfacecolor"] = "white" if k % 2 else colour
        look["label"] = f"{k + 1}  {run.run.item()}{_power(run.exponent, run.exponent_std)}"
        artists.append(ax.errorbar(x, film, error, **look))

        # of each run as points: a transient film is no function of duty
        if statistic == "film_min" and "film_theory" in comparison:
            look = {"label": "theory, in the colour of the run", "zorder": 1}
            theory = scale * run.duty, run.film_theory
            theories += style.draw_line(ax, *theory, colour, form="x", size=3, **look)

    joint = comparison.sel(statistic=statistic)
    if np.isfinite(joint.joint_exponent):
        ends = np.geomspace(*_range_of_fit(comparison), 50)
        label = f"all runs{_power(joint.joint_exponent, joint.joint_exponent_std)}"
        film = np.exp(float(joint.joint_log_scale)) * ends ** float(joint.joint_exponent)
        artists += ax.plot(scale * ends, film, color="black", linewidth=0.8, label=label, zorder=4)

    # the name of a variable is no name of a quantity
    meaning = str(comparison.duty.attrs["long_name"])
    for name in ("|rocker_speed|", "|sliding_speed|"):
        meaning = meaning.replace(name, "speed")
    ax.set_xlabel(f"{meaning} [{unit}]".replace("-1", "⁻¹"))
    ax.set_ylabel(f"{FILM[statistic].attrs['long_name']} [µm]")
    style.plain_log_ticks(ax)
    style.legend_below(ax, ncols=1)
    return [*artists, *theories]


def _power(value: xr.DataArray, std: xr.DataArray) -> str:
    """A fitted power as part of a label."""
    if not np.isfinite(value):
        return ""
    return f", n = {float(value):.3f} ± {float(std):.3f}".replace("-", "−")


def _range_of_fit(comparison: xr.Dataset) -> tuple[float, float]:
    """Smallest and largest duty parameter of the triggers of the fits."""
    speed, duty = comparison.speed.values, comparison.duty.values
    fast = speed >= SLOWEST * np.nanmax(speed, axis=1)[:, None]
    return float(np.nanmin(duty[fast])), float(np.nanmax(duty[fast]))


def _prefixed(values: Array, unit: str) -> tuple[float, str]:
    """Factor and unit with which the largest value has one to three digits before the point."""
    size = int(np.floor(np.log10(np.nanmax(values)) / 3)) * 3
    size = min(max(size, min(_PREFIXES)), 0)
    # a prefix belongs to the first unit of the product, and 10^-3 stands where none is usual
    if unit.startswith("Pa") and size in _PREFIXES:
        return 10.0**-size, f"{_PREFIXES[size]}{unit}"
    return 10.0**-size, f"10$^{{{size}}}$ {unit}" if size else unit


@styled
def difference_map_of_runs(comparison: xr.Dataset, *, ax: Axes | None = None) -> AxesImage:
    """Draw the difference map of two runs, with the outline of what is significant.

    Arguments as in `film_against_duty`.

    Returns
    -------
    AxesImage
        Difference [um], hatched where one of the runs has too few valid pixels.

    Examples
    --------
    >>> import erlif
    >>> from erlif.show.plots import example_film
    >>> film = example_film()
    >>> comparison = erlif.compare([film, film.assign(film_min=film.film_min + 0.5)])
    >>> difference_map_of_runs(comparison).axes.get_xlabel()
    'x [mm]'
    """
    cells = comparison[["map_difference", "map_differs"]].rename(map_x="x", map_y="y")
    ax = style.given_or_new(ax, height=image_height(cells, _MAP_WIDTH * style.ONE_COLUMN) + _LABELS)
    values = cells.map_difference.values
    limits = style.even_limits(values, within=99, least=_LEAST_LIMIT)
    look: dict[str, Any] = {"colours": "vik", "bad": "none"}
    image = style.draw_image(ax, values, limits, extent=pixel_edges(cells), **look)
    style.hatch_missing(ax, "" if np.isfinite(values).all() else "too few valid pixels")
    _outline(ax, cells)
    style.add_colour_bar(image, ax, "difference [µm]")

    # both runs are named by the order in which they are subtracted
    attrs = comparison.attrs
    ax.set(xlabel="x [mm]", ylabel="y [mm]")
    runs = f"{attrs['map_second_run']}\nless {attrs['map_first_run']}"
    ax.set_title(f"{runs}\n{attrs['map_first']}", fontsize="medium")
    style.legend_below(ax)
    return image


def _outline(ax: Axes, cells: xr.Dataset) -> None:
    """Draw the edges between cells that differ significantly and cells that do not."""
    differs = np.pad(cells.map_differs.values.astype(bool), 1)
    left, right, bottom, top = pixel_edges(cells)
    rows, columns = cells.map_differs.shape

    # column and row of both ends of each edge, and a gap behind it
    beside = np.argwhere(differs[1:-1, 1:] != differs[1:-1, :-1])
    below = np.argwhere(differs[1:, 1:-1] != differs[:-1, 1:-1])
    gap = [np.nan, np.nan]
    ends = [end for row, column in beside for end in ([column, row], [column, row + 1], gap)]
    ends += [end for row, column in below for end in ([column, row], [column + 1, row], gap)]
    x, y = np.reshape(ends, (-1, 2)).T
    dx, dy = (right - left) / columns, (bottom - top) / rows
    label = "edge of a significant difference"
    ax.plot(left + x * dx, top + y * dy, color="black", linewidth=0.8, label=label)


@style.panel
def control_chart_of(
    comparison: xr.Dataset, quantity: str, *, ax: Axes = style.NEW
) -> list[Artist | Container]:
    """Draw a control chart: values with their bars, centre and limits.

    `ErlifError` is raised where the comparison has none.

    Arguments that are not listed are those of `film_against_duty`.

    Parameters
    ----------
    quantity : str
        "patch", the ratio of the reference patch run by run, or "calibration", the ratio of a film
        by each calibration.

    Returns
    -------
    list of Artist or Container
        Points, then those beyond the limits, where there are any.

    Examples
    --------
    >>> from dataclasses import replace
    >>> from erlif.review.comparison import control_chart
    >>> from erlif.show.plots import example_calibration
    >>> one = example_calibration()
    >>> chart = control_chart([], [one, replace(one, ratio_at_zero=0.7, date="2026-05-02")])
    >>> len(control_chart_of(chart, "calibration"))
    2
    """
    if f"{quantity}_ratio" not in comparison:
        raise ErlifError(
            f"Expected a comparison with a control chart of the {quantity}; this one has none. "
            "Compare runs with a reference patch, or name several calibrations."
        )
    value, std = (comparison[f"{quantity}_{name}"].values for name in ("ratio", "ratio_std"))
    centre, limit = (float(comparison[f"{quantity}_{name}"]) for name in ("centre", "limit"))
    place = np.arange(value.size)
    artists: list[Artist | Container] = [
        ax.errorbar(place, value, std, fmt="o", color=OUTWARD, elinewidth=0.7)
    ]

    # centre and limits of the chart, which the values are judged by
    ax.axhline(centre, color=MUTED, linewidth=0.8, label="mean")
    for level, label in ((centre - limit, "limits, 3 s.d."), (centre + limit, None)):
        ax.axhline(level, label=label, color=MUTED, linewidth=0.8, linestyle=(0, (3, 1.5)))

    # a ring and not another colour of the point, for print in grey
    beyond = np.abs(value - centre) > limit
    if beyond.any():
        ring: dict[str, Any] = {"size": 7, "markerfacecolor": "none", "label": "beyond"}
        at = place[beyond], value[beyond]
        artists += style.draw_line(ax, *at, RETURN, form="o", **ring)

    called, where = "run", "on the reference patch"
    if quantity != "patch":
        called, where = (
            "calibration_date",
            f"of a film of {float(comparison.calibration_film):.1f} µm",
        )
    names = [str(name) or "no date" for name in comparison[called].values]
    ax.set_xticks(place, names, rotation=30, ha="right")
    ax.set(ylabel=f"ratio {where} [1]", xmargin=0.1)
    style.legend_above(ax)
    return artists


@styled
def comparison_figure(comparison: xr.Dataset) -> style.AnyFigure:
    """Draw film against duty parameter and the differences of all pairs, as `film_against_duty`.

    Returns
    -------
    Figure
        Two columns wide; one, without the duty parameter, where speed or load is not known.

    Examples
    --------
    >>> import erlif
    >>> from erlif.show.plots import example_film
    >>> film = example_film()
    >>> comparison = erlif.compare([film, film.assign(film_min=film.film_min + 0.5)])
    >>> [ax.get_ylabel() for ax in comparison_figure(comparison).axes]
    ['minimum film thickness [µm]', 'difference [µm]']
    """
    if "duty" not in comparison:
        figure = style.new_figure()
        _draw_differences(figure.add_subplot(), comparison, names=comparison.run.values)
        return figure

    # a pair takes the width of its bars; runs are numbered, with names beside the other panel
    share = min(_PAIR * (comparison.sizes["pair"] + 1), 1.0)
    figure = style.new_figure(TWO_COLUMNS, _TALL * TWO_COLUMNS)
    left, right = figure.subplots(1, 2, width_ratios=(1, share))
    film_against_duty(comparison, ax=left)
    numbers = np.arange(1, comparison.sizes["run"] + 1)
    _draw_differences(right, comparison, names=numbers)
    style.letter_panels(left, right)
    return figure


def _draw_differences(ax: Axes, comparison: xr.Dataset, names: npt.NDArray[Any]) -> None:
    """Differences of all pairs with bars of one standard deviation; `names` are those of runs."""
    place = np.arange(comparison.sizes["pair"])
    for shift, name, colour, marker, label in (
        (-0.12, "film_min", MINIMUM, "o", "minimum film"),
        (0.12, "film_mean", MEAN, "s", "mean film"),
    ):
        one = comparison.sel(statistic=name)
        value, std = one.difference.values, one.difference_std.values
        look: dict[str, Any] = {"fmt": marker, "color": colour, "elinewidth": 0.9}
        ax.errorbar(place + shift, value, std, label=f"{label}, {style.ONE_STD}", **look)
        # which differences are significant depends on the number of all tests
        for k in np.flatnonzero(one.differs.values):
            style.write_beside(ax, "*", (place[k] + shift, value[k]), (4, 0), color=colour)
    ax.axhline(0, color=MUTED, linewidth=0.6)

    # pairs are named in the order of the difference, turned where they would overlap
    called = dict(zip(comparison.run.values.tolist(), names.tolist(), strict=True))
    pairs = zip(comparison["first"].values, comparison.second.values, strict=True)
    labels = [f"{called[second]} less {called[first]}" for first, second in pairs]
    if place.size <= _SIDE_BY_SIDE:
        ax.set_xticks(place, [label.replace(" less ", "\nless ") for label in labels])
    else:
        ax.set_xticks(place, labels, rotation=60, ha="right", rotation_mode="anchor")
    ax.set_xlim(-0.6, place.size - 0.4)
    ax.set_ylabel("difference [µm]")
    # beside the films, the panel of few pairs is narrower than the legend
    add_legend = style.legend_below if place.size <= _SIDE_BY_SIDE else style.legend_above
    starred = "* differs, corrected\nfor the number of tests" if comparison.differs.any() else ""
    add_legend(ax, title=starred, ncols=1)


@styled
def write_comparison_figures(comparison: xr.Dataset, folder: Path) -> list[Path]:
    """Write the figures of a comparison as PNG.

    Arguments that are not listed are those of `film_against_duty`.

    Parameters
    ----------
    folder : Path
        Where to write them.

    Returns
    -------
    list of Path
        The files in the order in which they were drawn.

    Examples
    --------
    >>> import erlif
    >>> from tempfile import TemporaryDirectory
    >>> from erlif.show.plots import example_film
    >>> film = example_film()
    >>> comparison = erlif.compare([film, film.assign(film_min=film.film_min + 0.5)])
    >>> with TemporaryDirectory() as directory:
    ...     [path.name for path in write_comparison_figures(comparison, Path(directory))]
    ['films.png', 'difference_map.png']
    """
    figures: dict[str, style.AnyFigure] = {"films": comparison_figure(comparison)}
    image = difference_map_of_runs(comparison)
    figures["difference_map"] = style.figure_of(image)
    for quantity in ("patch", "calibration"):
        if f"{quantity}_ratio" in comparison:
            figure = style.new_figure()
            control_chart_of(comparison, quantity, ax=figure.add_subplot())
            figures[f"control_{quantity}"] = figure
    return [style.save_figure(figure, folder / f"{name}.png") for name, figure in figures.items()]
