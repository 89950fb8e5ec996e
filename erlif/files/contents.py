"""What is read from a film: its settings, its region of interest, its triggers."""

from __future__ import annotations

import tomllib

import numpy as np
import xarray as xr

from erlif.core.errors import ErlifError, OutputError
from erlif.settings import RegionOfInterest, RunSettings


def settings_of(film: xr.Dataset) -> RunSettings:
    """The settings that a film was made with; raises OutputError where the film does not hold them."""
    if "settings" not in film.attrs:
        raise OutputError(
            "Expected the settings among the attributes of the film, as erlif process writes them; there are none."
        )
    return RunSettings.model_validate(tomllib.loads(str(film.attrs["settings"])))


def region_of(film: xr.Dataset) -> RegionOfInterest:
    """Region of interest of a film in mm; the whole image where none was set."""
    chosen = settings_of(film).thickness.roi
    if chosen is not None:
        return chosen
    x, y = film.x.values, film.y.values
    return RegionOfInterest(x=(float(x[0]), float(x[-1])), y=(float(y[0]), float(y[-1])))


def check_trigger(film: xr.Dataset, trigger: int) -> None:
    """Raise ErlifError if the film has no such trigger."""
    count = film.sizes["trigger"]
    if not 0 <= trigger < count:
        raise ErlifError(
            f"Expected a trigger from 0 to {count - 1}, as many as the film has; got {trigger}."
        )


def fastest_trigger(film: xr.Dataset) -> int:
    """The outward trigger of highest speed, the example where one is shown for all."""
    speed = np.abs(film.rocker_speed.values)
    outward = np.where(film.stroke.values > 0, speed, -1.0)
    return int(np.argmax(outward if (outward >= 0).any() else speed))


def describe_trigger(film: xr.Dataset, trigger: int) -> str:
    """One line that says which trigger is seen."""
    one = film.isel(trigger=trigger)
    stroke = "outward" if float(one.stroke) > 0 else "return"
    return f"trigger {trigger}, {float(one.encoder_angle):.2f}°, {stroke}, {abs(float(one.rocker_speed)):.2f} rad/s"
