"""Refusals of runs, films and workers, from one table of texts."""

from erlif.core.refusals import refusal_writer

refusal = refusal_writer("erlif.pipeline")
