"""Refusals of the region, the position of the pin and the theory, from one table of texts."""

from erlif.core.refusals import refusal_writer

refusal = refusal_writer("erlif.trend")
