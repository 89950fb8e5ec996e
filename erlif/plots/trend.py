"""Film against speed over load, measured and predicted."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from erlif.core.arrays import Array
from erlif.plots.style import (
    LEAST,
    MEAN,
    MUTED,
    OUTWARD,
    RETURN,
    STROKES,
    TWO_COLUMNS,
    given_or_new,
    letter,
    new_figure,
    styled,
)
from erlif.trend import SLOWEST

_LABEL = "speed over load, |ω|/F [10⁻³ rad s⁻¹ N⁻¹]"


def speed_over_load(film: xr.Dataset) -> Array:
    """|rocker_speed| / load of each trigger. [rad s-1 N-1]"""
    return np.asarray(np.abs(film.rocker_speed.values) / film["load"].values)


@styled
def film_against_speed(film: xr.Dataset, *, ax: Axes | None = None) -> list[Artist]:
    """Draw least and mean film against speed over load, strokes apart, with the fitted powers.

    Bars are one standard deviation, random and shared. Triggers that the fit leaves out are drawn in grey.

    Parameters
    ----------
    film : xarray.Dataset
        As `erlif.process` returns it.
    ax : Axes, optional
        Its scales become logarithmic.

    Returns
    -------
    list of Artist
        The points of both strokes for mean and least film, then the two fitted lines.
    """
    ax = given_or_new(ax)
    ax.set(xscale="log", yscale="log")
    x = speed_over_load(film)
    speed = np.abs(film.rocker_speed.values)
    fitted = speed >= SLOWEST * speed.max()
    artists: list[Artist] = []
    lines: list[Line2D] = []
    for name, exponent, colour, dashes, words in (
        ("film_mean", "speed_exponent_mean", MEAN, (0, (3, 1.5)), "mean"),
        ("film_min", "speed_exponent", LEAST, "-", "least"),
    ):
        value, std = film[name].values, film[f"{name}_std"].values
        for sign, look in STROKES.items():
            for used, paint in ((fitted, colour), (~fitted, MUTED)):
                which = (film.stroke.values == sign) & used & np.isfinite(value) & (value > 0)
                if not which.any():
                    continue
                bars = ax.errorbar(
                    1e3 * x[which],
                    value[which],
                    std[which],
                    fmt=str(look["marker"]),
                    color=paint,
                    markerfacecolor=paint if sign > 0 else "white",
                    elinewidth=0.7,
                )
                artists.append(bars.lines[0])
        power, scale = float(film[exponent]), film[exponent].attrs.get("log_scale", np.nan)
        if np.isfinite(power) and np.isfinite(scale):
            ends = np.geomspace(x[fitted].min(), x[fitted].max(), 50)
            lines += ax.plot(
                1e3 * ends,
                np.exp(float(scale)) * ends**power,
                color=colour,
                linestyle=dashes,
                linewidth=0.8,
                label=f"{words} film, n = {power:.3f} ± {float(film[exponent + '_std']):.3f}",
                zorder=4,
            )
    artists += lines
    ax.set_xlabel(_LABEL)
    ax.set_ylabel("film thickness [µm]")
    _plain_ticks(ax)
    ax.legend(handles=[*lines, *_stroke_keys()], loc="best")
    return artists


def _stroke_keys() -> list[Line2D]:
    """Keys of the strokes' markers in the colour of neither film."""
    return [
        Line2D(
            [],
            [],
            linestyle="none",
            marker=str(look["marker"]),
            color=MUTED,
            markerfacecolor=MUTED if sign > 0 else "white",
            label=str(look["label"]),
        )
        for sign, look in STROKES.items()
    ]


@styled
def film_and_theory(film: xr.Dataset, *, ax: Axes | None = None) -> list[Artist]:
    """Draw the least film with what theory expects at the same speed and load; parameters as in `film_against_speed`.

    Returns
    -------
    list of Artist
        Measured points of both strokes, the film that the regime map selects, the line-contact formula with 2.65.
    """
    ax = given_or_new(ax)
    ax.set(xscale="log", yscale="log")
    x = 1e3 * speed_over_load(film)
    value = film.film_min.values
    order = np.argsort(x)
    artists: list[Artist] = []
    for sign, look in STROKES.items():
        which = (film.stroke.values == sign) & (value > 0)
        bars = ax.errorbar(
            x[which],
            value[which],
            film.film_min_std.values[which],
            fmt=str(look["marker"]),
            color=LEAST,
            markerfacecolor=LEAST if sign > 0 else "white",
            elinewidth=0.7,
            label=f"least film, {look['label']}",
        )
        artists.append(bars.lines[0])
    regime = str(film.film_theory.attrs.get("regime", "steady"))
    for name, colour, dashes, label in (
        ("film_theory", RETURN, "-", f"theory, {regime}"),
        (
            "film_hamrock_dowson",
            OUTWARD,
            (0, (4, 1.5, 1, 1.5)),
            "2.65 formula (piezoviscous-elastic)",
        ),
    ):
        artists += ax.plot(
            x[order], film[name].values[order], color=colour, linestyle=dashes, label=label
        )
    ax.set_xlabel(_LABEL)
    ax.set_ylabel("film thickness [µm]")
    _plain_ticks(ax)
    low, high = ax.get_ylim()
    ax.set_ylim(low, high * (high / low) ** 0.3)  # room for the legend
    ax.legend(loc="upper left")
    return artists


def _plain_ticks(ax: Axes) -> None:
    """Ticks of logarithmic axes as plain numbers, close enough to read a short range."""
    for axis, limits in ((ax.xaxis, ax.get_xlim()), (ax.yaxis, ax.get_ylim())):
        decades = np.log10(limits[1] / limits[0])
        every: tuple[float, ...] = (1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0)
        steps = every if decades < 0.7 else (1.0, 2.0, 3.0, 5.0) if decades < 1.5 else (1.0,)
        axis.set_major_locator(LogLocator(base=10, subs=steps, numticks=20))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axis.set_minor_locator(
            LogLocator(base=10, subs=tuple(map(float, range(1, 10))), numticks=20)
        )
        axis.set_minor_formatter(NullFormatter())


@styled
def speed_figure(film: xr.Dataset) -> Figure:
    """Measured film with its fit, and beside it with theory on scales that hold both; two columns wide."""
    figure = new_figure(TWO_COLUMNS, 0.4 * TWO_COLUMNS)
    left, right = figure.subplots(1, 2)
    film_against_speed(film, ax=left)
    film_and_theory(film, ax=right)
    letter(left, "a")
    letter(right, "b")
    return figure
