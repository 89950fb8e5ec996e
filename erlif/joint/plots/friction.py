"""Friction of a bushing over a torque log with reversals."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from matplotlib.artist import Artist
from matplotlib.axes import Axes

from erlif.joint.friction import ReversalSeries
from erlif.show.plots import style
from erlif.show.plots.style import ONE_COLUMN, OUTWARD, RETURN, pt

_MINUTE = 60.0
_HEIGHT = 3.0  # inch


@style.panel
def friction_over_reversals(series: ReversalSeries, *, ax: Axes = style.NEW) -> list[Artist]:
    """Draw the apparent coefficient of each pair of stretches with its mean. Colbert et al. fig. 8.

    Bars are one standard deviation of the scatter of a pair, the band one of the mean from all
    causes.

    Parameters
    ----------
    series : ReversalSeries
        The pairs of stretches that `erlif.joint.friction.analyse_friction` found.

    Returns
    -------
    list of Artist
        Points of the pairs of stretches, then their mean.

    Examples
    --------
    >>> import numpy as np
    >>> import xarray as xr
    >>> from erlif.joint.friction import analyse_friction
    >>> time = np.arange(0.0, 40.0, 0.1)
    >>> log = xr.Dataset({"cells": (("cell", "time"), [np.full(time.size, 400.0)])}, {"time": time})
    >>> log["torque"] = "time", 0.6 * np.where(time % 10 < 5, 1, -1)
    >>> points, *_ = friction_over_reversals(analyse_friction(log, shaft_radius=0.01))
    >>> points.axes.get_xlabel()
    'time [min]'
    """
    pairs = series.pairs
    known = "sliding_distance" in pairs
    x = (pairs["sliding_distance"] if known else pairs["time"] / _MINUTE).values
    look: dict[str, Any] = {"color": OUTWARD, "markersize": pt(2.5), "linewidth": pt(0.7)}
    look |= {"fmt": "o", "label": "pair of stretches"}
    drawn = ax.errorbar(x, pairs["friction"].values, pairs["friction_std"].values, **look)

    middle, half = series.friction, series.friction_std
    ax.axhspan(middle - half, middle + half, color=RETURN, alpha=0.25, linewidth=0)
    mean = ax.axhline(middle, color=RETURN, linewidth=pt(0.8), label="mean ± 1 s.d.")

    along = "sliding distance [m]" if known else "time [min]"
    ax.set(xlabel=along, ylabel="apparent friction coefficient", ymargin=0.1)
    ax.locator_params(axis="x", nbins=5)  # their labels do not meet
    style.legend_above(ax)
    return [drawn[0], mean]


def write_reversal_figure(series: ReversalSeries, output: Path) -> Path:
    """Write the figure of a torque log.

    `output` is the file; arguments that are not listed are those of `friction_over_reversals`.

    Returns
    -------
    Path
        That of the figure, which is PNG, PDF or SVG by its suffix.

    Examples
    --------
    >>> write_reversal_figure.__name__
    'write_reversal_figure'
    """
    with style.in_style(None):
        figure = style.new_figure(ONE_COLUMN, _HEIGHT, text=0.4)
        figure.suptitle(Path(series.pairs.attrs.get("file") or output).stem)
        friction_over_reversals(series, ax=figure.subplots())
        return style.save_figure(figure, output)
