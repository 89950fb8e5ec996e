"""Refusals of predictions and fits of the film, from one table of texts."""

from erlif.core.refusals import refusal_writer

refusal = refusal_writer("erlif.prediction")
