"""A number of the film of one trigger, with the parts of its standard deviation."""

from __future__ import annotations

import math
import operator
from functools import partial
from typing import NamedTuple

import numpy as np

from erlif.core.arrays import Array


class FilmNumber(NamedTuple):
    """A number of the film of one trigger, with the parts of its standard deviation.

    Attributes
    ----------
    value : float
        [um]
    random_std : float
        From the noise of the ratio, new at every trigger. [um]
    surface_std : float
        From marks and waviness of the surfaces about a smooth gap, the same at every trigger. [um]
    gradient : Array
        Change with the parameters of the calibration, (parameter,), in the order of
        `RatioCurve.full_covariance`.
    """

    value: float
    random_std: float
    surface_std: float
    gradient: Array

    def std(self, covariance: Array) -> float:
        """Return the standard deviation by all parts, with a covariance of the parameters. [um]"""
        shared = float(self.gradient @ covariance @ self.gradient)
        return math.sqrt(self.random_std**2 + self.surface_std**2 + shared)

    def scaled(self, by: float) -> FilmNumber:
        """Return this number times another."""
        return FilmNumber(*map(partial(operator.mul, by), self))

    def plus(self, other: FilmNumber) -> FilmNumber:
        """Return the sum with a number from the same pixels, whose errors add up."""
        return FilmNumber(*map(operator.add, self, other))

    @classmethod
    def unknown(cls, parameters: int) -> FilmNumber:
        """Make the number of a film that has none."""
        return cls(math.nan, math.nan, math.nan, np.full(parameters, math.nan))
