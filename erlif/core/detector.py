"""What every digital camera shares."""

QUANTISATION_VAR = 1 / 12
"""Variance of rounding to whole counts. [DN2]"""
