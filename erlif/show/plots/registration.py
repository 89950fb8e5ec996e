"""Displacement and drift of camera 2 against camera 1."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.image import AxesImage
from matplotlib.ticker import MaxNLocator

from erlif.show.plots import style
from erlif.show.plots.style import MUTED, OUTWARD, RETURN, TWO_COLUMNS, AnyFigure, pt, styled
from erlif.show.plots.triggers import broken

_LEAST_REACH = 1e-3  # px; a constant displacement still needs a colour scale
# masks whose edges are drawn, with colour and label
_EDGES = {
    "overlap": ("black", "edge of the overlap"),
    "poor": ("#E4002B", "edge of poor registration"),
}
_WIDE = 0.36  # of two columns, for one of two images beside their colour bars
_DRIFT, _AROUND = 1.7, 1.3  # inch for the drift, and for titles and labels
_MARKER, _MANY = 2.4, 100  # point; frame pairs above which the markers are half as large


@style.panel
def displacement_map(
    registration: xr.Dataset, *, component: str, ax: Axes = style.NEW
) -> AxesImage:
    """Draw one component of the displacement of camera 2 against camera 1, less its mean.

    Parameters
    ----------
    registration : xarray.Dataset
        Group ``registration`` of a film.
    component : str
        ``"x"`` or ``"y"``.

    Returns
    -------
    AxesImage
        The displacement less its mean [px]; the title gives the mean.

    Examples
    --------
    >>> from erlif.show.plots import example_registration
    >>> image = displacement_map(example_registration(), component="x")
    >>> image.axes.get_title()
    'mean Δx = +3.00 px'
    """
    field = registration[f"displacement_{component}"].values.astype(float)
    mean = float(np.nanmean(field))

    # white is the mean, so the scale is as long on either side
    limits = style.even_limits(field - mean, within=100, least=_LEAST_REACH)
    image = style.draw_image(ax, field - mean, limits, colours="vik", bad="none")
    style.hatch_missing(ax)
    _outline_masks(ax, registration)
    style.add_colour_bar(image, ax, f"Δ{component} less its mean [px]", extend="neither")
    ax.set_title(f"mean Δ{component} = {mean:+.2f} px".replace("-", "−"))
    ax.set(xlabel="column [px]", ylabel="row [px]")
    return image


def _outline_masks(ax: Axes, registration: xr.Dataset) -> None:
    """Draw the edges of the overlap and of poor registration, where the image holds any."""
    for name, (colour, label) in _EDGES.items():
        if name in registration and 0 < registration[name].values.mean() < 1:
            mask = registration[name].values.astype(float)
            ax.contour(mask, levels=[0.5], colors=colour, linewidths=pt(0.7), linestyles="--")
            style.draw_line(ax, [], [], colour, form="--", label=label)
            style.legend_below(ax)


@style.panel
def drift_of_frames(frames: xr.Dataset, *, ax: Axes = style.NEW) -> list[Artist]:
    """Draw the drift of camera 2 in each frame.

    Parameters
    ----------
    frames : xarray.Dataset
        Group ``frames`` of a film.

    Returns
    -------
    list of Artist
        Drift along x and along y [px].

    Examples
    --------
    >>> from erlif.show.plots import example_frames
    >>> along_x, along_y = drift_of_frames(example_frames())
    >>> along_x.get_label()
    'along x, rms 0.10 px'
    """
    number = frames.frame.values
    # frame pairs that were left out break the line
    stretches = np.split(np.arange(number.size), np.flatnonzero(np.diff(number) > 1) + 1)
    artists: list[Artist] = []
    for name, colour, marker, face in (("x", OUTWARD, "o", OUTWARD), ("y", RETURN, "s", "white")):
        drift = frames[f"drift_{name}"].values
        # without any drift, nanstd would warn
        spread = float(np.nanstd(drift)) if np.isfinite(drift).any() else np.nan
        look: dict[str, Any] = {"marker": marker, "markerfacecolor": face, "width": 0.5}
        look |= {
            "size": _MARKER if number.size <= _MANY else _MARKER / 2,
            "label": f"along {name}, rms {spread:.2f} px",
        }
        x, y = broken(stretches, number), broken(stretches, drift)
        artists += style.draw_line(ax, x, y, colour, **look)

    ax.axhline(0, color=MUTED, linewidth=pt(0.4), zorder=1)
    ax.xaxis.set_major_locator(MaxNLocator(integer=True))
    labels = "number of the frame pair [1]", "drift of camera 2 [px]"
    ax.set(xlabel=labels[0], ylabel=labels[1], xmargin=0.01)
    style.legend_below(ax)
    return artists


@styled
def registration_figure(
    registration: xr.Dataset,
    frames: xr.Dataset,
    *,
    film: xr.Dataset | None = None,
    figure: AnyFigure | None = None,
) -> AnyFigure:
    """Draw both components of the displacement, and the drift of each frame below.

    Parameters
    ----------
    registration, frames : xarray.Dataset
        Groups of a film.
    film : xarray.Dataset, optional
        The film, whose run is then named above the figure.

    Returns
    -------
    Figure
        Two maps above one panel over both columns.

    Examples
    --------
    >>> from erlif.show.plots import example_frames, example_registration
    >>> figure = registration_figure(example_registration(), example_frames())
    >>> len(figure.axes)
    3
    """
    height, width = registration.displacement_x.shape
    tall = _WIDE * TWO_COLUMNS * height / width
    whole = tall + _DRIFT + _AROUND
    figure = style.new_figure(TWO_COLUMNS, whole, given=figure, text=_AROUND, named=film)
    panels = figure.subplot_mosaic("xy;dd", height_ratios=(tall, _DRIFT))
    for component in "xy":
        displacement_map(registration, component=component, ax=panels[component])
    drift_of_frames(frames, ax=panels["d"])

    quality = float(registration.attrs["registration_quality"])
    model = registration.attrs["registration_model"]
    panels["d"].set_title(f"correlation of the aligned textures {quality:.3f}; model: {model}")
    style.letter_panels(*(panels[name] for name in "xyd"))
    return figure
