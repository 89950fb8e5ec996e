"""The orbit of the pin in its bushing over the triggers of a film."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.patches import Ellipse

from erlif.core.arrays import Array, Mask
from erlif.core.errors import ConfigError
from erlif.show.plots import style, triggers
from erlif.show.plots.style import MEAN, MINIMUM, MUTED, ONE_COLUMN, AnyFigure, pt, styled

_TALL = 1.7  # height by width of three panels
_ROOM, _LEAST_SPAN = 0.15, 0.1  # on either side of the values, of their range; its least [um]
_MARKER = 2.2  # point
_DASHES = (0, (3, 1.5))
_RANDOM: dict[str, Any] = {"facecolor": MEAN, "edgecolor": "none", "alpha": 0.5, "zorder": 2}
_WHOLE: dict[str, Any] = {"fill": False, "edgecolor": MINIMUM, "linestyle": _DASHES, "zorder": 4}


def has_position(film: xr.Dataset) -> bool:
    """Whether a film holds positions of the pin that are numbers, at two triggers or more."""
    if "pin_displacement" not in film:
        return False
    return int(np.isfinite(film.pin_displacement.values).all(axis=1).sum()) > 1


@style.film_panel
def pin_orbit(film: xr.Dataset, *, ax: Axes = style.NEW) -> list[Artist]:
    """Draw the displacement of the pin at every trigger, with the load downwards.

    Ellipses are one standard deviation of the random error, new at every trigger. The grey line is
    the clearance: there pin and bore touch. Arguments as in `erlif.plots`.

    Returns
    -------
    list of Artist
        The clearance, the points of each stroke, then the ellipses.

    Raises
    ------
    ConfigError
        If the film holds no position of the pin at two triggers or more.

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> clearance, outward, back, *ellipses = pin_orbit(example_film())
    >>> len(outward.get_xdata()) + len(back.get_xdata()), len(ellipses)
    (6, 6)
    """
    load, side, known = _displacements(film)
    clearance = float(film.pin_displacement.attrs["clearance"])

    # sideways no larger scale than along the load, which would make noise look like an orbit
    vertical = np.append(load[known], [clearance])
    low, high = _around(side[known], least=float(np.ptp(vertical)))
    across = np.linspace(low, high, 201)
    wall = np.sqrt(np.maximum(clearance**2 - across**2, 0.0))
    artists: list[Artist] = [*ax.plot(across, wall, color=MUTED, label="clearance", zorder=1)]
    artists += _draw_points(ax, film, side, load, known)
    for k in np.flatnonzero(known):
        covariance = film.pin_position_cov_random.values[k, :2, :2]
        artists.append(ax.add_patch(_ellipse(side[k], load[k], covariance[::-1, ::-1], **_RANDOM)))

    ax.set(xlim=(low, high), ylim=_around(np.append(load[known], wall))[::-1])
    ax.set(xlabel="sideways [µm]", ylabel="towards the load [µm]")
    style.legend_above(ax)
    return artists


@style.film_panel
def closest_film(film: xr.Dataset, *, ax: Axes = style.NEW) -> list[Artist]:
    """Draw the film where pin and bore are closest, against the angle of this place.

    This is the orbit unrolled: the angle counts from the load line, and the film is the clearance
    less the distance of the axes. Ellipses are one standard deviation of the random error; the
    dashed one is that of the last trigger with the errors that all triggers share. Arguments as in
    `pin_orbit`.

    Returns
    -------
    list of Artist
        The points of each stroke, the ellipses of the triggers, then the dashed one.

    Examples
    --------
    The film of this example is thinnest at the load line:

    >>> from erlif.show.plots import example_film
    >>> outward, *_ = closest_film(example_film())
    >>> outward.get_xdata()
    array([0., 0., 0.])
    """
    load, side, known = _displacements(film)
    distance = np.hypot(load, side)
    angle = np.degrees(np.arctan2(side, load))
    closest = float(film.pin_displacement.attrs["clearance"]) - distance

    artists = _draw_points(ax, film, angle, closest, known)

    # the errors of both displacements, turned to angle and film
    last = int(np.flatnonzero(known)[-1])
    parts = [(int(k), film.pin_position_cov_random, _RANDOM) for k in np.flatnonzero(known)]
    for k, covariance, look in [*parts, (last, film.pin_position_cov, _WHOLE)]:
        to_angle = np.degrees([-side[k], load[k]]) / distance[k] ** 2
        turn = np.array([to_angle, np.array([-load[k], -side[k]]) / distance[k]])
        turned = turn @ covariance.values[k, :2, :2] @ turn.T
        artists.append(ax.add_patch(_ellipse(angle[k], closest[k], turned, **look)))

    # an arc of the bore no longer than the films are thick, as in the orbit
    arc = math.degrees(float(np.ptp(closest[known])) / float(distance[known].mean()))
    reach = math.sqrt(turned[1, 1]) * np.array([-1, 1])  # of the last ellipse, with shared errors
    films = np.append(closest[known], closest[last] + reach)
    ax.set(xlim=_around(angle[known], least=arc), ylim=_around(films))
    ax.set(xlabel="angle from the load line [°]", ylabel="closest film [µm]")
    key = f"{style.ONE_STD} with shared errors"
    style.draw_line(ax, [], [], MINIMUM, form=_DASHES, width=0.7, label=key)
    style.legend_above(ax)
    return artists


@style.film_panel
def gap_curvature(film: xr.Dataset, *, ax: Axes = style.NEW) -> list[Artist]:
    """Draw the curvature of the gap along sliding beside that of the radii, as `pin_orbit`.

    Returns
    -------
    list of Artist
        The points of each stroke with bars of one s.d., then the curvature of circles.

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> gap_curvature(example_film())[-1].get_label()
    'circles of the radii; bars: 1 s.d.'
    """
    _require_position(film)
    names = ("film_curvature", "film_curvature_std", "film_curvature_expected")
    values, std, circles = (film[name].values for name in names)
    line: dict[str, Any] = {"colour": MINIMUM, "form": _DASHES, "zorder": 1.5}
    line["label"] = f"circles of the radii; bars: {style.ONE_STD}"
    # fifty bars stand side by side
    look: dict[str, Any] = {"elinewidth": pt(0.5), "capsize": 0, "markersize": pt(_MARKER)}
    label = "curvature [µm/mm²]"
    artists = triggers.draw_over_cycle(ax, film, label, values, std, circles, line, **look)
    style.legend_above(ax)
    return artists


@styled
def pin_figure(film: xr.Dataset, *, figure: AnyFigure | None = None) -> AnyFigure:
    """Combine the orbit of the pin, the closest film and the curvature of the gap.

    Arguments as in `erlif.plots`.

    Returns
    -------
    Figure
        Three panels below each other, in one column of a journal.

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> len(pin_figure(example_film()).axes)
    3
    """
    figure = style.new_figure(ONE_COLUMN, _TALL * ONE_COLUMN, given=figure, named=film)
    panels = style.rows_or_columns(figure, 3)
    style.draw_panels(panels, (pin_orbit, closest_film, gap_curvature), film)
    style.legend_of_figure(figure)
    return figure


def _require_position(film: xr.Dataset) -> None:
    if not has_position(film):
        raise ConfigError(
            "Expected a film with the position of the pin at two triggers or more; this one has "
            "none. Give [joint] in run.toml and process the run again."
        )


def _displacements(film: xr.Dataset) -> tuple[Array, Array, Mask]:
    """Displacement towards the load and sideways, and where both are known. [um]"""
    _require_position(film)
    load, side = film.pin_displacement.values.T
    return load, side, np.isfinite(load) & np.isfinite(side)


def _draw_points(ax: Axes, film: xr.Dataset, x: Array, y: Array, known: Mask) -> list[Artist]:
    """Draw the triggers, small enough to lie side by side."""
    return triggers.draw_strokes(ax, film, x, y, which=known, markersize=pt(_MARKER), zorder=3)


def _around(values: Array, *, least: float = _LEAST_SPAN) -> tuple[float, float]:
    """Limits of an axis with room about its values, which take `least` of it at least."""
    middle = float(values.min() + values.max()) / 2
    half = (0.5 + _ROOM) * max(float(np.ptp(values)), least)
    return middle - half, middle + half


def _ellipse(x: float, y: float, covariance: Array, **look: Any) -> Ellipse:
    """Ellipse of one standard deviation about a point; the covariance has the order x, y."""
    variance, axes = np.linalg.eigh(covariance)
    minor, major = 2 * np.sqrt(np.maximum(variance, 0.0))
    angle = math.degrees(math.atan2(axes[1, 1], axes[0, 1]))
    return Ellipse((x, y), major, minor, angle=angle, linewidth=pt(0.7), **look)
