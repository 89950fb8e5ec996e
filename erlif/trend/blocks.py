"""Sums over blocks of pixels: all that mean and minimum film thickness need of a trigger.

The region of interest is that of the rows and columns whose film is summed up.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from erlif.core.arrays import Array, Image, Mask
from erlif.core.errors import ConfigError
from erlif.core.flags import Flag
from erlif.core.products import RatioImages, ThicknessMaps

# Width of the blocks whose pixels are summed. [px]
BLOCK = 8

# Part of the last position by which a bound may lie beside a pixel that it includes.
_ROUNDING = 1e-12


@dataclass(frozen=True)
class BlockSums:
    """Sums over the blocks of 8 x 8 pixels of a region; every array is (row, column) of blocks.

    Lit pixels are those whose ratio has no flag; the gap is fitted to them. Measurable pixels are
    those of them whose surroundings lie within the measurable range; the mean film is theirs.

    Attributes
    ----------
    size : tuple[int, int]
        Rows and columns of the region. [px]
    offset : float
        Log ratio that is subtracted before summing: sums of small numbers keep their digits. [1]
    lit : Array
        Number of lit pixels.
    lit_ratio : Array
        Sum of their log ratio less the offset. [1]
    lit_var : Array
        Sum of their variance. [1]
    row : Array
        Sum of their rows, counted within the region. [px]
    row_squared : Array
        Sum of the squares of their rows. [px2]
    column : Array
        Sum of their columns, counted within the region. [px]
    column_squared : Array
        Sum of the squares of their columns. [px2]
    measurable : Array
        Number of measurable pixels.
    ratio : Array
        Sum of their log ratio less the offset. [1]
    var : Array
        Sum of their variance. [1]
    displaced : Array
        Sum of their variance by the registration. [1]
    valid : int
        Pixels of the region without flags in the map.
    beyond : int
        Pixels of the region whose only flag is that of a film beyond the measurable range.
    noise_correlation : float
        Variance of a mean over many pixels, relative to that of independent pixels. [1]
    """

    size: tuple[int, int]
    offset: float
    lit: Array
    lit_ratio: Array
    lit_var: Array
    row: Array
    row_squared: Array
    column: Array
    column_squared: Array
    measurable: Array
    ratio: Array
    var: Array
    displaced: Array
    valid: int
    beyond: int
    noise_correlation: float = 1.0


def sum_blocks(ratios: RatioImages, region: Region, maps: ThicknessMaps | None = None) -> BlockSums:
    """Sum ratio images over the blocks of a region.

    Parameters
    ----------
    ratios : RatioImages
        log_ratio (y, x) of a trigger, its variances and flags.
    region : Region
    maps : ThicknessMaps, optional
        The maps that `measure_thickness` made of them; without them no pixel is measurable.

    Returns
    -------
    BlockSums

    Examples
    --------
    >>> import xarray as xr
    >>> ratios = RatioImages(xr.Dataset({
    ...     "log_ratio": (("y", "x"), np.full((20, 16), 0.5)),
    ...     "log_ratio_var": (("y", "x"), np.full((20, 16), 1e-4)),
    ...     "flags": (("y", "x"), np.zeros((20, 16), np.uint16)),
    ... }))
    >>> sum_blocks(ratios, Region(slice(0, 20), slice(0, 16))).lit
    array([[64., 64.],
           [64., 64.],
           [32., 32.]])
    """
    within = region.rows, region.columns
    log_ratio = ratios.log_ratio.values[within].astype(float)
    variance = ratios.log_ratio_var.values[within]
    lit = ratios.flags.values[within] == 0
    rows, columns = np.indices(log_ratio.shape)

    # the middle of the values is near enough: no digit of double precision is lost
    offset = float(np.median(log_ratio[lit])) if lit.any() else 0.0
    ratio = log_ratio - offset

    measurable = np.zeros_like(lit)
    displaced = np.zeros(lit.shape, np.float32)
    valid = beyond = 0
    if maps is not None:
        measurable = np.isfinite(maps.log_ratio_near.values[within])
        displaced = ratios.log_ratio_var_shared.values[within]
        flags = maps.flags.values[within]
        valid = int((flags == 0).sum())
        beyond = int(((flags == Flag.BELOW_RANGE) | (flags == Flag.ABOVE_RANGE)).sum())

    return BlockSums(
        size=(lit.shape[0], lit.shape[1]),
        offset=offset,
        lit=_sum_selected(np.ones_like(ratio), lit),
        lit_ratio=_sum_selected(ratio, lit),
        lit_var=_sum_selected(variance, lit),
        row=_sum_selected(rows, lit),
        row_squared=_sum_selected(rows**2, lit),
        column=_sum_selected(columns, lit),
        column_squared=_sum_selected(columns**2, lit),
        measurable=_sum_selected(np.ones_like(ratio), measurable),
        ratio=_sum_selected(ratio, measurable),
        var=_sum_selected(variance, measurable),
        displaced=_sum_selected(displaced, measurable),
        valid=valid,
        beyond=beyond,
        noise_correlation=float(ratios.get("noise_correlation", 1.0)),
    )


def _sum_selected(image: Array | Image, mask: Mask) -> Array:
    """Sum over the pixels of each block that a mask selects."""
    chosen = np.where(mask, image, 0.0)
    for axis, size in enumerate(mask.shape):
        chosen = np.add.reduceat(chosen, np.arange(0, size, BLOCK), axis=axis)
    return chosen


_SMALLEST = 32  # least width and height: four blocks of eight pixels for the fit of the gap [px]

Interval = tuple[float, float]


@dataclass(frozen=True)
class Region:
    """A rectangle of pixels.

    Attributes
    ----------
    rows : slice
        Rows of the image.
    columns : slice
        Columns of the image.
    """

    rows: slice
    columns: slice


def find_region(x: Array, y: Array, *, roi: tuple[Interval, Interval] | None = None) -> Region:
    """Rows and columns of the region of interest.

    Parameters
    ----------
    x : array, (column,)
        Pixel positions. [mm]
    y : array, (row,)
        Pixel positions, downwards. [mm]
    roi : ((x_low, x_high), (y_low, y_high)), optional
        Bounds, included. Default: all of the image. [mm]

    Returns
    -------
    Region

    Raises
    ------
    ConfigError
        If fewer than 32 x 32 pixels of the image lie in it.

    Examples
    --------
    >>> position = np.arange(100) * 0.1
    >>> find_region(position, position, roi=((1.0, 5.0), (0.0, 9.0))).columns
    slice(10, 51, None)
    """
    if roi is None:
        return Region(slice(0, y.size), slice(0, x.size))

    across, down = roi
    columns = pixels_between(x, across)
    rows = pixels_between(y, down)
    if columns.stop - columns.start < _SMALLEST or rows.stop - rows.start < _SMALLEST:
        raise ConfigError(
            f"Expected a region of interest of at least {_SMALLEST} x {_SMALLEST} pixels within "
            f"the image, x 0 to {x[-1]:.2f} mm and y 0 to {y[-1]:.2f} mm; [thickness] roi is x = "
            f"[{across[0]:g}, {across[1]:g}], y = [{down[0]:g}, {down[1]:g}]. Correct roi, or "
            "pixel_pitch in [optics]."
        )
    return Region(rows, columns)


def pixels_between(position: Array, bounds: Interval) -> slice:
    """Pixels of rising positions that lie within bounds, included."""
    low, high = bounds
    # a bound at a pixel includes it, whatever the last digit of its position
    little = _ROUNDING * float(position[-1])
    first = int(np.searchsorted(position, low - little))
    return slice(first, int(np.searchsorted(position, high + little, side="right")))
