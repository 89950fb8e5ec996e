"""The slider-crank with a worn joint: its force, the wear round it, and the extrapolation."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import cycle
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from erlif.show.plots import style
from erlif.show.plots.style import MEAN, MINIMUM, MUTED, OUTWARD, RETURN, Curve

_DASHES = ("-", "--", "-.", ":", (0, (5, 1)))
_LOOKS = tuple(zip((MINIMUM, OUTWARD, RETURN, MEAN, MUTED), _DASHES, strict=True))

_PROFILES = 4  # in a figure of wear, evenly over the cycles and with the last


@style.panel
def joint_force(simulations: Mapping[str, xr.Dataset], *, ax: Axes = style.NEW) -> list[Line2D]:
    """Draw the force in the crank-pin joint over the crank angle, one line for each simulation.

    Mukras et al. (2008), figures 6 and 8. Arguments that are not listed are those of `erlif.plots`.

    Parameters
    ----------
    simulations : mapping of str to xarray.Dataset
        Names and results of `erlif.joint.models.slider_dynamics.simulate_slider_crank`.

    Returns
    -------
    list of Line2D
        In the order of the simulations.

    Examples
    --------
    >>> one = xr.Dataset({"crank_angle": ("time", [0.0, 3.0]), "force": ("time", [5.0, 6.0])})
    >>> (line,) = joint_force({"perfect": one})
    >>> line.axes.get_ylabel()
    'joint force [N]'
    """
    looks = zip(simulations.items(), cycle(_LOOKS), strict=False)
    curves = [
        Curve(np.degrees(one.crank_angle), one.force, colour, name, {"form": dashes, "width": 0.9})
        for (name, one), (colour, dashes) in looks
    ]
    limits = {"ylim": (0, None), "xmargin": 0}
    return style.draw_curves(ax, curves, "crank angle [°]", "joint force [N]", **limits)


@style.panel
def joint_wear(worn: xr.Dataset, *, ax: Axes = style.NEW) -> list[Line2D]:
    """Draw the worn depth round the bushing after several numbers of cycles, and that of the pin.

    Mukras et al. (2008), figures 13b and 14b.

    Parameters
    ----------
    worn : xarray.Dataset
        As `erlif.joint.models.slider_wear.wear_slider_crank` returns it.

    Returns
    -------
    list of Line2D
        Profiles of the bushing, then that of the pin at the end where it wears.

    Examples
    --------
    >>> angle, cycle = [-1.0, 0.0, 1.0], [0, 100]
    >>> depth = (("cycle", "angle"), [[0.0, 0.0, 0.0], [0.0, 1e-4, 0.0]])
    >>> data = {"depth": depth, "pin_depth": (("cycle", "angle"), np.zeros((2, 3)))}
    >>> lines = joint_wear(xr.Dataset(data, {"angle": angle, "cycle": cycle}))
    >>> lines[-1].get_label()
    '100 cycles'
    """
    degrees = np.degrees(worn.angle.values)

    # the state before the first cycle is no wear
    last = worn.sizes["cycle"] - 1
    chosen = sorted({round(last * k / _PROFILES) for k in range(1, _PROFILES + 1)} - {0})
    curves = []
    for k, at in enumerate(chosen, 1):
        look = {"form": _DASHES[len(chosen) - k], "alpha": 0.35 + 0.65 * k / len(chosen)}
        name, depth = f"{int(worn.cycle[at]):,} cycles", 1e3 * worn.depth.values[at]
        curves.append(Curve(degrees, depth, OUTWARD, name, look | {"width": 0.9}))

    # a pin that does not wear has no line
    if np.any(worn.pin_depth.values[-1] > 0):
        curves.append(Curve(degrees, 1e3 * worn.pin_depth.values[-1], RETURN, "pin"))
    labels = "place on the bushing, 0 in tension [°]", "worn depth [mm]"
    limits: dict[str, Any] = {"xlim": (-180, 180), "xticks": range(-180, 181, 90)}
    return style.draw_curves(ax, curves, *labels, ylim=(0, None), **limits)


@style.panel
def extrapolation_error(
    found: xr.Dataset, *, fine: xr.Dataset | None = None, ax: Axes = style.NEW
) -> list[Artist]:
    """Draw the error of worn volume and depth over the extrapolation factor, with its bound.

    Parameters
    ----------
    found : xarray.Dataset
        As `erlif.joint.models.slider_wear.bound_extrapolation` returns it.
    fine : xarray.Dataset, optional
        The end of a run with a far smaller factor, from which the error is counted: one cycle of
        `erlif.joint.models.slider_wear.wear_slider_crank`. Default: the limit that `found`
        estimates.

    Returns
    -------
    list of Artist
        Estimated error and bound of the volume, then of the depth.

    Examples
    --------
    >>> from erlif.joint.models.slider_wear import bound_extrapolation
    >>> def wear(factor):
    ...     value = ("cycle", [0.0, 1.0 + 1e-5 * factor])
    ...     return xr.Dataset({"worn_volume": value, "greatest_depth": value})
    >>> lines = extrapolation_error(bound_extrapolation(1000, wear=wear))
    >>> lines[0].axes.get_xlabel()
    'extrapolation factor [cycles]'
    """
    factors = found.extrapolation.values
    curves = []
    for name, label, colour, mark, dash, size in (
        ("worn_volume", "volume", OUTWARD, "o", "-", 3.0),
        ("greatest_depth", "depth", RETURN, "s", "--", 6.0),  # both are often alike
    ):
        # the limit is extrapolated from the runs, unless a finer one is known
        limit = float(found[f"{name}_limit"] if fine is None else fine[name])
        error = 100 * np.abs(found[name].values - limit) / abs(limit)
        bound = 100 * found[f"{name}_bound"].values / abs(limit)
        face = "none" if dash == "--" else colour
        look = {"form": mark, "size": size, "markerfacecolor": face}
        curves.append(Curve(factors, error, colour, f"{label}: error", look))
        look = {"form": dash, "width": 0.9}
        curves.append(Curve(factors, bound, colour, f"{label}: bound", look))

    labels = "extrapolation factor [cycles]", "error [%]"
    drawn = style.draw_curves(ax, curves, *labels, xscale="log", yscale="log")
    ax.set_xticks(factors, [f"{factor:g}" for factor in factors])
    ax.minorticks_off()
    return drawn
