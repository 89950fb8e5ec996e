"""The film that theory predicts for an oscillating joint, at every frame and trigger."""

from erlif.prediction.comparison import Candidate, Comparison, compare_models
from erlif.prediction.fit import Estimate, MotionFit, film_temperature, fit_motion
from erlif.prediction.measured import MeasuredMotion, measured_minima, measured_positions
from erlif.prediction.motion import FrameMotion, follow_motion
from erlif.prediction.pin_motion import PinMotion, find_pin_motion
from erlif.prediction.pressure import OverlapError, find_pressures, solve_pin_motion
from erlif.prediction.smoothing import SmoothPath, smooth_path
from erlif.prediction.start import StartFilm, find_start_film
from erlif.prediction.triggers import (
    average_triggers,
    predict_frames,
    predict_triggers,
    speed_correlation,
)
from erlif.prediction.view import View, gap_in_view, summarise_gap

__all__ = [
    "Candidate",
    "Comparison",
    "Estimate",
    "FrameMotion",
    "MeasuredMotion",
    "MotionFit",
    "OverlapError",
    "PinMotion",
    "SmoothPath",
    "StartFilm",
    "View",
    "average_triggers",
    "compare_models",
    "film_temperature",
    "find_pin_motion",
    "find_pressures",
    "find_start_film",
    "fit_motion",
    "follow_motion",
    "gap_in_view",
    "measured_minima",
    "measured_positions",
    "predict_frames",
    "predict_triggers",
    "smooth_path",
    "solve_pin_motion",
    "speed_correlation",
    "summarise_gap",
]
