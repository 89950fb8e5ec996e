"""A planned rig: ratio, standard deviation, relative error and signal against thickness."""

from __future__ import annotations

import tomllib
from functools import cache, partial
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from erlif.core.units import count_of
from erlif.io.settings import PlanSettings
from erlif.show.plots import style
from erlif.show.plots.style import MEAN, MUTED, OUTWARD, RETURN, TWO_COLUMNS, styled

_CALIBRATED: dict[str, Any] = {"facecolor": "#F2F2F2", "edgecolor": "none", "zorder": -2}
_MEASURABLE: dict[str, Any] = {"facecolor": "#DCE9F2", "edgecolor": "none", "zorder": -1}

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

    Parameters
    ----------
    plan : xarray.Dataset
        Curves, ranges and optimum, as `erlif.plan` returns them.

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
    lines: list[Artist] = []
    for curve, colour, form, label in (
        (plan.ratio, OUTWARD, "-", "as planned"),
        (plan.optimum_ratio, RETURN, "--", "best concentrations"),
    ):
        lines += style.draw_line(ax, plan.thickness, curve, colour, form=form, label=label)
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
    pixels = "1 pixel" if average == 1 else f"{average} × {average} pixels"
    curves = [(plan.thickness_std, OUTWARD, "-", "1 pixel, 1 frame")]
    name, best = f"{pixels}, {count_of(frames, 'frame')}", plan.optimum_thickness_std
    if frames > 1 or average > 1:
        curves.append((plan.thickness_std_frames, MEAN, "-", name))
        best = plan.optimum_thickness_std_frames
    curves.append((best, RETURN, "--", f"{name}, best conc."))

    lines: list[Artist] = []
    drawn: list[xr.DataArray] = []
    for std, colour, dashes, name in curves:
        shown = std * scale
        lines += ax.plot(plan.thickness, shown, color=colour, linestyle=dashes, label=name)
        drawn.append(shown)
    inside = plan.thickness <= float(plan.film_range[1]) * 1.2
    low = min(float(shown.min()) for shown in drawn)
    high = max(float(shown.where(inside).max()) for shown in drawn)
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
    """Draw the mean signal of both cameras against thickness and full scale, as `plan_ratio`.

    Returns
    -------
    list of Artist
        Signal of camera 1 and camera 2.

    Examples
    --------
    >>> [line.get_label() for line in plan_signal(example_plan_results())]
    ['camera 1', 'camera 2']
    """
    ax = style.given_or_new(ax)
    _draw_ranges(plan, ax)
    lines: list[Artist] = []
    for number, colour, dashes in ((1, OUTWARD, "-"), (2, RETURN, "--")):
        signal = plan.signal.sel(camera=number) / 1e3
        label = f"camera {number}"
        lines += style.draw_line(ax, plan.thickness, signal, colour, form=dashes, label=label)
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
    """Combine ratio, standard deviation, relative error and signal of a rig, as `plan_ratio`.

    Returns
    -------
    Figure
        Four panels. Dotted vertical lines are the ends of the wanted range.

    Examples
    --------
    >>> len(plan_figure(example_plan_results()).axes)
    4
    """
    figure = style.new_figure(TWO_COLUMNS, _TALL * TWO_COLUMNS)
    relative: Any = partial(plan_precision, relative=True)
    drawings = (plan_ratio, plan_precision, relative, plan_signal)
    style.draw_panels(figure.subplots(2, 2).ravel(), drawings, plan)
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
        A copy, which may be changed.

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
