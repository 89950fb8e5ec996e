"""The attribute `erlif` of a film: its groups, masks, regions, and what a notebook shows of it."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from erlif.core.errors import ErlifError
from erlif.core.flags import Flag
from erlif.core.html import captioned, card, colour_picture, findings_list, picture_tag, rows_table
from erlif.core.notes import Level, split_notes
from erlif.core.statistics import central_range
from erlif.core.units import count_of
from erlif.io import files
from erlif.show.notebook.region import Interval, summarise_region


class FilmAccessor:
    """Attribute `film.erlif` of a film from `erlif.process` or `erlif.open_film`.

    As the last line of a cell, `film.erlif` shows run, load, oil, statistics and some maps.

    Parameters
    ----------
    film : xarray.Dataset

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> film = example_film()
    >>> int(film.erlif.mask("no_film").sum("x").max())
    4
    """

    def __init__(self, film: xr.Dataset) -> None:
        self._film = film

    def __repr__(self) -> str:
        return describe_in_text(self._film)

    def _repr_html_(self) -> str:
        return describe_in_html(self._film)

    @property
    def frames(self) -> xr.Dataset:
        """The group frames: trigger, cycle, time, drift and pulse energy of each frame pair."""
        return self._open_group("frames")

    @property
    def registration(self) -> xr.Dataset:
        """The group registration: where camera 2 sees the pixels of camera 1."""
        return self._open_group("registration")

    def _open_group(self, group: str) -> xr.Dataset:
        # a film that was never a file carries its groups along
        kept = self._film.encoding.get("groups", {})
        if group in kept:
            dataset: xr.Dataset = kept[group]
            return dataset
        source = self._film.encoding.get("source", "")
        if not source or not Path(source).exists():
            raise ErlifError(
                f"Expected a film that was opened from its file, which holds the group {group}; "
                "this dataset names none. Open it with erlif.open_film, or name the file: "
                f'erlif.open_film("film.nc", group="{group}").'
            )
        return files.open_film(source, group=group)

    def mask(self, *names: str) -> xr.DataArray:
        """Pixels that have one of some flags.

        Choose triggers first where a run is long: ``film.isel(trigger=3).erlif.mask("no_film")``.

        Parameters
        ----------
        *names : str
            saturated, dim, bad_pixel, outside_overlap, below_range, above_range,
            poor_registration, no_film, film_step, masked. Default: all of them.

        Returns
        -------
        xarray.DataArray
            True where a pixel has one of the flags, on the dims of `film.flags`.

        Raises
        ------
        ErlifError
            If there is no such flag, or the dataset has none.
        """
        self._require("flags")
        known = {str(flag.name).lower(): flag for flag in Flag}
        unknown = [name for name in names if name not in known]
        if unknown:
            raise ErlifError(
                f"Expected names of flags, {', '.join(known)}; got {', '.join(unknown)}. Choose "
                "among them."
            )
        # one comparison for all flags
        bits = Flag(0)
        for name in names or known:
            bits |= known[name]
        masked: xr.DataArray = (self._film.flags & int(bits)) != 0
        return masked.rename("mask").assign_attrs(long_name=" or ".join(names) or "flagged")

    @property
    def valid(self) -> xr.DataArray:
        """Pixels without any flag, where `thickness` has a value."""
        self._require("flags")
        unflagged: xr.DataArray = self._film.flags == 0
        return unflagged.rename("valid").assign_attrs(long_name="valid")

    def region(self, *, x: Interval | None = None, y: Interval | None = None) -> xr.Dataset:
        """Mean and minimum film thickness over a rectangle, as `summarise_region`."""
        self._require("thickness", "thickness_std", "thickness_std_shared", "flags")
        return summarise_region(self._film, x=x, y=y)

    def plot_map(
        self, variable: str = "thickness", *, trigger: int | None = None, **style: Any
    ) -> Any:
        """Draw one map with y downwards and square pixels.

        `erlif.show.plots.thickness_map` draws the flags and the region of interest as well.

        Parameters
        ----------
        variable : str
            Any variable on the dims trigger, y and x.
        trigger : int, optional
            Number of the trigger, from 0; not where the dataset is at one trigger already.
        **style
            As for `MapAccessor.plot`, as what is returned.

        Returns
        -------
        artist

        Raises
        ------
        ErlifError
            If there is no such variable or trigger.
        """
        self._require(variable)
        one = self._film[variable]
        if "trigger" in one.dims:
            if trigger is None:
                raise ErlifError(
                    f"Expected one map, got those of {one.sizes['trigger']} triggers. Give "
                    "trigger=, a number from 0."
                )
            files.check_trigger(self._film, trigger)
            one = one.isel(trigger=trigger)
        return one.erlif.plot(**style)

    def _require(self, *names: str) -> None:
        missing = [name for name in names if name not in self._film]
        if missing:
            present = list_variables(self._film)
            raise ErlifError(
                f"Expected a film with {', '.join(missing)}; the dataset holds {present}. Open a "
                "film with erlif.open_film, or make one with erlif.process."
            )


_TITLE_PARTS = 2  # coordinates in a title


class MapAccessor:
    """Attribute `array.erlif` of a map.

    Parameters
    ----------
    array : xarray.DataArray
        A map, with the dims y and x.

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> drawn = example_film().thickness.isel(trigger=2).erlif.plot()
    >>> bool(drawn.axes.yaxis_inverted())
    True
    """

    def __init__(self, array: xr.DataArray) -> None:
        self._array = array

    def plot(self, **style: Any) -> Any:
        """Draw a map with y downwards and square pixels, in the colours of `erlif.show.plots`.

        `xarray.DataArray.plot` draws y upwards. xarray has no setting and no attribute that turns
        an axis for all plots.

        Parameters
        ----------
        **style
            As for `xarray.DataArray.plot.pcolormesh`; ``ax=`` for axes of your own.

        Returns
        -------
        artist
            As xarray returns it.

        Raises
        ------
        ErlifError
            If the array is no map.
        """
        if set(self._array.dims) != {"y", "x"}:
            raise ErlifError(
                f"Expected a map on the dims y and x, got {tuple(self._array.dims)}. Choose one "
                "first, such as film.thickness.isel(trigger=3)."
            )
        from erlif.show.plots.style import colour_map  # matplotlib is loaded for a figure alone

        # what the user gives takes precedence
        usual: dict[str, Any] = {"x": "x", "y": "y", "yincrease": False}
        if not {"cmap", "colors"} & set(style):
            usual["cmap"] = colour_map("batlow")  # that of erlif.plots
        drawn = self._array.plot.pcolormesh(**(usual | style))
        drawn.axes.set_aspect("equal")
        drawn.axes.set_title(_title(self._array))
        return drawn


def _title(array: xr.DataArray) -> str:
    """Trigger and angle in one short line; xarray would list all coordinates."""
    parts = []
    if "trigger" in array.coords and array.trigger.ndim == 0:
        parts.append(f"trigger {int(array.trigger)}")
    turned = array.coords["crank_angle"].attrs if "crank_angle" in array.coords else {}
    for name, label, unit in (
        ("crank_angle", turned.get("long_name", "crank angle"), "°"),
        ("encoder_angle", "encoder", "°"),
        ("position", "position", " mm"),
        ("time", "time", " s"),
    ):
        if name in array.coords and array[name].ndim == 0 and len(parts) < _TITLE_PARTS:
            parts.append(f"{label} {float(array[name]):.4g}{unit}")
    return ", ".join(parts)


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
    from erlif.show.report.layout import print_rows  # loads templates

    head = f"film {_name(film)!r}: {_size(film)}"
    lines = [print_rows(head, dict(_rows(film)), width=24)]
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
    """A film, also where one of its triggers was taken, which has no power of the speed."""
    if "trigger" in film.dims:
        return film
    powers = [name for name in film if str(name).startswith("speed_exponent")]
    return film.drop_vars(powers).expand_dims("trigger")


def _describe_foreign(dataset: xr.Dataset) -> str:
    way = "Open a film with erlif.open_film, or make one with erlif.process."
    return f"no film: the dataset holds {list_variables(dataset)}. {way}"


def list_variables(dataset: xr.Dataset) -> str:
    """The first variables of a dataset."""
    return ", ".join(str(name) for name in list(dataset.variables)[:8]) or "nothing"


def _name(film: xr.Dataset) -> str:
    try:
        return files.settings_of(film).name
    except ErlifError:
        return str(film.attrs.get("title", "film"))


def _size(film: xr.Dataset) -> str:
    size = f"{film.sizes['x']} x {film.sizes['y']} pixels"
    return f"{count_of(film.sizes['trigger'], 'trigger')} of {size}"


def _rows(film: xr.Dataset) -> list[tuple[str, str]]:
    """Rows of the summary of a film: name and value."""
    from erlif.show.report.summary import describe_briefly  # loads templates

    rows = list(describe_briefly(film, files.flag_shares(film)).items())
    shown = [(title, how) for title, how in _QUANTITIES.items() if how[0] in film]
    link = files.driven_link(film)
    rows += [(title.replace("crank", link), _range(film, *how)) for title, how in shown]
    with suppress(ErlifError):
        oil = files.settings_of(film).oil
        rows += [("oil", oil.name)] if oil is not None and oil.name else []
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
    captions = [files.describe_trigger(film, int(k)) for k in chosen]
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
