"""Films beyond the maximum of the ratio, which look like thinner ones.

Before a wall that reflects, the ratio has a maximum. Films beyond it have the ratio of thinner
ones, and both are so thick that their light hardly differs. The surroundings separate them. A
film is continuous, so between both lies a band at the maximum, where the ratio is beyond the
measurable range. What such a band separates from a part that is thin without doubt, or else from
the largest measurable part, may lie on its other side. Without doubt thin is a film with a lower
ratio than one without end.
"""

from __future__ import annotations

import numpy as np
import scipy.ndimage

from erlif.calibration import RatioCurve
from erlif.core.arrays import FlagImage, Image
from erlif.core.flags import Flag

_CELL = 8  # edge of the cells whose mean ratio is compared; noise opens no band of them [px]
_LEAST_SOUND = 0.25  # share of sound pixels of a cell, at least
_FEWEST = 4  # cells of an island; noise alone makes smaller ones within the band
_TOP = 0.97  # quantile of the cells whose ratio is that of the maximum
_WIDTHS = 3.0  # standard deviations of the ratio by which its maximum may be lower
_ENDLESS = 1e3  # um: film whose ratio does not change any more
_REACH = 3.0  # of the thick end of the range: the maximum lies below it
_GRID = 500  # films among which it is sought
_BAND = 0.9  # of the thick end of the range, from which on a film belongs to the band
_ABOVE = np.uint16(Flag.ABOVE_RANGE)


def flag_beyond_maximum(log_ratio: Image, flags: FlagImage, calibration: RatioCurve) -> None:
    """Flag films that a band at the maximum of the ratio separates from thin ones.

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
    thickest, endless = calibration.thickness_range[1], float(calibration.predict_log(_ENDLESS))
    films = np.linspace(_BAND * thickest, _REACH * thickest, _GRID)
    ratios = calibration.predict_log(films)
    top = float(np.nanquantile(mean, _TOP)) if known.any() else -np.inf
    width = _WIDTHS * float(calibration.log_ratio_std(thickest))
    if top < ratios[0] - width:
        return
    highest = top - float(ratios.max() - ratios[0])

    above = mean > highest
    islands, _ = scipy.ndimage.label(mean <= highest)
    size = np.bincount(islands.ravel())
    size[0] = 0  # of no island
    touched = np.unique(islands[scipy.ndimage.binary_dilation(above)])
    touched = touched[size[touched] >= _FEWEST]
    if not touched.size:
        return

    # films beyond the maximum have the ratio of an endless one, or more
    end = endless + top - float(ratios.max())
    thin = touched[scipy.ndimage.minimum(mean, islands, touched) < end - width]
    limit = end - width
    if not thin.size:  # none is thin without doubt: the largest is taken for it
        thin, limit = np.array([np.argmax(size)]), end
    other = np.setdiff1d(touched, thin)
    if not other.size:
        return
    middle = np.atleast_1d(scipy.ndimage.median(mean, islands, other))
    beyond = np.isin(islands, other[middle > limit])
    flags[beyond.ravel()[cells] & sound] |= _ABOVE
