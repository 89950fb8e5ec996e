from .comparison import FilmModel, ModelComparison, compare_models
from .fit import Estimate, MotionFit, film_temperature, fit_motion
from .given import GivenErrors
from .measured import MeasuredMotion, measured_minima, measured_positions
from .motion import FrameMotion, follow_motion
from .pin_film import OverlapError, solve_pin_motion
from .pin_motion import PinMotion, find_pin_motion
from .pressure import find_pressures
from .smoothing import SmoothPath, smooth_path
from .start import StartFilm, find_start_film
from .triggers import (
    average_triggers,
    predict_frames,
    predict_triggers,
    speed_correlation,
)
from .view import ImageLine, gap_in_view, summarise_gap

__all__ = [
    "Estimate",
    "FilmModel",
    "FrameMotion",
    "GivenErrors",
    "ImageLine",
    "MeasuredMotion",
    "ModelComparison",
    "MotionFit",
    "OverlapError",
    "PinMotion",
    "SmoothPath",
    "StartFilm",
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
