"""Checks that an opened film can have been written by `erlif process`.

A film may have been edited, converted by another program, or damaged. What figures, report and
summary rely on is checked once, when the film is opened; maps are not read for it.
"""

from __future__ import annotations

import json
import tomllib
from collections.abc import Mapping
from contextlib import suppress
from functools import lru_cache
from typing import Any

import numpy as np
import xarray as xr

from erlif.core.arrays import AnyArray
from erlif.core.flags import Flag
from erlif.core.format import LaterVersionError, is_later
from erlif.core.variables import FILM, FRAMES, LARGEST_NUMBER, REGISTRATION, Variable
from erlif.io.settings import RunSettings, count_keys

# Longest attribute. [character]
LARGEST_TEXT = 2**24

# Largest difference of two distances of pixels, relative to their mean.
_UNIFORM = 1e-6

_MAP = FILM["thickness"].dims

# Kinds of numpy types that stand for the type of the table: other programs widen numbers.
_KINDS = {
    "float32": "f",
    "float64": "iuf",
    "int64": "iu",
    "int8": "iuf",
    "uint8": "iub",
    "uint16": "iu",
}

_TEXT_KINDS = "OUST"

# Variables of which the exponent may be; a fit needs a speed.
_SPEEDS = ("rocker_speed", "rotation_speed", "sliding_speed")

# Attributes of text that every film has.
_TEXTS = ("title", "settings", "calibration")

_OPTIONAL_TEXTS = ("notes", "history", "input_hashes", "erlif_version", "identity")


@lru_cache(maxsize=8)  # a film is asked for its settings many times
def read_settings(text: str) -> RunSettings:
    """Settings as a film records them.

    Parameters
    ----------
    text : str
        TOML.

    Returns
    -------
    RunSettings

    Raises
    ------
    ValueError
        With the bare reason.

    Examples
    --------
    >>> read_settings("pixel = ")
    Traceback (most recent call last):
        ...
    ValueError: the settings in it cannot be read
    """
    try:
        return RunSettings.model_validate(tomllib.loads(text))
    except (ValueError, RecursionError) as error:
        raise ValueError("the settings in it cannot be read") from error


def check_film(film: xr.Dataset) -> None:
    """Refuse an opened film that figures, report and summary could not use.

    Parameters
    ----------
    film : xarray.Dataset
        The root of the file, with lazy maps.

    Raises
    ------
    ValueError
        With the bare reason, the first one found; `LaterVersionError` for a film of a later erlif.

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> check_film(example_film())
    >>> check_film(example_film().drop_vars("film_min_std"))
    Traceback (most recent call last):
        ...
    ValueError: it has no variable film_min_std
    """
    if is_later(film.attrs):
        raise LaterVersionError(film.attrs)
    _check_variables(film, FILM)
    _read_small(film)
    for variable in FILM.values():
        for other in variable.needs:
            if variable.name in film and other not in film:
                raise ValueError(f"it has {variable.name} and no variable {other}")

    if "speed_exponent" in film:
        for name in _SPEEDS:
            if name in film and not np.any(np.abs(film[name].values) > 0):
                raise ValueError(f"it has an exponent of the speed, and {name} is zero throughout")

    for axis in ("x", "y"):
        _check_axis(axis, film[axis].values)
    if not np.array_equal(film.trigger.values, np.arange(film.sizes["trigger"])):
        raise ValueError("its triggers are not numbered from 0")
    # films from before a flag was added lack the last ones
    known = [flag.value for flag in Flag][: film.sizes.get("flag", 0)]
    if "flag" in film and film.flag.values.tolist() != known:
        raise ValueError("its flags are not those of erlif")
    if "flagged_pixels" in film:
        pixels = film.sizes["y"] * film.sizes["x"]
        most = max(int(film[name].values.max()) for name in ("flagged_pixels", "valid_pixels"))
        if most > pixels:
            raise ValueError(f"it counts {most} pixels in maps of {pixels}")
    _check_film_attributes(film)


def check_frames(frames: xr.Dataset) -> None:
    """Refuse the group frames of a film; as `check_film`.

    Raises
    ------
    ValueError
        With the bare reason.
    """
    _check_variables(frames, FRAMES)
    _read_small(frames)


def check_registration(registration: xr.Dataset) -> None:
    """Refuse the group registration of a film; as `check_film`.

    Raises
    ------
    ValueError
        With the bare reason.
    """
    _check_variables(registration, REGISTRATION, values=False)
    quality = registration.attrs.get("registration_quality")
    if not _is_number(quality):
        raise ValueError(f"registration_quality is {_show(quality)}, not a number")
    _expect_text(registration.attrs, "registration_model")


def _check_variables(
    dataset: xr.Dataset, table: Mapping[str, Variable], *, values: bool = True
) -> None:
    for name, form in table.items():
        if name not in dataset:
            if form.required:
                raise ValueError(f"it has no variable {name}")
            continue
        variable = dataset[name]
        if variable.dims != form.dims:
            raise ValueError(f"{name} has the dims {variable.dims}, not {form.dims}")
        if variable.dtype.kind not in _KINDS.get(form.dtype, _TEXT_KINDS):
            raise ValueError(f"{name} has values of the type {variable.dtype}")
        if not all(variable.shape):
            raise ValueError(f"{name} has no values")
        unit = variable.attrs.get("units", form.units)
        if unit != form.units:
            raise ValueError(f"{name} is in {_show(unit)}, not in {form.units}")

        # maps are large, and read one by one where they are used
        if values and form.dims != _MAP and variable.dtype.kind in "iuf":
            values_read = variable.values
            if values_read.shape != tuple(dataset.sizes[dim] for dim in form.dims):
                raise ValueError(f"{name} has the shape {values_read.shape}")
            _check_values(form, values_read)


def _read_small(dataset: xr.Dataset) -> None:
    """Read what is no map once: a text in an unknown encoding fails here."""
    _check_encoding("", dataset.attrs)
    for name, variable in dataset.variables.items():
        _check_encoding(f" of {name}", variable.attrs)
        if variable.ndim < len(_MAP):
            _ = variable.values


def _check_encoding(where: str, attrs: Mapping[Any, Any]) -> None:
    """Refuse text that is not valid UTF-8; h5py returns it as half a surrogate pair."""
    for key, value in attrs.items():
        if isinstance(value, str):
            try:
                value.encode()
            except UnicodeEncodeError:
                raise ValueError(f"its attribute {key!a}{where} is no text in UTF-8") from None


def _check_values(form: Variable, values: AnyArray) -> None:
    known = values[~np.isnan(values)]
    if form.known and not known.size:
        raise ValueError(f"{form.name} has no value that is a number")
    outside = (known < form.low) | (known > LARGEST_NUMBER)
    if outside.any():
        raise ValueError(f"{form.name} has the value {known[np.argmax(outside)]:g}")


def _check_axis(name: str, values: AnyArray) -> None:
    """Refuse positions of pixels that do not rise evenly."""
    steps = np.diff(values)
    if not (steps.size and np.isfinite(values).all() and (steps > 0).all()):
        raise ValueError(f"its positions {name} do not rise")
    if np.ptp(steps) > _UNIFORM * steps.mean():
        raise ValueError(f"its positions {name} have unequal distances")


def _check_film_attributes(film: xr.Dataset) -> None:
    for name in _TEXTS:
        _expect_text(film.attrs, name)
    for name in _OPTIONAL_TEXTS:
        if name in film.attrs:
            _expect_text(film.attrs, name)

    try:
        settings = read_settings(film.attrs["settings"])
    except ValueError:
        written, known = film.attrs.get("settings_version", 0), count_keys(RunSettings)
        if _is_number(written) and written > known:
            more = f": its settings have version {written}, this erlif reads up to {known}"
            raise LaterVersionError(film.attrs, more) from None
        raise
    if settings.linkage is not None and "encoder_angle" in film and "rocker_speed" not in film:
        raise ValueError("it has a linkage and no variable rocker_speed")
    for name in ("calibration", "input_hashes"):
        record: Any = None
        with suppress(ValueError, RecursionError):
            record = json.loads(film.attrs.get(name, "{}"))
        if not isinstance(record, dict):
            raise ValueError(f"its attribute {name} is no record in JSON")
        # JSON can write half a pair of UTF-16
        _check_encoding(f" in {name}", {key: f"{key}{value}" for key, value in record.items()})
    if not all(isinstance(value, str) for value in record.values()):
        raise ValueError("its attribute input_hashes holds other values than text")

    if "speed_exponent" in film:
        for name in ("speed_exponent", "speed_exponent_mean"):
            _expect_number(film[name].attrs, "triggers_used", name)
            _expect_number(film[name].attrs, "log_scale", name, optional=True)
    for name in ("film_theory", "film_predicted_min"):
        for attribute in ("regime", "reason") if name in film else ():
            _expect_text(film[name].attrs, attribute)
    if "pin_displacement" in film:
        for name in ("load_line", "load_line_std", "radius"):
            _expect_number(film.pin_displacement.attrs, name, "pin_displacement", optional=True)
    if "attitude" in film:
        _expect_number(film.attitude.attrs, "load_line", "attitude")
    if "encoder_angle" in film:
        for name in ("zero", "zero_std"):
            _expect_number(film.encoder_angle.attrs, name, "encoder_angle", optional=True)


def _expect_text(attrs: Mapping[Any, Any], name: str) -> None:
    value = attrs.get(name)
    if not isinstance(value, str) or len(value) > LARGEST_TEXT:
        raise ValueError(f"its attribute {name} is {_show(value)}, not text")


def _expect_number(
    attrs: Mapping[Any, Any], name: str, variable: str, *, optional: bool = False
) -> None:
    value = attrs.get(name)
    if value is None and optional:
        return
    if not _is_number(value):
        raise ValueError(f"the attribute {name} of {variable} is {_show(value)}, not a number")


def _is_number(given: object) -> bool:
    """Whether an attribute is one real number, NaN included: what could not be fitted is NaN."""
    value = np.asarray(given)
    return value.size == 1 and value.dtype.kind in "iuf" and not np.isinf(value).any()


def _show(value: object) -> str:
    """The start of a value, for a message."""
    return "missing" if value is None else repr(value)[:40]
