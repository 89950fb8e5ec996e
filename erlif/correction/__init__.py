"""Counts to light with variance: dark, flat, photon transfer, saturation."""

from erlif.correction.agreement import find_reference_faults
from erlif.correction.camera import CameraMeasurement, measure_camera
from erlif.correction.darks import Background, Darks, declare_darks, reduce_background, reduce_darks
from erlif.correction.flats import FlatField, make_flat_field
from erlif.correction.frames import correct_frames, gather_light
from erlif.correction.light import CameraTables, NoiseTables, PairLight
from erlif.correction.pages import PageStack
from erlif.correction.photon_transfer import (
    LightLevel,
    PhotonTransfer,
    fit_photon_transfer,
    measure_response_spread,
    reduce_level,
)
from erlif.correction.references import (
    CHARACTERISTICS,
    CameraNoise,
    Cameras,
    DeclaredNoise,
    make_references,
)
from erlif.correction.saturation import count_pixels, find_pile_up

__all__ = [
    "CHARACTERISTICS",
    "Background",
    "CameraMeasurement",
    "CameraNoise",
    "CameraTables",
    "Cameras",
    "Darks",
    "DeclaredNoise",
    "FlatField",
    "LightLevel",
    "NoiseTables",
    "PageStack",
    "PairLight",
    "PhotonTransfer",
    "correct_frames",
    "count_pixels",
    "declare_darks",
    "find_pile_up",
    "find_reference_faults",
    "fit_photon_transfer",
    "gather_light",
    "make_flat_field",
    "make_references",
    "measure_camera",
    "measure_response_spread",
    "reduce_background",
    "reduce_darks",
    "reduce_level",
]
