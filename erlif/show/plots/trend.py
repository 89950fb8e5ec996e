"""Film thickness against speed over load, measured and predicted."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from erlif.core.arrays import Array
from erlif.io.files import formula_label, formula_scope, shows_plateau
from erlif.show.plots import style
from erlif.show.plots.style import MEAN, MINIMUM, MUTED, OUTWARD, RETURN, AnyFigure, pt, styled
from erlif.show.plots.triggers import (
    bars_of,
    draw_strokes,
    have_partial_mean,
    state_no_film,
    stroke_looks,
)
from erlif.trend import fast_triggers

# labels of the axis by the speed: that of the joint in a linkage, else the sliding speed
_LABELS = {
    "rocker_speed": "speed over load, |ω|/F [10⁻³ rad s⁻¹ N⁻¹]",
    "sliding_speed": "sliding speed over load, v/F [10⁻³ m s⁻¹ N⁻¹]",
}

_TALL, _TWO_ROWS = 0.52, 1.6  # height by width of one row of panels, and two rows over it

_MILLI = 1e3  # speed over load is drawn in thousandths
_DASHES = (0, (3, 1.5))
_DASH_DOT = (0, (4, 1.5, 1, 1.5))
_AROUND_POINTS = 6.0  # size of open markers round measured points, which have half of it
_REACH = 3.0  # theory within this factor of the measured film widens the axis
_LEAST_RATIO = 1.2  # highest over lowest value of an axis
_MARGIN = 0.06  # of the axis on either side of the curves

# Ratios of a film with their colours, and what they are over.
_RATIOS = {
    "film_over_hamrock_dowson": (OUTWARD, ""),
    "film_over_theory": (RETURN, "regime map"),
    "film_central_over_theory": (MINIMUM, "regime map, at the centre"),
    "film_over_predicted": (MEAN, "transient film"),
}


def _speed_name(film: xr.Dataset) -> str:
    """The speed that the exponents of a film belong to."""
    # the log may have a sliding speed of its own, which the exponents then name
    named = film["speed_exponent"].attrs.get("speed") if "speed_exponent" in film else None
    if isinstance(named, str) and named in _LABELS and named in film:
        return named
    return "rocker_speed" if "rocker_speed" in film else "sliding_speed"


def speed_over_load(film: xr.Dataset) -> Array:
    """Speed over load of each trigger, without sign. [rad s-1 N-1, else m s-1 N-1]"""
    return np.asarray(np.abs(film[_speed_name(film)].values) / film["joint_load"].values)


@style.film_panel
def film_against_speed(film: xr.Dataset, *, ax: Axes = style.NEW) -> list[Artist]:
    """Draw mean and minimum film thickness against speed over load, with the fitted powers.

    Bars are one standard deviation, random and shared. What the fit leaves out is grey: triggers
    that are too slow, and means that leave out pixels beyond the measurable range.

    Parameters
    ----------
    ax : Axes, optional
        Default: those of a new figure, one column wide. Both scales become logarithmic.

    Returns
    -------
    list of Artist
        The points of both strokes for mean and minimum, then the two fitted lines.

    Examples
    --------
    The minimum film thickness of this film is proportional to the speed to the power of 0.6:

    >>> import numpy as np
    >>> from erlif.show.plots import example_film
    >>> *_, line = film_against_speed(example_film())
    >>> x, y = np.log(line.get_data())
    >>> float(np.polyfit(x, y, 1)[0].round(6))
    0.6
    """
    ax.set(xscale="log", yscale="log")
    artists: list[Artist] = []
    lines: list[Line2D] = []
    for name, exponent, colour, dashes, label in (
        ("film_mean", "speed_exponent_mean", MEAN, _DASHES, "mean"),
        ("film_min", "speed_exponent", MINIMUM, "-", "minimum"),
    ):
        points = _draw_points(ax, film, name, colour)
        lines += _draw_power(ax, film, exponent, label, color=colour, linestyle=dashes)
        if not points:  # a statistic that no trigger has is not named
            lines[-1].set_label(None)
        artists += points

    ax.set(xlabel=_LABELS[_speed_name(film)], ylabel="film thickness [µm]")
    style.plain_log_ticks(ax)
    if artists:
        _add_stroke_keys(ax, film)
        style.legend_below(ax, title=bars_of(film).title)
    else:
        state_no_film(ax, film)
    return [*artists, *lines]


def _draw_points(ax: Axes, film: xr.Dataset, name: str, colour: str) -> list[Artist]:
    """Draw one statistic with its error bars, by stroke, in grey where the fit leaves it out."""
    x, fitted = _MILLI * speed_over_load(film), fast_triggers(film[_speed_name(film)].values)
    if name == "film_mean":
        fitted = fitted & ~have_partial_mean(film)
    value, std = film[name].values, bars_of(film, name).std
    drawable = np.isfinite(value) & (value > 0)  # the scale is logarithmic
    artists: list[Artist] = []
    for used, paint in ((fitted, colour), (~fitted, MUTED)):
        artists += draw_strokes(ax, film, x, value, std, which=used & drawable, colour=paint)
    return artists


def _draw_power(ax: Axes, film: xr.Dataset, name: str, label: str, **look: Any) -> list[Line2D]:
    """Draw a fitted power over the range of its triggers; its colour alone where none was."""
    power, std = float(film[name]), float(film[f"{name}_std"])
    scale = float(film[name].attrs.get("log_scale", np.nan))
    if not (np.isfinite(power) and np.isfinite(scale)):
        return style.draw_line(ax, [], [], look["color"], form="o", label=label)

    # a power is drawn over the triggers it was fitted to, not beyond them
    used = speed_over_load(film)[fast_triggers(film[_speed_name(film)].values)]
    ends = np.geomspace(used.min(), used.max(), 50)
    error = f" ± {std:.3f}" if np.isfinite(std) else ""
    label = f"{label}, n = {power:.3f}{error}".replace("-", "−")
    if "triggers_used" in film[name].attrs:
        label += f",\n{film[name].attrs['triggers_used']} of {film.sizes['trigger']} triggers"
    look |= {"linewidth": pt(0.8), "label": label, "zorder": 1.5}
    return ax.plot(_MILLI * ends, np.exp(scale) * ends**power, **look)


def _add_stroke_keys(ax: Axes, film: xr.Dataset) -> None:
    """Name the markers of the strokes, and the colour of points that no fit uses."""
    for _, look in stroke_looks(film) if "stroke" in film else ():
        face = "white" if look["markerfacecolor"] == "white" else MINIMUM
        key = {"form": look["marker"], "markerfacecolor": face, "label": look["label"]}
        style.draw_line(ax, [], [], MINIMUM, **key)
    if not fast_triggers(film[_speed_name(film)].values).all() or have_partial_mean(film).any():
        style.draw_line(ax, [], [], MUTED, form="o", label="not in the fit")


@styled
def film_and_theory(film: xr.Dataset, *, ax: Axes | None = None) -> list[Artist]:
    """Draw minimum film thickness with theory at the same speed and load.

    Arguments as in `film_against_speed`.

    Returns
    -------
    list of Artist
        Measured points of both strokes, the transient film at the triggers where it is predicted,
        the film of the regime that the regime map selects, the film of Hamrock-Dowson.

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> *_, theory, formula = film_and_theory(example_film())
    >>> theory.get_label().splitlines()
    ['regime map, isoviscous-rigid', 'beyond the axis: 74.5 to 129 µm']
    """
    ax = style.given_or_new(ax, film, height=style.ONE_COLUMN)
    ax.set(xscale="log", yscale="log")
    x = _MILLI * speed_over_load(film)
    value = film.film_min.values
    look: dict[str, Any] = {"colour": MINIMUM, "label": "measured minimum"}
    artists = draw_strokes(ax, film, x, value, bars_of(film).std, which=value > 0, **look)
    if "film_predicted_min" in film:
        # the points within stay visible
        look = {"label": "transient film over the cycle", "zorder": 1.5, "size": _AROUND_POINTS}
        look |= {"markerfacecolor": "none", "markeredgewidth": pt(0.5)}
        artists += style.draw_line(ax, x, film.film_predicted_min.values, MEAN, form="D", **look)
        if "film_predicted_min_std" in film:
            bars = film.film_predicted_min_std.values
            ax.errorbar(
                x, film.film_predicted_min.values, bars, fmt="none", ecolor=MEAN, zorder=1.4
            )

    # where the load differs between the strokes, steady theory is no curve over speed over load
    order = np.argsort(x)
    regime = str(film.film_theory.attrs.get("regime", "steady"))
    low, high = _range_of_film(film, ("film_theory", "film_hamrock_dowson"))
    for name, colour, dashes, label in (
        ("film_theory", RETURN, "-", f"regime map, {regime}"),
        ("film_hamrock_dowson", OUTWARD, _DASH_DOT, formula_label(film)),
    ):
        curve = film[name].values[order]
        beyond = _describe_beyond(curve, low, high)
        label = "\n".join([label, *beyond])
        form = dashes if _is_curve(curve) else "."
        drawn = style.draw_line(ax, x[order], curve, colour, form=form, label=label)
        # words without a key where nothing of the curve is seen
        if beyond and not beyond[0].startswith("partly"):
            drawn[0].set_color("none")
        artists += drawn

    ax.set(xlabel=_LABELS[_speed_name(film)], ylabel="film thickness [µm]", ylim=(low, high))
    style.plain_log_ticks(ax)
    style.legend_below(ax, title=bars_of(film).title, ncols=1)
    return artists


def _range_of_film(film: xr.Dataset, theories: Sequence[str]) -> tuple[float, float]:
    """Ends of an axis for the film with its bars, and for theory that is near it. [um]"""
    value, std = film.film_min.values, bars_of(film).std
    known = [value, value - std, value + std]
    if "film_predicted_min" in film:
        known.append(film.film_predicted_min.values)
    near = np.concatenate(known)
    near = near[np.isfinite(near) & (near > 0)]
    theory = np.concatenate([film[name].values for name in theories])
    theory = theory[np.isfinite(theory) & (theory > 0)]
    if near.size:
        theory = theory[(theory > near.min() / _REACH) & (theory < near.max() * _REACH)]

    both = np.log(np.concatenate([near, theory])) if near.size + theory.size else np.zeros(1)
    widen = max(math.log(_LEAST_RATIO) - float(np.ptp(both)), 2 * _MARGIN * float(np.ptp(both))) / 2
    return float(np.exp(both.min() - widen)), float(np.exp(both.max() + widen))


def _is_curve(values: Array) -> bool:
    """Whether values in the order of the abscissa rise, or fall, from one to the next."""
    steps = np.diff(values[np.isfinite(values)])
    return bool((steps >= 0).all() or (steps <= 0).all())


def _describe_beyond(curve: Array, low: float, high: float) -> list[str]:
    """State the range of a curve that an axis does not hold; empty where it does. [um]"""
    known = curve[np.isfinite(curve)]
    inside = (known >= low) & (known <= high)
    if inside.all():
        return []
    part = "partly " if inside.any() else ""
    return [f"{part}beyond the axis: {known.min():.3g} to {known.max():.3g} µm"]


def has_ratio(film: xr.Dataset) -> bool:
    """Whether the film has a ratio to a theory at some trigger."""
    return any(name in film and np.isfinite(film[name]).any() for name in _RATIOS)


@style.film_panel
def film_over_theory(film: xr.Dataset, *, ax: Axes = style.NEW) -> list[Artist]:
    """Draw the minimum film thickness over each theory, and the central one of a plateau.

    Bars are one standard deviation of the film, random and shared. Lines are the medians, which
    the legend states. Triggers below a tenth of the highest speed are left out, and theories that
    are off by more than a factor of three beside one that is not.

    Parameters
    ----------
    ax : Axes, optional
        Default: those of a new figure, one column wide. The ratio is on a logarithmic scale.

    Returns
    -------
    list of Artist
        The points of both strokes for each theory.

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> film = example_film()
    >>> ratio = (film.film_min / film.film_theory).assign_attrs(factor=0.05)
    >>> film = film.assign(film_over_theory=ratio, film_over_theory_std=0 * ratio)
    >>> outward, back = film_over_theory(film)
    >>> float(outward.get_ydata().max().round(3))
    0.034
    """
    name = "rocker_speed" if "rocker_speed" in film else "sliding_speed"
    x: Array = np.abs(film[name].values)
    ax.set(yscale="log")
    ax.axhline(1.0, color=style.MUTED, linewidth=pt(0.5))
    artists: list[Artist] = []
    known = [one for one in _RATIOS if one in film and np.isfinite(film[one].values).any()]
    if not shows_plateau(film):
        known = [one for one in known if one != "film_central_over_theory"]
    off = {one: abs(math.log(float(film[one].attrs["factor"]))) for one in known}
    for ratio in known:
        (colour, title), values = _RATIOS[ratio], film[ratio].values
        attrs = film[ratio].attrs
        ends = [float(np.min(x[np.isfinite(values)])), float(np.max(x[np.isfinite(values)]))]
        factor = f"{attrs['factor']:#.3g}".rstrip(".")  # zeros that are known stay
        label = f"over {title or formula_label(film)}: {factor}"
        if scope := formula_scope(attrs):
            label += f", {scope}"
        if off[ratio] > math.log(_REACH) >= min(off.values()):
            style.draw_line(ax, [], [], "none", label=f"{label}, beyond the axis")
            continue
        std = film[f"{ratio}_std"].values
        artists += draw_strokes(ax, film, x, values, std, which=np.isfinite(values), colour=colour)
        style.draw_line(ax, ends, [float(attrs["factor"])] * 2, colour, form="--", label=label)

    # a theory may lack some of the triggers
    counts = [np.count_nonzero(np.isfinite(film[one].values)) for one in known]
    fewest_and_most = sorted({min(counts, default=0), max(counts, default=0)})
    of = " to ".join(str(count) for count in fewest_and_most)
    units = {"rocker_speed": "|ω| [rad s⁻¹]", "sliding_speed": "sliding speed [m s⁻¹]"}
    ax.set(xlabel=units[name], ylabel="minimum film over theory")
    style.plain_log_ticks(ax)
    style.legend_below(ax, title=f"medians of {of} triggers", ncols=1)
    return artists


@styled
def speed_figure(film: xr.Dataset, *, figure: AnyFigure | None = None) -> AnyFigure:
    """Draw the measured film with its fit, beside it with theory, and below over theory.

    Theory that differs from the film by more than a factor of three is beyond the axis; the legend
    states its range. Arguments that are not listed are those of `erlif.plots`.

    Parameters
    ----------
    film : xarray.Dataset
        As `erlif.process` returns it, with a speed and a load.

    Returns
    -------
    Figure
        Two columns wide; one, without the theory, where the film has none.

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> [ax.get_ylabel() for ax in speed_figure(example_film()).axes]
    ['film thickness [µm]', 'film thickness [µm]']
    """
    drawings = (film_against_speed, film_and_theory)[: 2 if "film_theory" in film else 1]
    return draw_beside(drawings, film, figure, below=film_over_theory if has_ratio(film) else None)


def draw_beside(
    drawings: Sequence[Callable[..., Any]],
    film: xr.Dataset,
    given: AnyFigure | None,
    *,
    below: Callable[..., Any] | None = None,
) -> AnyFigure:
    """Draw a film in one or two ways, one column wide or two, and in one more below two."""
    if len(drawings) == 1:
        figure = style.new_figure(given=given, named=film)
        drawings[0](film, ax=figure.add_subplot())
        return figure
    tall = _TALL * style.TWO_COLUMNS * (1 if below is None else _TWO_ROWS)
    figure = style.new_figure(style.TWO_COLUMNS, tall, given=given, named=film)
    if below is None:
        style.draw_panels(figure.subplots(1, 2), drawings, film)
    else:
        panels = figure.subplot_mosaic("ab;cc", height_ratios=[1.0, 0.6])
        style.draw_panels(panels.values(), [*drawings, below], film)
    return figure
