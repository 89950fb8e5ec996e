"""Speed of the joint, and the film, over a cycle of the mechanism."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import numpy.typing as npt
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from erlif.core.arrays import Array
from erlif.files import settings_of
from erlif.kinematics import build_mechanism
from erlif.models.mechanism import SliderCrank
from erlif.plots.style import (
    COVERAGE,
    LEAST,
    MEAN,
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

_CYCLE = np.linspace(0.0, 2 * math.pi, 721)


def exact_cycle(film: xr.Dataset) -> tuple[Array, Array, Array]:
    """Crank angle [degree], encoder reading [degree] and joint speed [rad/s] over one turn, from the linkage alone."""
    settings = settings_of(film)
    mechanism = build_mechanism(settings)
    omega = settings.mechanism.crank_speed
    if isinstance(mechanism, SliderCrank):
        angle, speed = (
            mechanism.coupler_angle(_CYCLE),
            mechanism.joint_speed(_CYCLE, crank_speed=omega),
        )
    else:
        angle, speed = (
            mechanism.rocker_angle(_CYCLE),
            mechanism.rocker_speed(_CYCLE, crank_speed=omega),
        )
    if settings.encoder.mounted_on == "crank":
        reading = np.degrees(_CYCLE - (settings.encoder.zero or 0.0)) % 360
    else:
        reading = np.degrees(angle - _zero(settings, film, mechanism.limits()))
    return np.degrees(_CYCLE), np.asarray(reading), np.asarray(speed)


def _zero(settings: RunSettings, film: xr.Dataset, limits: tuple[float, float]) -> float:
    """Link angle at reading 0 [rad]; where it was not set, the extremes of the log lie even within the dead points."""
    if settings.encoder.zero is not None:
        return settings.encoder.zero
    reading = np.radians(film.encoder_angle.values)
    return sum(limits) / 2 - float(reading.min() + reading.max()) / 2


def _draw_strokes(ax: Axes, film: xr.Dataset, x: Array, y: Array) -> list[Artist]:
    """Points of the triggers, the strokes told apart by marker."""
    artists: list[Artist] = []
    for sign, look in STROKES.items():
        of_stroke = film.stroke.values == sign
        artists += ax.plot(x[of_stroke], y[of_stroke], linestyle="none", zorder=3, **look)  # type: ignore[arg-type]
    return artists


def _times(factor: float) -> Callable[[npt.ArrayLike], Array]:
    return lambda values: np.asarray(values, float) * factor


def _add_sliding_axis(ax: Axes, settings: RunSettings) -> None:
    radius = settings.joint.pin_radius * 1e3
    second = ax.secondary_yaxis("right", functions=(_times(radius), _times(1 / radius)))
    second.set_ylabel("sliding speed of the pin [mm/s]")
    ax.spines["right"].set_visible(False)


@styled
def speed_against_angle(film: xr.Dataset, *, ax: Axes | None = None) -> list[Artist]:
    """Draw joint speed against encoder angle: the exact curve of the linkage, the triggers on it, sliding speed at the right.

    Parameters
    ----------
    film : xarray.Dataset
        As `erlif.process` returns it.
    ax : Axes, optional

    Returns
    -------
    list of Artist
        The curve, then the points of the outward and of the return stroke.
    """
    ax = given_or_new(ax)
    settings = settings_of(film)
    _, reading, speed = exact_cycle(film)
    jump = (
        np.abs(np.diff(reading, prepend=reading[:1])) > 180
    )  # where an encoder on the crank starts anew
    (curve,) = ax.plot(
        np.where(jump, np.nan, reading),
        speed,
        color=MUTED,
        linewidth=0.9,
        label="exact linkage",
        zorder=2,
    )
    points = _draw_strokes(ax, film, film.encoder_angle.values, film.rocker_speed.values)
    if speed.min() < 0:
        ax.axhline(0, color=MUTED, linewidth=0.4, zorder=1)
    ax.set_xlabel("encoder angle [°]")
    ax.set_ylabel("joint speed [rad/s]")
    _add_sliding_axis(ax, settings)
    frame_legend(ax, loc="center")
    return [curve, *points]


@styled
def speed_over_cycle(film: xr.Dataset, *, ax: Axes | None = None) -> list[Artist]:
    """Draw joint speed against crank angle; parameters and artists as in `speed_against_angle`."""
    ax = given_or_new(ax)
    crank, _, speed = exact_cycle(film)
    (curve,) = ax.plot(crank, speed, color=MUTED, linewidth=0.9, zorder=2)
    points = _draw_strokes(ax, film, film.crank_angle.values, film.rocker_speed.values)
    if speed.min() < 0:
        ax.axhline(0, color=MUTED, linewidth=0.4, zorder=1)
    _label_crank(ax)
    ax.set_ylabel("joint speed [rad/s]")
    _add_sliding_axis(ax, settings_of(film))
    return [curve, *points]


@styled
def film_over_cycle(film: xr.Dataset, *, ax: Axes | None = None) -> list[Artist]:
    """Draw mean and least film against crank angle, with bands of 95 % that hold random and shared errors.

    Parameters and artists as in `speed_against_angle`: for each of the two films its band, then the points of both strokes.
    """
    ax = given_or_new(ax)
    artists: list[Artist] = []
    for name, colour, style, label in (
        ("film_mean", MEAN, (0, (3, 1.5)), "mean of the region"),
        ("film_min", LEAST, "-", "least film"),
    ):
        value, std = film[name].values, film[f"{name}_std"].values
        for n, members in enumerate(_runs(film)):
            x, y, half = film.crank_angle.values[members], value[members], COVERAGE * std[members]
            artists.append(
                ax.fill_between(x, y - half, y + half, color=colour, alpha=0.3, linewidth=0)
            )
            artists += ax.plot(
                x, y, color=colour, linestyle=style, linewidth=0.9, label=label if n == 0 else None
            )
        for sign, look in STROKES.items():
            of_stroke = film.stroke.values == sign
            artists += ax.plot(
                film.crank_angle.values[of_stroke],
                value[of_stroke],
                linestyle="none",
                marker=str(look["marker"]),
                markersize=2.4,
                color=colour,
                markerfacecolor=colour if sign > 0 else "white",
            )
    _label_crank(ax)
    ax.set_ylabel("film thickness [µm]")
    ax.set_ylim(0, None)
    frame_legend(
        ax, loc="lower center", ncols=2, title="bands 95 %, random and shared", title_fontsize=6.5
    )
    return artists


def _runs(film: xr.Dataset) -> list[npt.NDArray[np.intp]]:
    """Triggers in the order of the crank, cut where the stroke changes."""
    order = np.argsort(film.crank_angle.values)
    cuts = np.nonzero(np.diff(film.stroke.values[order]) != 0)[0] + 1
    return np.split(order, cuts)


def _label_crank(ax: Axes) -> None:
    ax.set_xlim(0, 360)
    ax.set_xticks(range(0, 361, 60))
    ax.set_xlabel("crank angle [°]")


@styled
def cycle_figure(film: xr.Dataset) -> Figure:
    """Film above and speed below against crank angle, one column wide; dotted lines where the motion turns."""
    figure = new_figure(ONE_COLUMN, 1.15 * ONE_COLUMN)
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=(1.35, 1))
    film_over_cycle(film, ax=above)
    speed_over_cycle(film, ax=below)
    above.set_xlabel("")
    crank, _, speed = exact_cycle(film)
    for turn in crank[1:][np.diff(np.sign(speed)) != 0]:
        for ax in (above, below):
            ax.axvline(turn, color=MUTED, linewidth=0.5, linestyle=":", zorder=1)
    below.legend(loc="lower right", ncols=1)
    letter(above, "a")
    letter(below, "b")
    return figure
