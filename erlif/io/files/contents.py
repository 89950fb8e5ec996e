"""Contents of a film: its settings, region of interest, and triggers."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from erlif.core.arrays import Array
from erlif.core.errors import ErlifError, OutputError
from erlif.core.flags import Flag, count_flags
from erlif.io.files.film import open_film
from erlif.io.files.soundness import read_settings
from erlif.io.files.wanted import takes
from erlif.io.settings import RegionOfInterest, RunSettings
from erlif.models.film import HAMROCK_DOWSON_LINE


@takes(film="part of a film")
def settings_of(film: xr.Dataset) -> RunSettings:
    """Read the settings that a film was made with.

    Parameters
    ----------
    film : Dataset
        Result of `erlif.process`.

    Returns
    -------
    RunSettings

    Raises
    ------
    OutputError
        If the film does not hold them.

    Examples
    --------
    >>> settings_of(xr.Dataset())  # doctest: +ELLIPSIS
    Traceback (most recent call last):
        ...
    erlif.core.errors.OutputError: Expected the settings among the attributes of the film, ...
    """
    try:
        return read_settings(str(film.attrs["settings"]))
    except (KeyError, ValueError) as error:
        reason = "there are none" if isinstance(error, KeyError) else error
        raise OutputError(
            "Expected the settings among the attributes of the film, as erlif process writes them; "
            f"{reason}. Make the film again with: erlif process RUN_DIR"
        ) from error


@takes(film="part of a film")
def motion_of(film: xr.Dataset) -> str:
    """Read the kind of [mechanism] in the settings of a film.

    Argument and errors as in `settings_of`.

    Returns
    -------
    str
        "crank-rocker", "slider-crank", "rotation" or "sinusoidal"; empty without [mechanism].

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> motion_of(example_film())
    'crank-rocker'
    """
    mechanism = settings_of(film).mechanism
    return "" if mechanism is None else mechanism.kind


def driven_link(film: xr.Dataset) -> str:
    """Name what turns by the crank angle of a film: crank, disc, or drive of a slider.

    Argument as in `settings_of`; part of a film without settings has a crank.

    Returns
    -------
    str
        "crank", "disc" or "drive".

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> driven_link(example_film())
    'crank'
    """
    motion = motion_of(film) if "settings" in film.attrs else ""
    return {"rotation": "disc", "sinusoidal": "drive"}.get(motion, "crank")


@takes(film="part of a film")
def region_of(film: xr.Dataset) -> RegionOfInterest:
    """Read the region of interest of a film.

    Argument and errors as in `settings_of`.

    Returns
    -------
    RegionOfInterest
        Intervals of x and y; the whole image where the settings have no region. [mm]

    Examples
    --------
    >>> region_of(xr.Dataset())  # doctest: +ELLIPSIS
    Traceback (most recent call last):
        ...
    erlif.core.errors.OutputError: Expected the settings among the attributes of the film, ...
    """
    chosen = settings_of(film).thickness.roi
    if chosen is not None:
        return chosen
    x, y = film.x.values, film.y.values
    return RegionOfInterest(x=(float(x[0]), float(x[-1])), y=(float(y[0]), float(y[-1])))


@takes(film="part of a film")
def axis_labels(film: xr.Dataset) -> tuple[str, str]:
    """Labels of x and y of an image, with their directions unless nothing moves.

    Argument and errors as in `settings_of`.

    Returns
    -------
    tuple of str
        Label of x and of y, with the unit.

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> axis_labels(example_film())
    ('x (sliding) [mm]', 'y (axial) [mm]')
    """
    settings = settings_of(film)
    if settings.mechanism is None and "sliding_speed" not in film:
        return "x [mm]", "y [mm]"
    across = "axial" if settings.linkage is not None or settings.joint is not None else "across"
    along_x = settings.optics.x_axis == "sliding"
    x, y = ("sliding", across) if along_x else (across, "sliding")
    return f"x ({x}) [mm]", f"y ({y}) [mm]"


@takes(film="part of a film")
def check_trigger(film: xr.Dataset, trigger: int) -> None:
    """Refuse a trigger that a film does not have.

    Parameters
    ----------
    film : Dataset
        With dim trigger.
    trigger : int
        Number of the trigger, from 0.

    Raises
    ------
    ErlifError
        If there is no such trigger, or if it is no whole number.

    Examples
    --------
    >>> film = xr.Dataset({"joint_load": ("trigger", [220.0, 230.0])})
    >>> check_trigger(film, 1)
    >>> check_trigger(film, 2)
    Traceback (most recent call last):
        ...
    erlif.core.errors.ErlifError: Expected a trigger from 0 to 1, as many as the film has; got 2. \
Choose one of them.
    """
    count = film.sizes["trigger"]
    number = np.asarray(trigger)  # that of a coordinate, too
    if number.ndim or not np.issubdtype(number.dtype, np.integer):
        raise ErlifError(
            f"Expected the number of a trigger, from 0 to {count - 1}; got {trigger!r}. Give a "
            "number; erlif.io.conversion.choose_trigger(film, crank_angle=90) finds that of an "
            "angle."
        )
    if not 0 <= trigger < count:
        raise ErlifError(
            f"Expected a trigger from 0 to {count - 1}, as many as the film has; got {trigger}. "
            "Choose one of them."
        )


@takes(film="part of a film")
def fastest_trigger(film: xr.Dataset) -> int:
    """Find the trigger that stands as an example for all: the fastest of the outward stroke.

    Parameters
    ----------
    film : Dataset
        With rocker_speed or sliding_speed, and stroke (trigger), where the motion is known.

    Returns
    -------
    int
        Number of the trigger; the fastest of all where there is no outward stroke, the first where
        there is no speed.

    Examples
    --------
    >>> film = xr.Dataset(
    ...     {"rocker_speed": ("trigger", [1.0, 2.0, -3.0]), "stroke": ("trigger", [1, 1, -1])}
    ... )
    >>> fastest_trigger(film)
    1
    """
    name = "rocker_speed" if "rocker_speed" in film else "sliding_speed"
    if name not in film:
        return 0
    speed = np.abs(film[name].values)
    if "stroke" not in film:
        return int(np.argmax(speed))
    outward = np.where(film.stroke.values > 0, speed, -1.0)
    return int(np.argmax(outward if (outward >= 0).any() else speed))


@takes(film="part of a film")
def describe_trigger(film: xr.Dataset, trigger: int) -> str:
    """Describe a trigger in one line: angle or time, stroke and speed, as far as they are known.

    Arguments as in `check_trigger`. The angle is that of the crank, the disc or the drive, or of
    the encoder where there is none.

    Returns
    -------
    str

    Examples
    --------
    >>> film = xr.Dataset(
    ...     {
    ...         "crank_angle": ("trigger", [75.0]),
    ...         "encoder_angle": ("trigger", [12.5]),
    ...         "rocker_speed": ("trigger", [-2.5]),
    ...         "stroke": ("trigger", [-1]),
    ...     }
    ... )
    >>> describe_trigger(film, 0)
    'trigger 0, crank 75.00°, return, 2.50 rad/s'
    >>> describe_trigger(film.drop_vars("crank_angle"), 0)
    'trigger 0, encoder 12.50°, return, 2.50 rad/s'
    >>> describe_trigger(xr.Dataset({"sliding_speed": ("trigger", [0.25])}), 0)
    'trigger 0, 250 mm/s'
    """
    one = film.isel(trigger=trigger)
    parts = [f"trigger {trigger}"]
    if "crank_angle" in one:
        parts.append(f"{driven_link(film)} {float(one.crank_angle):.2f}°")
    elif "encoder_angle" in one:
        parts.append(f"encoder {float(one.encoder_angle):.2f}°")
    elif "time" in one:
        parts.append(f"{float(one.time):.3f} s")

    if "stroke" in one:
        parts.append("outward" if float(one.stroke) > 0 else "return")
    if "rocker_speed" in one:
        parts.append(f"{abs(float(one.rocker_speed)):.2f} rad/s")
    elif "sliding_speed" in one:
        parts.append(f"{1e3 * float(one.sliding_speed):.3g} mm/s")
    return ", ".join(parts)


def applicable_theory(film: xr.Dataset) -> xr.DataArray | None:
    """Choose the theory of the minimum film that applies to the motion of the joint.

    Parameters
    ----------
    film : Dataset
        Result of `erlif.process`.

    Returns
    -------
    DataArray or None
        film_predicted_min (trigger) of a joint that swings, else film_theory, with regime, reason
        and notes as attributes; None where the film has neither. [um]

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> applicable_theory(example_film().drop_vars("film_predicted_min")).attrs["regime"]
    'isoviscous-rigid'
    """
    names = ("film_predicted_min", "film_theory")
    return next((film[name] for name in names if name in film), None)


@takes(film="part of a film")
def formula_label(film: xr.Dataset) -> str:
    """Name of the formula behind film_hamrock_dowson: line contact (2.65), or elliptical.

    Parameters
    ----------
    film : Dataset
        With film_hamrock_dowson.

    Returns
    -------
    str

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> formula_label(example_film())
    'Hamrock-Dowson, line contact (2.65)'
    """
    # films of before the formula was stated are those of a line contact
    attrs = film.film_hamrock_dowson.attrs
    return str(attrs["long_name"]) if "formula" in attrs else HAMROCK_DOWSON_LINE


def formula_scope(attrs: Mapping[str, Any]) -> str:
    """Why a formula does not hold for a film: its regime, or a bore that is not straight.

    Parameters
    ----------
    attrs : mapping
        Of a ratio to the formula.

    Returns
    -------
    str
        Empty where it holds, or no error of the formula is known.

    Examples
    --------
    >>> formula_scope({"formula_error": float("inf")}), formula_scope({"formula_error": 0.2})
    ('not its regime', '')
    """
    outside = math.isinf(attrs.get("formula_error", 0.0))
    return str(attrs.get("formula_of", "not its regime")) if outside else ""


def shows_plateau(film: xr.Dataset) -> bool:
    """Whether a film is that of an elastic contact, whose central film differs from the minimum.

    Parameters
    ----------
    film : Dataset

    Returns
    -------
    bool

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> shows_plateau(example_film())
    False
    """
    return film.attrs.get("contact") == "plateau" and "film_central" in film


@takes(film="part of a film")
def flag_shares(film: xr.Dataset) -> Array:
    """Share of valid pixels and of each flag in every map.

    Parameters
    ----------
    film : Dataset
        As `open_film` returns it.

    Returns
    -------
    array, (trigger, 1 + flag)
        Valid pixels first, then the flags in the order of `erlif.core.flags.Flag`. [1]

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> shares = flag_shares(example_film())
    >>> shares.shape[1], bool(0 < shares[0, 0] <= 1)
    (11, True)
    """
    if film.sizes.get("flag") == len(Flag):
        counts = np.column_stack([film.valid_pixels.values, film.flagged_pixels.values])
    else:  # map by map, because all maps of a long run do not fit into memory
        triggers = range(film.sizes["trigger"])
        counts = np.array([count_flags(film.flags.isel(trigger=k).values) for k in triggers])
    return np.asarray(counts / (film.sizes["y"] * film.sizes["x"]))


def has_identity(path: Path, identity: str) -> bool:
    """Check whether a file is the film of a piece of work.

    Parameters
    ----------
    path : Path
        ``film.nc`` or ``film.zarr``; it need not exist.
    identity : str
        Identity of the work, as the attribute of the same name holds it.

    Returns
    -------
    bool
        False also for a file that is no film.

    Examples
    --------
    >>> has_identity(Path("no such film.nc"), "5a")
    False
    """
    if not path.exists():
        return False
    try:
        with open_film(path) as film:
            return film.attrs.get("identity") == identity
    except OutputError:
        return False
