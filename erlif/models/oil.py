"""Viscosity of an oil against temperature and pressure.

Vogel (1921) for temperature, Barus (1893) for pressure. Walther's law (1931) is in
`erlif.models.oil_fit`.
"""

from typing import NamedTuple

import numpy as np

from erlif.core.errors import ModelError
from erlif.models.arguments import Values, formula, require_known


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

    Returns: Dynamic viscosity. [Pa s]

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
        raise ModelError(
            "temperatures and viscosities must be three each, got shapes "
            f"{np.shape(temperatures)} and {np.shape(viscosities)}."
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


@formula(pressure="signed number")
def barus_viscosity(pressure: Values, *, viscosity: Values, pressure_viscosity: Values) -> Values:
    """Viscosity under pressure: eta = eta0 exp(alpha p).

    Barus (1893); Farzaneh (2002), eq. 2.6.

    Parameters
    ----------
    pressure : float or array
        Pressure above ambient. [Pa]

    Returns: Dynamic viscosity. [Pa s]

    Notes
    -----
    Far too high above about 0.5 GPa.

    Examples
    --------
    At 116 MPa, the Hertz pressure of the steel joint of Farzaneh (2002), the viscosity is ten times
    that at ambient pressure:

    >>> round(barus_viscosity(116e6, viscosity=0.12, pressure_viscosity=2e-8) / 0.12, 1)
    10.2
    """
    return viscosity * np.exp(pressure_viscosity * pressure)


@formula()
def kinematic_viscosity(viscosity: Values, *, density: Values) -> Values:
    """Kinematic viscosity from dynamic viscosity and density: nu = eta / rho.

    Farzaneh (2002), eq. 2.4, which calls it the absolute viscosity.

    Parameters
    ----------
    density : float or array
        Density rho. [kg/m3]

    Returns: Kinematic viscosity. [m2/s]

    Examples
    --------
    The gear oil of Farzaneh (2002), in mm2/s:

    >>> round(kinematic_viscosity(0.12, density=857.1) * 1e6)
    140
    """
    return viscosity / density
