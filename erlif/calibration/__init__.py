"""The ratio of a film of known thickness: fit, file and inverse.

A fixture whose gap a coordinate measuring machine (CMM) has measured gives thickness and ratio
side by side. The reabsorption model of `erlif.models.fluorescence` is fitted to them with errors
in both, because the CMM's is usually the larger one: orthogonal distance regression, each CMM
point counted once. The pose of the fixture is refined with it where the profile has form. A
spline is added to the model where the residuals require one. Two calibrations can be compared.
"""

from erlif.calibration.background import BackgroundError
from erlif.calibration.comparison import Comparison, compare_calibrations
from erlif.calibration.curve import DIRECTION, Calibration, InverseTable, check_bands, share_bands
from erlif.calibration.fit import DIM_LIGHT, USEFUL, fit_calibration
from erlif.calibration.profile import Profile, read_profile
from erlif.calibration.storage import (
    calibration_of,
    open_calibration,
    record_calibration,
    save_calibration,
)

__all__ = [
    "DIM_LIGHT",
    "DIRECTION",
    "USEFUL",
    "BackgroundError",
    "Calibration",
    "Comparison",
    "InverseTable",
    "Profile",
    "calibration_of",
    "check_bands",
    "compare_calibrations",
    "fit_calibration",
    "open_calibration",
    "read_profile",
    "record_calibration",
    "save_calibration",
    "share_bands",
]
