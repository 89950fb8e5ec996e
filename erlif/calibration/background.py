"""The error that a background leaves in the ratio, as two more parameters of a calibration."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from erlif.core.arrays import Array


@dataclass(frozen=True)
class BackgroundError:
    """Uncertainty of a background that was subtracted.

    Attributes
    ----------
    brightness : float
        Light of camera 1 per um of a very thin film, where the illumination has its median. [DN/um]
    unit : tuple[float, float]
        Light of camera 1 and camera 2 that a share of 1 stands for. [DN]
    covariance : Array
        Covariance of the two shares, (2, 2). [1]
    cross : Array
        Covariance of the errors of the calibration (row) and of the shares (column), (n, 2).
    """

    brightness: float
    unit: tuple[float, float]
    covariance: Array
    cross: Array

    def gradient(self, signal: Array, *, ratio: Array) -> Array:
        """Derivatives of the logarithm of the ratio by the two shares, (2, ...).

        Parameters
        ----------
        signal : array
            Light of camera 1 of these films, over that per um of a very thin one. [um]
        ratio : array
            Camera 2 over camera 1 of these films. [1]

        Returns
        -------
        array
            The ratio is (L2 + s2 u2)/(L1 + s1 u1), with the light L of the film, shares s and
            units u. [1]
        """
        one = self.brightness * signal
        return np.stack([-self.unit[0] / one, self.unit[1] / (one * ratio)])

    def extend(self, covariance: Array) -> Array:
        """Covariance of a calibration with the two shares as further parameters."""
        return np.block([[covariance, self.cross], [self.cross.T, self.covariance]])
