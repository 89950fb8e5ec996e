"""Films beyond the maximum of the ratio, which look like thinner ones.

Before a wall that reflects, the ratio has a maximum. Films beyond it have the ratio of thinner
ones, and both are so thick that their light hardly differs. The surroundings separate them. The
gap of two surfaces is a parabola of the place: the whole curve, beyond its maximum too, fits the
ratios of all parts with one parabola that opens upwards.

Where none fits, as with two contacts, islands decide. A film is continuous, so between thin films
and those beyond the maximum lies a band at the maximum, where the ratio is beyond the measurable
range. What such a band separates from a part that is thin without doubt, or else from the largest
measurable part, may lie on its other side. Without doubt thin is a film with a lower ratio than
one without end.
"""

from __future__ import annotations

import itertools
import math

import numpy as np
import scipy

from erlif.calibration import RatioCurve
from erlif.core.arrays import Array, FlagImage, Image, Mask
from erlif.core.flags import Flag
from erlif.core.statistics import robust_rms

_CELL = 8  # edge of the cells whose mean ratio is compared; noise opens no band of them [px]
_LEAST_SOUND = 0.25  # share of sound pixels of a cell, at least
_FEWEST = 4  # cells of an island; noise alone makes smaller ones within the band
_TOP = 0.97  # quantile of the cells whose ratio is that of the maximum
_WIDTHS = 3.0  # standard deviations of the ratio by which its maximum may be lower
_ENDLESS = 1e3  # um: film whose ratio does not change any more
_THINNEST, _TABLE = 0.05, 4000  # um: thinnest film of the table of a curve; films in it
_REACH = 3.0  # of the thick end of the range: the maximum lies below it
_GRID = 500  # films among which it is sought
_BAND = 0.9  # of the thick end of the range, from which on a film belongs to the band
_ABOVE = np.uint16(Flag.ABOVE_RANGE)

_MOST_CELLS = 800  # to which a parabola is fitted
_STARTS = np.linspace(-0.8, 0.8, 5)  # places along both axes about which a first one is fitted
_ABOUT = 0.25  # half width of the squares about them
_FEWEST_OF_START = 12  # cells for the six amplitudes
_OUTLIER = 2.0  # standard deviations beyond which a residual counts by its size
_MOST_STEPS = 40
_DENIED = 0.01  # share of the cells that are thin without doubt but beyond by the parabola


def flag_beyond_maximum(log_ratio: Image, flags: FlagImage, calibration: RatioCurve) -> None:
    """Flag films beyond the maximum of the ratio.

    Parameters
    ----------
    log_ratio : array, (y, x)
        Logarithm of the ratio. [1]
    flags : array of uint16, (y, x)
        Reasons why a pixel has no ratio; receives `Flag.ABOVE_RANGE`.
    calibration : RatioCurve
        Without a wall that reflects nothing is flagged.

    Examples
    --------
    A film of 1 um at the left edge of the image and 25 um at the right one. The ratio is highest at
    13.6 um, and 17.4 um have that of 10.8 um:

    >>> from dataclasses import replace
    >>> from erlif.show.plots import example_calibration
    >>> calibration = replace(
    ...     example_calibration(),
    ...     attenuation_laser=0.2,
    ...     reflectance=0.3,
    ...     covariance=1e-6 * np.eye(5),
    ...     thickness_range=(0.5, 12.0),
    ... )
    >>> film = np.tile(np.linspace(1, 25, 320), (32, 1))
    >>> ratio = calibration.predict_log(film).astype(np.float32)
    >>> flags = np.zeros(film.shape, np.uint16)
    >>> flag_beyond_maximum(ratio, flags, calibration)
    >>> float(film[flags > 0].min().round())
    17.0
    """
    if not calibration.model.reflects:
        return
    shape = tuple(-(-size // _CELL) for size in flags.shape)
    cells = np.add.outer(
        shape[1] * (np.arange(flags.shape[0]) // _CELL), np.arange(flags.shape[1]) // _CELL
    )
    sound, count = flags == 0, shape[0] * shape[1]
    pixels = np.bincount(cells[sound], minlength=count)
    total = np.bincount(cells[sound], log_ratio[sound], count)
    known = pixels > _LEAST_SOUND * np.bincount(cells.ravel(), minlength=count)
    mean = np.where(known, total / np.maximum(pixels, 1), np.nan).reshape(shape)

    # the highest ratio of the image is that of the maximum where the error of the ratio allows it
    thickest = calibration.thickness_range[1]
    films = np.linspace(_BAND * thickest, _REACH * thickest, _GRID)
    ratios = calibration.predict_log(films)
    top = float(np.nanquantile(mean, _TOP)) if known.any() else -np.inf
    width = _WIDTHS * float(calibration.log_ratio_std(thickest))
    if top < ratios[0] - width:
        return

    beyond = _beyond_by_gap(mean, calibration)
    if beyond is None:
        # films beyond the maximum have the ratio of an endless one, or more
        highest = top - float(ratios.max() - ratios[0])
        end = float(calibration.predict_log(_ENDLESS)) + top - float(ratios.max())
        beyond = _beyond_by_islands(mean, highest, end, width)
    flags[beyond.ravel()[cells] & sound] |= _ABOVE


def _beyond_by_gap(mean: Array, calibration: RatioCurve) -> Mask | None:
    """Cells in which a parabola through all of them is thicker than the calibrated range.

    None where there is none, or where it denies what is thin without doubt.
    """
    down, right = (np.linspace(-1, 1, size) for size in mean.shape)
    y, x = np.meshgrid(down, right, indexing="ij")
    shapes = np.stack([np.ones_like(x), y, x, y**2, x * y, x**2])
    amplitudes = _fit_parabola(mean, shapes, calibration)
    if amplitudes is None:
        return None
    gap, known = np.tensordot(amplitudes, shapes, axes=1), np.isfinite(mean)
    thickest = calibration.thickness_range[1]
    left = mean - calibration.predict_log(np.clip(gap, _THINNEST, _ENDLESS))
    std = math.hypot(robust_rms(left[known]), float(calibration.log_ratio_std(thickest)))
    thin = mean < float(calibration.predict_log(_ENDLESS)) - _WIDTHS * std
    beyond = gap > thickest
    return None if (beyond & thin).sum() > _DENIED * known.sum() else beyond & ~thin


def _fit_parabola(mean: Array, shapes: Array, calibration: RatioCurve) -> Array | None:
    """Amplitudes of shapes whose film has the ratios of the cells, by the whole curve. [um]

    The search begins with parabolas that open upwards, through the measured films of one place
    each; None where there is none.
    """
    known = np.flatnonzero(np.isfinite(mean))
    known = known[:: -(-known.size // _MOST_CELLS)]
    value, acts = mean.ravel()[known], shapes.reshape(len(shapes), -1)[:, known]
    films, thickest = np.geomspace(_THINNEST, _ENDLESS, _TABLE), calibration.thickness_range[1]
    ratios, slopes = calibration.predict_log(films), calibration.slope(films)

    # noise and an uneven wall differ from cell to cell, the errors of the curve are common
    steps = np.diff(mean, axis=1)
    steps = steps[np.isfinite(steps)]
    if not steps.size:
        return None
    scatter = robust_rms(steps) / math.sqrt(2)
    scatter = math.hypot(scatter, float(calibration.log_ratio_std(thickest)))

    def rest(amplitudes: Array) -> Array:
        return np.asarray((np.interp(amplitudes @ acts, films, ratios) - value) / scatter)

    def derivative(amplitudes: Array) -> Array:
        return np.asarray((acts * np.interp(amplitudes @ acts, films, slopes)).T / scatter)

    measured, best = calibration.inverse.look_up(value), None
    for y, x in itertools.product(_STARTS, _STARTS):
        about = (np.abs(acts[1] - y) < _ABOUT) & (np.abs(acts[2] - x) < _ABOUT)
        about &= measured < _BAND * thickest
        if about.sum() < _FEWEST_OF_START:
            continue
        start = np.linalg.lstsq(acts[:, about].T, measured[about], rcond=None)[0]
        if start[3] + start[5] > 0:
            found = scipy.optimize.least_squares(
                rest,
                start,
                derivative,
                loss="soft_l1",
                f_scale=_OUTLIER,
                max_nfev=_MOST_STEPS,
            )
            best = found if best is None or found.cost < best.cost else best
    return None if best is None else np.asarray(best.x)


def _beyond_by_islands(mean: Array, highest: float, end: float, width: float) -> Mask:
    """Cells that a band of ratios above `highest` separates from thin ones.

    `end` is the ratio of a film without end, and `width` that by which it may be lower.
    """
    above = mean > highest
    islands, _ = scipy.ndimage.label(mean <= highest)
    size = np.bincount(islands.ravel())
    size[0] = 0  # of no island
    touched = np.unique(islands[scipy.ndimage.binary_dilation(above)])
    touched = touched[size[touched] >= _FEWEST]
    if not touched.size:
        return np.zeros(mean.shape, bool)

    thin = touched[scipy.ndimage.minimum(mean, islands, touched) < end - width]
    limit = end - width
    if not thin.size:  # none is thin without doubt: the largest is taken for it
        thin, limit = np.array([np.argmax(size)]), end
    other = np.setdiff1d(touched, thin)
    if not other.size:
        return np.zeros(mean.shape, bool)
    middle = np.atleast_1d(scipy.ndimage.median(mean, islands, other))
    return np.isin(islands, other[middle > limit])
