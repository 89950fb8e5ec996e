from .film import solve_film
from .journal import Groove, Journal, Motion, Mount, crank_motion
from .shapes import lobe_shape, pin_shape, roller_shape
from .steady import journal_coefficients, steady_journal
from .transient import solve_journal

__all__ = [
    "Groove",
    "Journal",
    "Motion",
    "Mount",
    "crank_motion",
    "journal_coefficients",
    "lobe_shape",
    "pin_shape",
    "roller_shape",
    "solve_film",
    "solve_journal",
    "steady_journal",
]
