"""Maps of film thickness and profiles through them."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap, to_rgba
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from erlif.core.arrays import Array, FlagImage
from erlif.core.flags import Flag
from erlif.files import check_trigger, describe_trigger, region_of, settings_of
from erlif.plots.style import (
    COVERAGE,
    FLAG_COLOURS,
    ONE_COLUMN,
    OUTWARD,
    RETURN,
    TWO_COLUMNS,
    add_colour_bar,
    colour_map,
    given_or_new,
    letter,
    new_figure,
    styled,
)
from erlif.trend import average_across_sliding, rigid_gap

Limits = tuple[float, float]

_SHEET_COLUMNS = 10
_SHEET_MOST = 60  # maps on one sheet; with more triggers, evenly chosen ones are shown


def common_limits(film: xr.Dataset, triggers: Iterable[int] | None = None) -> Limits:
    """Thickness that all but the 0.5 % thinnest and thickest pixels keep within. [um]"""
    chosen = range(film.sizes["trigger"]) if triggers is None else triggers
    samples = [film.thickness.isel(trigger=k).values[::3, ::3].ravel() for k in chosen]
    values = np.concatenate(samples)
    values = values[np.isfinite(values)]
    if values.size == 0:
        return 0.0, 1.0
    low, high = np.percentile(values, [0.5, 99.5])
    return float(low), float(max(high, low + 1e-3))


def pixel_edges(film: xr.Dataset) -> tuple[float, float, float, float]:
    """Left, right, bottom and top edge of the image in mm; y runs down."""
    x, y = film.x.values, film.y.values
    dx = float(x[1] - x[0]) / 2
    dy = float(y[1] - y[0]) / 2
    return float(x[0]) - dx, float(x[-1]) + dx, float(y[-1]) + dy, float(y[0]) - dy


def image_height(film: xr.Dataset, width: float) -> float:
    """Height of the joint's image at a width, both in inches."""
    left, right, bottom, top = pixel_edges(film)
    return width * (bottom - top) / (right - left)


def label_position(ax: Axes, film: xr.Dataset) -> None:
    """Name the axes of an image of the joint."""
    along = settings_of(film).optics.x_axis
    ax.set_xlabel("x (sliding) [mm]" if along == "sliding" else "x (axial) [mm]")
    ax.set_ylabel("y (axial) [mm]" if along == "sliding" else "y (sliding) [mm]")


def bare_image(ax: Axes) -> None:
    """A full frame about an image, as its edge is data."""
    for side in ("top", "right"):
        ax.spines[side].set_visible(True)


@styled
def thickness_map(
    film: xr.Dataset,
    *,
    trigger: int,
    ax: Axes | None = None,
    limits: Limits | None = None,
    region: bool = True,
) -> AxesImage:
    """Draw film thickness at one trigger, with the pixels that do not answer in the colour of their reason.

    Parameters
    ----------
    film : xarray.Dataset
        As `erlif.process` returns it.
    trigger : int
    ax : Axes, optional
    limits : (float, float), optional
        Ends of the colour scale [um]; default: those all but 1 % of this map keep within.
    region : bool
        Outline the region of interest.

    Returns
    -------
    AxesImage

    Raises
    ------
    ErlifError
        If there is no such trigger.
    """
    check_trigger(film, trigger)
    ax = given_or_new(ax, height=image_height(film, 0.75 * ONE_COLUMN) + 0.65)
    low, high = limits or common_limits(film, [trigger])
    image = ax.imshow(
        film.thickness.isel(trigger=trigger).values,
        cmap=colour_map("batlow"),
        vmin=low,
        vmax=high,
        extent=pixel_edges(film),
        interpolation="none",
    )
    legend = _draw_flags(ax, film.flags.isel(trigger=trigger).values, film)
    add_colour_bar(image, ax, "film thickness [µm]")
    if region:
        outline = _outline_region(ax, film)
        legend.append(outline)
    if legend:
        ax.legend(
            handles=legend,
            loc="upper center",
            bbox_to_anchor=(0.5, -0.17),
            ncols=2,
            handlelength=1.8,
            handleheight=1.0,
            columnspacing=1.2,
            labelspacing=0.35,
        )
    label_position(ax, film)
    bare_image(ax)
    ax.set_title(describe_trigger(film, trigger))
    return image


def first_reason(flags: FlagImage) -> FlagImage:
    """Number the reason that is shown for each pixel: 0 valid, 1 the first of FLAG_COLOURS, and so on."""
    shown = np.zeros(flags.shape, np.uint8)
    for n, flag in reversed(list(enumerate(FLAG_COLOURS, 1))):
        shown[(flags & int(flag)) != 0] = n
    return shown


def flag_title(flag: Flag) -> str:
    """Name of a flag as a reader sees it."""
    return str(flag.name).lower().replace("_", " ")


def _draw_flags(ax: Axes, flags: FlagImage, film: xr.Dataset) -> list[Artist]:
    shown = first_reason(flags)
    palette = ListedColormap(["none", *FLAG_COLOURS.values()])
    ax.imshow(
        shown,
        cmap=palette,
        vmin=-0.5,
        vmax=len(FLAG_COLOURS) + 0.5,
        extent=pixel_edges(film),
        interpolation="none",
    )
    return [
        Patch(
            facecolor=colour,
            edgecolor="#404040",
            linewidth=0.4,
            label=f"{flag_title(flag)}, {100 * share:.2f} %",
        )
        for n, (flag, colour) in enumerate(FLAG_COLOURS.items(), 1)
        if (share := float((shown == n).mean())) > 0
    ]


def _outline_region(ax: Axes, film: xr.Dataset) -> Line2D:
    """Outline the region of interest, black on white so that it shows on every colour; returns its key."""
    region = region_of(film)
    x = [region.x[0], region.x[1], region.x[1], region.x[0], region.x[0]]
    y = [region.y[0], region.y[0], region.y[1], region.y[1], region.y[0]]
    ax.plot(x, y, color="white", linewidth=1.1, scalex=False, scaley=False)
    (dashes,) = ax.plot(
        x,
        y,
        color="black",
        linewidth=1.1,
        linestyle=(0, (4, 3)),
        scalex=False,
        scaley=False,
        label="region of interest",
    )
    return dashes


@styled
def sliding_profile(film: xr.Dataset, *, trigger: int, ax: Axes | None = None) -> list[Artist]:
    """Draw the film along sliding, averaged over the region's axial extent, and the gap of rigid bodies for comparison.

    The dark band holds 95 % of the random error, the dashed lines that of the error that all pixels share.

    Parameters
    ----------
    film : xarray.Dataset
        As `erlif.process` returns it.
    trigger : int
    ax : Axes, optional

    Returns
    -------
    list of Artist
        Profile, random band, upper and lower limit of the shared error; the rigid gap where it could be fitted.

    Raises
    ------
    ErlifError
        If there is no such trigger.
    """
    ax = given_or_new(ax)
    profile = average_across_sliding(film, trigger=trigger)
    x, h = profile.position.values, profile.thickness.values
    artists = _draw_profile(ax, profile, np.zeros_like(x))
    gap = rigid_gap(profile, film)
    if gap is not None:
        artists += ax.plot(x, gap.thickness(x), color=RETURN, linewidth=1.0, label="rigid gap")
        words = (
            f"curvature {gap.curvature:.4f} ± {gap.curvature_std:.4f} µm/mm²\n"
            f"rigid gap: {1 / gap.radius:.4f} µm/mm²\nits least {gap.least:.2f} µm (mean over y)"
        )
        ax.annotate(
            words, (0.5, 0.03), xycoords="axes fraction", ha="center", va="bottom", fontsize=6.5
        )
    if np.isfinite(h).any():
        # room below the curve for the words on curvature, and no more of the rigid gap than was measured
        low, high = float(np.nanmin(h)), float(np.nanmax(h))
        ax.set_ylim(low - 0.42 * (high - low), high + 0.08 * (high - low))
    ax.set_ylabel("film thickness [µm]")
    ax.legend(loc="upper center")
    return artists


@styled
def profile_residual(film: xr.Dataset, *, trigger: int, ax: Axes | None = None) -> list[Artist]:
    """Draw what the gap of rigid bodies leaves of the profile along sliding; as in `sliding_profile` otherwise."""
    ax = given_or_new(ax)
    profile = average_across_sliding(film, trigger=trigger)
    gap = rigid_gap(profile, film)
    x = profile.position.values
    artists = _draw_profile(ax, profile, np.zeros_like(x) if gap is None else gap.thickness(x))
    artists.append(ax.axhline(0, color=RETURN, linewidth=0.8))
    ax.set_ylabel("minus rigid gap [µm]")
    return artists


def _draw_profile(ax: Axes, profile: xr.Dataset, base: Array) -> list[Artist]:
    """Profile less `base`, with its random band and the limits of its shared error."""
    x, h = profile.position.values, profile.thickness.values - base
    random, shared = (
        COVERAGE * profile.thickness_std.values,
        COVERAGE * profile.thickness_std_shared.values,
    )
    (line,) = ax.plot(x, h, color=OUTWARD, linewidth=0.7, label="measured")
    band = ax.fill_between(
        x, h - random, h + random, color=OUTWARD, alpha=0.3, linewidth=0, label="random, 95 %"
    )
    look: dict[str, Any] = {"color": "black", "linewidth": 0.6, "linestyle": (0, (2, 1.5))}
    centre = np.where(np.isfinite(h), 0.0, np.nan) if base.any() else h
    (above,) = ax.plot(x, centre + shared, label="shared, 95 %", **look)
    (below,) = ax.plot(x, centre - shared, **look)
    ax.set_xlabel(str(profile.position.attrs["long_name"]).replace(", sliding", " (sliding) [mm]"))
    ax.set_xlim(float(x[0]), float(x[-1]))
    return [line, band, above, below]


@styled
def thickness_figure(film: xr.Dataset, *, trigger: int) -> Figure:
    """Map of film thickness at one trigger and the profile through it, two columns wide."""
    figure = new_figure(TWO_COLUMNS, image_height(film, 0.43 * TWO_COLUMNS) + 1.05)
    panels = figure.subplot_mosaic("mp;mr", width_ratios=(1.25, 1), height_ratios=(2.2, 1))
    thickness_map(film, trigger=trigger, ax=panels["m"])
    sliding_profile(film, trigger=trigger, ax=panels["p"])
    profile_residual(film, trigger=trigger, ax=panels["r"])
    panels["p"].set_xlabel("")
    panels["p"].tick_params(labelbottom=False)
    below_map = panels["m"].get_legend()
    if below_map is not None:
        handles = below_map.legend_handles
        below_map.remove()
        figure.legend(
            handles=handles, loc="outside lower center", ncols=4, handlelength=1.8, handleheight=1.0
        )
    panels["m"].set_title("")
    figure.suptitle(describe_trigger(film, trigger))
    for name, text in (("m", "a"), ("p", "b"), ("r", "c")):
        letter(panels[name], text)
    return figure


@styled
def map_sheet_figure(film: xr.Dataset) -> Figure:
    """All maps of a cycle on one sheet with one colour scale, outward stroke above, return stroke below.

    Where a cycle has more than sixty triggers, sixty evenly chosen ones are shown.
    """
    count = film.sizes["trigger"]
    chosen = np.unique(np.linspace(0, count - 1, min(count, _SHEET_MOST)).round().astype(int))
    strokes = film.stroke.values[chosen]
    groups = [(name, chosen[strokes == sign]) for name, sign in (("outward", 1), ("return", -1))]
    groups = [(name, members) for name, members in groups if members.size]
    columns = _best_columns([members.size for _, members in groups])
    rows = [math.ceil(members.size / columns) for _, members in groups]
    left, right, bottom, top = pixel_edges(film)
    cell = (TWO_COLUMNS - 0.75) / columns
    height = cell * (bottom - top) / (right - left) + 0.17
    figure = new_figure(TWO_COLUMNS, sum(rows) * height + 0.2)
    panels = figure.subplots(sum(rows), columns, squeeze=False)
    limits = common_limits(film, chosen.tolist()[:: max(1, chosen.size // 12)])
    every = max(1, film.sizes["x"] // 240)
    first = 0
    for (name, members), count_rows in zip(groups, rows, strict=True):
        grid = panels[first : first + count_rows]
        first += count_rows
        for ax, trigger in zip(grid.ravel().tolist(), members.tolist(), strict=False):
            one = film.isel(trigger=trigger)
            image = ax.imshow(
                one.thickness.values[::every, ::every],
                cmap=colour_map("batlow", bad="#D9D9D9"),
                vmin=limits[0],
                vmax=limits[1],
                extent=pixel_edges(film),
            )
            ax.set_title(f"{float(one.encoder_angle):.2f}°", fontsize=6, pad=1.5)
            ax.set(xticks=[], yticks=[])
            bare_image(ax)
        for ax in grid[:, 0]:
            ax.set_ylabel(name, labelpad=2)
        for ax in grid.ravel()[members.size :]:
            ax.set_axis_off()
    figure.colorbar(
        image,
        ax=panels,
        label="film thickness [µm]; grey: no answer",
        extend="both",
        aspect=40,
        shrink=0.9,
        pad=0.01,
    )
    figure.supxlabel(
        f"encoder angle above each map; each map {right - left:.1f} mm × {bottom - top:.1f} mm, x to the right, y down",
        fontsize=6.5,
    )
    return figure


def _best_columns(sizes: list[int]) -> int:
    """Columns that leave the fewest gaps where every group starts a new row."""
    most = min(_SHEET_COLUMNS, max(sizes))
    fewest = min(7, most)
    return min(
        range(most, fewest - 1, -1), key=lambda columns: sum(-size % columns for size in sizes)
    )


def flag_swatch(flag: Flag) -> str:
    """Colour of a flag as a web page writes it."""
    red, green, blue, _ = (round(255 * part) for part in to_rgba(FLAG_COLOURS[flag]))
    return f"#{red:02x}{green:02x}{blue:02x}"
