"""Coordinates of triggers and frame pairs: what places them in the cycle and on the clock."""

from __future__ import annotations

import xarray as xr

# Coordinates of the triggers beside their number, as far as log and motion give them.
OF_TRIGGERS = ("encoder_angle", "crank_angle", "position", "stroke", "time")

# Coordinates of the frame pairs, in the group frames.
OF_FRAMES = ("trigger", "cycle", "time")


def set_coordinates(dataset: xr.Dataset) -> xr.Dataset:
    """Make angle, stroke and time coordinates, so that everything of a trigger carries them.

    Parameters
    ----------
    dataset : Dataset
        On dim trigger, or a group frames on dim frame.

    Returns
    -------
    Dataset
        The same values. Closing it closes the file of `dataset`.

    Examples
    --------
    >>> film = xr.Dataset(
    ...     {"film_min": ("trigger", [4.1, 4.3]), "crank_angle": ("trigger", [0.0, 90.0])}
    ... )
    >>> list(set_coordinates(film).film_min.coords)
    ['crank_angle']
    """
    wanted = [(name, ("trigger",)) for name in OF_TRIGGERS]
    wanted += [(name, ("frame",)) for name in OF_FRAMES]
    there = [
        name for name, dims in wanted if name in dataset.data_vars and dataset[name].dims == dims
    ]
    if not there:
        return dataset
    placed = dataset.set_coords(there)
    placed.set_close(dataset.close)
    return placed


def name_coordinates(dataset: xr.Dataset) -> str:
    """Names of the coordinates of the triggers, as the CF attribute `coordinates` lists them.

    Returns
    -------
    str
        Separated by blanks, without the coordinates of dims; empty without any.

    Examples
    --------
    >>> film = xr.Dataset(coords={"trigger": [0], "time": ("trigger", [0.5])})
    >>> name_coordinates(film)
    'time'
    """
    names = [str(name) for name, one in dataset.coords.items() if one.dims == ("trigger",)]
    return " ".join(sorted(name for name in names if name != "trigger"))
