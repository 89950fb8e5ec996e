from .agreement import find_reference_faults
from .camera import CameraMeasurement, measure_camera
from .darks import Background, Darks, declare_darks, reduce_background, reduce_darks
from .flats import FlatField, make_flat_field
from .frames import correct_frames, gather_light
from .light import CameraTables, NoiseTables, PairLight
from .pages import PageStack
from .photon_transfer import (
    LightLevel,
    PhotonTransfer,
    fit_photon_transfer,
    measure_response_spread,
    reduce_level,
)
from .references import (
    CHARACTERISTICS,
    CameraNoise,
    Cameras,
    DeclaredNoise,
    make_references,
)
from .saturation import count_pixels, find_pile_up
from .unlit import UnlitPixels, find_unlit

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
    "UnlitPixels",
    "correct_frames",
    "count_pixels",
    "declare_darks",
    "find_pile_up",
    "find_reference_faults",
    "find_unlit",
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
