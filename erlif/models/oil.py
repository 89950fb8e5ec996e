"""Viscosity and density of an oil against temperature and pressure.

Vogel (1921) and Walther (1931) for temperature, Barus (1893) and Roelands (1966) for pressure,
Dowson and Higginson (1966) for the density under pressure; Farzaneh (2002), section 2.2.2, for the
gear oil of the pin joint.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from erlif.core.errors import ModelError
from erlif.models.arguments import Values, formula, require_known

# Constant in Walther's law, of ASTM D341 for oils above 2 mm2/s. [mm2/s]
WALTHER_SHIFT = 0.7

# Kinematic viscosity above which the constant of Walther's law is 0.7. [m2/s]
LOWEST_WALTHER_VISCOSITY = 2e-6

# Pressure scale p_r of Roelands' law. [Pa]
ROELANDS_PRESSURE = 1.96e8

# Minus the logarithm of the viscosity of 6.31e-5 Pa s at which all isobars meet. [1]
ROELANDS_CONSTANT = 9.67


@dataclass(frozen=True)
class Oil:
    """Viscosities of an oil as a source gives them, at a single temperature.

    The dynamic viscosity is in Pa s, the kinematic one in m2/s, the density in kg/m3.

    Attributes
    ----------
    name : str
        Name or grade.
    viscosity : float
        Dynamic viscosity. [Pa s]
    kinematic_viscosity : float
        Kinematic viscosity. [m2/s]
    """

    name: str
    viscosity: float
    kinematic_viscosity: float

    @property
    def density(self) -> float:
        """Density with which the two viscosities agree. [kg/m3]"""
        return self.viscosity / self.kinematic_viscosity


# The gear oil of Farzaneh (2002), sections 2.2.2 and 5.2; its density is then 857.1 kg/m3.
#
# The thesis gives neither the temperature of these numbers nor a pressure-viscosity coefficient,
# and calls the kinematic viscosity "absolute". For mineral gear oils 2.0e-8 to 2.5e-8 1/Pa is a
# defensible coefficient.
THESIS_80W90 = Oil("80W-90", viscosity=0.12, kinematic_viscosity=1.4e-4)


@formula(a="number", temperature="signed temperature")
def vogel_viscosity(temperature: Values, *, a: Values, b: Values, c: Values) -> Values:
    """Dynamic viscosity of an oil at a temperature: eta = a exp(b / (T - c)).

    Vogel (1921); Farzaneh (2002), eq. 2.5.

    Parameters
    ----------
    temperature, a : float or array
        Temperature T, above c [K], viscosity that the oil approaches when hot [Pa s].
    b, c : float or array
        Constants of the oil, see `fit_vogel`. [K]

    Returns
    -------
    float or array
        Dynamic viscosity. [Pa s]

    Raises
    ------
    ModelError
        a not positive, a temperature not above c, or an infinite value.

    Examples
    --------
    At T = b + c the viscosity is a times e:

    >>> round(vogel_viscosity(1070.0, a=1e-4, b=900.0, c=170.0) / 1e-4, 5)
    2.71828
    """

    # the viscosity diverges at c; below it the law has no meaning
    above = temperature - c
    if np.any(np.less_equal(above, 0)):
        coldest = np.nanmin(np.asarray(temperature))
        raise ModelError(
            f"temperature must be above the Vogel constant c, got {coldest:g} K with c "
            f"{np.nanmax(np.asarray(c)):g} K."
        )
    return a * np.exp(b / above)


class VogelConstants(NamedTuple):
    """Constants of Vogel's law under the names of `vogel_viscosity`: a in Pa s, b and c in K.

    Attributes
    ----------
    a : float
        Viscosity that the oil approaches when hot. [Pa s]
    b : float
        Steepness. [K]
    c : float
        Temperature at which the law diverges. [K]
    """

    a: float
    b: float
    c: float


@formula(viscosities="viscosity")
def fit_vogel(temperatures: Values, *, viscosities: Values) -> VogelConstants:
    """Find the constants of Vogel's law through three measured viscosities; the solution is exact.

    Parameters
    ----------
    temperatures : sequence of three
        Temperatures, all different, in any order. [K]
    viscosities : sequence of three
        Dynamic viscosities measured there, positive. [Pa s]

    Returns
    -------
    VogelConstants
        a [Pa s], b [K] and c [K] of `vogel_viscosity`.

    Raises
    ------
    ModelError
        Not three points, equal temperatures, values that are not positive and finite, or points
        through which no Vogel curve runs.

    Examples
    --------
    An oil of 0.3, 0.12 and 0.0133 Pa s at 25, 40 and 100 degrees Celsius:

    >>> from erlif.models.oil import vogel_viscosity
    >>> constants = fit_vogel([298.15, 313.15, 373.15], viscosities=[0.3, 0.12, 0.0133])
    >>> [round(vogel_viscosity(T, **constants._asdict()), 4) for T in (298.15, 313.15, 373.15)]
    [0.3, 0.12, 0.0133]
    """
    if np.shape(temperatures) != (3,) or np.shape(viscosities) != (3,):
        shapes = (np.shape(temperatures), np.shape(viscosities))
        raise ModelError(
            f"temperatures and viscosities must be three each, got shapes {shapes[0]} and "
            f"{shapes[1]}."
        )
    require_known(temperatures=temperatures, viscosities=viscosities)

    # from cold to hot, in the logarithm of the viscosity
    order = np.argsort(np.asarray(temperatures))
    T, y = np.asarray(temperatures, float)[order], np.log(np.asarray(viscosities, float)[order])
    if T[0] == T[1] or T[1] == T[2]:
        raise ModelError(f"temperatures must differ, got {T} K.")

    # the mean slopes of b / (T - c) over two intervals are in the ratio (T2 - c) / (T0 - c)
    ratio = (y[1] - y[0]) / (T[1] - T[0]) * (T[2] - T[1]) / (y[2] - y[1])
    c = (T[2] - ratio * T[0]) / (1 - ratio)
    if not (ratio > 1 and c < T[0]):
        raise ModelError(
            "viscosities must fall with temperature, ever more slowly, for a Vogel curve through "
            "them."
        )

    # the two outer points fix b and a for this c
    b = (y[0] - y[2]) / (1 / (T[0] - c) - 1 / (T[2] - c))
    return VogelConstants(float(np.exp(y[0] - b / (T[0] - c))), float(b), float(c))


@formula()
def walther_viscosity(
    temperature: Values,
    *,
    viscosity_1: Values,
    temperature_1: Values,
    viscosity_2: Values,
    temperature_2: Values,
) -> Values:
    """Kinematic viscosity from two measured ones: log10 log10(nu + 0.7) = A - B log10 T, in mm2/s.

    Walther (1931), as ASTM D341 uses his law, for petroleum products above 2 mm2/s.

    Parameters
    ----------
    temperature, viscosity_1, viscosity_2 : float or array
        Temperature T of the result [K], kinematic viscosities measured at `temperature_1` and
        `temperature_2` [m2/s].
    temperature_1, temperature_2 : float or array
        Two different temperatures, often 313.15 and 373.15. [K]

    Returns
    -------
    float or array
        Kinematic viscosity. [m2/s]

    Raises
    ------
    ModelError
        A temperature that is not positive, equal temperatures, a viscosity below 2 mm2/s, where the
        constant 0.7 no longer holds, or an infinite value.

    Examples
    --------
    A gear oil of 140 mm2/s at 40 and 13.5 mm2/s at 100 degrees Celsius, at 25 degrees, in mm2/s:

    >>> at_25 = walther_viscosity(
    ...     298.15,
    ...     viscosity_1=140e-6,
    ...     temperature_1=313.15,
    ...     viscosity_2=13.5e-6,
    ...     temperature_2=373.15,
    ... )
    >>> round(at_25 * 1e6)
    360
    """
    for name, value in {"viscosity_1": viscosity_1, "viscosity_2": viscosity_2}.items():
        if np.any(np.less(value, LOWEST_WALTHER_VISCOSITY)):
            raise ModelError(
                f"{name} must be at least 2e-6 m2/s, got {np.nanmin(np.asarray(value)):g}."
            )
    if np.any(np.equal(temperature_1, temperature_2)):
        raise ModelError("temperature_1 and temperature_2 must differ.")

    # a straight line over log T, with the viscosity in mm2/s
    w1, w2 = (np.log10(np.log10(nu * 1e6 + WALTHER_SHIFT)) for nu in (viscosity_1, viscosity_2))
    slope = (w2 - w1) / (np.log10(temperature_2) - np.log10(temperature_1))
    w = w1 + slope * (np.log10(temperature) - np.log10(temperature_1))
    return (10 ** (10**w) - WALTHER_SHIFT) * 1e-6


@formula(pressure="signed number")
def barus_viscosity(pressure: Values, *, viscosity: Values, pressure_viscosity: Values) -> Values:
    """Viscosity under pressure: eta = eta0 exp(alpha p).

    Barus (1893); Farzaneh (2002), eq. 2.6.

    Parameters
    ----------
    viscosity : float or array
        Dynamic viscosity eta at ambient pressure. [Pa s]
    pressure_viscosity : float or array
        Barus coefficient alpha at ambient pressure. [1/Pa]
    pressure : float or array
        Pressure above ambient. [Pa]

    Returns
    -------
    float or array
        Dynamic viscosity. [Pa s]

    Notes
    -----
    Far too high above about 0.5 GPa; `roelands_viscosity` holds there.

    Examples
    --------
    At 116 MPa, the Hertz pressure of the steel joint of Farzaneh (2002), the viscosity is ten times
    that at ambient pressure:

    >>> round(barus_viscosity(116e6, viscosity=0.12, pressure_viscosity=2e-8) / 0.12, 1)
    10.2
    """
    return viscosity * np.exp(pressure_viscosity * pressure)


@formula(pressure="signed number")
def roelands_viscosity(
    pressure: Values, *, viscosity: Values, pressure_viscosity: Values
) -> Values:
    """Viscosity under pressure: ln(eta/eta0) = (ln eta0 + 9.67) [(1 + p/p_r)^Z - 1].

    p_r = 0.196 GPa; Z = alpha p_r / (ln eta0 + 9.67) gives the slope of `barus_viscosity` at
    ambient pressure. Roelands (1966).

    Parameters
    ----------
    pressure_viscosity : float or array
        Barus coefficient alpha at ambient pressure. [1/Pa]
    pressure : float or array
        Pressure above ambient, above -p_r. [Pa]
    viscosity : float or array
        Dynamic viscosity eta0 at ambient pressure, above 6.31e-5. [Pa s]

    Returns
    -------
    float or array
        Dynamic viscosity. [Pa s]

    Raises
    ------
    ModelError
        A viscosity or pressure outside the range of the law, a negative coefficient, or an infinite
        value.

    Notes
    -----
    At constant temperature; usual for pressures up to about 1 GPa.

    Examples
    --------
    At 1 GPa the law of Barus exceeds it thousands of times for an oil of 0.12 Pa s and 2e-8 1/Pa:
    exp(20) over exp(7.5497 (6.1020^0.51921 - 1)).

    >>> from erlif.models.oil import barus_viscosity
    >>> oil = {"viscosity": 0.12, "pressure_viscosity": 2e-8}
    >>> round(barus_viscosity(1e9, **oil) / roelands_viscosity(1e9, **oil), -2)
    3800.0
    """

    # all isobars meet at the lowest viscosity, and the power needs a positive base
    scale = np.log(viscosity) + ROELANDS_CONSTANT
    if np.any(np.less_equal(scale, 0)):
        least, found = np.exp(-ROELANDS_CONSTANT), np.nanmin(np.asarray(viscosity))
        raise ModelError(
            f"viscosity must exceed {least:.3g} Pa s for the law of Roelands, got {found:g}."
        )
    if np.any(np.less_equal(pressure, -ROELANDS_PRESSURE)):
        found = np.nanmin(np.asarray(pressure))
        raise ModelError(
            f"pressure must exceed {-ROELANDS_PRESSURE:g} Pa for the law of Roelands, got "
            f"{found:g}."
        )

    exponent = pressure_viscosity * ROELANDS_PRESSURE / scale
    return viscosity * np.exp(scale * ((1 + pressure / ROELANDS_PRESSURE) ** exponent - 1))


@formula()
def density_at_pressure(pressure: Values, *, density: Values) -> Values:
    """Density of a mineral oil under pressure: rho = rho0 [1 + 0.6 p / (1 + 1.7 p)], p in GPa.

    Dowson and Higginson (1966).

    Parameters
    ----------
    pressure, density : float or array
        Pressure above ambient [Pa], density rho0 at ambient pressure [kg/m3].

    Returns
    -------
    float or array
        Density. [kg/m3]

    Raises
    ------
    ModelError
        A density that is not positive, a negative pressure, or an infinite value.

    Examples
    --------
    At 1 GPa the oil is denser by 0.6/2.7:

    >>> round(density_at_pressure(1e9, density=900.0), 3)
    1100.0
    """
    return density * (1 + 0.6e-9 * pressure / (1 + 1.7e-9 * pressure))


@formula()
def density_at_temperature(
    temperature: Values, *, density: Values, reference_temperature: Values, expansion: Values
) -> Values:
    """Density of a warm oil: rho = rho0 [1 - beta (T - T0)].

    Parameters
    ----------
    temperature, reference_temperature, density, expansion : float or array
        Temperature T and the temperature T0 of the known density [K], density rho0 at T0 [kg/m3],
        coefficient of cubic expansion beta, about 7e-4 for mineral oils [1/K].

    Returns
    -------
    float or array
        Density. [kg/m3]

    Examples
    --------
    >>> round(density_at_temperature(
    ...     323.15, density=860.0, reference_temperature=313.15, expansion=7e-4
    ... ), 2)
    853.98
    """
    return density * (1 - expansion * (temperature - reference_temperature))


@formula()
def kinematic_viscosity(viscosity: Values, *, density: Values) -> Values:
    """Kinematic viscosity from dynamic viscosity and density: nu = eta / rho.

    Farzaneh (2002), eq. 2.4, which calls it the absolute viscosity.

    Parameters
    ----------
    viscosity : float or array
        Dynamic viscosity eta at ambient pressure. [Pa s]
    density : float or array
        Density rho. [kg/m3]

    Returns
    -------
    float or array
        Kinematic viscosity. [m2/s]

    Examples
    --------
    The gear oil of Farzaneh (2002), in mm2/s:

    >>> round(kinematic_viscosity(0.12, density=857.1) * 1e6)
    140
    """
    return viscosity / density
