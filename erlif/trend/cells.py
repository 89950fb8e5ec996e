"""The coarse cells of an image whose light is compared with that of their film."""

from __future__ import annotations

import numpy as np

from erlif.calibration import RatioCurve
from erlif.core.arrays import Array, Mask

# Frames of an estimate from the light of a run, at least.
FEWEST_FRAMES = 12

_FEWEST_CELLS = 24  # cells of a frame, at least; a surface through its films has six coefficients
FEWEST_VISITS = 6  # frames in which a cell must be measured
_THINNEST = 1.0  # um: below it the response of a film to its light is steep and not linear

# Share of the covered range; the noise of a cell with a thicker film may reach beyond it, and a
# choice that depends on the noise would bias what is estimated.
_THICKEST = 0.8
_PATTERNS = 2.0  # standard deviations of a pattern that stay within the range


def choosable_films(calibration: RatioCurve, pattern: float = 0.0) -> tuple[float, float]:
    """Films between which a cell is chosen: from 1 um to 0.8 of the covered range. [um]

    A pattern of the ratio of this size [1] lifts pixels of thick films beyond the range, and the
    mean of those left is too thin: two standard deviations of it end within the range.
    """
    low = max(calibration.thickness_range[0], _THINNEST)
    table = calibration.inverse
    end = calibration.predict_log(calibration.thickness_range[1])
    inside = float(table.look_up(end - _PATTERNS * pattern))
    return low, min(_THICKEST * float(table.thickness[-1]), inside)


def choose_cells(
    film: Array, measured: Mask, calibration: RatioCurve, pattern: float = 0.0
) -> Mask:
    """Choose the cells of each frame whose light can be compared with that of their film.

    Parameters
    ----------
    film : array, (frame, cell)
        [um]
    measured : array of bool, (frame, cell)
        Whether light and film are known.
    calibration : RatioCurve
    pattern : float
        Standard deviation of what stands still in the ratio of the pixels. [1]

    Returns
    -------
    array of bool, (frame, cell)
        Films of `choosable_films`, of frames with 24 cells and of cells with 6 frames at least.

    Examples
    --------
    >>> import numpy as np
    >>> from erlif.show.plots import example_calibration
    >>> film = np.full((8, 30), 4.0)
    >>> film[:, 0] = 0.5
    >>> chosen = choose_cells(film, np.ones(film.shape, bool), example_calibration())
    >>> int(chosen.sum())
    232
    """
    low, high = choosable_films(calibration, pattern)
    usable: Mask = measured & (film > low) & (film < high)
    usable &= (usable.sum(axis=1) >= _FEWEST_CELLS)[:, None]
    usable &= usable.sum(axis=0) >= FEWEST_VISITS
    return usable


def separate_light(light: Array, chosen: Mask) -> Array:
    """Part of each cell in logarithms of light, beside a part of each frame.

    Parameters
    ----------
    light : array, (frame, cell)
        [1]
    chosen : array of bool, (frame, cell)
        What is used.

    Returns
    -------
    array, (cell,)
        By ten rounds of means, a start for a search. The parts of the frames have the mean zero.

    Examples
    --------
    >>> light = np.array([[0.1], [-0.1]]) + np.array([1.0, 2.0, 3.0])
    >>> separate_light(light, np.ones((2, 3), bool))
    array([1., 2., 3.])
    """
    cells, frames = (np.maximum(chosen.sum(axis=axis), 1) for axis in (0, 1))
    energies = np.zeros(len(light))
    illumination = np.zeros(light.shape[1])
    for _ in range(10):
        illumination = (chosen * (light - energies[:, None])).sum(axis=0) / cells
        energies = (chosen * (light - illumination)).sum(axis=1) / frames
        energies -= energies.mean()
    return illumination
