"""A film at a glance, in text and in HTML."""

from __future__ import annotations

from contextlib import suppress

import numpy as np
import xarray as xr

from erlif.core.errors import ErlifError
from erlif.core.html import captioned, card, colour_picture, findings_list, picture_tag, rows_table
from erlif.core.notes import Level, split_notes
from erlif.core.statistics import central_range
from erlif.core.units import count_of
from erlif.io.files import (
    applicable_theory,
    describe_trigger,
    driven_link,
    flag_shares,
    settings_of,
)

_PICTURES = 4  # maps that are shown
_SIDE = 160  # px, width of a picture
_QUANTITIES = {
    "load": ("joint_load", "N", 1),
    "crank angle": ("crank_angle", "°", 1),
    "encoder angle": ("encoder_angle", "°", 1),
    "sliding speed": ("sliding_speed", "m/s", 3),
    "oil temperature": ("temperature", "°C", 1),
}


def describe_in_text(film: xr.Dataset) -> str:
    """Describe a film in some lines.

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> print(describe_in_text(example_film()).splitlines()[0])
    film 'example': 6 triggers of 64 x 24 pixels
    """
    if not _is_film(film):
        return _describe_foreign(film)
    film = _of_triggers(film)
    lines = [f"film {_name(film)!r}: {_size(film)}"]
    lines += [f"  {name:<24}{value}" for name, value in _rows(film)]
    lines += [f"  {level.value}: {text}" for level, text in _findings(film) if level != Level.NOTE]
    return "\n".join(lines)


def describe_in_html(film: xr.Dataset) -> str:
    """Describe a film as `describe_in_text` with some of its maps; text of files is escaped.

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> describe_in_html(example_film()).count("<img")
    4
    """
    if not _is_film(film):
        return card("no film", "", rows_table([("", _describe_foreign(film))]))
    film = _of_triggers(film)
    shown = rows_table(_rows(film)), _maps(film), findings_list(_findings(film))
    return card(_name(film), _size(film), *shown)


def _is_film(film: xr.Dataset) -> bool:
    return {"thickness", "film_min", "film_mean", "x", "y"} <= set(film.variables)


def _of_triggers(film: xr.Dataset) -> xr.Dataset:
    """A film, also where one of its triggers was taken."""
    return film if "trigger" in film.dims else film.expand_dims("trigger")


def _describe_foreign(dataset: xr.Dataset) -> str:
    way = "Open a film with erlif.open_film, or make one with erlif.process."
    return f"no film: the dataset holds {list_variables(dataset)}. {way}"


def list_variables(dataset: xr.Dataset) -> str:
    """The first variables of a dataset."""
    return ", ".join(str(name) for name in list(dataset.variables)[:8]) or "nothing"


def _name(film: xr.Dataset) -> str:
    try:
        return settings_of(film).name
    except ErlifError:
        return str(film.attrs.get("title", "film"))


def _size(film: xr.Dataset) -> str:
    size = f"{film.sizes['x']} x {film.sizes['y']} pixels"
    return f"{count_of(film.sizes['trigger'], 'trigger')} of {size}"


def _rows(film: xr.Dataset) -> list[tuple[str, str]]:
    """What is shown of a film by name and value."""
    rows = [
        ("minimum film thickness", _range(film, "film_min", "um", 2)),
        ("mean film thickness", _range(film, "film_mean", "um", 2)),
    ]
    rows.append(("valid pixels", f"{flag_shares(film)[:, 0].mean():.1%}"))
    shown = [(title, how) for title, how in _QUANTITIES.items() if how[0] in film]
    link = driven_link(film)
    rows += [(title.replace("crank", link), _range(film, *how)) for title, how in shown]
    with suppress(ErlifError):
        oil = settings_of(film).oil
        rows += [("oil", oil.name)] if oil is not None and oil.name else []
    if (theory := applicable_theory(film)) is not None:
        rows.append(("theory", str(theory.attrs.get("regime", ""))))
    return rows


def _range(film: xr.Dataset, name: str, unit: str, digits: int) -> str:
    values = film[name].values
    known = values[np.isfinite(values)]
    if not known.size:
        return "not known"
    low, high = (f"{value:.{digits}f}" for value in (known.min(), known.max()))
    return f"{low} {unit}" if low == high else f"{low} to {high} {unit}"


def _findings(film: xr.Dataset) -> list[tuple[Level, str]]:
    """Notes of a film with their levels."""
    return split_notes(str(film.attrs.get("notes", "")))


def _maps(film: xr.Dataset) -> str:
    """Some maps over the cycle on one scale."""
    count = film.sizes["trigger"]
    chosen = np.unique(np.linspace(0, count - 1, min(count, _PICTURES)).round().astype(int))
    step = max(1, max(film.sizes["x"], film.sizes["y"]) // _SIDE)
    thin = film.thickness[:, ::step, ::step]
    images = [thin.isel(trigger=k).values for k in chosen]
    captions = [describe_trigger(film, int(k)) for k in chosen]
    if not any(np.isfinite(image).any() for image in images):
        return ""
    # one colour scale, or the maps could not be compared
    low, high = ends = central_range(np.stack(images))
    pictures = [
        (picture_tag(colour_picture(image, ends), alt=caption, width=_SIDE), caption)
        for image, caption in zip(images, captions, strict=True)
    ]
    scale = rows_table([("colours", f"{low:.2f} to {high:.2f} um; grey: no value")])
    return captioned(pictures) + scale
