"""The film that theory predicts for an oscillating joint, at every frame and trigger."""

from erlif.prediction.motion import FrameMotion, follow_motion
from erlif.prediction.start import StartFilm, find_start_film
from erlif.prediction.triggers import (
    average_triggers,
    predict_frames,
    predict_triggers,
    speed_correlation,
)
from erlif.prediction.view import View, gap_in_view, summarise_gap

__all__ = [
    "FrameMotion",
    "StartFilm",
    "View",
    "average_triggers",
    "find_start_film",
    "follow_motion",
    "gap_in_view",
    "predict_frames",
    "predict_triggers",
    "speed_correlation",
    "summarise_gap",
]
