from .islands import flag_beyond_maximum
from .maps import measure_thickness
from .patch import NO_PATCH, PatchMean, sample_patch
from .pulse import compare_light, measure_pulse_energy, middle_of
from .surroundings import CLEAR
from .tables import FilmTables

__all__ = [
    "CLEAR",
    "NO_PATCH",
    "FilmTables",
    "PatchMean",
    "compare_light",
    "flag_beyond_maximum",
    "measure_pulse_energy",
    "measure_thickness",
    "middle_of",
    "sample_patch",
]
