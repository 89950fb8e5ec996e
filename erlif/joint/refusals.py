"""Refusals of the joint, from one table of texts."""

from erlif.core.refusals import refusal_writer

refusal = refusal_writer("erlif.joint")
