"""Standard deviation of one pixel against thickness, and the range in which it measures."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
from scipy.special import hyp1f1

from erlif.calibration import DIM_LIGHT, USEFUL
from erlif.core.arrays import Array
from erlif.planning.design import Design, log_ratio, log_ratio_slope, signal
from erlif.thickness import CLEAR

# Mean variance of a pixel of camera 2 after the cubic spline has laid it on the pixels of camera 1,
# over all sub-pixel positions: of 1 - 3 q^2 - (14 - 6 sqrt(3)) q^3 with q = f (1 - f) along x and
# y, 0.764. Neighbouring pixels are then correlated, so means over pixels do not gain from it.
INTERPOLATION = (1.0 - 1 / 10 - (14 - 6 * math.sqrt(3)) / 140) ** 2

# Signal below which a pixel is flagged dim by default. [electron]
LEAST_SIGNAL = 100.0

_GRID = 200  # films at which the ends of a range are looked for


@dataclass(frozen=True)
class WantedFilm:
    """The films to be measured, and how.

    Attributes
    ----------
    thinnest : float
        Thinnest film that is wanted. [um]
    thickest : float
        Thickest film that is wanted. [um]
    covered : tuple[float, float]
        Ends of the range that the calibration fixture covers. [um]
    frames : int
        Frame pairs of one map.
    average : int
        Side of the squares of pixels over which the map is averaged. [px]
    """

    thinnest: float
    thickest: float
    covered: tuple[float, float]
    frames: int = 1
    average: int = 1


def log_ratio_variance(
    design: Design, thickness: npt.ArrayLike, *, average: int = 1
) -> tuple[Array, Array]:
    """Variance of the logarithm of the ratio of one pixel, in the mean over the field.

    Both cameras are equally sharp; a blur of the sharper one lowers its noise.

    Parameters
    ----------
    design : Design
        Its light falls from the middle of the field to the corners.
    thickness : array_like
        Film thickness. [um]
    average : int
        Side of the squares of pixels over which the map is averaged. [px]

    Returns
    -------
    (array, array)
        Part that is new in every frame (photons, reading, rounding), and part that stays the same
        (the noise of dark and flat pages). [1]

    Examples
    --------
    >>> from erlif.planning.design import example_dye_design
    >>> new, fixed = log_ratio_variance(example_dye_design(), 5.0)
    >>> round(float(np.sqrt(new)), 4), round(float(np.sqrt(fixed)), 4)
    (0.0142, 0.0041)
    """
    new, fixed = np.zeros(()), np.zeros(())
    pages = design.references
    for number, camera in enumerate(design.cameras, start=1):
        electrons = signal(design, number, thickness)
        reading = camera.read_noise**2 + camera.gain**2 / 12
        smoothed = INTERPOLATION if number == 2 and average == 1 else 1.0
        share = smoothed / average**2

        photons = _mean_inverse(design.corner, 1) / electrons
        noise = _mean_inverse(design.corner, 2) * reading / electrons**2
        new = new + share * (photons + noise)
        fixed = fixed + share * noise / pages.dark_pages
        if pages.flat_pages:
            collected = pages.flat_pages * pages.flat_level * camera.full_scale
            fixed = fixed + share / collected
    return np.asarray(new), np.asarray(fixed)


def _mean_inverse(corner: float, power: int) -> float:
    """Mean over a square field of light^-power, for a Gaussian beam of 1 in its middle.

    The light is corner^(r^2/R^2), which is the same function along both sides.
    """
    return float(hyp1f1(0.5, 1.5, -0.5 * power * math.log(corner))) ** 2


def thickness_std(
    design: Design, thickness: npt.ArrayLike, *, frames: int = 1, average: int = 1
) -> Array:
    """Standard deviation of the film of one pixel, root mean square over the field.

    Photons, reading and rounding, dark and flat pages, and interpolation are included; the error
    of the calibration and of the registration are not.

    Parameters
    ----------
    design : Design
    thickness : array_like
        Film thickness. [um]
    frames : int
        Frame pairs that are averaged.
    average : int
        Side of the squares of pixels over which the map is averaged. [px]

    Returns
    -------
    array
        Infinite where the ratio does not rise with thickness. [um]

    Examples
    --------
    >>> from erlif.planning.design import example_dye_design
    >>> thickness_std(example_dye_design(), [2.0, 8.0]).round(2)
    array([0.32, 0.61])
    """
    new, fixed = log_ratio_variance(design, thickness, average=average)
    slope = log_ratio_slope(design, thickness)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        std = np.sqrt(new / frames + fixed) / slope
    return np.where(slope > 0, std, np.inf)


def frames_needed(
    design: Design, thickness: npt.ArrayLike, uncertainty: npt.ArrayLike, *, average: int = 1
) -> Array:
    """Frame pairs with which a pixel reaches a wanted standard deviation.

    Parameters
    ----------
    design : Design
    thickness : array_like
        Film thickness. [um]
    uncertainty : array_like
        Standard deviation wanted at these films. [um]
    average : int
        Side of the squares of pixels over which the map is averaged. [px]

    Returns
    -------
    array
        Whole numbers; infinite where dark and flat pages alone exceed the wanted value, and where a
        camera saturates. [1]

    Examples
    --------
    >>> from erlif.planning.design import example_dye_design
    >>> frames_needed(example_dye_design(), [3.0, 3.0], [0.15, 0.01])
    array([ 7., inf])
    """
    new, fixed = log_ratio_variance(design, thickness, average=average)
    slope = log_ratio_slope(design, thickness)
    left = (np.asarray(uncertainty, float) * slope) ** 2 - fixed
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        needed = np.ceil(new / left)
    reached = (left > 0) & (slope > 0) & (_filled(design, thickness) <= 1)
    return np.where(reached, np.maximum(needed, 1.0), np.inf)


def _filled(design: Design, thickness: npt.ArrayLike) -> Array:
    """Largest signal of a film [um] over the full scale of its camera. [1]"""
    cameras = enumerate(design.cameras, start=1)
    filled = [signal(design, n, thickness) / camera.full_scale for n, camera in cameras]
    return np.asarray(np.max(filled, axis=0))


def calibrated_range(design: Design, film: WantedFilm) -> tuple[float, float]:
    """Range in which the calibration of this design would hold.

    The fixture covers it, and the noise of one pixel of one frame leaves a thickness: it ends where
    the standard deviation exceeds a quarter of the film, as in `erlif.calibration`.

    Parameters
    ----------
    design : Design
    film : WantedFilm

    Returns
    -------
    (float, float)
        [um]

    Examples
    --------
    >>> from erlif.planning.design import example_dye_design
    >>> low, high = calibrated_range(example_dye_design(), WantedFilm(1.0, 10.0, (0.1, 18.0)))
    >>> low, round(high)
    (0.1, 17)
    """
    low, high = film.covered
    grid = np.linspace(low, high, _GRID + 1)[1:]
    relative = thickness_std(design, grid) / grid
    limit = max(USEFUL, DIM_LIGHT * float(relative.min()))
    last = float(grid[relative <= limit][-1])
    if last == grid[-1]:
        return low, high

    def useful(thickness: Array) -> npt.NDArray[np.bool_]:
        return np.asarray(thickness_std(design, thickness) / thickness <= limit)

    return low, _end_of_condition(useful, last, last + grid[1] - grid[0])


def measurable_range(design: Design, film: WantedFilm) -> tuple[float, float]:
    """Range in which one pixel is valid, by the rules of `erlif.thickness`.

    The film lies within the calibrated range and two standard deviations of its ratio from the ends
    of what the fixture covers, and no camera is dim or saturated.

    Parameters
    ----------
    design : Design
    film : WantedFilm
        `frames` and `covered` are used.

    Returns
    -------
    (float, float)
        NaN where no film is measurable. [um]

    Examples
    --------
    >>> from erlif.planning.design import example_dye_design
    >>> low, high = measurable_range(example_dye_design(), WantedFilm(1.0, 10.0, (0.1, 18.0)))
    >>> round(low, 1), round(high)
    (0.8, 13)
    """
    low, high = calibrated_range(design, film)
    thinnest, thickest = log_ratio(design, np.maximum(film.covered, 1e-9))

    def is_valid(thickness: Array) -> npt.NDArray[np.bool_]:
        new, fixed = log_ratio_variance(design, thickness)
        margin = CLEAR * np.sqrt(new / film.frames + fixed)
        value = log_ratio(design, thickness)
        valid = (value - margin >= thinnest) & (value + margin <= thickest)
        valid &= _filled(design, thickness) <= 1
        for number in (1, 2):
            valid &= signal(design, number, thickness) >= LEAST_SIGNAL
        return np.asarray(valid)

    grid = np.geomspace(max(low, high * 1e-4), high, _GRID)
    inside = np.flatnonzero(is_valid(grid))
    if not inside.size:
        return math.nan, math.nan
    first, last = inside[[0, -1]]
    return (
        _end_of_condition(is_valid, grid[first], grid[max(first - 1, 0)]),
        _end_of_condition(is_valid, grid[last], grid[min(last + 1, _GRID - 1)]),
    )


def _end_of_condition(
    holds: Callable[[Array], npt.NDArray[np.bool_]], inside: float, outside: float
) -> float:
    """Thickness between two neighbours of a grid at which a condition ends. [um]"""
    films = np.linspace(inside, outside, _GRID)
    return float(films[max(np.flatnonzero(holds(films)), default=0)])


def dimmed_to_full_scale(design: Design, thickest: float, fill: float) -> Design:
    """Lower the pulse energy so that the thickest film fills a camera no more than `fill`.

    Parameters
    ----------
    design : Design
    thickest : float
        Thickest film. [um]
    fill : float
        Largest mean signal, share of full scale. [1]

    Returns
    -------
    Design

    Examples
    --------
    >>> from erlif.planning.design import example_dye_design
    >>> round(dimmed_to_full_scale(example_dye_design(), 20.0, 0.3).energy, 2)
    0.47
    """
    filled = float(_filled(design, thickest))
    return replace(design, energy=design.energy * min(1.0, fill / filled))
