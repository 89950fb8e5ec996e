"""Camera 2 on the pixels of camera 1: the map, the drift of each frame, and the alignment.

`register_frames` finds one map for a run, `estimate_drift` the translation of a frame on top of it,
and `align_frames` samples camera 2 accordingly, with its noise and its flags.
"""

from erlif.registration.alignment import align_frames
from erlif.registration.background import divide_by_light, is_steep
from erlif.registration.camera_map import CameraMap, MapKind, describe_map, move_map
from erlif.registration.drift import Drift, check_map, estimate_drift
from erlif.registration.estimate import register, register_frames
from erlif.registration.interpolation import (
    interpolation_variance_factor,
    sample_spline,
    spline_coefficients,
    warp,
)
from erlif.registration.inverse import InverseComparison, MapNodes, compare_with_inverse
from erlif.registration.settings import RegistrationSettings, orient

__all__ = [
    "CameraMap",
    "Drift",
    "InverseComparison",
    "MapKind",
    "MapNodes",
    "RegistrationSettings",
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
