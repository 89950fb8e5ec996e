"""A planned rig: ratio, standard deviation, relative error and signal against thickness."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from functools import cache, partial
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes

from erlif.core.units import count_of
from erlif.io.settings import PlanSettings
from erlif.show.plots import style
from erlif.show.plots.style import MEAN, MUTED, OUTWARD, RETURN, TWO_COLUMNS, Curve, styled

_CALIBRATED, _MEASURABLE = "#F2F2F2", "#DCE9F2"

_WORST = 2.0  # of the film: largest standard deviation that is drawn
_TALL = 0.74  # height by width of the figure


def _draw(
    plan: xr.Dataset,
    ax: Axes,
    curves: Sequence[tuple[xr.DataArray, str, str, str]],
    quantity: str,
    *,
    ranges: tuple[str | None, str | None] = (None, None),
    **options: Any,
) -> list[Any]:
    """Draw values, colours, forms and names of curves over the thickness, with its ranges."""
    for bounds, colour, name, zorder in (
        (plan.calibrated_range, _CALIBRATED, ranges[0], -2),
        (plan.measurable_range, _MEASURABLE, ranges[1], -1),
    ):
        if np.isfinite(bounds[0]):
            ax.axvspan(*bounds.values, color=colour, linewidth=0, label=name, zorder=zorder)
    for edge in plan.film_range.values:
        ax.axvline(edge, color=MUTED, linewidth=0.6, linestyle=":", zorder=0)
    drawn = [
        Curve(plan.thickness, values, colour, name, {"form": form})
        for values, colour, form, name in curves
    ]
    ends = (float(plan.thickness[0]), float(plan.thickness[-1]))
    axes = {"xscale": "log", "xlim": ends} | options
    return style.draw_curves(ax, drawn, "film thickness [µm]", quantity, **axes)


@style.panel
def plan_ratio(plan: xr.Dataset, *, ax: Axes = style.NEW) -> list[Artist]:
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
    curves = (
        (plan.ratio, OUTWARD, "-", "as planned"),
        (plan.optimum_ratio, RETURN, "--", "best concentrations"),
    )
    ranges = "calibrated range", "measurable, 1 pixel of 1 frame"
    return _draw(plan, ax, curves, "ratio camera 2 / camera 1", ranges=ranges)


@style.panel
def plan_precision(
    plan: xr.Dataset, *, relative: bool = False, ax: Axes = style.NEW
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
    scale = 100 / plan.thickness if relative else xr.ones_like(plan.thickness)
    frames, average = int(plan.attrs["frames"]), int(plan.attrs["average"])
    pixels = "1 pixel" if average == 1 else f"{average} × {average} pixels"
    curves = [(plan.thickness_std * scale, OUTWARD, "-", "1 pixel, 1 frame")]
    name, best = f"{pixels}, {count_of(frames, 'frame')}", plan.optimum_thickness_std
    if frames > 1 or average > 1:
        curves.append((plan.thickness_std_frames * scale, MEAN, "-", name))
        best = plan.optimum_thickness_std_frames
    curves.append((best * scale, RETURN, "--", f"{name}, best conc."))

    stds = xr.concat([std for std, *_ in curves], "curve")
    inside = plan.thickness <= float(plan.film_range[1]) * 1.2
    low, high = float(stds.min()), float(stds.where(inside).max())
    # an error of several times the film is no measurement
    high = min(high, 100 * _WORST if relative else _WORST * float(plan.film_range[1]))
    if relative:
        wanted = 100 * plan.attrs["uncertainty"]
        ax.axhline(wanted, color=MUTED, linewidth=0.6, linestyle="-.", label="wanted")
        low, high = min(low, wanted), max(high, wanted)
    label = "std / thickness [%]" if relative else "standard deviation [µm]"
    return _draw(plan, ax, curves, label, yscale="log", ylim=(low / 1.3, high * 1.3))


@style.panel
def plan_signal(plan: xr.Dataset, *, ax: Axes = style.NEW) -> list[Artist]:
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
    one, two = (plan.signal.sel(camera=number) / 1e3 for number in (1, 2))
    full: dict[str, Any] = {"color": "black", "linestyle": (0, (1, 1)), "label": "full scale"}
    for value in sorted(set(plan.full_scale.values)):
        ax.axhline(value / 1e3, linewidth=0.8, **full)
    curves = ((one, OUTWARD, "-", "camera 1"), (two, RETURN, "--", "camera 2"))
    return _draw(plan, ax, curves, "signal [1000 electrons]", ylim=(0, None))


@styled
def plan_figure(plan: xr.Dataset) -> style.AnyFigure:
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
