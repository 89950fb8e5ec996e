"""Profiles of the film along the sliding direction, with the gap of rigid bodies."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes

from erlif.core.arrays import Array
from erlif.io.files import axis_labels, settings_of
from erlif.show.plots import style
from erlif.show.plots.style import MINIMUM, MUTED, OUTWARD, RETURN, pt
from erlif.trend import (
    GapShape,
    average_across_sliding,
    cut_through_minimum,
    place_of_minimum,
    rigid_gap,
)

_LINE = 0.7  # width of a profile [point]
_ROOM = 0.08  # above a profile, in heights of the profile


@style.film_panel
def sliding_profile(film: xr.Dataset, *, trigger: int, ax: Axes = style.NEW) -> list[Artist]:
    """Draw the profile along sliding with the gap of rigid bodies.

    The profile is the average over the axial extent of the region of interest; that of a point
    contact is a cut through the minimum, over a tenth of the extent. A diamond with its bar is the
    minimum film (``film_min``). Bands and bar are one standard deviation: blue of the random error,
    grey of the error that all pixels share. Arguments as in `erlif.plots`.

    Returns
    -------
    list of Artist
        Profile, random band, shared band; the minimum where its place is known; the rigid gap where
        it could be fitted.

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> line, *_ = sliding_profile(example_film(), trigger=1)
    >>> line.axes.get_xlabel(), line.axes.get_ylabel()
    ('x (sliding) [mm]', 'film thickness [µm]')
    """
    profile = _profile_of(film, trigger)
    x, h = profile.position.values, profile.thickness.values
    artists = draw_profile(ax, film, profile, np.zeros_like(x))
    along = "x" if settings_of(film).optics.x_axis == "sliding" else "y"
    artists += mark_minimum(ax, film, trigger, along)

    gap = rigid_gap(profile, film)
    if gap is not None:
        measured = f"measured, curvature {gap.curvature:.4f} ± {gap.curvature_std:.4f} µm/mm²"
        artists[0].set_label(measured)
        # wide and pale below the profile, which follows it closely
        label = f"rigid gap, {gap.rigid_curvature:.4f} µm/mm², minimum {gap.minimum:.2f} µm"
        look: dict[str, Any] = {"width": 2.5, "alpha": 0.5, "zorder": 1.2, "label": label}
        artists += style.draw_line(ax, x, gap.thickness(x), RETURN, **look)

    # the rigid gap may leave the limits beside the measured profile with its bands
    if np.isfinite(h).any():
        low, high = _ends(film, trigger, profile)
        ax.set_ylim(low - _ROOM * (high - low), high + _ROOM * (high - low))
        _name_visible(ax, profile, artists)
    else:
        style.state_empty(ax, "no valid pixel in the region of interest")
    ax.set_ylabel("film thickness [µm]")
    style.legend_above(ax, ncols=1)
    return artists


@style.film_panel
def profile_residual(film: xr.Dataset, *, trigger: int, ax: Axes = style.NEW) -> list[Artist]:
    """Draw the difference of the profile along sliding and the gap of rigid bodies.

    Arguments as in `sliding_profile`.

    Returns
    -------
    list of Artist
        Difference, random band, shared band, line at zero.

    Examples
    --------
    The noise of one pixel is 0.05 um, and the profile averages 17 rows:

    >>> import numpy as np
    >>> from erlif.show.plots import example_film
    >>> line, *_ = profile_residual(example_film(), trigger=1)
    >>> bool(0.5 < np.nanstd(line.get_ydata()) / (0.05 / 17**0.5) < 1.5)
    True
    """
    profile = _profile_of(film, trigger)
    gap = rigid_gap(profile, film)
    x = profile.position.values
    base = np.zeros_like(x) if gap is None else gap.thickness(x)
    artists = draw_profile(ax, film, profile, base)

    _name_visible(ax, profile, artists)

    artists.append(ax.axhline(0, color=RETURN, linewidth=pt(1.6), alpha=0.5, zorder=1.2))
    ax.set_ylabel("measured −\nrigid gap [µm]")
    return artists


def _profile_of(film: xr.Dataset, trigger: int) -> xr.Dataset:
    """Profile along sliding: through the minimum of a point or lobe, else over the whole region."""
    through = cut_through_minimum if is_local(film) else average_across_sliding
    return through(film, trigger=trigger)


def is_local(film: xr.Dataset) -> bool:
    """Whether the gap of a film differs along the axis: a point contact, or a bore with a shape."""
    joint = settings_of(film).joint
    local = film.attrs.get("contact") in (GapShape.POINT, GapShape.PLATEAU)
    return local or bool(joint and joint.bore)


def mark_minimum(ax: Axes, film: xr.Dataset, trigger: int, axis: str) -> list[Artist]:
    """Mark the minimum film with its bar at its place along x or y, where this is known."""
    place = place_of_minimum(film, trigger=trigger)
    value, std = (float(film[name][trigger]) for name in ("film_min", "film_min_std"))
    if place is None or not np.isfinite([value, std]).all():
        return []
    look: dict[str, Any] = {"fmt": "D", "color": MINIMUM, "markersize": pt(2.6), "zorder": 4}
    look |= {"elinewidth": pt(0.7), "capsize": pt(1.5)}
    label = f"film_min {value:.2f} ± {std:.2f} µm"
    return list(ax.errorbar(place[axis], value, std, label=label, **look).lines[:1])


def _name_visible(ax: Axes, profile: xr.Dataset, artists: list[Artist]) -> None:
    """Remove a band that the line hides from the legend."""
    for name, band in zip(("thickness_std", "thickness_std_shared"), artists[1:3], strict=True):
        if not style.is_visible(ax, 2 * profile[name].values, pt(_LINE)):
            band.set_label(None)


def _ends(film: xr.Dataset, trigger: int, profile: xr.Dataset) -> tuple[float, float]:
    """Lowest and highest film of a profile with its bands and its minimum. [um]"""
    h = profile.thickness.values
    half = np.fmax(profile.thickness_std.values, profile.thickness_std_shared.values)
    ends = [h - half, h + half]
    if place_of_minimum(film, trigger=trigger) is not None:
        value, std = film.film_min.values[trigger], film.film_min_std.values[trigger]
        ends.append(np.array([value - std, value + std]))
    return float(np.nanmin(np.concatenate(ends))), float(np.nanmax(np.concatenate(ends)))


def draw_profile(ax: Axes, film: xr.Dataset, profile: xr.Dataset, base: Array) -> list[Artist]:
    """Draw the profile less `base`, with the bands of its random and its shared error."""
    # a profile along y runs to the right as well, so that both directions compare
    x, h = profile.position.values, profile.thickness.values - base
    random, shared = profile.thickness_std.values, profile.thickness_std_shared.values
    label = "measured, through the minimum" if is_local(film) else "measured"
    (line,) = style.draw_line(ax, x, h, OUTWARD, width=_LINE, label=label)
    band = style.draw_band(ax, x, h - random, h + random, OUTWARD, label=f"random, {style.ONE_STD}")

    # about a difference, the shared error lies about zero
    centre = np.where(np.isfinite(h), 0.0, np.nan) if base.any() else h
    wider = np.nansum(shared) > np.nansum(random)  # the wider band lies behind
    look: dict[str, Any] = {"label": f"shared, {style.ONE_STD}", "alpha": 0.4}
    look["zorder"] = 0.9 if wider else 3
    common = style.draw_band(ax, x, centre - shared, centre + shared, MUTED, **look)

    x_label, y_label = axis_labels(film)
    along_x = str(profile.position.attrs["long_name"]).startswith("x")
    ax.set_xlabel(x_label if along_x else y_label)
    ax.set_xlim(float(x[0]), float(x[-1]))
    return [line, band, common]
