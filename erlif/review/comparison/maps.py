"""The difference of two maps, cell by cell, and where it is more than chance."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import xarray as xr

from erlif.calibration import calibration_of
from erlif.core.arrays import Array
from erlif.core.described import describe
from erlif.core.errors import ErlifError
from erlif.io.files import describe_trigger, settings_of
from erlif.review.comparison.calibrations import calibration_var, key_of
from erlif.review.comparison.cells import average_cells, cell_edges

# Expected share of cells that do not differ, among those stated to differ.
FALSE_DISCOVERIES = 0.05


def difference_map(one: xr.Dataset, other: xr.Dataset, *, triggers: tuple[int, int]) -> xr.Dataset:
    """Subtract the map of a trigger of one film from that of another one, cell by cell.

    Cells have 8 x 8 pixels of the coarser camera and are placed by the positions from the first
    pixel of each image; nothing is interpolated. The errors of one calibration cancel as far as the
    films are equal, those of two add.

    Parameters
    ----------
    one, other : xarray.Dataset
        Films; the difference is `other` less `one`.
    triggers : (int, int)
        Number of the trigger of each film.

    Returns
    -------
    xarray.Dataset
        On (y, x): difference, difference_std [um]; significance, their ratio; differs, 1 where the
        difference is significant with 5 % of false discoveries (Benjamini and Hochberg 1995).

    Raises
    ------
    ErlifError
        If the axes of the images lie along other directions, or the images hardly overlap.

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> film = example_film()
    >>> found = difference_map(film, film.assign(thickness=film.thickness + 0.5), triggers=(0, 0))
    >>> float(found.difference.mean().round(2)), int(found.differs.sum())
    (0.5, 24)
    """
    if settings_of(one).optics.x_axis != settings_of(other).optics.x_axis:
        raise ErlifError(
            "Expected images whose x lies along the same direction; x_axis in [optics] differs. "
            "Compare the film statistics alone, or runs of one camera."
        )
    edges = {f"{axis}_edges": cell_edges([one, other], axis) for axis in ("x", "y")}
    calibrations = calibration_of(one, triggers[0]), calibration_of(other, triggers[1])
    a, b = (
        average_cells(film, trigger, calibration, **edges)
        for film, trigger, calibration in zip((one, other), triggers, calibrations, strict=True)
    )
    same = key_of(calibrations[0]) == key_of(calibrations[1])
    shared = calibration_var(a.gradient, b.gradient, calibrations, same=same)

    difference = b.film - a.film
    std = np.where(np.isfinite(difference), np.sqrt(a.own_var + b.own_var + shared), np.nan)
    significance = difference / std
    dims = ("y", "x")
    described = [describe_trigger(film, k) for film, k in zip((one, other), triggers, strict=True)]
    middles = {
        axis: 0.5 * (edges[f"{axis}_edges"][1:] + edges[f"{axis}_edges"][:-1]) for axis in "xy"
    }
    mapped = describe(
        {
            "difference": (dims, difference, "um", ""),
            "difference_std": (dims, std, "um", ""),
            "significance": (dims, significance, "1", ""),
            "differs": (dims, _significant(significance), "1", ""),
        },
        {axis: (axis, middle, "mm", "") for axis, middle in middles.items()},
    )
    return mapped.assign_attrs(
        first=described[0],
        second=described[1],
        first_trigger=triggers[0],
        second_trigger=triggers[1],
        same_calibration=int(same),
    )


def _significant(significance: Array) -> npt.NDArray[np.uint8]:
    """Where a difference is more than chance among that many cells."""
    signs = np.zeros(significance.shape, np.uint8)
    known = np.isfinite(significance)
    if known.any():
        import scipy.stats

        probability = 2 * scipy.stats.norm.sf(np.abs(significance[known]))
        corrected = scipy.stats.false_discovery_control(probability)
        signs[known] = corrected < FALSE_DISCOVERIES
    return signs
