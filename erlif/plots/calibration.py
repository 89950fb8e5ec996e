"""The calibration: the fixture's profile, the ratio it gave, and how well the model goes through it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from erlif.calibration import Calibration, Profile
from erlif.core.arrays import Array
from erlif.plots.style import (
    COVERAGE,
    MUTED,
    ONE_COLUMN,
    OUTWARD,
    RETURN,
    add_colour_bar,
    colour_map,
    given_or_new,
    letter,
    new_figure,
    save_figure,
    styled,
)

_SHADE = "#EDEDED"


@styled
def fixture_profile(
    profile: Profile, *, calibration: Calibration | None = None, ax: Axes | None = None
) -> list[Artist]:
    """Draw what the coordinate measuring machine (CMM) saw of the fixture; the calibrated range is shaded where given.

    Parameters
    ----------
    profile : Profile
        From `erlif.calibration.read_profile`; a line, or a surface drawn as coloured points.
    calibration : Calibration, optional
        What was made of it.
    ax : Axes, optional

    Returns
    -------
    list of Artist
    """
    ax = given_or_new(ax)
    if profile.position.ndim == 2:
        points = ax.scatter(
            profile.position[:, 0],
            profile.position[:, 1],
            c=profile.thickness,
            cmap=colour_map("batlow"),
            s=6,
            linewidths=0,
        )
        add_colour_bar(points, ax, "thickness by CMM [µm]", extend="neither")
        ax.set(xlabel="profile x [mm]", ylabel="profile y [mm]", aspect="equal")
        return [points]
    artists: list[Artist] = []
    if calibration is not None:
        low, high = calibration.thickness_range
        artists.append(
            ax.axhspan(
                low,
                high,
                facecolor=_SHADE,
                edgecolor=MUTED,
                linestyle=":",
                linewidth=0.5,
                zorder=0,
                label="calibrated range",
            )
        )
    bars = ax.errorbar(
        profile.position,
        profile.thickness,
        profile.uncertainty,
        fmt="o",
        markersize=1.6,
        color=OUTWARD,
        ecolor=MUTED,
        elinewidth=0.5,
        capsize=0,
        label="CMM" if profile.uncertainty is None else "CMM, bars 1 s.d.",
    )
    ax.set(xlabel="profile x [mm]", ylabel="thickness by CMM [µm]")
    ax.margins(x=0.01)
    ax.legend(loc="upper left")
    return [bars.lines[0], *artists]


def _grid(calibration: Calibration) -> Array:
    low, high = calibration.thickness_range
    if "curve_thickness" in calibration.curve:
        low = max(min(low, float(calibration.curve.curve_thickness.min())), 0.0)
        high = max(high, float(calibration.curve.curve_thickness.max()))
    return np.linspace(low, high, 400)


def _band(calibration: Calibration, thickness: Array) -> Array:
    """Half width of the 95 % band of the ratio that the fit's covariance leaves, as a share of the ratio."""
    return COVERAGE * calibration.log_ratio_std(thickness)


@styled
def ratio_against_thickness(calibration: Calibration, *, ax: Axes | None = None) -> list[Artist]:
    """Draw ratio against thickness: the binned fixture with error bars, the fit with its 95 % band, the range shaded.

    Parameters
    ----------
    calibration : Calibration
        One read back from a film has no points; the curve is then drawn alone.
    ax : Axes, optional

    Returns
    -------
    list of Artist
        Fit, band, and the points where there are any.
    """
    ax = given_or_new(ax)
    t = _grid(calibration)
    ratio, share = calibration.predict(t), _band(calibration, t)
    ax.axvspan(
        *calibration.thickness_range,
        facecolor=_SHADE,
        edgecolor=MUTED,
        linestyle=":",
        linewidth=0.5,
        zorder=0,
        label="calibrated range",
    )
    band = ax.fill_between(
        t,
        ratio * np.exp(-share),
        ratio * np.exp(share),
        color=RETURN,
        alpha=0.35,
        linewidth=0,
        label="fit, 95 % band",
    )
    model = "reabsorption model" + ("" if calibration.departure is None else " and departure")
    (fit,) = ax.plot(t, ratio, color=RETURN, zorder=3, label=model)
    artists: list[Artist] = [fit, band]
    curve = calibration.curve
    if "curve_ratio" in curve:
        bars = ax.errorbar(
            curve.curve_thickness.values,
            curve.curve_ratio.values,
            curve.curve_ratio_std.values,
            fmt="o",
            markersize=1.8,
            color=OUTWARD,
            ecolor=MUTED,
            elinewidth=0.5,
            capsize=0,
            label="fixture, bars 1 s.d.",
            zorder=2,
        )
        artists.append(bars.lines[0])
    one, two = calibration.bands
    ax.set(xlabel="thickness [µm]", ylabel=f"ratio {two:g} nm / {one:g} nm [1]")
    ax.margins(x=0.01)
    ax.legend(loc="lower right")
    ax.annotate(
        _parameters(calibration),
        (0.04, 0.97),
        xycoords="axes fraction",
        ha="left",
        va="top",
        fontsize=6.5,
    )
    return artists


def _parameters(calibration: Calibration) -> str:
    values, stds = calibration.parameters, calibration.standard_deviations
    lines = [
        f"K = {values[0]:.4f} ± {stds[0]:.4f}",
        f"p = {values[1]:.4f} ± {stds[1]:.4f} µm⁻¹",
        f"q = {values[2]:.4f} ± {stds[2]:.4f} µm⁻¹",
    ]
    if np.isfinite(calibration.reduced_chi_square):
        lines.append(f"reduced χ² = {calibration.reduced_chi_square:.2f}")
    return "\n".join(lines)


@styled
def ratio_residuals(calibration: Calibration, *, ax: Axes | None = None) -> list[Artist]:
    """Draw what the fit leaves of the ratio, in per cent of it; parameters and artists as in `ratio_against_thickness`.

    Where a spline departs from the reabsorption model, the model alone is the dashed line.
    """
    ax = given_or_new(ax)
    t = _grid(calibration)
    share = 100 * _band(calibration, t)
    ax.axvspan(
        *calibration.thickness_range,
        facecolor=_SHADE,
        edgecolor=MUTED,
        linestyle=":",
        linewidth=0.5,
        zorder=0,
    )
    band = ax.fill_between(t, -share, share, color=RETURN, alpha=0.35, linewidth=0)
    zero = ax.axhline(0, color=RETURN, linewidth=0.8, zorder=3)
    artists: list[Artist] = [zero, band]
    if calibration.departure is not None:
        alone = 100 * np.expm1(-calibration.departure.predict(t))
        artists += ax.plot(
            t, alone, color=MUTED, linestyle="--", linewidth=0.8, label="model alone"
        )
        ax.legend(loc="best")
    curve = calibration.curve
    if "curve_ratio" in curve:
        fitted = curve.curve_ratio.values - curve.curve_residual.values
        bars = ax.errorbar(
            curve.curve_thickness.values,
            100 * curve.curve_residual.values / fitted,
            100 * curve.curve_ratio_std.values / fitted,
            fmt="o",
            markersize=1.8,
            color=OUTWARD,
            ecolor=MUTED,
            elinewidth=0.5,
            capsize=0,
        )
        artists.append(bars.lines[0])
    ax.set(xlabel="thickness [µm]", ylabel="residual [% of ratio]")
    ax.margins(x=0.01)
    return artists


@styled
def calibration_figure(calibration: Calibration) -> Figure:
    """Ratio against thickness above and residuals below, one column wide."""
    figure = new_figure(ONE_COLUMN, 1.12 * ONE_COLUMN)
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=(2.1, 1))
    ratio_against_thickness(calibration, ax=above)
    ratio_residuals(calibration, ax=below)
    above.set_xlabel("")
    letter(above, "a")
    letter(below, "b")
    above.set_title(calibration.fixture)
    return figure


def write_calibration_figure(calibration: Calibration, path: str | Path) -> Path:
    """Write the figure of a calibration, PNG, PDF or SVG by the suffix of `path`; raises OutputError."""
    return save_figure(calibration_figure(calibration), Path(path))
