"""Friction of the measured film against Hersey number and film parameter."""

from __future__ import annotations

from functools import partial

import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes

from erlif.show.plots import style
from erlif.show.plots.style import MUTED, AnyFigure, styled
from erlif.show.plots.trend import draw_beside
from erlif.show.plots.triggers import draw_strokes, state_no_film

# of a Stribeck curve, by its variable: label of the axis, its unit and its scale
_STRIBECK = {
    "hersey_number": ("Hersey number, ηvL/F [10⁻⁶]", 1e6, "log"),
    "film_parameter": ("film parameter, Λ [1]", 1.0, "linear"),
}


@style.film_panel
def stribeck_curve(
    film: xr.Dataset, *, against: str = "hersey_number", ax: Axes = style.NEW
) -> list[Artist]:
    """Draw the friction coefficient of the film against Hersey number or film parameter.

    Grey: that of the logged torque. Other arguments as in `film_against_speed`.

    Parameters
    ----------
    against : str
        "hersey_number" or "film_parameter".

    Returns
    -------
    list of Artist
        Points of each stroke, then those of the log.

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> film, number = example_film(), ("trigger", [1e-6, 2e-6, 3e-6, 3e-6, 2e-6, 1e-6])
    >>> names = "hersey_number", "friction_coefficient", "friction_coefficient_std"
    >>> outward, back = stribeck_curve(film.assign(dict.fromkeys(names, number)))
    >>> outward.axes.get_xlabel()
    'Hersey number, ηvL/F [10⁻⁶]'
    """
    label, unit, scale = _STRIBECK[against]
    ax.set(xscale=scale, yscale="log", xlabel=label, ylabel="friction coefficient [1]")
    x, value = unit * film[against].values, film.friction_coefficient.values
    drawable = (x > 0) & (value > 0)  # the scales are logarithmic
    std = film.friction_coefficient_std.values
    artists = draw_strokes(ax, film, x, value, std, which=drawable)
    if not artists:
        state_no_film(ax, film)
        return []
    if "torque_not_film" in film:
        whole = value * (1 + film.torque_not_film.values / film.friction_torque.values)
        which = drawable & (whole > 0)
        artists += draw_strokes(ax, film, x, whole, which=which, colour=MUTED, label="logged")
    style.plain_log_ticks(ax)
    style.legend_below(ax, title=f"bars: {style.ONE_STD}")
    return artists


@styled
def stribeck_figure(film: xr.Dataset, *, figure: AnyFigure | None = None) -> AnyFigure:
    """Draw the Stribeck curve of a film, and beside it that against the film parameter.

    Arguments as in `speed_figure`.

    Returns
    -------
    Figure
        Two columns wide; one, without the film parameter, where the film has none.

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> film, number = example_film(), ("trigger", [1e-6, 2e-6, 3e-6, 3e-6, 2e-6, 1e-6])
    >>> names = "hersey_number", "friction_coefficient", "friction_coefficient_std"
    >>> figure = stribeck_figure(film.assign(dict.fromkeys(names, number)))
    >>> [ax.get_xlabel() for ax in figure.axes]
    ['Hersey number, ηvL/F [10⁻⁶]', 'film parameter, Λ [1]']
    """
    drawings = [partial(stribeck_curve, against=name) for name in _STRIBECK if name in film]
    return draw_beside(drawings, film, figure)
