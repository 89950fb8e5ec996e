"""The viewer of the maps: its controls, and the data that viewer.js reads."""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
import xarray as xr
from markupsafe import Markup

from erlif.core.arrays import Array
from erlif.io.files import describe_trigger, region_of
from erlif.show.plots.maps import axis_labels, common_limits, flag_swatch
from erlif.show.plots.prediction import has_prediction, predicted_map
from erlif.show.plots.style import FLAG_COLOURS, even_limits
from erlif.show.report.layout import TABLES, render
from erlif.show.report.maps import MapCoding, describe_coding
from erlif.show.view.layers import describe_flags, palette

_SAMPLES = 12  # maps that the limits of the colour scales are taken from
_WITHIN = 98.0  # percent of the pixels of a sample whose values have colours of their own
_LEAST_REACH = 1e-3  # um, of a colour scale
_OF_PREDICTION = ("predicted", "difference")

# Maps of the viewer by the names of viewer.js, with their titles.
LAYERS: dict[str, str] = TABLES["layers"]


def viewer_section(
    film: xr.Dataset,
    coding: MapCoding,
    *,
    triggers: Sequence[int] | None = None,
    opening: int = 0,
    limit: float | None = None,
) -> Markup:
    """Write the controls of the viewer.

    Parameters
    ----------
    film : xarray.Dataset
    coding : MapCoding
        How the maps are kept.
    triggers : sequence of int, optional
        Triggers whose maps the page holds, rising; default: all.
    opening : int
        The one that is shown first.
    limit : float, optional
        Largest size of the page, as it is stated where something was thinned. [MB]
    """
    count = film.sizes["trigger"]
    kept = range(count) if triggers is None else triggers
    hidden = () if has_prediction(film) else _OF_PREDICTION
    layers = {name: title for name, title in LAYERS.items() if name not in hidden}

    # what the page does not hold
    held = [f"the maps of {len(kept)} of {count} triggers"] if len(kept) < count else []
    if coding.stride > 1:
        ordinal = {2: "2nd", 3: "3rd"}.get(coding.stride, f"{coding.stride}th")
        held.append(f"every {ordinal} pixel along each axis")
    return render(
        "viewer.html",
        held=held,
        limit=None if limit is None else f"{limit:g}",
        rounding=f"{1e3 * coding.step:g}",
        last=len(kept) - 1,
        opening=list(kept).index(opening),
        layers=layers,
        flags=[(flag_swatch(flag), flag.title) for flag in FLAG_COLOURS],
    )


def viewer_data(
    film: xr.Dataset, coding: MapCoding, *, triggers: Sequence[int] | None = None
) -> str:
    """Write the data of viewer.js as JSON that can stand in a script element."""
    x, y = film.x.values[:: coding.stride], film.y.values[:: coding.stride]
    pitch = (float(x[1] - x[0]), float(y[1] - y[0]))
    region = region_of(film)
    x_label, y_label = axis_labels(film)

    kept = range(film.sizes["trigger"]) if triggers is None else triggers
    numbers = film.drop_dims(["y", "x"]).load()  # read once, not for each trigger
    data: dict[str, Any] = {
        "width": int(x.size),
        "height": int(y.size),
        "coding": describe_coding(coding),
        "x": [float(x[0]), pitch[0]],
        "y": [float(y[0]), pitch[1]],
        "pixelAspect": pitch[1] / pitch[0],
        "xLabel": x_label,
        "yLabel": y_label,
        "region": [*region.x, *region.y],
        "limits": _layer_limits(film, kept),
        "layers": LAYERS,
        "palettes": {"even": palette("batlow"), "signed": palette("vik")},
        "flags": describe_flags(),
        "numbers": list(kept),
        "triggers": [describe_trigger(numbers, k).capitalize() for k in kept],
        "minima": [_find_minimum(numbers, k, coding, (x.size, y.size)) for k in kept],
    }

    # "</script>" in a name must not end the element
    text = json.dumps(data, ensure_ascii=False, separators=(",", ":"))
    return text.replace("<", "\\u003c")


def _find_minimum(
    numbers: xr.Dataset, trigger: int, coding: MapCoding, shape: tuple[int, int]
) -> list[int] | None:
    """Column and row of the minimum film among the kept pixels; None where it is not known."""
    if "film_min_x" not in numbers:
        return None
    place = np.array([float(numbers[f"film_min_{axis}"][trigger]) for axis in "xy"])
    if not np.isfinite(place).all():
        return None
    return [int(one) for one in np.clip(np.rint(place / coding.stride), 0, np.array(shape) - 1)]


def _layer_limits(film: xr.Dataset, kept: Sequence[int]) -> dict[str, list[float]]:
    """Colour limits of the maps that the film has, each common to all triggers."""

    def reach(maps: Iterable[Array]) -> float:
        """Largest size among all but the largest 2 % of each map."""
        return max(even_limits(each, within=_WITHIN, least=_LEAST_REACH)[1] for each in maps)

    # a sample of maps is enough for one colour scale of all
    sample = kept[:: max(1, len(kept) // _SAMPLES)]
    low, high = common_limits(film, sample)
    limits = {"thickness": [low, high]}
    for layer, name in (("std", "thickness_std"), ("std_shared", "thickness_std_shared")):
        limits[layer] = [0.0, reach(film[name].isel(trigger=k).values for k in sample)]

    if has_prediction(film):
        predicted = {k: predicted_map(film, trigger=k) for k in sample}
        ends = [float(end) for one in predicted.values() for end in (one.min(), one.max())]
        limits["predicted"] = [min(low, *ends), max(high, *ends)]
        most = reach(film.thickness.isel(trigger=k).values - predicted[k] for k in sample)
        limits["difference"] = [-most, most]
    return {name: [round(limit, 3) for limit in both] for name, both in limits.items()}
