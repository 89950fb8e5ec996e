"""Counts to light with variance: dark, flat, photon transfer, saturation."""

from erlif.correction.frames import correct_frames
from erlif.correction.pages import PageStack
from erlif.correction.photon_transfer import (
    LightLevel,
    PhotonTransfer,
    fit_photon_transfer,
    measure_response_spread,
    reduce_level,
)
from erlif.correction.references import CameraNoise, measure_references
from erlif.correction.saturation import find_pile_up

__all__ = [
    "CameraNoise",
    "LightLevel",
    "PageStack",
    "PhotonTransfer",
    "correct_frames",
    "find_pile_up",
    "fit_photon_transfer",
    "measure_references",
    "measure_response_spread",
    "reduce_level",
]
