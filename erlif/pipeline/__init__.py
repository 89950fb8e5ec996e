"""The order of the stages, and only here."""

from erlif.pipeline.budget import budget, render_budget
from erlif.pipeline.check import Finding, check
from erlif.pipeline.fixture import calibrate
from erlif.pipeline.run import process

__all__ = ["Finding", "budget", "calibrate", "check", "process", "render_budget"]
