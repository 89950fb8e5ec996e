"""Points of the CMM profile, each with the ratio of the pixels around it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from erlif.core.arrays import Array


@dataclass(frozen=True)
class Points:
    """CMM points inside the image, each with the mean ratio of the pixels nearest to it.

    Attributes
    ----------
    thickness : Array
        Film thickness by the CMM, (point,). [um]
    thickness_std : Array
        Its standard deviation, (point,); NaN where the profile states none. [um]
    log_ratio : Array
        Logarithm of the ratio camera 2 / camera 1 at the point, (point,). [1]
    log_ratio_std : Array
        Its standard deviation, (point,). [1]
    pixel_var : Array
        Variance of one pixel of the mean image that is new in every frame, (point,). [1]
    fixed_var : Array
        Variance of one pixel that repeats from frame to frame, (point,). [1]
    position : Array
        Position on the profile, (point, axis): one axis for a line, two for a surface. [mm]
    gradient : Array
        Gradient of the film thickness along the axes, (point, axis). [um/mm]
    ratio_gradient : Array
        Gradient of `log_ratio` along the axes, (point, axis). [1/mm]
    mean_across : Array
        Mean position of the pixels across a line, (point,); 0 for a surface. [mm]
    across_slope : Array
        Slope of the logarithm of the ratio across a line, (point,); NaN for a surface. [1/mm]
    across_slope_std : Array
        Standard deviation of `across_slope`, (point,). [1/mm]
    """

    thickness: Array
    thickness_std: Array
    log_ratio: Array
    log_ratio_std: Array
    pixel_var: Array
    fixed_var: Array
    position: Array
    gradient: Array
    ratio_gradient: Array
    mean_across: Array
    across_slope: Array
    across_slope_std: Array

    @property
    def on_surface(self) -> bool:
        """Whether the profile is a surface; otherwise it is a line."""
        return bool(self.position.shape[1] == 2)

    @property
    def has_error_bars(self) -> bool:
        """Whether the profile states the uncertainty of every thickness."""
        return bool(np.isfinite(self.thickness_std).all())
