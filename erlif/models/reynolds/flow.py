"""Mobility of the film: viscosity under pressure and rough walls."""

from dataclasses import dataclass

import numpy as np

from erlif.core.arrays import Array
from erlif.core.errors import ModelError

# Reduction of the flow between touching isotropic rough walls. Patir and Cheng (1978). [1]
ROUGHNESS_AMPLITUDE = 0.9

# Decay of that reduction with film over roughness. Patir and Cheng (1978). [1]
ROUGHNESS_DECAY = 0.56


# Ambient over local viscosity at a pressure of 14 / alpha, beyond any use of Barus' law. [1]
SMALLEST_FLUIDITY = 1e-6


@dataclass(frozen=True)
class Fluid:
    """Viscosity of the film, its change with pressure, and the roughness of its walls.

    The unknown of the equations is the reduced pressure q = (1 - exp(-alpha p)) / alpha, with which
    the flow of a Barus fluid, exp(-alpha p) grad p = grad q, is linear (Grubin 1949). Without
    pressure-viscosity, q is the pressure.

    Attributes
    ----------
    viscosity : float
        Viscosity at ambient pressure eta0. [Pa s]
    pressure_viscosity : float
        Coefficient alpha of Barus' law. [1/Pa]
    roughness : float
        Combined rms roughness sigma of both walls; zero for smooth ones. [m]
    """

    viscosity: float
    pressure_viscosity: float = 0.0
    roughness: float = 0.0

    def reduced(self, pressure: float) -> float:
        """Reduced pressure of one pressure. [Pa]"""
        if not self.pressure_viscosity:
            return pressure
        return float(-np.expm1(-self.pressure_viscosity * pressure) / self.pressure_viscosity)

    def pressure(self, reduced: Array) -> tuple[Array, Array | float]:
        """Pressure of a reduced pressure, and its derivative. [Pa; 1]"""
        if not self.pressure_viscosity:
            return reduced, 1.0

        # no pressure has a reduced pressure beyond 1/alpha; a Newton step may pass it
        rest = np.maximum(1 - self.pressure_viscosity * reduced, SMALLEST_FLUIDITY)
        return -np.log(rest) / self.pressure_viscosity, 1 / rest

    def mobility(self, film: Array) -> tuple[Array, Array]:
        """`mobility_of` this fluid."""
        return mobility_of(film, self.viscosity, self.roughness)

    def viscosity_at(self, pressure: Array) -> Array | float:
        """Viscosity at a pressure, Barus. [Pa s]"""
        if not self.pressure_viscosity:
            return self.viscosity
        return np.asarray(self.viscosity * np.exp(self.pressure_viscosity * pressure))


def mobility_of(film: Array, viscosity: float, roughness: float) -> tuple[Array, Array]:
    """Flow per width and gradient of the reduced pressure, and its derivative by the film.

    h^3 / (12 eta0), times 1 - 0.9 exp(-0.56 h / sigma) between rough walls without lay (Patir and
    Cheng 1978, gamma = 1), for h above half of sigma.
    """
    square = film * film / (12 * viscosity)
    if roughness == 0.0:
        return square * film, 3 * square
    missing = ROUGHNESS_AMPLITUDE * np.exp(-ROUGHNESS_DECAY / roughness * film)
    smooth = square * film
    slope = 3 * square * (1 - missing) + smooth * missing * ROUGHNESS_DECAY / roughness
    return smooth * (1 - missing), slope


def check_cavitation(pressure: float) -> None:
    """Refuse cavities whose pressure [Pa] is above ambient."""
    if pressure > 0:
        raise ModelError(
            f"cavitation_pressure is relative to ambient and at most 0, got {pressure:g} Pa."
        )
