"""The calibration: profile of the fixture, ratio against thickness, and residuals of the fit."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from erlif.calibration import Calibration, Profile
from erlif.core.arrays import Array
from erlif.show.plots import style
from erlif.show.plots.naming import write_title
from erlif.show.plots.style import MUTED, ONE_COLUMN, OUTWARD, RETURN, AnyFigure, pt, styled

# of the calibrated range
_SHADE: dict[str, Any] = {"facecolor": "#EDEDED", "edgecolor": MUTED, "linestyle": ":", "zorder": 0}

_PANELS = (2.1, 1)  # heights of curve and residuals
_GRID = 400  # points of a curve

# Parameters and their units; the last two only where the wall reflects.
_PARAMETERS = (("K", ""), ("p", " µm⁻¹"), ("q", " µm⁻¹"), ("a", " µm⁻¹"), ("R", ""))


def _draw_points(
    ax: Axes, x: Array, y: Array, std: Array | None, *, label: str | None = None
) -> Line2D:
    """Draw points with bars of one standard deviation."""
    points: dict[str, Any] = {"color": OUTWARD, "markersize": pt(1.7), "label": label}
    bars: dict[str, Any] = {"ecolor": MUTED, "elinewidth": pt(0.5), "capsize": 0}
    line: Line2D = ax.errorbar(x, y, std, fmt="o", zorder=2, **points, **bars).lines[0]
    return line


def _draw_range(calibration: Calibration, shade: Callable[..., Artist], **look: Any) -> Artist:
    """Shade the calibrated range across or along axes."""
    return shade(*calibration.thickness_range, linewidth=pt(0.5), **_SHADE, **look)


@style.panel
def fixture_profile(
    profile: Profile, *, calibration: Calibration | None = None, ax: Axes = style.NEW
) -> list[Artist]:
    """Draw the profile of a fixture by the coordinate measuring machine (CMM).

    Parameters
    ----------
    profile : Profile
        From `erlif.calibration.read_profile`; a line, or a surface drawn as coloured points.
    calibration : Calibration, optional
        The calibration of this fixture; its calibrated range is shaded in the profile of a line.

    Returns
    -------
    list of Artist
        The points; for a line with a calibration, the shaded range.

    Examples
    --------
    >>> import numpy as np
    >>> from erlif.calibration import Profile
    >>> wedge = Profile(np.linspace(0, 20, 5), np.linspace(0, 16, 5), np.full(5, 0.1))
    >>> points, = fixture_profile(wedge)
    >>> points.axes.get_xlabel(), points.axes.get_ylabel()
    ('profile x [mm]', 'thickness by CMM [µm]')
    """
    if profile.position.ndim == 2:
        look: dict[str, Any] = {"cmap": style.colour_map("batlow"), "s": 6, "linewidths": 0}
        x, y = profile.position.T
        scatter = ax.scatter(x, y, c=profile.thickness, **look)
        style.add_colour_bar(scatter, ax, "thickness by CMM [µm]", extend="neither")
        ax.set(xlabel="profile x [mm]", ylabel="profile y [mm]", aspect="equal")
        return [scatter]

    artists: list[Artist] = []
    if calibration is not None:
        artists.append(_draw_range(calibration, ax.axhspan, label="calibrated range"))
    label = "CMM" if profile.uncertainty is None else f"CMM, {style.ONE_STD}"
    columns = profile.position, profile.thickness, profile.uncertainty
    points = _draw_points(ax, *columns, label=label)
    ax.set(xlabel="profile x [mm]", ylabel="thickness by CMM [µm]", xmargin=0.01)
    style.legend_above(ax)
    return [points, *artists]


@styled
def profile_figure(profile: Profile, *, calibration: Calibration | None = None) -> style.AnyFigure:
    """Draw the profile of a line, and what it departs from a straight line below.

    Arguments as in `fixture_profile`.

    Returns
    -------
    Figure
        Two panels, one column of a journal wide.

    Examples
    --------
    >>> import numpy as np
    >>> from erlif.calibration import Profile
    >>> wedge = Profile(np.linspace(0, 20, 5), np.linspace(0, 16, 5), np.full(5, 0.1))
    >>> profile_figure(wedge).axes[1].get_ylabel()
    'less a straight line [µm]'
    """
    figure = style.new_figure(ONE_COLUMN, style.STACK * ONE_COLUMN)
    above, below = figure.subplots(2, sharex=True, height_ratios=_PANELS)
    fixture_profile(profile, calibration=calibration, ax=above)
    line = np.polynomial.Polynomial.fit(profile.position, profile.thickness, 1)
    departure = profile.thickness - line(profile.position)
    _draw_points(below, profile.position, departure, profile.uncertainty)
    below.axhline(0.0, color="0.4", linewidth=pt(0.5), zorder=1)
    below.set(xlabel="profile x [mm]", ylabel="less a straight line [µm]")
    style.letter_panels(above, below)
    return figure


def _grid(calibration: Calibration) -> Array:
    """Thicknesses of a curve, over the calibrated range and all points. [um]"""
    # points beyond the calibrated range are drawn too
    low, high = calibration.thickness_range
    if "curve_thickness" in calibration.curve:
        low = max(min(low, float(calibration.curve.curve_thickness.min())), 0.0)
        high = max(high, float(calibration.curve.curve_thickness.max()))
    return np.linspace(low, high, _GRID)


@style.panel
def ratio_against_thickness(calibration: Calibration, *, ax: Axes = style.NEW) -> list[Artist]:
    """Draw ratio against thickness: the points of the fixture and the fit with its band of one s.d.

    Parameters
    ----------
    calibration : Calibration
        A calibration read back from a film has no points; the curve is then drawn alone.

    Returns
    -------
    list of Artist
        Fit, band, and the points where there are any. The calibrated range is shaded.

    Examples
    --------
    >>> from erlif.show.plots import example_calibration
    >>> fit, band, points = ratio_against_thickness(example_calibration())
    >>> fit.axes.get_xlabel(), fit.axes.get_ylabel()
    ('thickness [µm]', 'ratio 610 nm / 580 nm [1]')
    """

    # the band is symmetric in the logarithm of the ratio, in which the fit was made
    t = _grid(calibration)
    ratio, share = calibration.predict(t), calibration.log_ratio_std(t)
    _draw_range(calibration, ax.axvspan, label="calibrated range")
    low, high = ratio * np.exp(-share), ratio * np.exp(share)
    band = style.draw_band(ax, t, low, high, RETURN, alpha=0.35)
    model = "reabsorption model" + ("" if calibration.departure is None else " and spline")
    (fit,) = ax.plot(t, ratio, color=RETURN, zorder=1.5, label=model)
    artists: list[Artist] = [fit, band]

    curve = calibration.curve
    if "curve_ratio" in curve:
        names = ("curve_thickness", "curve_ratio", "curve_ratio_std")
        columns = [curve[name].values for name in names]
        artists.append(_draw_points(ax, *columns, label=f"fixture, {style.ONE_STD}"))

    one, two = calibration.bands
    ylabel = f"ratio {two:g} nm / {one:g} nm [1]"
    ax.set(xlabel="thickness [µm]", ylabel=ylabel, xmargin=0.01)
    if style.is_visible(ax, ratio * np.sinh(share) * 2, pt(1.0)):
        band.set_label(f"fit, {style.ONE_STD}")
    style.legend_above(ax)

    # a curve that rises ever less leaves the lower right free
    place: dict[str, Any] = {"transform": ax.transAxes, "ha": "right", "va": "bottom"}
    ax.text(0.97, 0.05, _parameters(calibration), fontsize=pt(6.5), **place)
    return artists


def _parameters(calibration: Calibration) -> str:
    """Fitted parameters with their standard deviations, one a line."""
    lines = [
        f"{name} = {value:.4f} ± {std:.4f}{unit}"
        for (name, unit), value, std in zip(
            _PARAMETERS, calibration.parameters, calibration.standard_deviations, strict=False
        )
    ]
    if np.isfinite(calibration.reduced_chi_square):
        lines.append(f"reduced χ² = {calibration.reduced_chi_square:.2f}")
    return "\n".join(lines)


@style.panel
def ratio_residuals(calibration: Calibration, *, ax: Axes = style.NEW) -> list[Artist]:
    """Draw the residuals of the fit in per cent of the ratio, with its band of one s.d.

    Where a spline corrects the reabsorption model, the model alone is the dashed line.
    Arguments as in `ratio_against_thickness`.

    Returns
    -------
    list of Artist
        Line at zero and band; the model alone where a spline corrects it; the points where there
        are any.

    Examples
    --------
    These points lie on the model:

    >>> from erlif.show.plots import example_calibration
    >>> zero, band, points = ratio_residuals(example_calibration())
    >>> float(abs(points.get_ydata()).max())
    0.0
    """
    t = _grid(calibration)
    percent = 100 * calibration.log_ratio_std(t)
    _draw_range(calibration, ax.axvspan)
    look: dict[str, Any] = {"alpha": 0.35, "label": f"fit, {style.ONE_STD}"}
    band = style.draw_band(ax, t, -percent, percent, RETURN, **look)
    artists: list[Artist] = [ax.axhline(0, color=RETURN, linewidth=pt(0.8), zorder=1.5), band]

    # the departure is the logarithm of fit over model
    if calibration.departure is not None:
        alone = 100 * np.expm1(-calibration.departure.predict(t))
        look = {"label": "model alone", "zorder": 1.5}
        artists += style.draw_line(ax, t, alone, MUTED, form="--", width=0.8, **look)

    curve = calibration.curve
    if "curve_ratio" in curve:
        fitted = curve.curve_ratio.values - curve.curve_residual.values
        residual, std = (
            100 * curve[name].values / fitted for name in ("curve_residual", "curve_ratio_std")
        )
        artists.append(_draw_points(ax, curve.curve_thickness.values, residual, std))
    ax.set(xlabel="thickness [µm]", ylabel="residual [% of ratio]", xmargin=0.01)
    style.legend_above(ax)
    return artists


@styled
def calibration_figure(calibration: Calibration, *, figure: AnyFigure | None = None) -> AnyFigure:
    """Draw ratio against thickness, and the residuals below.

    Arguments as in `ratio_against_thickness`.

    Returns
    -------
    Figure
        Curve above residuals; one column of a journal wide.

    Examples
    --------
    >>> from erlif.show.plots import example_calibration
    >>> calibration_figure(example_calibration()).get_suptitle()
    'calibration with example wedge'
    """
    figure = style.new_figure(ONE_COLUMN, style.STACK * ONE_COLUMN, given=figure)
    panels = style.rows_or_columns(figure, 2, sharex=True, ratios=_PANELS)
    style.draw_panels(panels, (ratio_against_thickness, ratio_residuals), calibration)
    style.legend_of_figure(figure)
    write_title(figure, f"calibration with {calibration.fixture}")
    return figure


def write_calibration_figure(calibration: Calibration, path: str | Path) -> Path:
    """Write the figure of a calibration as PNG, PDF or SVG by the suffix of `path`.

    Arguments that are not listed are those of `ratio_against_thickness`.

    Parameters
    ----------
    path : path
        The file; an existing one is replaced.

    Returns
    -------
    Path
        The one that was given, as a `Path`.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> from erlif.show.plots import example_calibration
    >>> with TemporaryDirectory() as directory:
    ...     write_calibration_figure(example_calibration(), f"{directory}/wedge.pdf").name
    'wedge.pdf'
    """
    with style.in_style(None):
        return style.save_figure(calibration_figure(calibration), Path(path))
