from .background import BackgroundEstimate, estimate_background
from .bleaching import Trend, fit_trend
from .blocks import BLOCK, BlockSums, sum_blocks
from .cells import LightRecord
from .course import CourseChange, find_ratio_change, find_shift
from .curve import FilmCurve
from .exponent import (
    LARGEST_BEYOND,
    LEAST_TRIGGERS,
    SLOWEST,
    Exponent,
    fit_exponent,
    mean_at_constant_minimum,
)
from .form import SCALE_STD, SIGNIFICANT, Cause, GapForm, judge_form
from .gap import GapMinimum, GapShape, choose_contact, find_gap_minima, find_gap_minimum
from .position import (
    PARAMETERS,
    FittedNumbers,
    PinPosition,
    PinView,
    find_pin_in_blocks,
    find_pin_position,
    load_line_covariance,
    pin_covariance,
)
from .profile import (
    RigidGap,
    average_across_sliding,
    cut_through_minimum,
    place_of_minimum,
    rigid_gap,
)
from .region import Region, find_region
from .rigidity import (
    CLEARANCE_STD,
    ErrorEstimate,
    RatioEquations,
    RigidityUnknowns,
    estimate_errors,
    gap_of_pin,
    solve_equations,
)
from .statistics import FilmStatistics, summarise_blocks, summarise_film
from .theory import (
    LubricatedJoint,
    Solid,
    VogelLaw,
    compare_with_roughness,
    predict_film,
    viscosity_at,
)

__all__ = [
    "BLOCK",
    "CLEARANCE_STD",
    "LARGEST_BEYOND",
    "LEAST_TRIGGERS",
    "PARAMETERS",
    "SCALE_STD",
    "SIGNIFICANT",
    "SLOWEST",
    "BackgroundEstimate",
    "BlockSums",
    "Cause",
    "CourseChange",
    "ErrorEstimate",
    "Exponent",
    "FilmCurve",
    "FilmStatistics",
    "FittedNumbers",
    "GapForm",
    "GapMinimum",
    "GapShape",
    "LightRecord",
    "LubricatedJoint",
    "PinPosition",
    "PinView",
    "RatioEquations",
    "Region",
    "RigidGap",
    "RigidityUnknowns",
    "Solid",
    "Trend",
    "VogelLaw",
    "average_across_sliding",
    "choose_contact",
    "compare_with_roughness",
    "cut_through_minimum",
    "estimate_background",
    "estimate_errors",
    "find_gap_minima",
    "find_gap_minimum",
    "find_pin_in_blocks",
    "find_pin_position",
    "find_ratio_change",
    "find_region",
    "find_shift",
    "fit_exponent",
    "fit_trend",
    "gap_of_pin",
    "judge_form",
    "load_line_covariance",
    "mean_at_constant_minimum",
    "pin_covariance",
    "place_of_minimum",
    "predict_film",
    "rigid_gap",
    "solve_equations",
    "sum_blocks",
    "summarise_blocks",
    "summarise_film",
    "viscosity_at",
]
