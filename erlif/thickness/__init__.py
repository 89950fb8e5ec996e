"""Log ratio to film thickness, and the range in which it is measurable."""

from erlif.thickness.maps import measure_thickness
from erlif.thickness.measurable import CLEAR, MeasurableRange, find_range
from erlif.thickness.patch import NO_PATCH, PatchMean, sample_patch
from erlif.thickness.pulse import compare_light, measure_pulse_energy, middle_of

__all__ = [
    "CLEAR",
    "NO_PATCH",
    "MeasurableRange",
    "PatchMean",
    "compare_light",
    "find_range",
    "measure_pulse_energy",
    "measure_thickness",
    "middle_of",
    "sample_patch",
]
