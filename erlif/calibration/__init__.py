"""The ratio of a film of known thickness: fit, file and inverse.

A fixture whose gap a coordinate measuring machine (CMM) has measured gives thickness and ratio side by side. The
reabsorption model of `erlif.models.fluorescence` is laid through them with errors in both, because the CMM's is usually the
larger one: orthogonal distance regression, each CMM point counted once.
"""

from erlif.calibration.curve import DIRECTION, Calibration, InverseTable, check_bands
from erlif.calibration.fit import fit_calibration
from erlif.calibration.profile import Profile, read_profile

__all__ = [
    "DIRECTION",
    "Calibration",
    "InverseTable",
    "Profile",
    "check_bands",
    "fit_calibration",
    "read_profile",
]
