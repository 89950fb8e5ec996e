"""Points of the profile beside the ratio the cameras saw there."""

from __future__ import annotations

from dataclasses import dataclass

from erlif.core.arrays import Array


@dataclass(frozen=True)
class Points:
    """CMM points with the ratio of the pixels about each."""

    thickness: Array  # [um]
    thickness_std: Array  # [um]
    log_ratio: Array
    log_ratio_std: Array
    pixel_var: Array  # variance of a pixel that is new in every frame, in the mean image
    fixed_var: Array  # variance of a pixel that all frames share
    position: Array  # (point, axis), on the profile [mm]
    gradient: Array  # (point, axis), of the thickness [um/mm]
    ratio_gradient: Array  # (point, axis), of log_ratio [1/mm]
    mean_across: Array  # where the pixels about a point of a line lie across it [mm]
    across_slope: Array  # of log_ratio across a line; NaN for a surface [1/mm]
    across_slope_std: Array
