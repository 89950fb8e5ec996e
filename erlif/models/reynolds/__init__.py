"""Transient Reynolds equation with mass-conserving cavitation: the film of an oscillating joint."""

from erlif.models.reynolds.coefficients import journal_coefficients
from erlif.models.reynolds.film import solve_film
from erlif.models.reynolds.journal import Groove, Journal, Motion, Mount, crank_motion
from erlif.models.reynolds.shapes import lobe_shape, pin_shape, roller_shape
from erlif.models.reynolds.steady import steady_journal
from erlif.models.reynolds.transient import solve_journal

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
