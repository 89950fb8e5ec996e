from .bands import check_bands, note_pitch, share_bands
from .comparison import Comparison, compare_calibrations
from .curve import DIRECTION, Calibration
from .fit import DIM_LIGHT, USEFUL, fit_calibration
from .inverse import InverseTable
from .profile import Profile, read_profile
from .regression import Reabsorption
from .storage import (
    calibration_of,
    open_calibration,
    record_calibration,
    save_calibration,
)
from .systematics import TERMS, Systematics
from .wall import change_wall

__all__ = [
    "DIM_LIGHT",
    "DIRECTION",
    "TERMS",
    "USEFUL",
    "Calibration",
    "Comparison",
    "InverseTable",
    "Profile",
    "Reabsorption",
    "Systematics",
    "calibration_of",
    "change_wall",
    "check_bands",
    "compare_calibrations",
    "fit_calibration",
    "note_pitch",
    "open_calibration",
    "read_profile",
    "record_calibration",
    "save_calibration",
    "share_bands",
]
