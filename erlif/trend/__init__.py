"""Maps to statistics, profiles, theory and the speed exponent."""

from erlif.trend.exponent import SLOWEST, Exponent, fit_exponent
from erlif.trend.profile import RigidGap, average_across_sliding, rigid_gap
from erlif.trend.region import region_mask
from erlif.trend.statistics import FilmStatistics, summarise_film
from erlif.trend.theory import predict_film

__all__ = [
    "SLOWEST",
    "Exponent",
    "FilmStatistics",
    "RigidGap",
    "average_across_sliding",
    "fit_exponent",
    "predict_film",
    "region_mask",
    "rigid_gap",
    "summarise_film",
]
