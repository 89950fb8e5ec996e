"""Refusals of the noise and the smoothing of a ratio, from one table of texts."""

from erlif.core.refusals import refusal_writer

refusal = refusal_writer("erlif.ratio")
