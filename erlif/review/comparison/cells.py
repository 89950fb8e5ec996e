"""Means of a map over cells of the surface, with their errors.

The noise of one pixel is several tenths of a micrometre. A mean over 8 x 8 pixels resolves what
matters and has an eighth of the noise.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import xarray as xr

from erlif.calibration import RunCurve
from erlif.core.arrays import Array
from erlif.core.errors import ErlifError

# Edge of a cell, in pixels of the coarser camera. Errors of the registration are common to it.
CELL = 8

_LEAST_SHARE = 0.25  # valid pixels of a cell, at least
_STEP = 1e-3  # um, for the derivative of the slope
_LEAST_OVERLAP = 2  # cells along either axis
_EDGE = 25.0  # variances; a squared difference of neighbours beyond it is no noise


@dataclass(frozen=True)
class CellMeans:
    """Means of one map over cells.

    Attributes
    ----------
    film : Array
        Mean film, NaN with too few valid pixels, (row, column). [um]
    own_var : Array
        Variance of what is not shared by the calibration: noise and registration. [um2]
    gradient : Array
        Change of the film with the parameters of the calibration, (row, column, parameter).
    count : Array
        Valid pixels, (row, column).
    """

    film: Array
    own_var: Array
    gradient: Array
    count: Array


def cell_edges(films: list[xr.Dataset], axis: str) -> Array:
    """Edges of cells that lie within all images along one axis. [mm]

    Parameters
    ----------
    films : list of Dataset
        With positions x and y [mm], from the first pixel of each image.
    axis : str
        "x" or "y".

    Returns
    -------
    array, (cell + 1,)

    Raises
    ------
    ErlifError
        If the images share less than two cells.

    Examples
    --------
    >>> one = xr.Dataset(coords={"x": 0.1 * np.arange(64)})
    >>> cell_edges([one, one], "x").round(2)[:3].tolist()
    [-0.05, 0.75, 1.55]
    """
    # positions may rise or fall
    places = [film[axis].values.astype(float) for film in films]
    pitches = [float(np.ptp(place)) / max(place.size - 1, 1) for place in places]
    pitch = max(pitches)
    low = max(float(place.min()) - p / 2 for place, p in zip(places, pitches, strict=True))
    high = min(float(place.max()) + p / 2 for place, p in zip(places, pitches, strict=True))
    # rounding must not cost a cell that fits exactly
    count = int((high - low) / (CELL * pitch) + 1e-6) if pitch > 0 else 0
    if count < _LEAST_OVERLAP:
        raise ErlifError(
            f"Expected images that share {_LEAST_OVERLAP} cells of {CELL} pixels along {axis}; "
            f"these share {max(high - low, 0.0):.2f} mm of pixels of {pitch:.3f} mm. Compare films "
            "of larger images."
        )
    return np.asarray(low + CELL * pitch * np.arange(count + 1))


def average_cells(
    film: xr.Dataset, trigger: int, calibration: RunCurve, edges: Mapping[str, Array]
) -> CellMeans:
    """Average the map of one trigger over cells.

    The mean of a noisy film is biased, because the inverse of the ratio is curved. The bias to
    second order, half the variance times the relative change of the slope, is taken out.

    Parameters
    ----------
    film : xarray.Dataset
    trigger : int
    calibration : RunCurve
        Of the film.
    edges : mapping of str to array
        Along x and y, as `cell_edges` returns them. [mm]

    Returns
    -------
    CellMeans

    Examples
    --------
    >>> from erlif.calibration import calibration_of
    >>> from erlif.show.plots import example_film
    >>> film = example_film()
    >>> edges = {axis: cell_edges([film], axis) for axis in ("x", "y")}
    >>> average_cells(film, 0, calibration_of(film), edges).film.shape
    (3, 8)
    """
    one = film.isel(trigger=trigger)
    value = one.thickness.values.astype(float)
    noise = one.thickness_std.values.astype(float) ** 2
    shared = one.thickness_std_shared.values.astype(float) ** 2
    valid = np.isfinite(value) & np.isfinite(noise)

    # cell of every pixel; those beyond the last edge have none
    row, column = (
        np.searchsorted(edges[axis], film[axis].values, side="right") - 1 for axis in ("y", "x")
    )
    shape = (edges["y"].size - 1, edges["x"].size - 1)
    inside = valid & ((row >= 0) & (row < shape[0]))[:, None]
    inside &= ((column >= 0) & (column < shape[1]))[None, :]
    place = (row[:, None] * shape[1] + column[None, :])[inside]

    def total(weights: Array | None = None) -> Array:
        found = np.bincount(place, weights, minlength=shape[0] * shape[1])
        return np.asarray(found.reshape(shape), float)

    count = total()
    pixels = np.outer(*(np.histogram(film[axis].values, edges[axis])[0] for axis in ("y", "x")))
    enough = (count >= _LEAST_SHARE * pixels) & (count > 0)
    count = np.where(enough, count, np.nan)
    mean = total(value[inside]) / count
    variance = total(noise[inside]) / count

    # bias of a pixel: half of h''(r) var(r), with h' = 1/s and h'' = -s'/s^3
    at = np.where(enough, mean, np.nanmean(mean) if enough.any() else 1.0)
    slope = calibration.slope(at)
    bend = (calibration.slope(at + _STEP) - calibration.slope(at - _STEP)) / (2 * _STEP)
    mean = mean + 0.5 * bend / slope * variance

    middles = (0.5 * (edges[axis][1:] + edges[axis][:-1]) for axis in ("y", "x"))
    down, right = np.meshgrid(*middles, indexing="ij")
    pitch = abs(float(film.x[1] - film.x[0]))
    middle = right / pitch, down / pitch
    gradient = np.moveaxis(calibration.film_gradient(at, place=middle), 0, -1)
    common = calibration.thickness_std(at) ** 2
    registration = np.maximum(total(shared[inside]) / count - common, 0.0)
    noise_var = noise_inflation(value, noise) * variance / count
    return CellMeans(mean, noise_var + registration, gradient, count)


def noise_inflation(value: Array, variance: Array) -> float:
    """Factor by which the variance of a mean exceeds that of independent pixels.

    The interpolation of camera 2 correlates neighbours, within two pixels. The mean square of the
    difference of neighbours, over that of pixels farther apart, is one less their correlation.

    Parameters
    ----------
    value : array, (y, x)
        Film, NaN where not valid. [um]
    variance : array, (y, x)
        Random variance of a pixel. [um2]

    Returns
    -------
    float
        At least 1.

    Examples
    --------
    >>> rng = np.random.default_rng(1)
    >>> white = rng.standard_normal((400, 401))
    >>> round(noise_inflation(white, np.ones_like(white)), 1)
    1.0
    >>> smooth = (white[:, 1:] + white[:, :-1]) / 2**0.5
    >>> round(noise_inflation(smooth, np.ones_like(smooth)), 1)
    2.0
    """
    far = 0.5 * (_squared_steps(value, variance, 2, 2) + _squared_steps(value, variance, 2, -2))
    if not far > 0:
        return 1.0
    lags = ((0, 1), (1, 0), (1, 1), (1, -1), (0, 2), (2, 0))
    correlation = [1 - _squared_steps(value, variance, dy, dx) / far for dy, dx in lags]
    return max(1.0, 1 + 2 * float(np.nansum(correlation)))


def _squared_steps(value: Array, variance: Array, dy: int, dx: int) -> float:
    """Mean square of the difference of pixels at a distance, in units of their variance."""
    (lower, upper), (lower_var, upper_var) = _shifted(value, dy, dx), _shifted(variance, dy, dx)
    step = (upper - lower) / np.sqrt(lower_var + upper_var)

    # edges of scratches and dust are no noise; the slope of the gap is that of rows and columns
    step = np.where(step**2 < _EDGE, step, np.nan)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # rows without a valid pixel
        step = step - np.nanmean(step, axis=0)
        step = step - np.nanmean(step, axis=1)[:, None]
        return float(np.nanmean(step**2))


def _shifted(image: Array, dy: int, dx: int) -> tuple[Array, Array]:
    """An image and its neighbour, cut to the pixels that have one."""
    rows, columns = image.shape
    if dx < 0:
        return image[: rows - dy, -dx:], image[dy:, : columns + dx]
    return image[: rows - dy, : columns - dx], image[dy:, dx:]
