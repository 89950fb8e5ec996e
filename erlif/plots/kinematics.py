"""Speed of the joint and film thickness over a cycle of the mechanism."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from erlif.core.arrays import Array
from erlif.files import settings_of
from erlif.models.mechanism import SliderCrank
from erlif.pipeline.joint import build_mechanism
from erlif.plots.style import (
    COVERAGE,
    MEAN,
    MINIMUM,
    MUTED,
    ONE_COLUMN,
    STROKES,
    frame_legend,
    given_or_new,
    letter,
    new_figure,
    styled,
)
from erlif.settings import RunSettings

_CYCLE = np.linspace(0.0, 2 * math.pi, 721)  # crank angle every half degree [rad]
_TALL, _PANELS = 1.15, (1.35, 1)  # height by width, and ratio of film to speed
_DASHES = (0, (3, 1.5))


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
    """Compute one turn of the crank by the kinematics of the linkage of a film."""
    settings = settings_of(film)
    mechanism = build_mechanism(settings)
    omega = settings.mechanism.crank_speed
    if isinstance(mechanism, SliderCrank):
        angle = mechanism.coupler_angle(_CYCLE)
        speed = mechanism.joint_speed(_CYCLE, crank_speed=omega)
    else:
        angle = mechanism.rocker_angle(_CYCLE)
        speed = mechanism.rocker_speed(_CYCLE, crank_speed=omega)

    if settings.encoder.mounted_on == "crank":
        reading = np.degrees(_CYCLE - (settings.encoder.zero or 0.0)) % 360
    else:
        reading = np.degrees(angle - _zero(settings, film, mechanism.limits()))
    return LinkageCycle(np.degrees(_CYCLE), np.asarray(reading), np.asarray(speed))


def _zero(settings: RunSettings, film: xr.Dataset, limits: tuple[float, float]) -> float:
    """Link angle at reading 0. [rad]

    Without a setting, the readings are centred between the dead points.
    """
    if settings.encoder.zero is not None:
        return settings.encoder.zero
    reading = np.radians(film.encoder_angle.values)
    return sum(limits) / 2 - float(reading.min() + reading.max()) / 2


def _draw_strokes(ax: Axes, film: xr.Dataset, x: Array, y: Array) -> list[Artist]:
    """Draw the triggers, with a marker for each stroke."""
    artists: list[Artist] = []
    for sign, look in STROKES.items():
        of_stroke = film.stroke.values == sign
        artists += ax.plot(x[of_stroke], y[of_stroke], linestyle="none", zorder=3, **look)
    return artists


def _times(factor: float) -> Callable[[npt.ArrayLike], Array]:
    return lambda values: np.asarray(values, float) * factor


def _label_speed(ax: Axes, settings: RunSettings) -> None:
    """Label the joint speed, with a second axis of the sliding speed."""
    ax.set_ylabel("joint speed [rad/s]")
    radius = settings.joint.pin_radius * 1e3  # mm
    second = ax.secondary_yaxis("right", functions=(_times(radius), _times(1 / radius)))
    second.set_ylabel("sliding speed [mm/s]")
    ax.spines["right"].set_visible(False)


@styled
def speed_against_angle(film: xr.Dataset, *, ax: Axes | None = None) -> list[Artist]:
    """Draw joint speed against encoder angle, and sliding speed on a second axis.

    Parameters
    ----------
    film : xarray.Dataset
        As `erlif.process` returns it.
    ax : Axes, optional
        Default: those of a new figure, one column wide.

    Returns
    -------
    list of Artist
        The curve of the linkage, then the triggers of the outward and of the return stroke.

    Examples
    --------
    The rocker of this linkage swings by 24.43 degree:

    >>> import numpy as np
    >>> from erlif.plots import example_film
    >>> curve, outward, back = speed_against_angle(example_film())
    >>> float(np.ptp(curve.get_xdata()).round(2))
    24.43
    """
    ax = given_or_new(ax)
    cycle = linkage_cycle(film)

    # the reading of an encoder on the crank jumps back to zero after 360 degree
    jump = np.abs(np.diff(cycle.reading, prepend=cycle.reading[:1])) > 180
    (curve,) = ax.plot(
        np.where(jump, np.nan, cycle.reading),
        cycle.speed,
        color=MUTED,
        linewidth=0.9,
        label="kinematics of the linkage",
        zorder=2,
    )
    points = _draw_strokes(ax, film, film.encoder_angle.values, film.rocker_speed.values)
    if cycle.speed.min() < 0:
        ax.axhline(0, color=MUTED, linewidth=0.4, zorder=1)

    ax.set_xlabel("encoder angle [°]")
    _label_speed(ax, settings_of(film))
    frame_legend(ax, loc="center")
    return [curve, *points]


@styled
def speed_over_cycle(film: xr.Dataset, *, ax: Axes | None = None) -> list[Artist]:
    """Draw joint speed against crank angle, and sliding speed on a second axis.

    Parameters
    ----------
    film, ax
        As for `speed_against_angle`.

    Returns
    -------
    list of Artist
        The curve of the linkage, then the triggers of the outward and of the return stroke.

    Examples
    --------
    >>> from erlif.plots import example_film
    >>> curve, outward, back = speed_over_cycle(example_film())
    >>> curve.axes.get_xlabel(), curve.axes.get_ylabel()
    ('crank angle [°]', 'joint speed [rad/s]')
    """
    ax = given_or_new(ax)
    cycle = linkage_cycle(film)
    (curve,) = ax.plot(cycle.crank_angle, cycle.speed, color=MUTED, linewidth=0.9, zorder=2)
    points = _draw_strokes(ax, film, film.crank_angle.values, film.rocker_speed.values)
    if cycle.speed.min() < 0:
        ax.axhline(0, color=MUTED, linewidth=0.4, zorder=1)
    _label_crank(ax)
    _label_speed(ax, settings_of(film))
    return [curve, *points]


@styled
def film_over_cycle(film: xr.Dataset, *, ax: Axes | None = None) -> list[Artist]:
    """Draw mean and minimum film thickness against crank angle, with 95 % bands.

    Parameters
    ----------
    film, ax
        As for `speed_against_angle`.

    Returns
    -------
    list of Artist
        Band and line of each stretch of one stroke, first of the mean, then of the minimum. The
        bands hold random and shared errors.

    Examples
    --------
    >>> from erlif.plots import example_film
    >>> band, line, *_ = film_over_cycle(example_film())
    >>> line.get_label(), line.axes.get_ylabel()
    ('mean of the region', 'film thickness [µm]')
    """
    ax = given_or_new(ax)
    artists: list[Artist] = []
    for name, colour, dashes, label in (
        ("film_mean", MEAN, _DASHES, "mean of the region"),
        ("film_min", MINIMUM, "-", "minimum"),
    ):
        value, half = film[name].values, COVERAGE * film[f"{name}_std"].values
        for n, members in enumerate(_strokes_in_order(film)):
            x, y, reach = film.crank_angle.values[members], value[members], half[members]
            artists.append(
                ax.fill_between(x, y - reach, y + reach, color=colour, alpha=0.3, linewidth=0)
            )
            own = label if n == 0 else None  # one key for all stretches
            artists += ax.plot(x, y, color=colour, linestyle=dashes, linewidth=0.9, label=own)
        _mark_strokes(ax, film, value, colour)

    _label_crank(ax)
    ax.set_ylabel("film thickness [µm]")
    ax.set_ylim(0, None)  # from contact, so that the film is seen in proportion
    frame_legend(ax, loc="lower center", ncols=2, title="with 95 % bands", title_fontsize=6.5)
    return artists


def _mark_strokes(ax: Axes, film: xr.Dataset, value: Array, colour: str) -> None:
    """Draw the triggers in one colour, with a marker for each stroke."""
    for sign, look in STROKES.items():
        of_stroke = film.stroke.values == sign
        ax.plot(
            film.crank_angle.values[of_stroke],
            value[of_stroke],
            linestyle="none",
            marker=str(look["marker"]),
            markersize=2.4,
            color=colour,
            markerfacecolor=colour if sign > 0 else "white",
        )


def _strokes_in_order(film: xr.Dataset) -> list[npt.NDArray[np.intp]]:
    """Triggers in the order of the crank, cut where the stroke changes."""
    # a line from one stroke to the other would cross the dead point, where nothing was measured
    order = np.argsort(film.crank_angle.values)
    cuts = np.nonzero(np.diff(film.stroke.values[order]) != 0)[0] + 1
    return np.split(order, cuts)


def _label_crank(ax: Axes) -> None:
    ax.set_xlim(0, 360)
    ax.set_xticks(range(0, 361, 60))
    ax.set_xlabel("crank angle [°]")


@styled
def cycle_figure(film: xr.Dataset) -> Figure:
    """Draw film thickness and speed against crank angle, with dotted lines at the dead points.

    Parameters
    ----------
    film : xarray.Dataset
        As `erlif.process` returns it.

    Returns
    -------
    Figure
        One column wide.

    Examples
    --------
    >>> from erlif.plots import example_film
    >>> figure = cycle_figure(example_film())
    >>> [ax.get_ylabel() for ax in figure.axes]
    ['film thickness [µm]', 'joint speed [rad/s]']
    """
    figure = new_figure(ONE_COLUMN, _TALL * ONE_COLUMN)
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=_PANELS)
    film_over_cycle(film, ax=above)
    speed_over_cycle(film, ax=below)
    above.set_xlabel("")

    # the speed changes its sign at the dead points
    cycle = linkage_cycle(film)
    turns = cycle.crank_angle[1:][np.diff(np.sign(cycle.speed)) != 0]
    for turn in turns:
        for ax in (above, below):
            ax.axvline(turn, color=MUTED, linewidth=0.5, linestyle=":", zorder=1)

    # the markers of the strokes are those of both panels
    below.legend(loc="lower right", ncols=1)
    letter(above, "a")
    letter(below, "b")
    return figure
