"""The attribute `erlif` of a film: its groups, masks, regions, and what a notebook shows of it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import xarray as xr

from erlif.core.errors import ErlifError
from erlif.core.flags import Flag
from erlif.io.files import check_trigger, open_film
from erlif.show.notebook.region import Interval, summarise_region
from erlif.show.notebook.summary import describe_in_html, describe_in_text, list_variables


class FilmAccessor:
    """What `film.erlif` offers; `film` comes from `erlif.process` or `erlif.open_film`.

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
        return open_film(source, group=group)

    def mask(self, *names: str) -> xr.DataArray:
        """Pixels that have one of some flags.

        Choose triggers first where a run is long: ``film.isel(trigger=3).erlif.mask("no_film")``.

        Parameters
        ----------
        *names : str
            saturated, dim, bad_pixel, outside_overlap, below_range, above_range,
            poor_registration, no_film. Default: all of them.

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
            check_trigger(self._film, trigger)
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
    """What `array.erlif` offers.

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
