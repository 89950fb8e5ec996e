"""A calibration applied: ratio images to maps of film thickness, with two kinds of uncertainty and flags."""

from __future__ import annotations

import numba
import numpy as np
import xarray as xr

from erlif.calibration import Calibration
from erlif.core.flags import FLAG_ATTRS, Flag
from erlif.core.products import RatioImages, ThicknessMaps, require
from erlif.thickness.measurable import find_range

_BELOW, _ABOVE, _POOR = int(Flag.BELOW_RANGE), int(Flag.ABOVE_RANGE), int(Flag.POOR_REGISTRATION)


def measure_thickness(ratios: RatioImages, calibration: Calibration) -> ThicknessMaps:
    """Read film thickness off ratio images, pixel by pixel.

    Parameters
    ----------
    ratios : RatioImages
        log_ratio (..., y, x) with log_ratio_var, log_ratio_var_shared and flags.
    calibration : Calibration

    Returns
    -------
    ThicknessMaps
        thickness [um]; thickness_std, what the noise of this pixel leaves [um]; thickness_std_shared, what calibration and
        registration leave to all pixels alike [um]; flags; log_ratio_near, the mean ratio about each pixel whose film is within
        the range. A film beyond the range is flagged by its surroundings (`erlif.thickness.measurable`), and a ratio beyond what the fixture
        covers by itself; nothing is extrapolated. A pixel where the registration could be further off than the noise is flagged
        poor_registration.
    """
    require(ratios, "log_ratio", "log_ratio_var", "log_ratio_var_shared", "flags")
    table = calibration.inverse
    shape = ratios.log_ratio.shape
    thickness, random, shared, near = (np.empty(shape, np.float32) for _ in range(4))
    flags = ratios.flags.values.copy()
    for n in np.ndindex(shape[:-2]):
        log_ratio, variance, displaced = (
            ratios[name].values[n]
            for name in ("log_ratio", "log_ratio_var", "log_ratio_var_shared")
        )
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
            random[n],
            shared[n],
            flags[n],
        )
    dims = ratios.log_ratio.dims
    return ThicknessMaps(
        xr.Dataset(
            {
                "thickness": (
                    dims,
                    thickness,
                    {
                        "units": "um",
                        "long_name": "oil-film thickness",
                        "ancillary_variables": "thickness_std thickness_std_shared flags",
                    },
                ),
                "thickness_std": (
                    dims,
                    random,
                    {"units": "um", "long_name": "standard deviation of thickness, random part"},
                ),
                "thickness_std_shared": (
                    dims,
                    shared,
                    {
                        "units": "um",
                        "long_name": "standard deviation of thickness, what all pixels share",
                    },
                ),
                "flags": (dims, flags, FLAG_ATTRS),
                "log_ratio_near": (
                    dims,
                    near,
                    {"units": "1", "long_name": "mean of log_ratio about the pixel"},
                ),
            },
            ratios.coords,
        )
    )


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
    random,
    shared,
    flags,
):
    last = table.size - 1
    for i in range(log_ratio.shape[0]):
        for j in range(log_ratio.shape[1]):
            thickness[i, j] = np.nan
            random[i, j] = np.nan
            shared[i, j] = np.nan
            place = (log_ratio[i, j] - start) / step
            if flags[i, j] != 0:
                continue
            if place < 0.0:
                flags[i, j] |= _BELOW
                continue
            if place > last:
                flags[i, j] |= _ABOVE
                continue
            k = min(int(place), last - 1)
            f = place - k
            thickness[i, j] = table[k] + f * (table[k + 1] - table[k])
            # where the curve bends, its slope at a noisy ratio goes with the error; halfway to the surroundings it spans the error
            place = min(max(0.5 * (place + (near[i, j] - start) / step), 0.0), float(last))
            k = min(int(place), last - 1)
            f = place - k
            rate = per_log_ratio[k] + f * (per_log_ratio[k + 1] - per_log_ratio[k])
            own = calibration_std[k] + f * (calibration_std[k + 1] - calibration_std[k])
            random[i, j] = rate * np.sqrt(variance[i, j])
            shared[i, j] = np.sqrt(own * own + rate * rate * variance_shared[i, j])
