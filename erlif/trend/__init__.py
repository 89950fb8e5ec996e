"""Maps to statistics, profiles, theory and the speed exponent."""

from erlif.trend.background import BackgroundEstimate, LightRecord, estimate_background
from erlif.trend.bleaching import Trend, fit_trend
from erlif.trend.blocks import BLOCK, BlockSums, sum_blocks
from erlif.trend.curve import FilmCurve
from erlif.trend.exponent import SLOWEST, Exponent, fit_exponent
from erlif.trend.form import SCALE_STD, SIGNIFICANT, Cause, GapForm, judge_form
from erlif.trend.gap import GapMinimum
from erlif.trend.position import (
    PARAMETERS,
    PinPosition,
    PinView,
    find_pin_in_blocks,
    find_pin_position,
    pin_covariance,
)
from erlif.trend.profile import RigidGap, average_across_sliding, rigid_gap
from erlif.trend.region import Region, find_region
from erlif.trend.statistics import FilmStatistics, summarise_blocks, summarise_film
from erlif.trend.theory import (
    Joint,
    Solid,
    VogelLaw,
    compare_with_roughness,
    predict_film,
    viscosity_at,
)

__all__ = [
    "BLOCK",
    "PARAMETERS",
    "SCALE_STD",
    "SIGNIFICANT",
    "SLOWEST",
    "BackgroundEstimate",
    "BlockSums",
    "Cause",
    "Exponent",
    "FilmCurve",
    "FilmStatistics",
    "GapForm",
    "GapMinimum",
    "Joint",
    "LightRecord",
    "PinPosition",
    "PinView",
    "Region",
    "RigidGap",
    "Solid",
    "Trend",
    "VogelLaw",
    "average_across_sliding",
    "compare_with_roughness",
    "estimate_background",
    "find_pin_in_blocks",
    "find_pin_position",
    "find_region",
    "fit_exponent",
    "fit_trend",
    "judge_form",
    "pin_covariance",
    "predict_film",
    "rigid_gap",
    "sum_blocks",
    "summarise_blocks",
    "summarise_film",
    "viscosity_at",
]
