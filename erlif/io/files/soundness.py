"""Whether an opened film can be one that `erlif process` wrote.

A film may have been edited, converted by another program, or damaged. What figures, report and
summary rely on is checked once, when the film is opened; maps are not read for it.
"""

from __future__ import annotations

import json
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from erlif.core.arrays import AnyArray
from erlif.core.flags import Flag
from erlif.core.format import is_later
from erlif.io.settings import RunSettings

LARGEST_NUMBER = 1e9
"""Largest magnitude of a number of a trigger, in the units of the file."""

LARGEST_TEXT = 2**24
"""Longest attribute. [character]"""

_UNIFORM = 1e-6
"""Largest difference of two distances of pixels, relative to their mean."""

_MAP = ("trigger", "y", "x")
_TRIGGER = ("trigger",)


@dataclass(frozen=True)
class _Form:
    """What a variable must be.

    Attributes
    ----------
    dims : tuple[str, ...]
        Its dims.
    unit : str
        Its unit, if it states one.
    kinds : str
        Kinds of numpy types.
    required : bool
        Whether every film has it.
    low : float
        Smallest value; no value is infinite.
    known : bool
        Whether some value must be a number and not NaN.
    """

    dims: tuple[str, ...] = _TRIGGER
    unit: str = ""
    kinds: str = "iuf"
    required: bool = False
    low: float = -LARGEST_NUMBER
    known: bool = False


FILM: Mapping[str, _Form] = {
    "trigger": _Form(kinds="iu", required=True, low=0),
    "x": _Form(("x",), "mm", required=True, known=True),
    "y": _Form(("y",), "mm", required=True, known=True),
    "thickness": _Form(_MAP, "um", "f", required=True),
    "thickness_std": _Form(_MAP, "um", "f", required=True),
    "thickness_std_shared": _Form(_MAP, "um", "f", required=True),
    "flags": _Form(_MAP, kinds="u", required=True),
    "frames_used": _Form(kinds="iu", required=True, low=0),
    "film_mean": _Form(unit="um", required=True),
    "film_mean_std": _Form(unit="um", required=True, low=0),
    "film_min": _Form(unit="um", required=True),
    "film_min_std": _Form(unit="um", required=True, low=0),
    "film_min_x": _Form(unit="px", low=0),
    "film_min_y": _Form(unit="px", low=0),
    "share_beyond_range": _Form(unit="1", low=0),
    "valid_pixels": _Form(kinds="iu", low=0),
    "flagged_pixels": _Form(("trigger", "flag"), kinds="iu", low=0),
    "flag": _Form(("flag",), kinds="iu"),
    "encoder_angle": _Form(unit="degree", known=True),
    "time": _Form(unit="s"),
    "stroke": _Form(low=-1),
    "crank_angle": _Form(unit="degree", known=True),
    "position": _Form(unit="mm", known=True),
    "rocker_speed": _Form(unit="rad s-1", known=True),
    "sliding_speed": _Form(unit="m s-1", low=0, known=True),
    "rotation_speed": _Form(unit="rad s-1", known=True),
    "load": _Form(unit="N", low=0, known=True),
    "temperature": _Form(unit="degree_Celsius", low=-273.15),
    "film_hamrock_dowson": _Form(unit="um", low=0),
    "film_theory": _Form(unit="um", low=0),
    "film_regime_map": _Form(unit="um", low=0),
    "film_regime": _Form(kinds="OUST"),
    "film_predicted_min": _Form(unit="um", low=0, known=True),
    "film_predicted_mean": _Form(unit="um", low=0, known=True),
    "eccentricity": _Form(unit="1", low=0, known=True),
    "attitude": _Form(unit="degree", low=-180, known=True),
    "film_parameter": _Form(),
    "axis": _Form(("axis",), kinds="OUST"),
    "parameter": _Form(("parameter",), kinds="OUST"),
    "pin_displacement": _Form(("trigger", "axis"), "um"),
    "pin_tilt": _Form(("trigger", "axis"), "um mm-1"),
    "pin_position_cov": _Form(("trigger", "parameter", "parameter_other"), kinds="f"),
    "pin_position_cov_random": _Form(("trigger", "parameter", "parameter_other"), kinds="f"),
    "pin_position_gradient": _Form(("trigger", "parameter", "calibration_parameter"), kinds="f"),
    "film_curvature": _Form(unit="um mm-2"),
    "film_curvature_std": _Form(unit="um mm-2", low=0),
    "film_curvature_expected": _Form(unit="um mm-2"),
    "film_curvature_axial": _Form(unit="um mm-2"),
    "film_curvature_axial_std": _Form(unit="um mm-2", low=0),
    "speed_exponent": _Form(()),
    "speed_exponent_std": _Form((), low=0),
    "speed_exponent_mean": _Form(()),
    "speed_exponent_mean_std": _Form((), low=0),
}
"""Variables of the root of a film."""

FRAMES: Mapping[str, _Form] = {
    "trigger": _Form(("frame",), kinds="iu", required=True, low=0),
    "cycle": _Form(("frame",), kinds="iu", low=0),
    "time": _Form(("frame",), "s"),
    "drift_x": _Form(("frame",), "px", required=True),
    "drift_y": _Form(("frame",), "px", required=True),
    "pulse_energy": _Form(("frame",), required=True, low=0),
    "film_predicted_min": _Form(("frame",), "um", low=0, known=True),
    "film_predicted_mean": _Form(("frame",), "um", low=0, known=True),
    "eccentricity": _Form(("frame",), "1", low=0, known=True),
    "attitude": _Form(("frame",), "degree", low=-180, known=True),
    "elapsed_cycles": _Form(("frame",), "1", low=0, known=True),
    "file_camera1": _Form(("frame",), kinds="OUST"),
    "file_camera2": _Form(("frame",), kinds="OUST"),
}
"""Variables of the group frames."""

REGISTRATION: Mapping[str, _Form] = {
    "displacement_x": _Form(("y", "x"), "px", "f", required=True),
    "displacement_y": _Form(("y", "x"), "px", "f", required=True),
    "displacement_std": _Form(("y", "x"), "px", "f", required=True, low=0),
    "overlap": _Form(("y", "x"), kinds="iub"),
    "poor": _Form(("y", "x"), kinds="iub"),
}
"""Variables of the group registration."""

_TOGETHER = (
    ("valid_pixels", "flagged_pixels", "flag"),
    ("film_theory", "film_hamrock_dowson"),
    (
        "pin_displacement",
        "pin_tilt",
        "pin_position_cov",
        "pin_position_cov_random",
        "pin_position_gradient",
        "film_curvature",
        "film_curvature_std",
        "film_curvature_axial",
        "film_curvature_axial_std",
    ),
    ("film_predicted_min", "film_predicted_mean", "eccentricity", "attitude"),
    ("speed_exponent", "speed_exponent_std", "speed_exponent_mean", "speed_exponent_mean_std"),
)
"""Variables that a film has together or not at all."""

_NEEDED = {
    "film_theory": ("sliding_speed", "load"),
    "film_regime_map": ("film_theory",),
    "film_predicted_min": ("film_theory", "film_regime_map"),
    "speed_exponent": ("load",),
    "rocker_speed": ("crank_angle", "encoder_angle"),
}
"""What a variable stands for nothing without."""

_SPEEDS = ("rocker_speed", "rotation_speed", "sliding_speed")
"""Variables of which the exponent may be; a fit needs a speed."""

_TEXTS = ("title", "settings", "calibration")
"""Attributes of text that every film has."""

_OPTIONAL_TEXTS = ("notes", "history", "input_hashes", "erlif_version", "identity")


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
        With the bare reason, the first one found.

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
        version = film.attrs.get("erlif_version", "unknown")
        raise ValueError(f"it was written by a later version of erlif, {version}")
    _check_variables(film, FILM)
    _read_small(film)
    for group in _TOGETHER:
        there = [name in film for name in group]
        if any(there) and not all(there):
            raise ValueError(f"it has no variable {group[there.index(False)]}")
    for name, needed in _NEEDED.items():
        for other in needed:
            if name in film and other not in film:
                raise ValueError(f"it has {name} and no variable {other}")

    if "speed_exponent" in film:
        for name in _SPEEDS:
            if name in film and not np.any(np.abs(film[name].values) > 0):
                raise ValueError(f"it has an exponent of the speed, and {name} is zero throughout")

    for axis in ("x", "y"):
        _check_axis(axis, film[axis].values)
    if not np.array_equal(film.trigger.values, np.arange(film.sizes["trigger"])):
        raise ValueError("its triggers are not numbered from 0")
    if "flag" in film and film.flag.values.tolist() != [flag.value for flag in Flag]:
        raise ValueError("its flags are not those of erlif")
    if "flagged_pixels" in film:
        pixels = film.sizes["y"] * film.sizes["x"]
        most = max(int(film[name].values.max()) for name in ("flagged_pixels", "valid_pixels"))
        if most > pixels:
            raise ValueError(f"it counts {most} pixels in maps of {pixels}")
    _check_film_attributes(film)


def check_frames(frames: xr.Dataset) -> None:
    """Refuse the group frames of a film; as `check_film`.

    Parameters
    ----------
    frames : xarray.Dataset

    Raises
    ------
    ValueError
        With the bare reason.
    """
    _check_variables(frames, FRAMES)
    _read_small(frames)


def check_registration(registration: xr.Dataset) -> None:
    """Refuse the group registration of a film; as `check_film`.

    Parameters
    ----------
    registration : xarray.Dataset

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
    dataset: xr.Dataset, forms: Mapping[str, _Form], *, values: bool = True
) -> None:
    for name, form in forms.items():
        if name not in dataset:
            if form.required:
                raise ValueError(f"it has no variable {name}")
            continue
        variable = dataset[name]
        if variable.dims != form.dims:
            raise ValueError(f"{name} has the dims {variable.dims}, not {form.dims}")
        if variable.dtype.kind not in form.kinds:
            raise ValueError(f"{name} has values of the type {variable.dtype}")
        if not all(variable.shape):
            raise ValueError(f"{name} has no values")
        unit = variable.attrs.get("units", form.unit)
        if form.unit and unit != form.unit:
            raise ValueError(f"{name} is in {_show(unit)}, not in {form.unit}")

        # maps are large, and read one by one where they are used
        if values and form.dims != _MAP and variable.dtype.kind in "iuf":
            values_read = variable.values
            if values_read.shape != tuple(dataset.sizes[dim] for dim in form.dims):
                raise ValueError(f"{name} has the shape {values_read.shape}")
            _check_values(name, form, values_read)


def _read_small(dataset: xr.Dataset) -> None:
    """Read what is no map once: a text in an unknown encoding fails here."""
    _check_encoding("", dataset.attrs)
    for name, variable in dataset.variables.items():
        _check_encoding(f" of {name}", variable.attrs)
        if variable.ndim < len(_MAP):
            _ = variable.values


def _check_encoding(where: str, attrs: Mapping[Any, Any]) -> None:
    """Refuse text that no file can hold: h5py returns bytes that are no UTF-8 as half a pair."""
    for key, value in attrs.items():
        if isinstance(value, str):
            try:
                value.encode()
            except UnicodeEncodeError:
                raise ValueError(f"its attribute {key!a}{where} is no text in UTF-8") from None


def _check_values(name: str, form: _Form, values: AnyArray) -> None:
    known = values[~np.isnan(values)]
    if form.known and not known.size:
        raise ValueError(f"{name} has no value that is a number")
    outside = (known < form.low) | (known > LARGEST_NUMBER)
    if outside.any():
        raise ValueError(f"{name} has the value {known[np.argmax(outside)]:g}")


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

    settings = read_settings(film.attrs["settings"])
    if settings.linkage is not None and "encoder_angle" in film and "rocker_speed" not in film:
        raise ValueError("it has a linkage and no variable rocker_speed")
    for name in ("calibration", "input_hashes"):
        record = _read_json(film.attrs.get(name, "{}"))
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
    if "film_theory" in film:
        for name in ("regime", "reason"):
            _expect_text(film.film_theory.attrs, name)
    if "attitude" in film:
        _expect_number(film.attitude.attrs, "load_line", "attitude")
    if "encoder_angle" in film:
        for name in ("zero", "zero_std"):
            _expect_number(film.encoder_angle.attrs, name, "encoder_angle", optional=True)


def _expect_text(attrs: Mapping[Any, Any], name: str) -> None:
    found = attrs.get(name)
    if not isinstance(found, str) or len(found) > LARGEST_TEXT:
        raise ValueError(f"its attribute {name} is {_show(found)}, not text")


def _expect_number(
    attrs: Mapping[Any, Any], name: str, variable: str, *, optional: bool = False
) -> None:
    found = attrs.get(name)
    if found is None and optional:
        return
    if not _is_number(found):
        raise ValueError(f"the attribute {name} of {variable} is {_show(found)}, not a number")


def _is_number(found: object) -> bool:
    """Whether an attribute is one real number, NaN included: what could not be fitted is NaN."""
    value = np.asarray(found)
    return value.size == 1 and value.dtype.kind in "iuf" and not np.isinf(value).any()


def _read_json(text: str) -> Any:
    try:
        return json.loads(text)
    except (ValueError, RecursionError):
        return None


def _show(found: object) -> str:
    """The start of a value, for a message."""
    return "missing" if found is None else repr(found)[:40]
