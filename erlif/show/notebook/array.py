"""The attribute `erlif` of an array: a map drawn as the camera sees it."""

from __future__ import annotations

from typing import Any

import xarray as xr

from erlif.show.refusals import refusal

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
            raise refusal("no_map", dims=tuple(self._array.dims))
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
    for name, label, unit in (
        ("encoder_angle", "encoder", "°"),
        ("position", "position", " mm"),
        ("time", "time", " s"),
    ):
        if name in array.coords and array[name].ndim == 0 and len(parts) < _TITLE_PARTS:
            parts.append(f"{label} {float(array[name]):.4g}{unit}")
    return ", ".join(parts)
