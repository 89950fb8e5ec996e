"""Refusals of audits, budgets and comparisons, from one table of texts."""

from erlif.core.refusals import refusal_writer

refusal = refusal_writer("erlif.review")
