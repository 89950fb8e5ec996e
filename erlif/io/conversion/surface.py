"""Where the pixels of a film lie in space: on the cylinder of the pin, or on a plane."""

from __future__ import annotations

import numpy as np
import xarray as xr

from erlif.core.arrays import Array
from erlif.core.errors import ConfigError
from erlif.io.files import settings_of

# Kinds of motion whose surfaces are flat, whatever [joint] states.
_FLAT = ("sinusoidal",)


def find_surface(film: xr.Dataset) -> Array:
    """Place the pixels on the surface that they show.

    With [joint], positions along sliding are arcs on a cylinder of the radius of the pin, whose
    axis passes through the origin; the load line (that of the settings, else of the positions of
    the pin, else the middle of the image) is at the top, where Z is the radius. Without [joint] the
    surface is the plane Z = 0. Seen from above, the surface looks as in the camera: X to the right,
    Y up, so that Y is -y.

    Parameters
    ----------
    film : xarray.Dataset
        As `erlif.open_film` returns it; the radius is that of its settings.

    Returns
    -------
    array, (y, x, 3)
        X, Y and Z of the pixel centres. [mm]

    Raises
    ------
    ConfigError
        If the image is longer than the circumference of the pin.

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> points = find_surface(example_film())
    >>> float(np.hypot(points[..., 0], points[..., 2]).max().round(6))
    33.36
    """
    settings = settings_of(film)
    x, y = np.broadcast_arrays(film.x.values, -film.y.values[:, None])
    flat = settings.linkage is not None and settings.linkage.kind in _FLAT
    if settings.joint is None or flat:
        return np.stack([x, y, np.zeros_like(x)], axis=-1)

    # the direction along the axis keeps its place, the other is wound up
    radius = settings.joint.pin_radius * 1e3
    along_x = settings.optics.x_axis == "sliding"
    sliding = (x if along_x else -y).astype(float)
    length = float(sliding.max() - sliding.min())
    if length > 2 * np.pi * radius:
        raise ConfigError(
            "Expected an image no longer than the circumference of the pin, "
            f"{2 * np.pi * radius:.1f} mm; it is {length:.1f} mm along sliding. Correct "
            "pixel_pitch in [optics] or pin_radius in [joint], and process the run again."
        )
    # the load line is measured from the first pixel of the camera, also where the film is cropped
    line = 0.5 * float(sliding.max() + sliding.min())
    if settings.prediction.load_line is not None:
        line = settings.prediction.load_line * 1e3
    elif "pin_displacement" in film:
        line = film.pin_displacement.attrs.get("load_line", line)
    angle = (sliding - line) / radius
    wound, height = radius * np.sin(angle), radius * np.cos(angle)
    return np.stack([wound, y, height] if along_x else [x, -wound, height], axis=-1)
