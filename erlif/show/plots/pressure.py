"""The pressure that carries the joint: its map, its profile along sliding, and its load."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.container import Container
from matplotlib.image import AxesImage

from erlif.core.errors import ConfigError
from erlif.io.files import check_trigger, describe_trigger
from erlif.show.plots import style
from erlif.show.plots.maps import figure_of_maps, joint_image
from erlif.show.plots.style import MEAN, MUTED, AnyFigure, pt, styled
from erlif.show.plots.triggers import draw_over_cycle

_THIRD = 0.3  # of two columns, for each of three panels
_AROUND = 1.05  # inch above and below the map
_LEAST_HEIGHT = 2.2  # inch
_PEAK = {"x": "peak_place", "y": "peak_pressure"}


@style.film_panel
def pressure_map(found: xr.Dataset, *, trigger: int, ax: Axes = style.NEW) -> AxesImage:
    """Draw the pressure over the image at one trigger.

    Parameters
    ----------
    found : xarray.Dataset
        From `erlif.pressure_from_film`.

    Returns
    -------
    AxesImage
        Grey where the pressure is not known.

    Examples
    --------
    >>> from erlif.show.plots import example_pressure
    >>> image = pressure_map(example_pressure(), trigger=0)
    >>> image.axes.get_title()
    'trigger 0'
    """
    check_trigger(found, trigger)
    image = joint_image(ax, found, found.pressure.isel(trigger=trigger).values, (None, None))
    # nodes lie on the first and last pixel: their outer halves are beyond the image
    x, y = found.x.values, found.y.values
    ax.set(xlim=(x[0], x[-1]), ylim=(y[-1], y[0]))
    ax.set_title(f"trigger {trigger}")
    style.add_colour_bar(image, ax, "pressure [kPa]", extend="neither")
    return image


@style.film_panel
def pressure_profile(
    found: xr.Dataset, *, trigger: int, ax: Axes = style.NEW
) -> list[Artist | Container]:
    """Draw the pressure along sliding in the axial middle of the image, with its band of one s.d.

    Arguments as in `pressure_map`.

    Returns
    -------
    list of Artist or Container
        The band, the profile, and the peak with bars of one standard deviation.

    Examples
    --------
    >>> from erlif.show.plots import example_pressure
    >>> band, profile, peak = pressure_profile(example_pressure(), trigger=0)
    >>> profile.axes.get_ylabel()
    'pressure [kPa]'
    """
    check_trigger(found, trigger)
    one = found.isel(trigger=trigger)
    place, value = one.place.values, one.pressure_profile.values
    std = one.pressure_profile_std.values
    band = style.draw_band(ax, place, value - std, value + std, MEAN, label=style.ONE_STD)
    (line,) = style.draw_line(ax, place, value, MEAN, width=1.2, label="pressure")

    # a peak at the edge of the image is drawn whole
    look: dict[str, Any] = {"color": "black", "marker": "o", "label": "peak", "clip_on": False}
    look |= {"linewidth": pt(0.8), "markersize": pt(2.5)}
    at, height = (np.atleast_1d(one[name].values) for name in _PEAK.values())
    look |= {f"{axis}err": one[f"{name}_std"].values for axis, name in _PEAK.items()}
    peak = ax.errorbar(at, height, **look)
    ax.set(xlim=(place[0], place[-1]), xlabel="sliding direction [mm]", ylabel="pressure [kPa]")
    style.legend_above(ax)
    return [band, line, peak]


@style.film_panel
def load_balance(found: xr.Dataset, *, ax: Axes = style.NEW) -> list[Artist]:
    """Draw the load that the pressure makes against crank angle, with the logged one.

    Arguments as in `pressure_map`.

    Returns
    -------
    list of Artist or Container
        Points of both strokes with bars of one standard deviation, then the logged load.

    Examples
    --------
    >>> from erlif.show.plots import example_pressure
    >>> load_balance(example_pressure())[-1].get_label()
    'logged'
    """
    names = ("load_from_pressure", "load_from_pressure_std", "joint_load")
    load, std, logged = (found[name].values for name in names)
    line: dict[str, Any] = {"colour": MUTED, "label": "logged", "zorder": 1}
    artists = draw_over_cycle(ax, found, "load of the pressure [N]", load, std, logged, line)
    style.legend_above(ax, title="bars: one standard deviation")
    # zero is shown, and so is every point with its bar
    low, high = ax.get_ylim()
    ax.set_ylim(min(low, 0.0), max(high, 0.0))
    return artists


def best_trigger(found: xr.Dataset) -> int:
    """Find the trigger whose peak is known best. Arguments as in `pressure_map`.

    Returns
    -------
    int
        Its number, counted from 0.

    Raises
    ------
    ConfigError
        If the pressure is known at no trigger.

    Examples
    --------
    >>> found = xr.Dataset({"peak_pressure": ("trigger", [80.0, 90.0]),
    ...                     "peak_pressure_std": ("trigger", [8.0, 3.0])})
    >>> best_trigger(found)
    1
    """
    share = (found.peak_pressure_std / found.peak_pressure).values
    if not np.isfinite(share).any():
        raise ConfigError(
            "Expected a pressure to draw; it is known at no trigger. "
            f"{found.attrs.get('statement', '')} Record more triggers per cycle, or more light."
        )
    return int(np.nanargmin(share))


@styled
def pressure_figure(
    found: xr.Dataset, *, trigger: int | None = None, figure: AnyFigure | None = None
) -> AnyFigure:
    """Draw map and profile of the pressure at one trigger, and the balance of the load at all.

    Arguments that are not listed are those of `pressure_map`.

    Parameters
    ----------
    trigger : int, optional
        Default: that of `best_trigger`.

    Returns
    -------
    Figure
        Three panels over two columns: map, profile, loads.

    Raises
    ------
    ErlifError
        As `best_trigger` and `pressure_map`.

    Examples
    --------
    >>> from erlif.show.plots import example_pressure
    >>> figure = pressure_figure(example_pressure())
    >>> len(figure.axes)
    3
    """
    chosen = best_trigger(found) if trigger is None else trigger
    sizes = {"width": _THIRD, "around": _AROUND, "least": _LEAST_HEIGHT}
    more = describe_trigger(found, chosen)
    figure = figure_of_maps(figure, found, more=more, **sizes)
    panels = figure.subplots(1, 3)
    pressure_map(found, trigger=chosen, ax=panels[0])
    pressure_profile(found, trigger=chosen, ax=panels[1])
    load_balance(found, ax=panels[2])
    style.letter_panels(*panels)
    return figure


def write_pressure_figure(found: xr.Dataset, path: Path) -> Path:
    """Write the figure of a pressure; parameters as for `pressure_figure` and `save_figure`.

    Arguments that are not listed are those of `pressure_map`.

    Parameters
    ----------
    path : Path
        PNG, PDF or SVG, by its suffix.

    Returns
    -------
    Path
        That of the figure, as it was given.

    Raises
    ------
    ErlifError
        If the pressure is known at no trigger, or the file cannot be written.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> from erlif.show.plots import example_pressure
    >>> with TemporaryDirectory() as directory:
    ...     path = write_pressure_figure(example_pressure(), Path(directory) / "pressure.png")
    ...     path.stat().st_size > 10_000
    True
    """
    with style.in_style(None):
        return style.save_figure(pressure_figure(found), path)
