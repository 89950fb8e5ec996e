from .alignment import align_bands, align_frames
from .background import divide_by_light, is_steep
from .camera_map import CameraMap, MapKind, describe_map, move_map
from .drift import Drift, check_map, estimate_drift
from .estimate import register, register_frames
from .interpolation import (
    interpolation_variance_factor,
    sample_spline,
    spline_coefficients,
    warp,
)
from .inverse import InverseComparison, MapNodes, compare_with_inverse
from .settings import RegistrationSettings, orient

__all__ = [
    "CameraMap",
    "Drift",
    "InverseComparison",
    "MapKind",
    "MapNodes",
    "RegistrationSettings",
    "align_bands",
    "align_frames",
    "check_map",
    "compare_with_inverse",
    "describe_map",
    "divide_by_light",
    "estimate_drift",
    "interpolation_variance_factor",
    "is_steep",
    "move_map",
    "orient",
    "register",
    "register_frames",
    "sample_spline",
    "spline_coefficients",
    "warp",
]
