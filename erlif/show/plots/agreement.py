"""Minimum film thickness over theory, against speed over load."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes

from erlif.core.arrays import Array
from erlif.io.files import formula_label
from erlif.show.plots import style
from erlif.show.plots.style import MEAN, OUTWARD, RETURN, pt
from erlif.show.plots.triggers import draw_strokes

# Ratios of a film with their colours, and what they are over.
_RATIOS = {
    "film_over_hamrock_dowson": (OUTWARD, ""),
    "film_over_theory": (RETURN, "regime map"),
    "film_over_predicted": (MEAN, "transient film"),
}


def has_ratio(film: xr.Dataset) -> bool:
    """Whether the film has a ratio to a theory at some trigger."""
    return any(name in film and np.isfinite(film[name]).any() for name in _RATIOS)


@style.film_panel
def film_over_theory(film: xr.Dataset, *, ax: Axes = style.NEW) -> list[Artist]:
    """Draw the minimum film thickness over each theory against the size of the speed.

    Bars are one standard deviation of the film, random and shared. Lines are the medians, which
    the legend states. Triggers below a tenth of the highest speed are left out.

    Parameters
    ----------
    ax : Axes, optional
        Default: those of a new figure, one column wide. The ratio is on a logarithmic scale.

    Returns
    -------
    list of Artist
        The points of both strokes for each theory.

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> film = example_film()
    >>> ratio = (film.film_min / film.film_theory).assign_attrs(factor=0.05)
    >>> film = film.assign(film_over_theory=ratio, film_over_theory_std=0 * ratio)
    >>> outward, back = film_over_theory(film)
    >>> float(outward.get_ydata().max().round(3))
    0.034
    """
    name = "rocker_speed" if "rocker_speed" in film else "sliding_speed"
    x: Array = np.abs(film[name].values)
    ax.set(yscale="log")
    ax.axhline(1.0, color=style.MUTED, linewidth=pt(0.5))
    artists: list[Artist] = []
    for ratio, (colour, title) in _RATIOS.items():
        values = film[ratio].values if ratio in film else np.empty(0)
        if not np.isfinite(values).any():
            continue
        std = film[f"{ratio}_std"].values
        artists += draw_strokes(ax, film, x, values, std, which=np.isfinite(values), colour=colour)
        factor = float(film[ratio].attrs["factor"])
        ends = [float(np.min(x[np.isfinite(values)])), float(np.max(x[np.isfinite(values)]))]
        label = f"over {title or formula_label(film)}: {factor:.3g}"
        style.draw_line(ax, ends, [factor, factor], colour, form="--", label=label)
    units = {"rocker_speed": "|ω| [rad s⁻¹]", "sliding_speed": "sliding speed [m s⁻¹]"}
    ax.set(xlabel=units[name], ylabel="minimum film over theory")
    style.plain_log_ticks(ax)
    style.legend_below(ax, title="medians", ncols=1)
    return artists
