"""A calibration for a joint whose wall reflects another share of the light than the fixture's."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import scipy

from erlif.calibration.curve import Calibration
from erlif.calibration.fit import DIM_LIGHT
from erlif.calibration.regression import (
    BLACK,
    EXACT,
    LASER_SHARE,
    LASER_SHARE_STD,
    LEAST_REFLECTANCE,
)
from erlif.core.arrays import Array
from erlif.core.notes import remark, warn

_STATED = 1e-3  # standard deviation of a reflectance up to which it was stated

_FILMS = 2001  # of the calibrated range, among which its end is sought


def change_wall(calibration: Calibration, reflectance: float) -> Calibration:
    """The calibration with the curve that the fixture would have before another wall.

    K, p, q and a are those of the dyes; the departure from the model is kept. Where the wall of the
    fixture is black, the attenuation of the laser is 0.8 ± 0.1 of that in the band of camera 2.

    Parameters
    ----------
    calibration : Calibration
        Of one fixture.
    reflectance : float
        Share of laser and emission that the wall of the joint returns. It is exact: the term `wall`
        of the systematics is its error. [1]

    Returns
    -------
    Calibration
        Its range ends where a pixel would be less certain than at its end before.

    Examples
    --------
    >>> from erlif.show.plots import example_calibration
    >>> black = example_calibration()
    >>> mirrored = change_wall(black, 0.3)
    >>> bool(mirrored.predict(6.0) > black.predict(6.0))
    True
    >>> mirrored.thickness_range[1] < black.thickness_range[1]
    True
    """
    before = calibration.reflectance or 0.0
    if reflectance == before:
        return calibration
    notes = [
        remark(
            "",
            f"the curve is that of a joint whose wall reflects {reflectance:.0%}, with the dyes "
            f"of a fixture whose wall reflects {before:.0%}",
        )
    ]
    if not before:
        text = (
            "the wall of the fixture is taken as black: a fit finds a reflectance from "
            f"{LEAST_REFLECTANCE:.0%} on. wall in [optics] of fixture.toml states a lower one"
        )
        notes.append(remark("", text))
    elif (std := calibration.standard_deviations[-1]) > _STATED:
        text = (
            "the curve before another wall is uncertain: the reflectance of the wall of the "
            f"fixture, {before:.0%} ± {std:.0%}, is that of its fit. State wall in [optics] of "
            "fixture.toml and calibrate again"
        )
        notes.append(warn("", text))

    covariance, laser = calibration.covariance, calibration.attenuation_laser
    if laser is None:
        q = calibration.attenuation_camera2
        laser = LASER_SHARE * q
        covariance = _extend(_extend(covariance, LASER_SHARE_STD * q), EXACT)
    # the reflectance that the fixture had is no longer a parameter, the stated one is exact
    covariance = _extend(covariance[:-1, :-1], EXACT)
    black = reflectance == 0
    changed = replace(
        calibration,
        covariance=covariance[:BLACK, :BLACK] if black else covariance,
        attenuation_laser=None if black else laser,
        reflectance=None if black else reflectance,
        notes=(*calibration.notes, *notes),
    )
    systematics = calibration.systematics
    if systematics:
        cross = np.zeros((len(changed.fitted_covariance), len(systematics.terms)))
        systematics = replace(systematics, cross=cross)
    low = calibration.thickness_range[0]
    return replace(
        changed,
        thickness_range=(low, _end_of_range(calibration, changed)),
        systematics=systematics,
    )


def _extend(covariance: Array, std: float) -> Array:
    """A covariance with one more parameter, independent of the others."""
    return np.asarray(scipy.linalg.block_diag(covariance, np.array([[std**2]])))


def _end_of_range(before: Calibration, changed: Calibration) -> float:
    """Film at which a pixel is as certain as at the end of the range before. [um]"""
    films = np.linspace(*before.thickness_range, _FILMS)
    useful, needed = (films * np.asarray(each.slope(films)) for each in (changed, before))
    peak = int(np.argmax(useful))
    enough = useful[peak:] >= min(needed[-1], useful[peak] / DIM_LIGHT)
    last = peak + (len(enough) if enough.all() else int(np.argmin(enough))) - 1
    return float(films[last])
