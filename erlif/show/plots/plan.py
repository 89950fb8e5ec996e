"""A planned rig: ratio, standard deviation, relative error and signal against thickness."""

from __future__ import annotations

import tomllib
from functools import cache
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from erlif.io.settings import PlanSettings
from erlif.show.plots import style
from erlif.show.plots.style import MEAN, MUTED, OUTWARD, RETURN, TWO_COLUMNS, styled

_CALIBRATED: dict[str, Any] = {"facecolor": "#F2F2F2", "edgecolor": "none", "zorder": -2}
_MEASURABLE: dict[str, Any] = {"facecolor": "#DCE9F2", "edgecolor": "none", "zorder": -1}
"""Looks of the two ranges."""

_WORST = 2.0  # of the film: largest standard deviation that is drawn
_TALL = 0.74  # height by width of the figure
_ABOVE = 1.35  # free share above the curves, for the legend


def _draw_ranges(plan: xr.Dataset, ax: Axes, *, label: bool = False) -> None:
    """Shade the calibrated range, and within it the measurable one."""
    ranges = (
        (plan.calibrated_range, _CALIBRATED, "calibrated range"),
        (plan.measurable_range, _MEASURABLE, "measurable, 1 pixel of 1 frame"),
    )
    for bounds, look, name in ranges:
        low, high = bounds.values
        if np.isfinite(low):
            ax.axvspan(low, high, label=name if label else None, **look)
    for edge in plan.film_range.values:
        ax.axvline(edge, color=MUTED, linewidth=0.6, linestyle=":", zorder=0)


def _finish(plan: xr.Dataset, ax: Axes) -> None:
    """Thickness on a logarithmic axis with plain numbers, over the films of the plan."""
    ax.set_xscale("log")
    ax.set_xlim(float(plan.thickness[0]), float(plan.thickness[-1]))
    style.plain_log_axis(ax.xaxis)
    ax.set_xlabel("film thickness [µm]")


@styled
def plan_ratio(plan: xr.Dataset, *, ax: Axes | None = None) -> list[Artist]:
    """Draw the expected ratio against thickness, with the ranges shaded.

    Arguments that are not listed are those of `erlif.plots`.

    Parameters
    ----------
    plan : xarray.Dataset
        From `erlif.plan`.

    Returns
    -------
    list of Artist
        The ratio as planned and with the best concentrations.

    Examples
    --------
    >>> planned, best = plan_ratio(example_plan_results())
    >>> planned.axes.get_ylabel()
    'ratio camera 2 / camera 1'
    """
    ax = style.given_or_new(ax)
    _draw_ranges(plan, ax, label=True)
    lines: list[Artist] = [
        *ax.plot(plan.thickness, plan.ratio, color=OUTWARD, label="as planned"),
        *ax.plot(
            plan.thickness,
            plan.optimum_ratio,
            color=RETURN,
            linestyle="--",
            label="best concentrations",
        ),
    ]
    values = np.concatenate([plan.ratio.values, plan.optimum_ratio.values])
    low, high = float(values.min()), float(values.max())
    ax.set(ylabel="ratio camera 2 / camera 1", ylim=(low - 0.05 * (high - low), None))
    ax.set_ylim(top=low + _ABOVE * (high - low))
    style.frame_legend(ax, loc="upper left", ncols=2, columnspacing=1.0)
    _finish(plan, ax)
    return lines


@styled
def plan_precision(
    plan: xr.Dataset, *, relative: bool = False, ax: Axes | None = None
) -> list[Artist]:
    """Draw the standard deviation of a film against thickness.

    Arguments that are not listed are those of `plan_ratio`.

    Parameters
    ----------
    relative : bool
        As a share of the film, with the wanted one; else in um.

    Returns
    -------
    list of Artist
        One pixel of one frame, then the frames and the averaging of the plan where there are
        several, then one pixel with the best concentrations.

    Examples
    --------
    >>> lines = plan_precision(example_plan_results())
    >>> [line.get_label() for line in lines]
    ['1 pixel, 1 frame', '1 pixel, 1 frame, best conc.']
    """
    ax = style.given_or_new(ax)
    _draw_ranges(plan, ax)
    scale = 100 / plan.thickness if relative else xr.ones_like(plan.thickness)
    frames, average = int(plan.attrs["frames"]), int(plan.attrs["average"])
    several = frames > 1 or average > 1
    pixels = "1 pixel" if average == 1 else f"{average} × {average} pixels"
    curves = [(plan.thickness_std, OUTWARD, "-", "1 pixel, 1 frame")]
    if several:
        name = f"{pixels}, {frames} frame{'s' if frames > 1 else ''}"
        curves.append((plan.thickness_std_frames, MEAN, "-", name))
        curves.append((plan.optimum_thickness_std_frames, RETURN, "--", f"{name}, best conc."))
    else:
        name = "1 pixel, 1 frame, best conc."
        curves.append((plan.optimum_thickness_std, RETURN, "--", name))

    lines: list[Artist] = []
    for std, colour, dashes, name in curves:
        shown = std * scale
        lines += ax.plot(plan.thickness, shown, color=colour, linestyle=dashes, label=name)
    low = min(float((std * scale).min()) for std, *_ in curves)
    inside = plan.thickness <= float(plan.film_range[1]) * 1.2
    high = max(float((std * scale).where(inside).max()) for std, *_ in curves)
    # an error of several times the film is no measurement
    high = min(high, 100 * _WORST if relative else _WORST * float(plan.film_range[1]))
    if relative:
        wanted = 100 * plan.attrs["uncertainty"]
        ax.axhline(wanted, color=MUTED, linewidth=0.6, linestyle="-.", label="wanted")
        low, high = min(low, wanted), max(high, wanted)
    ax.set_yscale("log")
    ax.set_ylim(low / 1.3, high * 1.3 * (high / low) ** (_ABOVE - 1))
    style.plain_log_axis(ax.yaxis)
    ax.set_ylabel("std / thickness [%]" if relative else "standard deviation [µm]")
    style.frame_legend(ax, loc="upper left")
    _finish(plan, ax)
    return lines


@styled
def plan_signal(plan: xr.Dataset, *, ax: Axes | None = None) -> list[Artist]:
    """Draw the mean signal of both cameras against thickness, with their full scale.

    Arguments as in `plan_ratio`.

    Returns
    -------
    list of Artist
        Signal of camera 1 and camera 2.

    Examples
    --------
    >>> lines = plan_signal(example_plan_results())
    >>> [line.get_label() for line in lines]
    ['camera 1', 'camera 2']
    """
    ax = style.given_or_new(ax)
    _draw_ranges(plan, ax)
    lines: list[Artist] = []
    for number, colour, dashes in ((1, OUTWARD, "-"), (2, RETURN, "--")):
        signal = plan.signal.sel(camera=number) / 1e3
        lines += ax.plot(
            plan.thickness, signal, color=colour, linestyle=dashes, label=f"camera {number}"
        )
    full = sorted(set(plan.full_scale.values))
    for number, value in enumerate(full):
        name = "full scale" if number == 0 else None
        ax.axhline(value / 1e3, color="black", linewidth=0.8, linestyle=(0, (1, 1)), label=name)
    top = max(full[-1], float(plan.signal.max())) / 1e3
    ax.set(ylabel="signal [1000 electrons]", ylim=(0, _ABOVE * top))
    style.frame_legend(ax, loc="upper left", ncols=3, columnspacing=1.0)
    _finish(plan, ax)
    return lines


@styled
def plan_figure(plan: xr.Dataset) -> Figure:
    """Combine ratio, standard deviation, relative error and signal of a planned rig.

    Arguments as in `plan_ratio`.

    Returns
    -------
    Figure
        Two journal columns wide. Dotted vertical lines are the ends of the wanted range.

    Examples
    --------
    >>> len(plan_figure(example_plan_results()).axes)
    4
    """
    figure = style.new_figure(TWO_COLUMNS, _TALL * TWO_COLUMNS)
    (a, b), (c, d) = figure.subplots(2, 2)
    plan_ratio(plan, ax=a)
    plan_precision(plan, ax=b)
    plan_precision(plan, relative=True, ax=c)
    plan_signal(plan, ax=d)
    style.letter_panels(a, b, c, d)
    about = "; invented spectra" if plan.attrs["synthetic"] else ""
    one, two = plan.concentration.values
    first, last = plan.film_range.values
    films = f"{first:g} to {last:g} µm"
    figure.suptitle(f"{plan.attrs['title']}, {films}: dyes {one:.3g} and {two:.3g} mol/L{about}")
    return figure


def example_plan_results() -> xr.Dataset:
    """Return the results of the plan that `erlif plan --example` prints.

    Returns
    -------
    xarray.Dataset

    Examples
    --------
    >>> example_plan_results().sizes["camera"]
    2
    """
    return _example().copy()


@cache
def _example() -> xr.Dataset:
    from erlif.planning.plan import example_plan, plan

    return plan(PlanSettings.model_validate(tomllib.loads(example_plan())))
