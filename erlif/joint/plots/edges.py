"""Pressure at the edges of a bearing: its map, its profile along the axis, the stress below."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection, QuadMesh
from matplotlib.lines import Line2D
from matplotlib.patches import StepPatch

from erlif.core.arrays import Array
from erlif.show.plots import style
from erlif.show.plots.style import MEAN, MINIMUM, MUTED, OUTWARD, RETURN, Curve, pt

_MEGA, _MILLI = 1e-6, 1e3

_COLOURS = (RETURN, OUTWARD, MEAN, MINIMUM)

_REST = 1e-3  # of the largest pressure, below which a cell counts as free
_LOW = 0.02  # of the largest stress, below which the ends of a section are left out


@style.panel
def contact_pressure_map(found: xr.Dataset, *, ax: Axes = style.NEW) -> QuadMesh:
    """Draw the pressure of a contact over its surface.

    Parameters
    ----------
    found : xarray.Dataset
        As `erlif.joint.models.solve_contact` or `erlif.joint.models.solve_joint` return it.

    Returns
    -------
    QuadMesh
        One patch for each cell; white where there is no contact.

    Examples
    --------
    >>> from erlif.joint.models import solve_contact
    >>> x = (np.arange(24) - 11.5) * 0.1
    >>> contact = solve_contact(
    ...     (x[:, None] ** 2 + x**2) / 2, spacing=0.1, contact_modulus=1e9, load=1e9
    ... )
    >>> contact_pressure_map(contact).axes.get_xlabel()
    'axial place z [mm]'
    """
    across = "angle" if "angle" in found.dims else "x"
    pressure = found.pressure.transpose(across, "z").values * _MEGA
    place = np.degrees(found[across].values) if across == "angle" else found.x.values * _MILLI
    lines, shown = _axial_lines(found) * _MILLI, np.where(pressure > 0, pressure, np.nan)
    colours = style.colour_map("lajolla")
    mesh = ax.pcolormesh(lines, _lines(place), shown, cmap=colours, vmin=0.0)
    touching = place[(pressure > _REST * pressure.max()).any(axis=1)]
    reach = min(1.3 * np.abs(touching).max(initial=0.0) or np.inf, np.abs(place).max())
    ax.set_ylim(-reach, reach)
    (loaded,) = np.nonzero((pressure > 0).any(axis=0))
    if loaded.size:
        first, last = lines[loaded[0]], lines[loaded[-1] + 1]
        margin = 0.1 * (last - first)
        ax.set_xlim(max(first - margin, lines[0]), min(last + margin, lines[-1]))
    label = "angle from the load [°]" if across == "angle" else "across x [mm]"
    ax.set(xlabel="axial place z [mm]", ylabel=label)
    style.add_colour_bar(mesh, ax, "pressure [MPa]", extend="neither")
    return mesh


@style.panel
def axial_pressure(
    contacts: Mapping[str, xr.Dataset], *, hertz: float | None = None, ax: Axes = style.NEW
) -> list[StepPatch | Line2D]:
    """Draw the largest pressure round or across the contact along the axis, from cell to cell.

    Parameters
    ----------
    contacts : mapping of str to xarray.Dataset
        Contacts by their names in the legend, as `erlif.joint.models.solve_contact` or
        `erlif.joint.models.solve_joint` return them.
    hertz : float, optional
        Pressure of Hertz's line contact, drawn as a line. [Pa]

    Returns
    -------
    list of StepPatch and Line2D
        The contacts in their order, then Hertz.

    Examples
    --------
    >>> from erlif.joint.models import solve_contact
    >>> x, z = (np.arange(16) - 7.5) * 1e-4, (np.arange(32) - 15.5) * 1e-3
    >>> roller = solve_contact(
    ...     x[:, None] ** 2 / 0.1 + 0 * z, spacing=(1e-4, 1e-3), contact_modulus=1e11, load=1e4
    ... )
    >>> steps, line = axial_pressure({"straight": roller}, hertz=5e8)
    >>> line.get_label()
    "Hertz's line contact"
    """
    artists: list[StepPatch | Line2D] = []
    for k, (label, contact) in enumerate(contacts.items()):
        across = "angle" if "angle" in contact.dims else "x"
        line = contact.pressure.max(across).values * _MEGA
        look: dict[str, Any] = {"color": _COLOURS[k % len(_COLOURS)], "linewidth": pt(1.0)}
        sides = _axial_lines(contact) * _MILLI
        artists.append(ax.stairs(line, sides, baseline=None, label=label, **look))
    if hertz is not None:
        level = ax.axhline(hertz * _MEGA, color=MUTED, linestyle="--", label="Hertz's line contact")
        artists.append(level)
    style.draw_curves(ax, (), "axial place z [mm]", "pressure [MPa]", ylim=(0.0, None))
    return artists


@style.panel
def stress_section(stress: xr.Dataset, *, ax: Axes = style.NEW) -> PolyCollection:
    """Draw the von Mises stress in the plane of the load.

    Parameters
    ----------
    stress : xarray.Dataset
        As `erlif.joint.models.section_stress` or `erlif.joint.models.subsurface_stress` return it;
        of the latter the section along the axis through the largest stress.

    Returns
    -------
    PolyCollection
        One patch for each element or cell, where the stress is not small; a cross marks the
        largest.

    Examples
    --------
    >>> from erlif.joint.models import solve_contact, subsurface_stress
    >>> x = (np.arange(24) - 11.5) * 0.1
    >>> contact = solve_contact(
    ...     (x[:, None] ** 2 + x**2) / 2, spacing=0.1, contact_modulus=1e9, load=1e9
    ... )
    >>> stress = subsurface_stress(contact, depth=[0.2, 0.4, 0.6, 0.8])
    >>> stress_section(stress).axes.get_ylabel()
    'depth [mm]'
    """
    section = "point" in stress.dims
    if section:
        place, width = stress.z.values * _MILLI, stress.width_z.values * _MILLI
        height, depth = stress.r.values * _MILLI, stress.width_r.values * _MILLI
        values = stress.von_mises.values * _MEGA
    else:
        cut = stress.von_mises.sel(x=float(stress.peak_x)).transpose("depth", "z")
        sides = [_lines(stress[name].values * _MILLI) for name in ("z", "depth")]
        (place, height), (width, depth) = (
            (part.ravel() for part in np.meshgrid(*parts))
            for parts in ([(s[1:] + s[:-1]) / 2 for s in sides], [np.diff(s) for s in sides])
        )
        values = cut.values.ravel() * _MEGA

    corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) / 2
    middle, size = (np.stack(pair, axis=-1)[:, None] for pair in ((place, height), (width, depth)))
    boxes = middle + corners * size
    colours = style.colour_map("batlow")
    patches = PolyCollection(list(boxes), cmap=colours, edgecolors="face", linewidths=pt(0.1))
    patches.set_array(values)
    patches.set_clim(0.0, float(values.max()))
    ax.add_collection(patches)

    top = float(stress.peak_r if section else stress.peak_depth) * _MILLI
    cross: dict[str, Any] = {"form": "x", "markeredgewidth": pt(1.2), "size": 5.0, "clip_on": False}
    style.draw_line(ax, float(stress.peak_z) * _MILLI, top, "white", **cross)
    stressed = boxes[values > _LOW * values.max()]
    ax.set(xlim=(stressed[..., 0].min(), stressed[..., 0].max()))
    ax.set(ylim=(boxes[..., 1].max(), boxes[..., 1].min()))
    ax.set(xlabel="axial place z [mm]", ylabel="radius r [mm]" if section else "depth [mm]")
    style.add_colour_bar(patches, ax, "von Mises [MPa]", extend="neither")
    return patches


@style.panel
def undercut_pressure(found: xr.Dataset, *, ax: Axes = style.NEW) -> list[Line2D]:
    """Draw the pressure against the thickness of the lip, for each depth of the undercut.

    Parameters
    ----------
    found : xarray.Dataset
        As `erlif.joint.models.search_undercut` returns it.

    Returns
    -------
    list of Line2D
        One line for each depth, at the best width, and a circle about the best undercut.

    Examples
    --------
    >>> lips = [0.005, 0.007, 0.009]
    >>> found = xr.Dataset(
    ...     {"patch_pressure": (("depth", "width", "lip"), [[[4e8, 3e8, 3.5e8]]],
    ...                         {"patch": 1e-3}),
    ...      "best_depth": 0.02, "best_width": 0.008, "best_lip": 0.007},
    ...     {"depth": [0.02], "width": [0.008], "lip": lips},
    ... )
    >>> line, best = undercut_pressure(found)
    >>> line.get_label()
    '20'
    """
    chosen = found.patch_pressure.sel(width=float(found.best_width))
    colours = style.colour_map("batlow")(np.linspace(0.05, 0.8, found.sizes["depth"]))
    look: dict[str, Any] = {"form": "o-", "size": 2.5}
    curves = [
        Curve(found.lip * _MILLI, line * _MEGA, colour, f"{float(line.depth) * _MILLI:g}", look)
        for colour, line in zip(colours, chosen.transpose("depth", "lip"), strict=True)
    ]
    best = chosen.sel(depth=float(found.best_depth), lip=float(found.best_lip))
    look = {"form": "o", "size": 7.0, "markerfacecolor": "none"}
    curves.append(Curve(found.best_lip * _MILLI, best * _MEGA, MINIMUM, None, look))
    patch = float(found.patch_pressure.attrs["patch"]) * _MILLI
    labels = "lip D3 [mm]", f"largest mean over {patch:g} mm [MPa]"
    lines = style.draw_curves(ax, curves, *labels)
    style.legend_above(ax, title="depth D1 [mm]")
    return lines


def _lines(middles: Array) -> Array:
    """Sides of cells about their middles, equal ones at both ends."""
    between = (middles[1:] + middles[:-1]) / 2
    first, last = 2 * middles[0] - between[0], 2 * middles[-1] - between[-1]
    return np.concatenate([[first], between, [last]])


def _axial_lines(found: xr.Dataset) -> Array:
    """Sides of the axial cells, which may be of any length."""
    middles = found.z.values
    if "cell_length" not in found:
        return _lines(middles)
    half = found.cell_length.values / 2
    return np.concatenate([middles - half, [middles[-1] + half[-1]]])
