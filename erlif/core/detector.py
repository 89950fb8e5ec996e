"""Properties that all digital cameras share."""

QUANTISATION_VAR = 1 / 12
"""Variance of rounding to whole counts, uniform over one count. [DN2]"""
