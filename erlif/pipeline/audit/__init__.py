"""Audits that find mistakes in files, log and settings from the measured frames of a run."""
