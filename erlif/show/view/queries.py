"""Requests of the page and their replies: one function for each kind of request."""

from __future__ import annotations

import json
import struct
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias, TypeVar

import numpy as np
import xarray as xr

from erlif.core.arrays import Array, FlagImage, Image
from erlif.core.errors import ErlifError
from erlif.core.flags import FLAG_COLOURS, Flag, count_flags
from erlif.core.statistics import film_limits
from erlif.core.tables import read_table
from erlif.io.files import axis_labels, driven_link, fastest_trigger, formula_label, region_of
from erlif.show.view import measures
from erlif.show.view.exports import map_csv, map_tiff
from erlif.show.view.films import FilmReader, axis_of, check_one_grid
from erlif.show.view.layers import DIFFERENCE, LAYERS, SIGNIFICANCE, Layer, describe_layers
from erlif.show.view.levels import choose_step, cover, reduce_map
from erlif.show.view.run_settings import propose_region, write_change

T = TypeVar("T")


@dataclass(frozen=True)
class Request:
    """The named values of an address, and the films they refer to.

    Attributes
    ----------
    films : Sequence[FilmReader]
        Open films.
    values : Mapping[str, str]
        Texts by name.

    Examples
    --------
    >>> Request([], {"trigger": "12"}).whole("trigger")
    12
    >>> Request([], {"trigger": "second"}).whole("trigger")
    Traceback (most recent call last):
        ...
    erlif.core.errors.ErlifError: Expected a whole number as trigger; got 'second'. Reload the page.
    """

    films: Sequence[FilmReader]
    values: Mapping[str, str]

    def film(self, name: str = "film") -> FilmReader:
        """The film of this number."""
        number = self.whole(name)
        if not 0 <= number < len(self.films):
            raise ErlifError(
                f"Expected a film from 0 to {len(self.films) - 1}; got {number}. Reload the page."
            )
        return self.films[number]

    def whole(self, name: str) -> int:
        """A whole number."""
        return self._convert(name, int, "a whole number")

    def numbers(self, name: str, count: int) -> list[float]:
        """Finite numbers between commas."""
        return self._convert(name, lambda text: _split(text, count), f"{count} numbers")

    def text(self, name: str, default: str = "") -> str:
        """A text."""
        return self.values.get(name, default)

    def _convert(self, name: str, convert: Callable[[str], T], expected: str) -> T:
        text = self.values.get(name, "")
        try:
            return convert(text)
        except ValueError:
            raise ErlifError(
                f"Expected {expected} as {name}; got {text[:80]!a}. Reload the page."
            ) from None


def _split(text: str, count: int) -> list[float]:
    numbers = [float(part) for part in text.split(",")]
    if len(numbers) != count or not np.isfinite(numbers).all():
        raise ValueError(text)
    return numbers


def list_films(request: Request) -> dict[str, Any]:
    """Describe the films, the layers and the flags.

    Examples
    --------
    >>> list(list_films(Request([], {})))
    ['films', 'layers', 'palettes', 'flags']
    """
    return {
        "films": [
            describe_film(reader.film, reader.name, reader.path.name, reader.layers)
            for reader in request.films
        ],
        **describe_layers([*LAYERS.values(), DIFFERENCE, SIGNIFICANCE]),
    }


def describe_film(film: xr.Dataset, name: str, file: str, layers: list[str]) -> dict[str, Any]:
    """Describe a film for the page: its grid, its triggers, and the layers that it offers."""
    count, first, region = film.sizes["trigger"], fastest_trigger(film), region_of(film)
    (x0, dx), (y0, dy) = (axis_of(film, name) for name in "xy")

    # the first profile is the row of the minimum, or the middle one
    row = float(film["film_min_y"][first]) if "film_min_y" in film else np.nan
    y = y0 + dy * (row if np.isfinite(row) else (film.sizes["y"] - 1) / 2)
    return {
        "name": name,
        "file": file,
        "numbers": list(range(count)),
        "first": first,
        "width": film.sizes["x"],
        "height": film.sizes["y"],
        "x": (x0, dx),
        "y": (y0, dy),
        "labels": axis_labels(film),
        "region": [*region.x, *region.y],
        "line": [x0, y, x0 + dx * (film.sizes["x"] - 1), y],
        "layers": layers,
    }


def pack_map(request: Request) -> bytes:
    """Read the visible part of a map at the detail of the screen.

    Parameters
    ----------
    request : Request
        film, trigger and layer; window, its left, top, right and bottom edge in pixels; room, width
        and height on the screen; coarse=1 for half the detail.

    Returns
    -------
    bytes
        Length of a description (uint32), the description in JSON, the values (float32) and the
        flags (uint16), all little endian.

    Raises
    ------
    ErlifError
        If a value is missing or there is no such map.
    """
    chosen = _read_chosen(request)
    return pack_values(request, chosen.layer, chosen.values, chosen.flags, text=chosen.text)


@dataclass(frozen=True)
class _Chosen:
    """The map that a request names, whole."""

    reader: FilmReader
    layer: Layer
    values: Image
    flags: FlagImage
    text: str

    def std(self, request: Request, *, shared: bool = False) -> Image:
        """Random or shared standard deviation of the pixels; NaN where the layer has none."""
        if self.layer == DIFFERENCE and not shared:
            return _subtract(request)[1]
        if self.layer.name != "thickness":
            return np.full(self.values.shape, np.nan, np.float32)
        name = "thickness_std_shared" if shared else "thickness_std"
        return self.reader.read(name, request.whole("trigger"))[0]


def _read_chosen(request: Request) -> _Chosen:
    reader, trigger = request.film(), request.whole("trigger")
    name = request.text("layer")
    text = reader.describe(trigger)
    if name in (DIFFERENCE.name, SIGNIFICANCE.name):
        values, std, flags = _subtract(request)
        other = request.film("film2").describe(request.whole("trigger2"))
        text = f"{other} − {text}"
        if name == DIFFERENCE.name:
            return _Chosen(reader, DIFFERENCE, values, flags, text)
        return _Chosen(reader, SIGNIFICANCE, measures.significance(values, std), flags, text)
    values, flags = reader.read(name, trigger)
    return _Chosen(reader, LAYERS[name], values, flags, text)


def _subtract(request: Request) -> tuple[Image, Image, FlagImage]:
    """Difference of the film thickness of two triggers."""
    readers = request.film("film"), request.film("film2")
    check_one_grid(*readers)
    maps = []
    for reader, trigger in zip(readers, ("trigger", "trigger2"), strict=True):
        values, flags = reader.read("thickness", request.whole(trigger))
        maps.append((values, reader.read("thickness_std", request.whole(trigger))[0], flags))
    return measures.subtract_maps(maps[0], maps[1])


def pack_values(
    request: Request, layer: Layer, values: Image, flags: FlagImage, **about: str | int
) -> bytes:
    """The visible part of any map, described by `about`; the rest as for `pack_map`."""
    window = cover((values.shape[0], values.shape[1]), request.numbers("window", 4))
    width, height = request.numbers("room", 2)
    coarse = request.text("coarse") == "1"
    step = choose_step(window, (int(width), int(height)), coarse=coarse)
    shown, reasons = reduce_map(values[window], flags[window], step=step)
    rows, columns = window
    _, *counts = count_flags(flags[flags != 0])  # mostly few
    share = {flag: count / flags.size for flag, count in zip(Flag, counts, strict=True)}

    described = {
        **about,
        "layer": layer.name,
        "window": [columns.start, rows.start, columns.stop, rows.stop],
        "step": step,
        "shape": shown.shape,
        "shares": [share[flag] for flag in FLAG_COLOURS],
    }
    # the values begin at a multiple of four bytes
    text = json.dumps(described, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    parts = np.ascontiguousarray(shown, "<f4"), np.ascontiguousarray(reasons, np.uint16)
    return b"".join([struct.pack("<I", len(text)), text, *(part.tobytes() for part in parts)])


def send_cycle(request: Request) -> dict[str, Any]:
    """Collect the numbers of the triggers.

    Parameters
    ----------
    request : Request
        film.

    Returns
    -------
    dict
        As `erlif.show.view.queries.describe_cycle`.
    """
    return describe_cycle(request.film().film)


def send_profile(request: Request) -> dict[str, Any]:
    """Read a map along a line.

    Parameters
    ----------
    request : Request
        As for `pack_map`; line, x and y of its ends [mm]; width [px].

    Returns
    -------
    dict
        "position" [mm], "value" and "std" of the points; None where flagged. "predicted" beside the
        film thickness, where the film has a prediction.
    """
    chosen = _read_chosen(request)
    x0, y0, x1, y1 = request.numbers("line", 4)
    values = np.where(chosen.flags == 0, chosen.values, np.nan)
    place: dict[str, Any] = {name: axis_of(chosen.reader.film, name) for name in ("x", "y")}
    place |= {"line": (x0, y0, x1, y1), "width": request.whole("width")}
    profile = measures.line_profile(values, chosen.std(request), **place)
    if (theory := _read_theory(request, chosen)) is not None:
        profile["predicted"] = measures.line_profile(theory, 0 * theory, **place)["value"]
    return {name: to_list(values) for name, values in profile.items()}


def _read_theory(request: Request, chosen: _Chosen) -> Image | None:
    """The predicted film beside a measured one, where the film has a prediction."""
    if chosen.layer.name != "thickness" or "predicted" not in chosen.reader.layers:
        return None
    return chosen.reader.read("predicted", request.whole("trigger"))[0]


def send_region(request: Request) -> dict[str, Any]:
    """Compute the statistics of a region.

    Parameters
    ----------
    request : Request
        As for `pack_map`; region, low and high x, low and high y [mm].

    Returns
    -------
    dict
        As `erlif.show.view.measures.region_statistics`, None in place of NaN, and "unit".
    """
    chosen = _read_chosen(request)
    x0, x1, y0, y1 = request.numbers("region", 4)
    film = chosen.reader.film
    part = measures.select_region(film.x.values, film.y.values, (x0, x1, y0, y1))
    std, shared = chosen.std(request)[part], chosen.std(request, shared=True)[part]
    values = measures.region_statistics(chosen.values[part], chosen.flags[part], std, shared)
    numbers = {name: None if value != value else value for name, value in values.items()}
    return {**numbers, "unit": chosen.layer.unit}


def send_pixel(request: Request) -> dict[str, Any]:
    """Read one pixel.

    Parameters
    ----------
    request : Request
        As for `pack_map`; place, x and y [mm].

    Returns
    -------
    dict
        "x", "y" [mm], "column" and "row" of the pixel; "flags", "value", "unit"; of the film
        thickness "std", "std_shared" and "predicted". None where unknown.
    """
    chosen = _read_chosen(request)
    x, y = request.numbers("place", 2)
    (x0, dx), (y0, dy) = (axis_of(chosen.reader.film, name) for name in "xy")
    # a pointer at the edge belongs to the last pixel
    rows, columns = chosen.reader.shape
    column = min(max(round((x - x0) / dx), 0), columns - 1)
    row = min(max(round((y - y0) / dy), 0), rows - 1)

    maps = {
        "value": chosen.values,
        "std": chosen.std(request),
        "std_shared": chosen.std(request, shared=True),
        "predicted": _read_theory(request, chosen),
    }
    found = {name: _value_at(one, row, column) for name, one in maps.items()}
    flags = int(chosen.flags[row, column])
    place = {"x": x, "y": y, "column": column, "row": row}
    return {**place, **found, "flags": flags, "unit": chosen.layer.unit}


def _value_at(values: Image | None, row: int, column: int) -> float | None:
    return None if values is None else to_list(values[row, [column]].astype(float))[0]


# What a request is served.
Found: TypeAlias = Mapping[str, Any] | bytes


def export(request: Request) -> bytes:
    """Write a map as a file; what the page holds in numbers, it writes itself.

    Parameters
    ----------
    request : Request
        kind: "csv" or "tiff"; the rest as for `pack_map`.

    Returns
    -------
    bytes
        The file: all pixels of the visible window, whatever the detail on the screen.

    Raises
    ------
    ErlifError
        If there is no such export.
    """
    kind = request.text("kind")
    if kind not in ("csv", "tiff"):
        raise ErlifError(f"Expected an export that exists; got {kind}. Reload the page.")
    chosen = _read_chosen(request)
    rows, columns = window = cover(chosen.reader.shape, request.numbers("window", 4))
    film, layer = chosen.reader.film, chosen.layer
    values, flags = chosen.values[window], chosen.flags[window]
    unit = layer.unit.replace("µ", "u")
    if kind == "csv":
        x, y = film.x.values[columns], film.y.values[rows]
        return map_csv(values, flags, name=f"{layer.name} [{unit}]", x=x, y=y)
    title = f"{chosen.reader.name}, {layer.title}, {chosen.text}"
    pitch = (axis_of(film, "x")[1], axis_of(film, "y")[1])
    return map_tiff(values, flags, title=title, unit=unit, pitch=pitch)


def change_region(films: Sequence[FilmReader], body: bytes) -> dict[str, str]:
    """Show how a region changes run.toml, or write it.

    Parameters
    ----------
    films : sequence of FilmReader
        Open films.
    body : bytes
        JSON with film, region [mm], and, to write it, confirmed and before.

    Returns
    -------
    dict
        "file", "change" and "before", the hash of the file as it was.

    Raises
    ------
    ErlifError
        If the body is no such record, or the file cannot be changed.
    """
    try:
        wanted = json.loads(body)
        x0, x1, y0, y1 = (float(value) for value in wanted["region"])
        request = Request(films, {"film": str(wanted["film"])})
        confirmed, before = wanted.get("confirmed") is True, str(wanted.get("before", ""))
    except (ValueError, TypeError, KeyError, RecursionError) as error:
        raise ErlifError("Expected a film and a region as JSON. Reload the page.") from error

    from erlif.trend import find_region  # loads the fits, which nothing else here needs

    # the pipeline needs more pixels than statistics on the page
    reader = request.film()
    find_region(reader.film.x.values, reader.film.y.values, roi=((x0, x1), (y0, y1)))
    change = propose_region(reader.run_dir, (x0, x1, y0, y1))
    if confirmed:
        write_change(change, before=before)
    return {"file": str(change.path), "change": change.lines, "before": change.digest}


_TABLES = read_table("erlif.show.view", "page.toml")
_MEASURED = ("film_mean", "film_min")
_DIGITS = 6  # significant ones of the numbers that are sent


def describe_cycle(film: xr.Dataset) -> dict[str, Any]:
    """Collect what is known of each trigger besides its maps.

    Parameters
    ----------
    film : Dataset
        As `erlif.open_film` returns it.

    Returns
    -------
    dict
        "axes" and "films": titles by name; "limits" of an axis of the measured films [um];
        "columns": a list of one number for each trigger by name, None where it is not known;
        "units" of the columns; "stroke": +1, -1 or 0 where there are no strokes.

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> cycle = describe_cycle(example_film())
    >>> list(cycle["axes"])[:3], cycle["columns"]["trigger"]
    (['encoder_angle', 'crank_angle', 'rocker_speed'], [0, 1, 2, 3, 4, 5])
    """
    axes, films = (
        {name: title for name, title in table.items() if name in film}
        for table in (_TABLES["axes"], _TABLES["films"])
    )
    if "film_hamrock_dowson" in films:
        films["film_hamrock_dowson"] = formula_label(film)
    if "film_predicted_min" in films:  # the steady film of a joint that swings is far off
        films.pop("film_theory", None)
    link = driven_link(film)
    if "crank_angle" in axes and link != "crank":  # its angle comes first
        del axes["crank_angle"]
        axes = {"crank_angle": f"{link} angle [°]"} | axes
    stds = [f"{name}_std" for name in films if f"{name}_std" in film]
    ends = []
    for name in _MEASURED:
        reach = np.nan_to_num(film.get(f"{name}_std", 0.0))
        ends += [film[name].values - reach, film[name].values + reach]
    # numbers of triggers count from 0, whatever the film was cut from
    count = film.sizes["trigger"]
    columns = {name: to_list(film[name].values) for name in (*axes, *films, *stds)}
    columns["trigger"] = list(range(count))

    axes.setdefault("trigger", _TABLES["axes"]["trigger"])
    stroke = np.sign(film.stroke.values) if "stroke" in film else np.zeros(count)
    return {
        "axes": axes,
        "films": films,
        "limits": film_limits(np.concatenate(ends)),
        "columns": columns,
        "units": {name: film[name].attrs.get("units", "1") for name in columns if name in film},
        "stroke": np.nan_to_num(stroke).astype(int).tolist(),
    }


def to_list(values: Array) -> list[float | None]:
    """Numbers as JSON holds them.

    Parameters
    ----------
    values : array, (n,)
        Numbers; NaN where unknown.

    Returns
    -------
    list
        Rounded to six significant digits; None for NaN, which JSON lacks.

    Examples
    --------
    >>> to_list(np.array([1 / 3, np.nan]))
    [0.333333, None]
    """
    return [
        float(f"{value:.{_DIGITS}g}") if np.isfinite(value) else None
        for value in np.asarray(values, float).tolist()
    ]
