"""Products of erlif recognised by what they hold."""

from __future__ import annotations

from os import PathLike
from typing import Any

import xarray as xr

_MARKS = (
    ("comparison", "difference_at"),
    ("pressure", "peak_pressure"),
    ("prediction", "film_predicted"),
    ("film", "thickness"),
    ("film", "film_min"),
    ("frames", "drift_x"),
    ("registration", "displacement_x"),
    ("images", "log_ratio"),
    ("budget", "std"),
    ("calibration file", "ratio_at_zero"),
)
"""Kind of a dataset by a variable that only this kind has; the first that is found counts."""

KIND_NAMES = {
    "film": "a film",
    "part of a film": "a film",
    "frames": "the group frames of a film",
    "registration": "the group registration of a film",
    "images": "the images of one trigger",
    "comparison": "a comparison of runs",
    "pressure": "a pressure",
    "prediction": "a prediction",
    "budget": "an uncertainty budget",
    "calibration": "a calibration",
    "calibration file": "the content of calibration.nc",
    "run": "the path of a run directory",
    "fixture": "the path of a fixture directory",
    "directory": "the path of a directory",
    "film file": "the path of a film",
    "calibration path": "a calibration, or its path",
    "run or film": "the path of a run directory or of a film",
    "path": "a path",
}
"""Kinds in words."""


def kind_of(value: Any) -> str:
    """Recognise a product.

    Parameters
    ----------
    value : object

    Returns
    -------
    str
        A kind as for `take`; "path" for any path, "dataset" for an unknown one, else empty.

    Examples
    --------
    >>> kind_of("film.nc"), kind_of(xr.Dataset({"film_min": 4.1})), kind_of(3)
    ('path', 'film', '')
    """
    if isinstance(value, str | PathLike):
        return "path"
    if isinstance(value, xr.Dataset):
        return next((kind for kind, mark in _MARKS if mark in value), "dataset")
    if {"ratio_at_zero", "attenuation_camera1", "thickness_range"} <= set(dir(value)):
        return "calibration"
    return ""
