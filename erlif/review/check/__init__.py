"""Checks of a run or a fixture before anything is computed."""

from erlif.review.check.directory import Examination, check, examine

__all__ = ["Examination", "check", "examine"]
