"""The region of interest."""

from __future__ import annotations

import numpy as np

from erlif.core.arrays import Array
from erlif.core.errors import ConfigError
from erlif.settings import RunSettings


def region_mask(settings: RunSettings, x: Array, y: Array) -> tuple[slice, slice]:
    """Rows and columns of the region of interest.

    Raises
    ------
    ConfigError
        If fewer than 32 x 32 pixels of the image lie in it.
    """
    roi = settings.thickness.roi
    if roi is None:
        return slice(0, y.size), slice(0, x.size)
    columns = slice(
        int(np.searchsorted(x, roi.x[0])), int(np.searchsorted(x, roi.x[1], side="right"))
    )
    rows = slice(int(np.searchsorted(y, roi.y[0])), int(np.searchsorted(y, roi.y[1], side="right")))
    if columns.stop - columns.start < 32 or rows.stop - rows.start < 32:
        raise ConfigError(
            f"Expected a region of interest of at least 32 x 32 pixels within the image, x 0 to {x[-1]:.2f} mm and y 0 to "
            f"{y[-1]:.2f} mm; [thickness] roi is x = [{roi.x[0]:g}, {roi.x[1]:g}], y = [{roi.y[0]:g}, {roi.y[1]:g}]."
        )
    return rows, columns
