"""A small film, stored beside this module, for the examples of the documentation.

It follows from formulas: a joint after Farzaneh (2002) whose minimum film grows with the speed to
the power of 0.6, the rigid gap of two cylinders with noise, a bubble and an edge without overlap.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import xarray as xr

from erlif.calibration import Calibration, calibration_of
from erlif.core.flags import FLAG_ATTRS
from erlif.io.files import open_netcdf, write_dataset

_STORED = Path(__file__).with_name("example.nc")


@cache
def _read(group: str) -> xr.Dataset:
    with open_netcdf(_STORED, group=group) as stored:
        return stored.load().drop_encoding()


def _copy(group: str) -> xr.Dataset:
    """A product that the caller may change."""
    return _read(group).copy(deep=True)


def example_calibration() -> Calibration:
    """Make a calibration whose points lie on the reabsorption model.

    Returns
    -------
    Calibration
        Of a wedge from 0.3 um to 16 um, with 20 points.

    Examples
    --------
    The ratio of a vanishing film is K:

    >>> calibration = example_calibration()
    >>> float(calibration.predict(1e-9).round(4))
    0.66
    """
    return Calibration.from_dataset(_copy("calibration"))


def example_film() -> xr.Dataset:
    """Make a film of six triggers, with noise, a bubble and an edge that camera 2 does not see.

    Returns
    -------
    xarray.Dataset
        As `erlif.process` returns it, thickness (trigger, y, x) [um] among its variables.

    Examples
    --------
    The minimum film thickness is 2 um at 1 rad/s and grows with the speed to the power of 0.6:

    >>> film = example_film()
    >>> speed = abs(film.rocker_speed)
    >>> bool(abs(film.film_min / (2 * speed**0.6) - 1).max() < 1e-12)
    True
    """
    return _copy("film")


def example_images(film: xr.Dataset, *, trigger: int) -> xr.Dataset:
    """Make the images behind a map, in even light of 1000 DN on camera 1.

    Parameters
    ----------
    film : xarray.Dataset
        From `example_film`.
    trigger : int
        Number of the trigger, counted from 0.

    Returns
    -------
    xarray.Dataset
        As `erlif.pipeline.restore_images` returns it: light (camera, y, x) [DN], log_ratio (y, x)
        [1], flags (y, x).

    Examples
    --------
    >>> images = example_images(example_film(), trigger=2)
    >>> images.light.dims, images.light.attrs["units"]
    (('camera', 'y', 'x'), 'DN')
    """
    one = film.isel(trigger=trigger)
    log_ratio = calibration_of(film).predict_log(one.thickness.values.astype(float))
    light = 1000.0 * np.stack([np.ones_like(log_ratio), np.exp(log_ratio)])
    return xr.Dataset(
        {
            "light": (("camera", "y", "x"), light, {"units": "DN"}),
            "log_ratio": (("y", "x"), log_ratio, {"units": "1"}),
            "flags": (("y", "x"), one.flags.values, FLAG_ATTRS),
        },
        {"camera": [1, 2], "x": film.x, "y": film.y},
        {"trigger": trigger, "frames": [trigger]},
    )


def example_registration() -> xr.Dataset:
    """Make a displacement map of two cameras that are turned by 5 mrad against each other.

    Returns
    -------
    xarray.Dataset
        Group ``registration`` of a film: displacement_x and displacement_y (y, x) [px].

    Examples
    --------
    >>> registration = example_registration()
    >>> float(registration.displacement_x.mean().round(3))
    3.0
    """
    return _copy("registration")


def example_frames() -> xr.Dataset:
    """Make the drift and the predicted film of the frames, one frame a trigger.

    Returns
    -------
    xarray.Dataset
        Group ``frames`` of a film: drift_x and drift_y (frame) [px], film_predicted_min [um] and
        elapsed_cycles.

    Examples
    --------
    >>> frames = example_frames()
    >>> frames.drift_x.values.tolist()
    [0.1, -0.1, 0.1, -0.1, 0.1, -0.1]
    """
    return _copy("frames")


def write_example(path: str | Path) -> Path:
    """Write the film of `example_film` with its groups.

    Parameters
    ----------
    path : path
        The file, with the suffix ``.nc``.

    Returns
    -------
    Path
        That of the film.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> from erlif.io.files import open_film, settings_of
    >>> with TemporaryDirectory() as directory:
    ...     with open_film(write_example(f"{directory}/film.nc")) as film:
    ...         settings_of(film).name
    'example'
    """
    path = Path(path)
    groups = {"registration": example_registration(), "frames": example_frames()}
    write_dataset(example_film(), path, groups=groups)
    return path


def example_pressure() -> xr.Dataset:
    """Make a pressure of three triggers by the formula of a squeezed long film.

    Returns
    -------
    xarray.Dataset
        The variables of `erlif.pressure_from_film` that figures draw.

    Examples
    --------
    A film of 6 um under 50 lbf:

    >>> print(f"{example_pressure().peak_pressure.values[1]:.0f} kPa")
    78 kPa
    """
    return _copy("pressure")
