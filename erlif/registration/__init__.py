"""Camera 2 onto the pixels of camera 1."""

from erlif.registration.background import divide_by_light
from erlif.registration.camera_map import CameraMap
from erlif.registration.drift import Drift, check_map, estimate_drift
from erlif.registration.estimate import register, register_frames
from erlif.registration.settings import ORIENTATIONS, RegistrationSettings, orient
from erlif.registration.warp import (
    interpolation_variance_factor,
    sample_spline,
    spline_coefficients,
    warp,
)

__all__ = [
    "ORIENTATIONS",
    "CameraMap",
    "Drift",
    "RegistrationSettings",
    "check_map",
    "divide_by_light",
    "estimate_drift",
    "interpolation_variance_factor",
    "orient",
    "register",
    "register_frames",
    "sample_spline",
    "spline_coefficients",
    "warp",
]
