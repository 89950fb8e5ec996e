"""Refusals of encoder logs and of motion, from one table of texts."""

from erlif.core.refusals import refusal_writer

refusal = refusal_writer("erlif.kinematics")
