"""Speed and film thickness over a cycle of the mechanism, or over the time of a run."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes

from erlif.core.arrays import Array, Mask
from erlif.core.errors import ConfigError
from erlif.core.statistics import film_limits
from erlif.io.files import settings_of
from erlif.io.settings import SinusoidalSettings
from erlif.kinematics import choose_link, joint_speed
from erlif.pipeline.physics.joint import build_linkage
from erlif.show.plots import style, triggers
from erlif.show.plots.style import MEAN, MINIMUM, MUTED, ONE_COLUMN, AnyFigure, pt, styled

_CYCLE = np.linspace(0.0, 2 * math.pi, 721)  # crank angle every half degree [rad]
_PANEL = 0.5  # height of a panel by the width of a column
_LOOKS: dict[str, tuple[str, Any, str]] = {
    "film_mean": (MEAN, (0, (3, 1.5)), "mean"),
    "film_min": (MINIMUM, "-", "minimum"),
}

_MARKER = 2.4  # point
_PALE = 0.35  # opacity of such a mean


@dataclass(frozen=True)
class LinkageCycle:
    """One turn of the crank, from the lengths of the links alone.

    Attributes
    ----------
    crank_angle : Array
        Crank angle. [degree]
    reading : Array
        Encoder reading. [degree]
    speed : Array
        Speed of the joint, positive on the outward stroke. [rad/s]
    """

    crank_angle: Array
    reading: Array
    speed: Array


def linkage_cycle(film: xr.Dataset) -> LinkageCycle:
    """Compute one turn of the crank of a film; raises ConfigError where it has no linkage."""
    settings = settings_of(film)
    links, encoder = settings.linkage, settings.encoder
    if links is None or encoder is None:
        raise ConfigError(
            "Expected the film of a crank-rocker or a slider-crank; its settings have no linkage. "
            "Use film_over_cycle."
        )
    mechanism, omega = build_linkage(links), links.crank_speed

    sign = -1.0 if film.encoder_angle.attrs.get("direction") == "falling" else 1.0
    if encoder.mounted_on == "crank":
        reading = sign * np.degrees(_CYCLE - (encoder.zero or 0.0)) % 360
    else:
        angle = choose_link(mechanism, encoder.mounted_on).angle(_CYCLE)
        fitted = film.encoder_angle.attrs.get("zero")
        zero = np.radians(fitted) if encoder.zero is None else encoder.zero
        reading = sign * np.degrees(angle - zero)

        # an encoder that starts again at 0 was counted on, by whole turns
        away = float(film.encoder_angle.mean()) - (reading.min() + reading.max()) / 2
        reading = reading + 360 * np.round(away / 360)
    return LinkageCycle(np.degrees(_CYCLE), reading, joint_speed(mechanism, _CYCLE, omega))


@style.film_panel
def speed_against_angle(film: xr.Dataset, *, ax: Axes = style.NEW) -> list[Artist]:
    """Draw joint speed against encoder angle, and sliding speed on a second axis.

    Without a linkage, the sliding speed is drawn against the position of the slider, or against
    angle or time. Arguments as in `erlif.plots`.

    Returns
    -------
    list of Artist
        The curve of the linkage or slider, then the triggers of the outward and of the return
        stroke.

    Raises
    ------
    ConfigError
        If the film has no speed.

    Examples
    --------
    The rocker of this linkage swings by 24.43 degree:

    >>> import numpy as np
    >>> from erlif.show.plots import example_film
    >>> curve, outward, back = speed_against_angle(example_film())
    >>> float(np.ptp(curve.get_xdata()).round(2))
    24.43
    """
    if settings_of(film).linkage is None:
        return _draw_sliding_speed(ax, film, against_position=True)
    artists = _draw_joint_speed(ax, film, "encoder_angle")
    artists[0].set_label("kinematics of the linkage")
    style.legend_above(ax)
    return artists


def _draw_joint_speed(ax: Axes, film: xr.Dataset, along: str) -> list[Artist]:
    """Draw the speed of the links and of the triggers along an angle, with both units."""
    cycle = linkage_cycle(film)
    place = cycle.crank_angle if along == "crank_angle" else cycle.reading
    # the reading of an encoder on the crank jumps back to zero after 360 degree
    jump = np.abs(np.diff(place, prepend=place[:1])) > 180
    place, speed = np.where(jump, np.nan, place), cycle.speed
    curve = style.draw_line(ax, place, speed, MUTED, width=0.9, zorder=2)
    points = triggers.draw_strokes(ax, film, film[along].values, film.rocker_speed.values, zorder=3)
    if speed.min() < 0:  # the line between both directions, where there are two
        ax.axhline(0, color=MUTED, linewidth=pt(0.4), zorder=1)
    ax.set(xlabel=f"{along.replace('_', ' ')} [°]", ylabel="joint speed [rad/s]")

    # the sliding speed is that of the surface of the pin, whose radius must be known
    joint = settings_of(film).joint
    if joint is not None:
        radius = joint.pin_radius * 1e3  # mm
        second = ax.secondary_yaxis(
            "right", functions=(partial(np.multiply, radius), partial(np.multiply, 1 / radius))
        )
        second.set_ylabel("sliding speed [mm/s]")
        ax.spines["right"].set_visible(False)
    return [*curve, *points]


def _draw_sliding_speed(ax: Axes, film: xr.Dataset, *, against_position: bool) -> list[Artist]:
    """Draw the sliding speed, with the sign of the stroke, where there is no linkage."""
    if "sliding_speed" not in film:
        raise ConfigError(
            "Expected a film with a speed; this one has none. Add [mechanism] to run.toml, or a "
            "column of the sliding speed to the log, and process the run again."
        )
    speed = 1e3 * film.sliding_speed.values * (film.stroke.values if "stroke" in film else 1)
    slider = settings_of(film).mechanism
    artists: list[Artist] = []
    if against_position and isinstance(slider, SinusoidalSettings):
        # the speed of a sine over its position is an ellipse
        top, end = 1e3 * math.pi * slider.frequency * slider.stroke, 1e3 * slider.stroke / 2
        ellipse = end * np.sin(_CYCLE), top * np.cos(_CYCLE)
        look: dict[str, Any] = {"label": "kinematics of the slider", "zorder": 2}
        artists += style.draw_line(ax, *ellipse, MUTED, width=0.9, **look)
        x, label = film.position.values, "position from mid-stroke [mm]"
    else:
        x, label, whole_turn = triggers.choose_abscissa(film)
        if whole_turn:
            triggers.limit_to_turn(ax)

    artists += triggers.draw_strokes(ax, film, x, speed, zorder=3)
    if speed.min() < 0:
        ax.axhline(0, color=MUTED, linewidth=pt(0.4), zorder=1)
    else:
        ax.set_ylim(0, 1.1 * speed.max())  # whole markers
    ax.set(xlabel=label, ylabel="sliding speed [mm/s]")
    if against_position and "stroke" in film:
        style.legend_above(ax)
    return artists


@style.film_panel
def speed_over_cycle(film: xr.Dataset, *, ax: Axes = style.NEW) -> list[Artist]:
    """Draw joint speed against crank angle, and sliding speed on a second axis.

    Without a linkage, the sliding speed is drawn against angle or time.
    Arguments as in `speed_against_angle`.

    Returns
    -------
    list of Artist
        The curve of the linkage, then the triggers of the outward and of the return stroke.

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> curve, outward, back = speed_over_cycle(example_film())
    >>> curve.axes.get_xlabel(), curve.axes.get_ylabel()
    ('crank angle [°]', 'joint speed [rad/s]')
    """
    if settings_of(film).linkage is None:
        return _draw_sliding_speed(ax, film, against_position=False)
    artists = _draw_joint_speed(ax, film, "crank_angle")
    triggers.limit_to_turn(ax)
    return artists


@style.film_panel
def film_over_cycle(
    film: xr.Dataset, *, ax: Axes = style.NEW, statistic: str | None = None
) -> list[Artist]:
    """Draw mean and minimum film thickness against crank angle, with bands of one s.d.

    The axis ends at the films with their bands, and at zero where they vary by more than their
    smallest value. Without an angle of the drive they are drawn against time or the number of the
    trigger. A whole turn of a disc is closed. The mean is pale at triggers where part of the region
    of interest is beyond the measurable range: it is that of other pixels there. Arguments that are
    not listed are those of `speed_against_angle`.

    Parameters
    ----------
    statistic : str, optional
        ``"film_min"`` or ``"film_mean"``, for an axis of its own; default: both.

    Returns
    -------
    list of Artist
        Band and line of each stretch of one stroke and one selection of pixels, first of the mean,
        then of the minimum. The bands hold random and shared errors.

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> band, line, *_ = film_over_cycle(example_film())
    >>> line.get_label(), line.axes.get_ylabel()
    ('mean', 'film thickness [µm]')
    >>> film_over_cycle(example_film(), statistic="film_min")[0].axes.get_ylabel()
    'minimum film [µm]'
    """
    along = triggers.choose_abscissa(film)
    names = [name for name in _LOOKS if statistic in (None, name)]
    value = np.array([film[name].values for name in names])
    reach = np.array([film[f"{name}_std"].values for name in names])
    artists = [artist for name in names for artist in _draw_statistic(ax, film, name, along)]
    triggers.label_abscissa(ax, along)
    ax.set_ylabel("film thickness [µm]" if len(names) > 1 else f"{_LOOKS[names[0]][2]} film [µm]")
    low, high = film_limits(np.concatenate([value - reach, value + reach]))
    ax.set_ylim(low, high)
    if not np.isfinite(value).any():
        triggers.state_no_film(ax, film)
        return artists

    # a band hidden by the markers is not announced as one
    visible = any(style.is_visible(ax, 2 * half, pt(_MARKER)) for half in reach)
    title = f"bands: {style.ONE_STD}" if visible else f"{style.ONE_STD}: within markers"
    style.legend_above(ax, title=title)
    return artists


def _draw_statistic(
    ax: Axes, film: xr.Dataset, name: str, along: triggers.Abscissa
) -> list[Artist]:
    """Draw one statistic of all triggers, with its band; pale where it is that of other pixels."""
    colour, dashes, label = _LOOKS[name]
    part_of = np.zeros(along.values.size, bool)
    if name == "film_mean":
        part_of = triggers.have_partial_mean(film)
    order, place = triggers.close_turn(film, along)
    value, half, pale_at = (
        values[order] for values in (film[name].values, film[f"{name}_std"].values, part_of)
    )
    artists: list[Artist] = []
    for part in _of_one_selection(triggers.in_order(film.isel(trigger=order), place), pale_at):
        x, low, high = place[part], (value - half)[part], (value + half)[part]
        pale = bool(pale_at[part[0]])
        alpha = _PALE if pale else 1.0
        artists.append(style.draw_band(ax, x, low, high, colour))
        if part.size == 1:  # a band of one trigger has no area
            ax.vlines(x, low, high, colour, alpha=alpha, linewidth=pt(0.7))
        named = f"{label}, part beyond range" if pale else label
        look: dict[str, Any] = {"form": dashes, "width": 0.9, "label": named}
        artists += style.draw_line(ax, x, value[part], colour, alpha=alpha, **look)
    points: dict[str, Any] = {"colour": colour, "markersize": pt(_MARKER)}
    for pale, alpha in ((False, 1.0), (True, _PALE)):
        which = {"which": part_of == pale, "alpha": alpha}
        triggers.draw_strokes(ax, film, along.values, film[name].values, **points, **which)
    return artists


def _of_one_selection(
    stretches: list[npt.NDArray[np.intp]], part_of: Mask
) -> list[npt.NDArray[np.intp]]:
    """Cut stretches of triggers where the selection of pixels changes; none is empty."""
    cuts = [np.flatnonzero(np.diff(part_of[members])) + 1 for members in stretches]
    pieces = [np.split(members, cut) for members, cut in zip(stretches, cuts, strict=True)]
    return [piece for each in pieces for piece in each if piece.size]


@styled
def cycle_figure(film: xr.Dataset, *, figure: AnyFigure | None = None) -> AnyFigure:
    """Draw minimum and mean film and speed against crank angle, with dotted lines at dead points.

    Without a linkage they are drawn against angle or time, and the speed is left out where it is
    not known or the same at all triggers. Arguments as in `erlif.plots`.

    Returns
    -------
    Figure
        Minimum above mean above speed, each with its axis; one column wide.

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> figure = cycle_figure(example_film())
    >>> [ax.get_ylabel() for ax in figure.axes]
    ['minimum film [µm]', 'mean film [µm]', 'joint speed [rad/s]']
    """
    varies = triggers.has_varying_speed(film)
    count = 2 + varies
    figure = style.new_figure(ONE_COLUMN, count * _PANEL * ONE_COLUMN, given=figure, named=film)
    panels = style.rows_or_columns(figure, count, sharex=True)
    for ax, name in zip(panels, ("film_min", "film_mean"), strict=False):
        film_over_cycle(film, ax=ax, statistic=name)
    if varies:
        speed_over_cycle(film, ax=panels[-1])
    look: dict[str, Any] = {"color": MUTED, "linewidth": pt(0.6), "linestyle": ":", "zorder": 1}
    for turn in dead_points(film) if varies else []:
        for ax in panels:
            ax.axvline(turn, **look)
        panels[-1].lines[-1].set_label("dead points")

    # the markers of the strokes are those of both panels
    if varies and "stroke" in film:
        style.legend_above(panels[-1])
    style.letter_panels(*panels)
    return figure


def dead_points(film: xr.Dataset) -> list[float]:
    """Angles of the drive at which the speed changes its sign. [degree]"""
    settings = settings_of(film)
    if settings.linkage is not None:
        cycle = linkage_cycle(film)
        turns: list[float] = cycle.crank_angle[1:][np.diff(np.sign(cycle.speed)) != 0].tolist()
        return turns
    return [90.0, 270.0] if isinstance(settings.mechanism, SinusoidalSettings) else []
