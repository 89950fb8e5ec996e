"""How camera 2 lies over camera 1."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.image import AxesImage

from erlif.plots.maps import bare_image
from erlif.plots.style import (
    MUTED,
    OUTWARD,
    RETURN,
    TWO_COLUMNS,
    add_colour_bar,
    colour_map,
    given_or_new,
    letter,
    new_figure,
    signed,
    styled,
)


@styled
def displacement_map(
    registration: xr.Dataset, *, component: str, ax: Axes | None = None
) -> AxesImage:
    """Draw one component of the displacement of camera 2 against camera 1, less its mean, which the title gives.

    Parameters
    ----------
    registration : xarray.Dataset
        Group ``registration`` of a film.
    component : str
        ``"x"`` or ``"y"``.
    ax : Axes, optional

    Returns
    -------
    AxesImage
    """
    ax = given_or_new(ax)
    field = registration[f"displacement_{component}"].values.astype(float)
    mean = float(np.nanmean(field))
    reach = max(float(np.nanmax(np.abs(field - mean))), 1e-3)
    image = ax.imshow(
        field - mean,
        cmap=colour_map("vik", bad="#D9D9D9"),
        vmin=-reach,
        vmax=reach,
        interpolation="none",
    )
    _outline_overlap(ax, registration)
    add_colour_bar(image, ax, f"Δ{component} less its mean [px]", extend="neither")
    ax.set_title(f"mean Δ{component} = {signed(mean)} px")
    ax.set(xlabel="column [px]", ylabel="row [px]")
    bare_image(ax)
    return image


def _outline_overlap(ax: Axes, registration: xr.Dataset) -> None:
    """Dashed edge of what camera 2 sees too."""
    for name, colour in (("overlap", "black"), ("poor", "#E4002B")):
        if name in registration and 0 < registration[name].values.mean() < 1:
            ax.contour(
                registration[name].values.astype(float),
                levels=[0.5],
                colors=colour,
                linewidths=0.7,
                linestyles="--",
            )


@styled
def drift_of_frames(frames: xr.Dataset, *, ax: Axes | None = None) -> list[Artist]:
    """Draw the drift of camera 2 in each frame.

    Parameters
    ----------
    frames : xarray.Dataset
        Group ``frames`` of a film.
    ax : Axes, optional

    Returns
    -------
    list of Artist
        Drift along x and along y.
    """
    ax = given_or_new(ax)
    number = frames.frame.values
    artists: list[Artist] = []
    for name, colour, marker, face in (("x", OUTWARD, "o", OUTWARD), ("y", RETURN, "s", "white")):
        drift = frames[f"drift_{name}"].values
        spread = float(np.nanstd(drift)) if np.isfinite(drift).any() else np.nan
        artists += ax.plot(
            number,
            drift,
            color=colour,
            marker=marker,
            markerfacecolor=face,
            linewidth=0.5,
            markersize=2.4,
            label=f"along {name}, rms {spread:.2f} px",
        )
    ax.axhline(0, color=MUTED, linewidth=0.4, zorder=1)
    ax.set_xlabel("frame")
    ax.set_ylabel("drift of camera 2 [px]")
    ax.margins(x=0.01)
    low, high = ax.get_ylim()
    ax.set_ylim(low, high + 0.22 * (high - low))  # room for the legend
    ax.legend(loc="upper right", ncols=2)
    return artists


@styled
def registration_figure(registration: xr.Dataset, frames: xr.Dataset) -> Figure:
    """Displacement field above and drift per frame below, two columns wide."""
    height, width = registration.displacement_x.shape
    tall = 0.36 * TWO_COLUMNS * height / width
    figure = new_figure(TWO_COLUMNS, tall + 2.3)
    panels = figure.subplot_mosaic("xy;dd", height_ratios=(tall, 1.5))
    displacement_map(registration, component="x", ax=panels["x"])
    displacement_map(registration, component="y", ax=panels["y"])
    drift_of_frames(frames, ax=panels["d"])
    quality = float(registration.attrs["registration_quality"])
    panels["d"].set_title(
        f"correlation of the aligned textures {quality:.3f}; {registration.attrs['registration_model']}"
    )
    for name, text in (("x", "a"), ("y", "b"), ("d", "c")):
        letter(panels[name], text)
    return figure
