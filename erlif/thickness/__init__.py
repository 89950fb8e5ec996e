"""Log ratio to film thickness, and the range in which it is measurable."""

from erlif.thickness.maps import measure_thickness
from erlif.thickness.patch import NO_PATCH, PatchMean, sample_patch
from erlif.thickness.pulse import compare_light, measure_pulse_energy, middle_of
from erlif.thickness.surroundings import CLEAR
from erlif.thickness.tables import FilmTables

__all__ = [
    "CLEAR",
    "NO_PATCH",
    "FilmTables",
    "PatchMean",
    "compare_light",
    "measure_pulse_energy",
    "measure_thickness",
    "middle_of",
    "sample_patch",
]
