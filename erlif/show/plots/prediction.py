"""The film that theory predicts, beside the measured one: over the cycle, over the run, as maps."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes

from erlif.core.arrays import Array, Image
from erlif.core.errors import ConfigError
from erlif.io.files import check_trigger, describe_trigger, settings_of
from erlif.pipeline.physics.prediction import film_along_sliding
from erlif.pipeline.plane import ObjectPlane
from erlif.show.plots import style, triggers
from erlif.show.plots.maps import (
    average_in_blocks,
    common_limits,
    draw_blocks,
    figure_of_maps,
    joint_image,
    label_position,
    name_blocks,
    state_reason,
)
from erlif.show.plots.style import MINIMUM, OUTWARD, TWO_COLUMNS, AnyFigure, pt, styled
from erlif.show.report.prediction import describe_correlation

_TALL = 0.42  # height by width of the two panels over cycle and run
_THIRD = 0.26  # of two columns, for each of three maps
_AROUND = 0.95  # inch above and below the maps, for title, labels and legend
_WITHIN = 99.5  # percentile of the differences at the ends of their colour scale
_LEAST_REACH = 0.01  # um; equal maps still need a scale
_MINIMUM = "minimum film thickness [µm]"
_MEASURED: dict[str, Any] = {"colour": MINIMUM, "label": "measured", "zorder": 3}
_PREDICTED: dict[str, Any] = {"colour": OUTWARD, "width": 1.0, "zorder": 2}


def has_prediction(film: xr.Dataset) -> bool:
    """Whether a film holds the transient film that theory predicts."""
    return "film_predicted_min" in film


@style.film_panel
def film_and_prediction(film: xr.Dataset, *, ax: Axes = style.NEW) -> list[Artist]:
    """Draw measured and predicted minimum film against crank angle.

    `ConfigError` is raised where the film has no prediction.

    Parameters
    ----------
    film : xarray.Dataset
        As `erlif.process` returns it, with a prediction.

    Returns
    -------
    list of Artist
        Measured points of both strokes, with bars of one standard deviation; the prediction, in a
        band of its own.

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> *points, line = film_and_prediction(example_film())
    >>> line.get_label()
    'predicted, pin free sideways'
    """
    _require_prediction(film)
    bars, line = triggers.bars_of(film), _PREDICTED | {"label": _name_line(film)}
    columns = film.film_min.values, bars.std, film.film_predicted_min.values
    artists = triggers.draw_over_cycle(ax, film, _MINIMUM, *columns, line, **_MEASURED)
    along = triggers.choose_abscissa(film).values
    _draw_band(ax, film, along, triggers.in_order(film, along))
    style.legend_below(ax, title=bars.title)
    return artists


@style.film_panel
def film_over_run(film: xr.Dataset, frames: xr.Dataset, *, ax: Axes = style.NEW) -> list[Artist]:
    """Draw measured and predicted minimum film against the turns of the crank since the start.

    Arguments that are not listed are those of `film_and_prediction`.

    Parameters
    ----------
    frames : xarray.Dataset
        Group frames of the film: trigger, elapsed_cycles and film_predicted_min (frame). [um]

    Returns
    -------
    list of Artist
        Measured points of both strokes, each at the mean turn of its frames; the prediction of
        every frame.

    Examples
    --------
    >>> from erlif.show.plots import example_film, example_frames
    >>> *points, line = film_over_run(example_film(), example_frames())
    >>> line.axes.get_xlabel()
    'turns of the crank [1]'
    """
    _require_prediction(film)
    turns, trigger = frames.elapsed_cycles.values, frames.trigger.values
    number = film.sizes["trigger"]
    count = np.maximum(np.bincount(trigger, minlength=number)[:number], 1)
    mean = np.bincount(trigger, turns, minlength=number)[:number] / count
    bars = triggers.bars_of(film)
    artists = triggers.draw_strokes(ax, film, mean, film.film_min.values, bars.std, **_MEASURED)
    order = np.argsort(turns, kind="stable")
    stretches = np.split(order, np.flatnonzero(triggers.find_gaps(np.diff(turns[order]))) + 1)
    predicted = frames.film_predicted_min.values
    look = _PREDICTED | {"label": _name_line(film)}
    artists += triggers.draw_stretches(ax, stretches, turns, predicted, **look)
    _draw_band(ax, frames, turns, stretches)
    ax.set(xlabel="turns of the crank [1]", ylabel=_MINIMUM)
    style.legend_below(ax, title=bars.title)
    return artists


def _name_line(film: xr.Dataset) -> str:
    """Key of the predicted film: how the pin is held."""
    held = str(film.film_predicted_min.attrs["regime"]).removeprefix("transient Reynolds, ")
    return f"predicted, {held}"


def _draw_band(
    ax: Axes, film: xr.Dataset, x: Array, stretches: Sequence[npt.NDArray[np.intp]]
) -> None:
    """Draw one standard deviation about the predicted film, where it is known."""
    if "film_predicted_min_std" not in film:
        return
    middle, std = film["film_predicted_min"].values, film["film_predicted_min_std"].values
    low, high = middle - std, middle + std
    for k, part in enumerate(stretches):
        label = "± 1 s.d. by viscosity, load, clearance" if k == 0 else None
        style.draw_band(ax, x[part], low[part], high[part], OUTWARD, label=label, zorder=1)


@style.film_panel
def film_less_prediction(film: xr.Dataset, *, ax: Axes = style.NEW) -> list[Artist]:
    """Draw measured less predicted minimum film against crank angle.

    Arguments as in `film_and_prediction`.

    Returns
    -------
    list of Artist
        Points of both strokes, with bars of one standard deviation; the line of no difference.

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> *points, line = film_less_prediction(example_film())
    >>> line.axes.get_ylabel()
    'measured − predicted [µm]'
    """
    _require_prediction(film)
    bars = triggers.bars_of(film)
    difference = film.film_min.values - film.film_predicted_min.values
    along = triggers.choose_abscissa(film)
    artists = triggers.draw_strokes(ax, film, along.values, difference, bars.std, **_MEASURED)
    artists.append(ax.axhline(0.0, color=OUTWARD, linewidth=pt(1.0), zorder=2))
    still = film.assign(film_predicted_min=0.0 * film.film_predicted_min)
    _draw_band(ax, still, along.values, triggers.in_order(film, along.values))
    triggers.label_abscissa(ax, along)
    ax.set_ylabel("measured − predicted [µm]")
    style.legend_below(ax, title=bars.title)
    return artists


@styled
def prediction_figure(
    film: xr.Dataset, frames: xr.Dataset, *, figure: AnyFigure | None = None
) -> AnyFigure:
    """Draw measured and predicted film against crank angle, and against the turns of the crank.

    Of one turn, the second panel has measured less predicted film. Arguments as in `film_over_run`.

    Returns
    -------
    Figure
        Two panels beside each other, two columns wide.

    Examples
    --------
    >>> from erlif.show.plots import example_film, example_frames
    >>> figure = prediction_figure(example_film(), example_frames())
    >>> [ax.get_xlabel() for ax in figure.axes]
    ['crank angle [°]', 'crank angle [°]']
    """
    figure = style.new_figure(TWO_COLUMNS, _TALL * TWO_COLUMNS, given=figure, named=film)
    left, right = figure.subplots(1, 2)
    film_and_prediction(film, ax=left)
    if np.ptp(frames.elapsed_cycles.values) < 1:
        film_less_prediction(film, ax=right)
    else:
        film_over_run(film, frames, ax=right)
    title = triggers.bars_of(film).title
    if correlation := describe_correlation(film).replace("-", "−"):
        title += f"\ncorrelation with |speed|: {correlation}"
    style.legend_of_figure(figure, title=title)
    style.letter_panels(left, right)
    return figure


def predicted_map(film: xr.Dataset, *, trigger: int) -> Image:
    """Compute the predicted map of one trigger from its eccentricity and attitude.

    Arguments as in `film_and_prediction`.

    Returns
    -------
    array of float32, (y, x)
        [um]

    Examples
    --------
    The thinnest film of this trigger:

    >>> from erlif.show.plots import example_film
    >>> print(f"{predicted_map(example_film(), trigger=0).min():.1f}")
    3.2
    """
    _require_prediction(film)
    check_trigger(film, trigger)
    settings, x, y = settings_of(film), film.x.values, film.y.values
    plane = ObjectPlane(settings, (y.size, x.size))
    position = x if plane.sliding_along_x else y
    return plane.spread(film_along_sliding(settings, film.isel(trigger=trigger), position))


@styled
def prediction_map_figure(
    film: xr.Dataset, *, trigger: int, figure: AnyFigure | None = None
) -> AnyFigure:
    """Draw the measured map, the predicted one on the same scale, and their difference.

    The difference is averaged in blocks, as the noise of single pixels would hide it. Arguments as
    in `predicted_map`.

    Returns
    -------
    Figure
        Three maps, two columns wide.

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> figure = prediction_map_figure(example_film(), trigger=1)
    >>> measured, predicted, difference = [ax.images[0] for ax in figure.axes[:3]]
    >>> measured.get_clim() == predicted.get_clim()
    True
    """
    predicted = predicted_map(film, trigger=trigger)
    measured = film.thickness.isel(trigger=trigger).values
    low, high = common_limits(film, [trigger])
    low, high = min(low, float(predicted.min())), max(high, float(predicted.max()))
    means = average_in_blocks(film, measured - predicted)
    reach = style.even_limits(means.values, within=_WITHIN, least=_LEAST_REACH)

    more = describe_trigger(film, trigger)
    figure = figure_of_maps(figure, film, width=_THIRD, around=_AROUND, more=more)
    panels = figure.subplots(1, 3, sharey=True)
    for ax, values in zip(panels, (measured, predicted), strict=False):
        image = joint_image(ax, film, values, (low, high), bad="none")
    difference = draw_blocks(panels[2], film, means, reach)
    label_position(panels[2], film)
    style.add_colour_bar(image, panels[1], "film, (a, b) [µm]")
    style.add_colour_bar(difference, panels[2], f"difference [µm]\n{name_blocks(means)}".rstrip())

    hatched = "" if np.isfinite(measured).all() else "not valid"
    titles = ("measured", "predicted", "measured − predicted")
    for ax, title in zip(panels, titles, strict=True):
        style.hatch_missing(ax, hatched)
        ax.set(title=title, ylabel=ax.get_ylabel() if ax is panels[0] else "")
    state_reason(panels[0], film.flags.isel(trigger=trigger).values)
    style.letter_panels(*panels)
    style.legend_of_figure(figure)
    return figure


def _require_prediction(film: xr.Dataset) -> None:
    if not has_prediction(film):
        raise ConfigError(
            "Expected a film with a prediction; this one has none. Give [mechanism] of kind "
            '"crank-rocker", [joint] and [oil] in run.toml and process the run again.'
        )
