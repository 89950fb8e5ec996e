"""The viewer of the maps in a report: the page of `erlif view`, and the data it shows."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from markupsafe import Markup, escape

from erlif.core.statistics import central_range
from erlif.io.files import describe_trigger, settings_of
from erlif.show.plots.maps import common_limits
from erlif.show.plots.prediction import has_prediction, predicted_map
from erlif.show.plots.style import even_limits
from erlif.show.report.layout import read_resource, render
from erlif.show.report.maps import KeptMaps, describe_coding
from erlif.show.view.films import axis_of
from erlif.show.view.layers import LAYERS, describe_layers
from erlif.show.view.queries import describe_cycle, describe_film

_SAMPLES = 12  # maps that the limits of the colour scales are taken from
_WITHIN = 99.0  # percent of the differences of a sample that have colours of their own
_LEAST_REACH = 1e-3  # um, of a colour scale
_MEASURED = ["thickness", "thickness_std", "thickness_std_shared"]
_STYLES = ("uPlot.min.css", "view.css")
_MODULES = ("draw.js", "map.js", "charts.js", "view.js")


def viewer_section(
    film: xr.Dataset, kept: KeptMaps, maps: Markup, *, limit: float | None = None
) -> Markup:
    """Write the viewer with its data.

    Parameters
    ----------
    film : xarray.Dataset
    kept : KeptMaps
        Maps that the page holds.
    maps : Markup
        Elements of the maps.
    limit : float, optional
        Largest size of the page, as it is stated where something was thinned. [MB]
    """
    count, stride = film.sizes["trigger"], kept.coding.stride
    held = [f"the maps of {len(kept.triggers)} of {count} triggers"]
    held = held if len(kept.triggers) < count else []
    if stride > 1:
        ordinal = {2: "2nd", 3: "3rd"}.get(stride, f"{stride}th")
        held.append(f"every {ordinal} pixel along each axis")
    return render(
        "viewer.html",
        held=held,
        limit=None if limit is None else f"{limit:g}",
        rounding=f"{1e3 * kept.coding.step:g}",
        data=Markup(viewer_data(film, kept)),
        maps=maps,
        page=viewer_page(),
    )


def viewer_page() -> Markup:
    """The page of `erlif view` in one text, with replies.js for the server, as an attribute."""

    def read(name: str) -> str:
        return read_resource(f"page/{name}", of="erlif.show.view")

    page = str(read("view.html"))
    for name in _STYLES:
        link = f'<link rel="stylesheet" href="{name}">'
        page = page.replace(link, f"<style>{read(name)}</style>")
    drawing = f"<script>{read('uPlot.iife.min.js')}</script>"
    page = page.replace('<script src="uPlot.iife.min.js" defer></script>', drawing)

    # modules become one text, in which nothing is imported
    *modules, last = map(read, _MODULES)
    script = "\n".join([*modules, read_resource("replies.js"), last])
    script = re.sub(r"^import [^;]*;\n|^export ", "", script, flags=re.MULTILINE)
    page = page.replace(' src="view.js"></script>', f">{script}</script>")
    return escape(page)


def viewer_data(film: xr.Dataset, kept: KeptMaps) -> str:
    """Write the data of replies.js as JSON that can stand in a script element."""
    layers = [*_MEASURED, *(("predicted", "residual") if has_prediction(film) else ())]
    numbers = film.drop_dims(["y", "x"]).load()  # read once, not for each trigger
    every = slice(None, None, kept.coding.stride)
    grid = film[["x", "y"]].isel(x=every, y=every)
    held = film.isel(trigger=list(kept.triggers))
    one = describe_film(held, settings_of(film).name, "film", layers)
    one |= {"numbers": kept.triggers, "width": grid.sizes["x"], "height": grid.sizes["y"]}
    one |= {name: axis_of(grid, name) for name in "xy"}

    cycle = describe_cycle(numbers.isel(trigger=list(kept.triggers)))
    cycle["columns"]["trigger"] = kept.triggers
    data: dict[str, Any] = {
        "films": [one],
        **describe_layers([LAYERS[name] for name in layers]),
        "limits": _layer_limits(film, kept.triggers, layers),
        "coding": describe_coding(kept.coding),
        "texts": [describe_trigger(numbers, k) for k in kept.triggers],
        "cycle": cycle,
    }

    # "</script>" in a name must not end the element
    text = json.dumps(data, ensure_ascii=False, separators=(",", ":"))
    return text.replace("<", "\\u003c")


def _layer_limits(
    film: xr.Dataset, kept: Sequence[int], layers: Sequence[str]
) -> dict[str, list[float]]:
    """Colour limits of the maps that the film has, each common to all triggers."""
    # a sample of maps is enough for one colour scale of all
    sample = kept[:: max(1, len(kept) // _SAMPLES)]
    maps = film.isel(trigger=list(sample))
    limits = {"thickness": common_limits(maps)}
    for name in _MEASURED[1:]:
        limits[name] = (0.0, max(central_range(maps[name].values)[1], _LEAST_REACH))
    if "predicted" in layers:
        predicted = np.array([predicted_map(film, trigger=k) for k in sample])
        low, high = limits["thickness"]
        limits["predicted"] = min(low, predicted.min()), max(high, predicted.max())
        difference = maps.thickness.values - predicted
        limits["residual"] = even_limits(difference, within=_WITHIN, least=_LEAST_REACH)
    return {name: [round(float(one), 3) for one in both] for name, both in limits.items()}
