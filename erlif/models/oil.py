"""Viscosity and density of an oil against temperature and pressure."""

from dataclasses import dataclass

import numpy as np

from erlif.core.errors import ModelError
from erlif.models.arguments import Values, require_not_negative, require_positive

WALTHER_SHIFT = 0.7  # mm2/s, of ASTM D341 for oils above 2 mm2/s
ROELANDS_PRESSURE = 1.96e8  # Pa
ROELANDS_CONSTANT = 9.67  # -ln of the viscosity of 6.31e-5 Pa s at which all isobars meet


@dataclass(frozen=True)
class Oil:
    """What a source says about an oil at its own, single temperature."""

    name: str
    viscosity: float
    """Dynamic viscosity. [Pa s]"""
    kinematic_viscosity: float
    """Kinematic viscosity. [m2/s]"""

    @property
    def density(self) -> float:
        """Density that makes the two viscosities agree. [kg/m3]"""
        return self.viscosity / self.kinematic_viscosity


THESIS_80W90 = Oil("80W-90", viscosity=0.12, kinematic_viscosity=1.4e-4)
"""The gear oil of Farzaneh (2002), sections 2.2.2 and 5.2; its density is then 857.1 kg/m3.

The thesis gives neither the temperature of these numbers nor a pressure-viscosity coefficient, and calls the kinematic
viscosity "absolute". For mineral gear oils 2.0e-8 to 2.5e-8 1/Pa is a defensible coefficient.
"""


def vogel_viscosity(temperature: Values, *, a: Values, b: Values, c: Values) -> Values:
    """Dynamic viscosity [Pa s] of an oil: eta = a exp(b / (T - c)). Farzaneh (2002), eq. 2.5.

    Parameters
    ----------
    temperature : float or array
        Temperature T, above c. [K]
    a, b, c : float or array
        Constants of the oil, fitted to measurements: a [Pa s], b and c [K].

    Raises
    ------
    ModelError
        a not positive, or a temperature not above c.
    """
    require_positive(a=a)
    if np.any(np.less_equal(temperature - c, 0)):
        raise ModelError(
            f"temperature must be above the Vogel constant c, got {np.nanmin(np.asarray(temperature)):g} K."
        )
    return a * np.exp(b / (temperature - c))


def fit_vogel(temperatures: Values, *, viscosities: Values) -> tuple[float, float, float]:
    """Find the Vogel constants (a [Pa s], b [K], c [K]) through three measured viscosities; exact.

    Parameters
    ----------
    temperatures, viscosities : sequence of three
        Temperatures [K], all different, and the dynamic viscosities measured there [Pa s].

    Raises
    ------
    ModelError
        Not three points, equal temperatures, or points through which no Vogel curve runs.
    """
    if len(temperatures) != 3 or len(viscosities) != 3:
        raise ModelError(
            f"temperatures and viscosities must be three each, got {len(temperatures)}, {len(viscosities)}."
        )
    require_positive(viscosities=viscosities)
    order = np.argsort(temperatures)
    T, y = np.asarray(temperatures, float)[order], np.log(np.asarray(viscosities, float)[order])
    if T[0] == T[1] or T[1] == T[2]:
        raise ModelError(f"temperatures must differ, got {T} K.")
    # the mean slopes of b / (T - c) over two intervals are in the ratio (T2 - c) / (T0 - c)
    ratio = (y[1] - y[0]) / (T[1] - T[0]) * (T[2] - T[1]) / (y[2] - y[1])
    c = (T[2] - ratio * T[0]) / (1 - ratio)
    if not (ratio > 1 and c < T[0]):
        raise ModelError(
            "viscosities must fall with temperature, ever more slowly, for a Vogel curve through them."
        )
    b = (y[0] - y[2]) / (1 / (T[0] - c) - 1 / (T[2] - c))
    return float(np.exp(y[0] - b / (T[0] - c))), float(b), float(c)


def walther_viscosity(
    temperature: Values,
    *,
    viscosity_1: Values,
    temperature_1: Values,
    viscosity_2: Values,
    temperature_2: Values,
) -> Values:
    """Kinematic viscosity [m2/s] through two measured ones: log10 log10(nu + 0.7) = A - B log10 T, nu in mm2/s.

    Parameters
    ----------
    temperature : float or array
        Where the viscosity is wanted. [K]
    viscosity_1, viscosity_2 : float or array
        Kinematic viscosities measured at `temperature_1` and `temperature_2`. [m2/s]
    temperature_1, temperature_2 : float or array
        Two different temperatures, often 313.15 and 373.15. [K]

    Raises
    ------
    ModelError
        A temperature or viscosity not positive, equal temperatures, or a viscosity below 2 mm2/s, where the constant
        0.7 no longer holds.

    Notes
    -----
    Walther's law as ASTM D341 uses it, for petroleum products above 2 mm2/s.
    """
    require_positive(
        temperature=temperature, temperature_1=temperature_1, temperature_2=temperature_2
    )
    for name, value in {"viscosity_1": viscosity_1, "viscosity_2": viscosity_2}.items():
        if np.any(np.less(value, 2e-6)):
            raise ModelError(
                f"{name} must be at least 2e-6 m2/s, got {np.nanmin(np.asarray(value)):g}."
            )
    if np.any(np.equal(temperature_1, temperature_2)):
        raise ModelError("temperature_1 and temperature_2 must differ.")
    w1, w2 = (np.log10(np.log10(nu * 1e6 + WALTHER_SHIFT)) for nu in (viscosity_1, viscosity_2))
    slope = (w2 - w1) / (np.log10(temperature_2) - np.log10(temperature_1))
    w = w1 + slope * (np.log10(temperature) - np.log10(temperature_1))
    return (10 ** (10**w) - WALTHER_SHIFT) * 1e-6


def barus_viscosity(pressure: Values, *, viscosity: Values, pressure_viscosity: Values) -> Values:
    """Viscosity [Pa s] under pressure: eta = eta0 exp(alpha p). Farzaneh (2002), eq. 2.6.

    Parameters
    ----------
    pressure : float or array
        Pressure above ambient. [Pa]
    viscosity : float or array
        Viscosity eta0 at ambient pressure. [Pa s]
    pressure_viscosity : float or array
        Coefficient alpha. [1/Pa]

    Notes
    -----
    Far too stiff above about 0.5 GPa; use `roelands_viscosity` there.
    """
    require_positive(viscosity=viscosity)
    require_not_negative(pressure_viscosity=pressure_viscosity)
    return viscosity * np.exp(pressure_viscosity * pressure)


def roelands_viscosity(
    pressure: Values, *, viscosity: Values, pressure_viscosity: Values
) -> Values:
    """Viscosity [Pa s] under pressure: ln(eta/eta0) = (ln eta0 + 9.67) [(1 + p/p_r)^Z - 1], p_r = 0.196 GPa.

    Z = alpha p_r / (ln eta0 + 9.67) makes the slope at ambient pressure that of `barus_viscosity`.

    Parameters
    ----------
    pressure : float or array
        Pressure above ambient, above -p_r. [Pa]
    viscosity : float or array
        Viscosity eta0 at ambient pressure, above 6.31e-5. [Pa s]
    pressure_viscosity : float or array
        Coefficient alpha at ambient pressure. [1/Pa]

    Notes
    -----
    Roelands, thesis, Delft 1966, at constant temperature; usual for pressures up to about 1 GPa.
    """
    scale = np.log(viscosity) + ROELANDS_CONSTANT
    require_not_negative(pressure_viscosity=pressure_viscosity)
    if np.any(np.less_equal(scale, 0)):
        raise ModelError(
            f"viscosity must exceed {np.exp(-ROELANDS_CONSTANT):.3g} Pa s for the Roelands law."
        )
    if np.any(np.less_equal(pressure, -ROELANDS_PRESSURE)):
        raise ModelError(f"pressure must exceed {-ROELANDS_PRESSURE:g} Pa for the Roelands law.")
    exponent = pressure_viscosity * ROELANDS_PRESSURE / scale
    return viscosity * np.exp(scale * ((1 + pressure / ROELANDS_PRESSURE) ** exponent - 1))


def density_at_pressure(pressure: Values, *, density: Values) -> Values:
    """Density [kg/m3] of a mineral oil: rho = rho0 [1 + 0.6 p / (1 + 1.7 p)], p in GPa. Dowson and Higginson (1966).

    Parameters
    ----------
    pressure : float or array
        Pressure above ambient, not negative. [Pa]
    density : float or array
        Density rho0 at ambient pressure. [kg/m3]
    """
    require_positive(density=density)
    require_not_negative(pressure=pressure)
    return density * (1 + 0.6e-9 * pressure / (1 + 1.7e-9 * pressure))


def density_at_temperature(
    temperature: Values, *, density: Values, reference_temperature: Values, expansion: Values
) -> Values:
    """Density [kg/m3] of a warm oil: rho = rho0 [1 - beta (T - T0)].

    Parameters
    ----------
    temperature, reference_temperature : float or array
        Temperature T and the temperature T0 of the known density. [K]
    density : float or array
        Density rho0 at T0. [kg/m3]
    expansion : float or array
        Coefficient of cubic expansion beta, about 7e-4 for mineral oils. [1/K]
    """
    require_positive(
        temperature=temperature, density=density, reference_temperature=reference_temperature
    )
    return density * (1 - expansion * (temperature - reference_temperature))


def kinematic_viscosity(viscosity: Values, *, density: Values) -> Values:
    """Kinematic viscosity [m2/s] of a dynamic viscosity [Pa s] and a density [kg/m3]: nu = eta / rho.

    Note: Farzaneh (2002), section 2.2.2, calls this the absolute viscosity.
    """
    require_positive(viscosity=viscosity, density=density)
    return viscosity / density
