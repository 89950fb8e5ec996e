"""Ratio images to maps of film thickness, with two kinds of uncertainty and flags."""

from __future__ import annotations

import numba
import numpy as np
import xarray as xr

from erlif.calibration import Calibration
from erlif.core.flags import FLAG_ATTRS, Flag
from erlif.core.products import RatioImages, ThicknessMaps, require
from erlif.thickness.measurable import find_range

_BELOW, _ABOVE, _POOR = int(Flag.BELOW_RANGE), int(Flag.ABOVE_RANGE), int(Flag.POOR_REGISTRATION)

_ATTRS: dict[str, dict[str, str]] = {
    "thickness": {
        "units": "um",
        "long_name": "oil-film thickness",
        "ancillary_variables": "thickness_std thickness_std_shared flags",
    },
    "thickness_std": {"units": "um", "long_name": "standard deviation of thickness, random part"},
    "thickness_std_shared": {
        "units": "um",
        "long_name": "standard deviation of thickness, common to all pixels",
    },
    "log_ratio_near": {"units": "1", "long_name": "mean of log_ratio about the pixel"},
}


def measure_thickness(ratios: RatioImages, calibration: Calibration) -> ThicknessMaps:
    """Convert ratio images to film thickness, pixel by pixel.

    A pixel is flagged, and not extrapolated, where its surroundings lie beyond the measurable range
    (`erlif.thickness.measurable`) or its own ratio beyond what the fixture covers. It is flagged
    poor_registration where the error of the registration exceeds the noise.

    Parameters
    ----------
    ratios : RatioImages
        log_ratio (..., y, x) with log_ratio_var, log_ratio_var_shared and flags.
    calibration : Calibration

    Returns
    -------
    ThicknessMaps
        thickness; thickness_std, from the noise of the pixel; thickness_std_shared, from
        calibration and registration, common to all pixels [um]; flags; log_ratio_near, mean log
        ratio about each valid pixel [1].

    Raises
    ------
    ErlifError
        If a variable is missing.

    Examples
    --------
    >>> calibration = Calibration(
    ...     0.65, 0.40, 0.25, 1e-8 * np.eye(3), (0.5, 12.0), (580.0, 610.0), xr.Dataset(), 1.0, ""
    ... )
    >>> image = np.full((16, 16), calibration.predict_log(np.array(4.0)), np.float32)
    >>> ratios = RatioImages(xr.Dataset({
    ...     "log_ratio": (("y", "x"), image),
    ...     "log_ratio_var": (("y", "x"), np.full_like(image, 1e-4)),
    ...     "log_ratio_var_shared": (("y", "x"), np.zeros_like(image)),
    ...     "flags": (("y", "x"), np.zeros(image.shape, np.uint8)),
    ... }))
    >>> maps = measure_thickness(ratios, calibration)
    >>> round(float(maps.thickness[8, 8]), 3)
    4.0

    The standard deviation is that of the log ratio over the slope, 0.25/(e - 1) - 0.4/(e^1.6 - 1):

    >>> slope = 0.25 / np.expm1(0.25 * 4) - 0.40 / np.expm1(0.40 * 4)
    >>> round(float(maps.thickness_std[8, 8] * slope), 4)
    0.01
    """
    require(ratios, "log_ratio", "log_ratio_var", "log_ratio_var_shared", "flags")
    table = calibration.inverse
    shape = ratios.log_ratio.shape
    thickness, std, std_shared, near = (np.empty(shape, np.float32) for _ in range(4))
    flags = ratios.flags.values.copy()
    for n in np.ndindex(shape[:-2]):
        log_ratio, variance, displaced = (
            ratios[name].values[n]
            for name in ("log_ratio", "log_ratio_var", "log_ratio_var_shared")
        )

        # flags that the surroundings decide, before those of the pixels themselves
        flags[n][(flags[n] == 0) & (displaced > variance)] = _POOR
        near[n], beyond = find_range(log_ratio, variance, flags[n], calibration)
        flags[n] |= np.where(flags[n] == 0, beyond, 0).astype(np.uint8)
        near[n][flags[n] != 0] = np.nan

        _invert(
            log_ratio,
            variance,
            displaced,
            near[n],
            table.start,
            table.step,
            table.thickness,
            table.per_log_ratio,
            table.calibration_std,
            thickness[n],
            std[n],
            std_shared[n],
            flags[n],
        )

    images = {
        "thickness": thickness,
        "thickness_std": std,
        "thickness_std_shared": std_shared,
        "log_ratio_near": near,
    }
    dims = ratios.log_ratio.dims
    maps = {name: (dims, image, _ATTRS[name]) for name, image in images.items()}
    return ThicknessMaps(xr.Dataset(maps | {"flags": (dims, flags, FLAG_ATTRS)}, ratios.coords))


@numba.njit(nogil=True, cache=True)
def _interpolate(table, place):  # type: ignore[no-untyped-def]
    """Value of a table at a position between its rows."""
    k = min(int(place), table.size - 2)
    return table[k] + (place - k) * (table[k + 1] - table[k])


@numba.njit(nogil=True, cache=True)
def _invert(  # type: ignore[no-untyped-def]
    log_ratio,
    variance,
    variance_shared,
    near,
    start,
    step,
    table,
    per_log_ratio,
    calibration_std,
    thickness,
    std,
    std_shared,
    flags,
):
    """Fill the last four arguments from the tables of the calibration over log ratio."""
    last = table.size - 1
    for i in range(log_ratio.shape[0]):
        for j in range(log_ratio.shape[1]):
            thickness[i, j] = np.nan
            std[i, j] = np.nan
            std_shared[i, j] = np.nan
            if flags[i, j] != 0:
                continue

            place = (log_ratio[i, j] - start) / step
            if place < 0.0:
                flags[i, j] |= _BELOW
                continue
            if place > last:
                flags[i, j] |= _ABOVE
                continue
            thickness[i, j] = _interpolate(table, place)

            # the slope of a curve at a noisy ratio is correlated with its error; half-way to the
            # mean of the surroundings it is that of the chord between both
            near_place = (near[i, j] - start) / step
            place = min(max(0.5 * (place + near_place), 0.0), float(last))
            rate = _interpolate(per_log_ratio, place)
            own = _interpolate(calibration_std, place)
            std[i, j] = rate * np.sqrt(variance[i, j])
            std_shared[i, j] = np.sqrt(own * own + rate * rate * variance_shared[i, j])
