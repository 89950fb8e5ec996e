"""Profiles of the film along the sliding direction, with the gap of rigid bodies."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes

from erlif.core.arrays import Array
from erlif.io.files import axis_labels
from erlif.show.plots import style
from erlif.show.plots.style import MUTED, OUTWARD, RETURN, pt, styled
from erlif.trend import average_across_sliding, rigid_gap

_ROOM = 0.08  # above a profile, in heights of the profile


@styled
def sliding_profile(film: xr.Dataset, *, trigger: int, ax: Axes | None = None) -> list[Artist]:
    """Draw the profile along sliding with the gap of rigid bodies.

    The profile is the average over the axial extent of the region of interest. Bands are one
    standard deviation: blue of the random error, grey of the error that all pixels share.
    Arguments as in `erlif.plots`.

    Returns
    -------
    list of Artist
        Profile, random band, shared band; the rigid gap where it could be fitted.

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> line, *_ = sliding_profile(example_film(), trigger=1)
    >>> line.axes.get_xlabel(), line.axes.get_ylabel()
    ('x (sliding) [mm]', 'film thickness [µm]')
    """
    ax = style.given_or_new(ax, film)
    profile = average_across_sliding(film, trigger=trigger)
    x, h = profile.position.values, profile.thickness.values
    artists = _draw_profile(ax, film, profile, np.zeros_like(x))

    gap = rigid_gap(profile, film)
    if gap is not None:
        measured = f"measured, curvature {gap.curvature:.4f} ± {gap.curvature_std:.4f} µm/mm²"
        artists[0].set_label(measured)
        # wide and pale below the profile, which follows it closely
        label = f"rigid gap, {gap.rigid_curvature:.4f} µm/mm², minimum {gap.minimum:.2f} µm"
        look: dict[str, Any] = {"width": 2.5, "alpha": 0.5, "zorder": 1.2, "label": label}
        artists += style.draw_line(ax, x, gap.thickness(x), RETURN, **look)

    # the rigid gap may leave the limits beside the measured profile
    if np.isfinite(h).any():
        low, high = float(np.nanmin(h)), float(np.nanmax(h))
        ax.set_ylim(low - _ROOM * (high - low), high + _ROOM * (high - low))
    else:
        style.state_empty(ax, "no valid pixel in the region of interest")
    ax.set_ylabel("film thickness [µm]")
    style.legend_above(ax, ncols=2)
    return artists


@styled
def profile_residual(film: xr.Dataset, *, trigger: int, ax: Axes | None = None) -> list[Artist]:
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
    ax = style.given_or_new(ax, film)
    profile = average_across_sliding(film, trigger=trigger)
    gap = rigid_gap(profile, film)
    x = profile.position.values
    base = np.zeros_like(x) if gap is None else gap.thickness(x)
    artists = _draw_profile(ax, film, profile, base)

    artists.append(ax.axhline(0, color=RETURN, linewidth=pt(1.6), alpha=0.5, zorder=1.2))
    ax.set_ylabel("measured −\nrigid gap [µm]")
    return artists


def _draw_profile(ax: Axes, film: xr.Dataset, profile: xr.Dataset, base: Array) -> list[Artist]:
    """Draw the profile less `base`, with the bands of its random and its shared error."""
    # a profile along y runs to the right as well, so that both directions compare
    x, h = profile.position.values, profile.thickness.values - base
    random, shared = profile.thickness_std.values, profile.thickness_std_shared.values
    (line,) = style.draw_line(ax, x, h, OUTWARD, width=0.7, label="measured")
    band = style.draw_band(ax, x, h - random, h + random, OUTWARD, label=f"random, {style.ONE_STD}")

    # about a difference, the shared error lies about zero
    centre = np.where(np.isfinite(h), 0.0, np.nan) if base.any() else h
    look: dict[str, Any] = {"label": f"shared, {style.ONE_STD}", "alpha": 0.4, "zorder": 3}
    common = style.draw_band(ax, x, centre - shared, centre + shared, MUTED, **look)

    x_label, y_label = axis_labels(film)
    along_x = str(profile.position.attrs["long_name"]).startswith("x")
    ax.set_xlabel(x_label if along_x else y_label)
    ax.set_xlim(float(x[0]), float(x[-1]))
    return [line, band, common]
