"""Sliding speed, pv, heat and growth of a joint. Strand (2005), eqs. 26 to 30."""

import numpy as np

from erlif.models.arguments import Values, formula


@formula()
def mean_sliding_speed(half_swing: Values, *, diameter: Values, period: Values) -> Values:
    """Compute the mean sliding speed of a swinging joint. Strand (2005), eq. 26.

    v = 2 d beta / t.

    Parameters
    ----------
    half_swing, diameter, period : float or array
        Half of the angle from end to end, beta [rad], diameter d of the pin [m], time t of a swing
        forth and back [s].

    Returns
    -------
    float or array
        Mean sliding speed v. [m/s]

    Notes
    -----
    The nomenclature of the source lists beta in degrees; the equation needs radians.

    Examples
    --------
    The rig of Farzaneh (2002): 24.426 degrees from end to end at 114 rpm.

    >>> speed = mean_sliding_speed(np.radians(24.426) / 2, diameter=0.06672, period=60 / 114)
    >>> print(f"{speed * 1e3:.2f} mm/s")
    54.04 mm/s
    """
    # four times the half swing per period, on half the diameter
    return 2 * diameter * half_swing / period


@formula(load="signed load")
def pressure_velocity(load: Values, *, diameter: Values, width: Values, speed: Values) -> Values:
    """Compute the product pv of projected pressure and speed. Strand (2005), section 2.1.13.

    F v / (d w).

    Parameters
    ----------
    diameter, width : float or array
        Diameter d and width w of the joint. [m]
    speed : float or array
        Sliding speed v; its sign is kept. [m/s]

    Returns
    -------
    float or array
        pv. [W/m2]

    Examples
    --------
    12.5 MPa at 50 mm/s:

    >>> pv = pressure_velocity(100e3, diameter=0.08, width=0.1, speed=0.05)
    >>> print(f"{pv / 1e6:.3f} W/mm2")
    0.625 W/mm2
    """
    return load * speed / (diameter * width)


@formula(load="load or zero")
def friction_heat(load: Values, *, friction: Values, speed: Values) -> Values:
    """Compute the heat of a sliding joint: Q = mu F |v|. Strand (2005), eqs. 27 and 28.

    Parameters
    ----------
    friction, speed : float or array
        Friction coefficient mu [1], sliding speed v, in either direction [m/s].

    Returns
    -------
    float or array
        Heat Q. [W]

    Examples
    --------
    >>> print(f"{friction_heat(100e3, friction=0.1, speed=-0.05):.0f} W")
    500 W
    """
    return friction * load * np.abs(speed)  # both directions of motion heat the joint


@formula()
def bushing_heat_share(pin_conductivity: Values, *, bushing_conductivity: Values) -> Values:
    """Compute the share of the friction heat that enters the bushing. Strand (2005), eq. 28.

    1 / (1 + lambda_pin / lambda_bush): slow sliding, both bodies count as at rest.

    Parameters
    ----------
    pin_conductivity, bushing_conductivity : float or array
        Thermal conductivities. [W/(m K)]

    Returns
    -------
    float or array
        Share of the heat. [1]

    Examples
    --------
    4/7 for a steel pin in a bronze bushing:

    >>> print(f"{bushing_heat_share(45.0, bushing_conductivity=60.0):.4f} {4 / 7:.4f}")
    0.5714 0.5714
    """
    # both bodies have the temperature of the contact, so the heat divides as they conduct
    return 1 / (1 + pin_conductivity / bushing_conductivity)


@formula()
def surface_temperature(
    measured_temperature: Values,
    *,
    heat: Values,
    pin_diameter: Values,
    wall: Values,
    width: Values,
    conductivity: Values,
    arc: Values = 2 * np.pi,
) -> Values:
    """Compute the temperature of the sliding surface from one behind it. Strand (2005), eq. 29.

    T_s = T_m + Q ln((d + 2t)/d) / (arc w lambda).

    Parameters
    ----------
    measured_temperature, heat, wall, width, conductivity, arc : float or array
        Temperature T_m on the outside of the bushing [K], heat Q into the bushing [W], wall
        thickness t of the bushing [m], width w of the bushing [m], thermal conductivity lambda of
        the bushing [W/(m K)], angle through which the heat flows, 2 pi for the whole ring [rad].

    Returns
    -------
    float or array
        Temperature T_s of the sliding surface. [K]

    Notes
    -----
    The source has pi in the place of the arc: heat through half of the ring, twice the rise of the
    whole one.

    Examples
    --------
    Heat that flows through half of the ring raises the temperature by twice as much:

    >>> case = {"pin_diameter": 0.08, "wall": 0.01, "width": 0.1, "conductivity": 60.0}
    >>> ring = surface_temperature(300.0, heat=500.0, **case) - 300.0
    >>> half = surface_temperature(300.0, heat=500.0, arc=np.pi, **case) - 300.0
    >>> print(f"{half / ring:.3f}")
    2.000
    """
    # conduction through a cylindrical wall
    return measured_temperature + heat * np.log((pin_diameter + 2 * wall) / pin_diameter) / (
        arc * width * conductivity
    )


@formula()
def thermal_growth(diameter: Values, *, expansion: Values, temperature_change: Values) -> Values:
    """Compute the thermal growth of a diameter: d alpha dT. Strand (2005), eq. 30.

    Parameters
    ----------
    diameter, expansion, temperature_change : float or array
        Diameter d [m], coefficient of linear thermal expansion alpha [1/K], rise of the temperature
        dT [K].

    Returns
    -------
    float or array
        Change of the diameter, positive for growth. [m]

    Examples
    --------
    Steel of 80 mm, 50 K warmer:

    >>> growth = thermal_growth(0.08, expansion=12e-6, temperature_change=50.0)
    >>> print(f"{growth * 1e6:.0f} um")
    48 um
    """
    return diameter * expansion * temperature_change
