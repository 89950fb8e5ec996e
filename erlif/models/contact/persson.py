"""Pressure of a pin in a bushing: prescribed (Strand, 2005), or that of their contact.

The contact goes over an arc of a bushing of the pin's material, up to all round it (Persson, 1964).
"""

from typing import NamedTuple

import numpy as np

from erlif.core.errors import ModelError
from erlif.models.arguments import Values, formula
from erlif.models.contact.roots import like

# E Delta / 2q at which Persson's contact closes around the pin. [1]
FULL_CONTACT = -2 / np.pi

# Steps to the last digit of any half contact angle from 1e-65 to pi - 1e-8, one in reserve.
_NEWTON_STEPS = 5


@formula(load_per_length="signed line_load")
def projected_pressure(load_per_length: Values, *, pin_diameter: Values) -> Values:
    """Compute the load over the projected area of a pin: p = q / d. Strand (2005), eq. 6.

    Parameters
    ----------
    load_per_length : float or array
        Line load q. [N/m]
    pin_diameter : float or array
        Diameter d of the pin. [m]

    Returns
    -------
    float or array
        Projected pressure p. [Pa]

    Examples
    --------
    400 N on a bushing of 10 mm by 10 mm; Colbert et al. (2009) give 4 MPa.

    >>> print(f"{projected_pressure(400 / 0.010, pin_diameter=0.010) / 1e6:.1f} MPa")
    4.0 MPa
    """
    return load_per_length / pin_diameter


@formula(load_per_length="signed line_load")
def sinusoidal_pressure(load_per_length: Values, *, pin_diameter: Values) -> Values:
    """Compute the maximum of a cosine pressure over half the pin. Strand (2005), eq. 7.

    p = 4q / (pi d).

    Parameters
    ----------
    load_per_length : float or array
        Line load q. [N/m]
    pin_diameter : float or array
        Diameter d of the pin. [m]

    Returns
    -------
    float or array
        Maximum pressure p, on the line of load. [Pa]

    Notes
    -----
    Against Persson's law this pressure is safe from a half contact angle of 72.9 degrees (printed:
    72), and 2q/d from 38.8 degrees (printed: 38).

    Examples
    --------
    4/pi times the projected pressure of 4 MPa:

    >>> print(f"{sinusoidal_pressure(400 / 0.010, pin_diameter=0.010) / 1e6:.3f} MPa")
    5.093 MPa
    """
    # the load is int p cos^2(theta) d/2 over half the pin: p pi d / 4
    return 4 * load_per_length / (np.pi * pin_diameter)


@formula(half_angle="arc")
def persson_group(half_angle: Values) -> Values:
    """Compute E Delta / 2q of a conformal contact. Persson (1964); Strand (2005), eq. 9.

    [2 - ln(1 + b^2) - 2 b^4] / [pi b^2 (1 + b^2)] with b = tan(half_angle / 2).

    Parameters
    ----------
    half_angle : float or array
        Half of the arc of contact. [rad]

    Returns
    -------
    float or array
        E Delta / 2q. [1]

    Notes
    -----
    Delta is the diametral play, q the line load and E Young's modulus of both bodies in plane
    stress; in plane strain put E/(1 - nu^2). The group falls from infinity (a point contact)
    through zero at b = 0.9136 (no play) to -2/pi (an interference with contact all round).

    Examples
    --------
    At 90 degrees b is 1 and the group -ln(2) / 2 pi:

    >>> from math import log, pi
    >>> print(f"{persson_group(pi / 2):.6f} {-log(2) / (2 * pi):.6f}")
    -0.110318 -0.110318
    """
    b2 = np.tan(half_angle / 2) ** 2  # log1p keeps the digits of narrow contacts
    return (2 - np.log1p(b2) - 2 * b2**2) / (np.pi * b2 * (1 + b2))


@formula(half_angle="arc")
def persson_peak_group(half_angle: Values) -> Values:
    """Compute d p_max / 2q of a conformal contact. Persson (1964); Strand (2005), eq. 9.

    2b / (pi sqrt(1 + b^2)) + asinh(b) / [pi b^2 (1 + b^2)] with b = tan(half_angle / 2).

    Parameters
    ----------
    half_angle : float or array
        Half of the arc of contact. [rad]

    Returns
    -------
    float or array
        d p_max / 2q. [1]

    Notes
    -----
    The last row of Strand's table prints -2/pi for the closed contact; the limit is +2/pi.

    Examples
    --------
    At 90 degrees b is 1 and the group sqrt(2)/pi + asinh(1) / 2 pi:

    >>> from math import asinh, pi, sqrt
    >>> print(f"{persson_peak_group(pi / 2):.6f} {sqrt(2) / pi + asinh(1) / (2 * pi):.6f}")
    0.590433 0.590433
    """
    b = np.tan(half_angle / 2)
    return 2 * b / (np.pi * np.sqrt(1 + b**2)) + np.arcsinh(b) / (np.pi * b**2 * (1 + b**2))


@formula()
def persson_half_angle(group: Values) -> Values:
    """Find the half contact angle from E Delta / 2q, the inverse of `persson_group`.

    Parameters
    ----------
    group : float or array
        E Delta / 2q, above -2/pi. [1]

    Returns
    -------
    float or array
        Half contact angle. [rad]

    Raises
    ------
    ModelError
        A value at or below -2/pi, where the contact has closed around the pin, or an infinite one.

    Examples
    --------
    Without play the contact spans 84.8 degrees to either side, whatever the load:

    >>> from math import degrees
    >>> print(f"{degrees(persson_half_angle(0.0)):.1f} degrees")
    84.8 degrees
    """
    if np.any(np.less_equal(group, FULL_CONTACT)):
        raise ModelError(
            f"group (E Delta / 2q) must exceed -2/pi, got {float(np.nanmin(np.asarray(group))):g}: "
            "the interference presses all round the pin."
        )

    # the logarithm of the distance from the closed contact falls almost linearly in ln b, so that
    # Newton's method converges from any start
    wanted = np.log(np.asarray(group, float) - FULL_CONTACT)
    log_b = -wanted / 2
    for _ in range(_NEWTON_STEPS):
        b2 = np.exp(2 * log_b)
        shape = 2 - np.log1p(b2) + 2 * b2
        distance = np.log(shape / (np.pi * (1 + b2))) - 2 * log_b - wanted
        slope = 2 * b2 * ((2 - 1 / (1 + b2)) / shape - 1 / (1 + b2)) - 2
        log_b = log_b - distance / slope
    return like(group, 2 * np.arctan(np.exp(log_b)))


@formula(half_angle="arc", angle="signed number", load_per_length="signed line_load")
def persson_pressure(
    angle: Values, *, half_angle: Values, load_per_length: Values, pin_diameter: Values
) -> Values:
    """Compute the pressure along the arc of a conformal contact. Persson (1964).

    d p / 2q = 2u / [pi s (1 + y^2)] + ln[(s + u)/(s - u)] / [2 pi b^2 (1 + b^2)],
    with b = tan(half_angle / 2), y = tan(angle / 2), s = sqrt(1 + b^2), u = sqrt(b^2 - y^2).

    Parameters
    ----------
    half_angle : float or array
        Half of the arc of contact. [rad]
    load_per_length : float or array
        Line load q. [N/m]
    pin_diameter : float or array
        Diameter d of the pin. [m]
    angle : float or array
        Angle from the line of load. [rad]

    Returns
    -------
    float or array
        Pressure, zero outside the contact. [Pa]

    Raises
    ------
    ModelError
        A half angle outside 0 to pi, a diameter not positive, or an infinite value.

    Examples
    --------
    On the line of load the pressure is that of `persson_peak_group`; at the edge it vanishes:

    >>> from erlif.models.contact import persson_peak_group
    >>> case = {"half_angle": 1.0, "load_per_length": 1e5, "pin_diameter": 0.08}
    >>> peak = persson_peak_group(1.0) * 2 * 1e5 / 0.08
    >>> print(f"{persson_pressure(0.0, **case) / peak:.9f}", persson_pressure(1.0, **case))
    1.000000000 0.0
    """

    b, y = np.tan(half_angle / 2), np.tan(angle / 2)
    s = np.sqrt(1 + b**2)
    u = np.sqrt(np.maximum(b**2 - y**2, 0.0))  # zero outside the contact, and so is the pressure
    shape = 2 * u / (np.pi * s * (1 + y**2)) + np.arctanh(u / s) / (np.pi * b**2 * (1 + b**2))
    return shape * 2 * load_per_length / pin_diameter


class ConformalContact(NamedTuple):
    """Contact of a pin in a bushing of the same material.

    Attributes
    ----------
    half_angle, pressure : Values
        Half of the arc of contact [rad], maximum pressure, on the line of load [Pa].
    """

    half_angle: Values
    pressure: Values


@formula()
def persson_contact(
    load_per_length: Values, *, play: Values, pin_diameter: Values, youngs_modulus: Values
) -> ConformalContact:
    """Solve the contact of a pin in a bushing of the same material. Strand (2005), eq. 9.

    Parameters
    ----------
    load_per_length : float or array
        Line load q. [N/m]
    play : float or array
        Bore less pin diameter; negative for an interference. [m]
    pin_diameter : float or array
        Diameter d of the pin. [m]
    youngs_modulus : float or array
        E of both bodies for plane stress; E/(1 - nu^2) for plane strain. [Pa]

    Returns
    -------
    ConformalContact
        Half contact angle [rad] and maximum pressure [Pa].

    Raises
    ------
    ModelError
        A value not positive or not finite, or an interference so large that the contact closes
        around the pin.

    Notes
    -----
    Equal elastic constants only; frictionless; infinite bodies around the hole.

    Examples
    --------
    The joint of Farzaneh (2002) under 100,000 lbf over 237 mm. Hertz, who takes the arc as flat,
    gives 116.1 MPa on a half angle of 17.7 degrees.

    >>> from math import degrees
    >>> contact = persson_contact(
    ...     444822.0 / 0.237, play=0.46e-3, pin_diameter=0.06672, youngs_modulus=200e9
    ... )
    >>> print(f"{degrees(contact.half_angle):.2f} degrees, {contact.pressure / 1e6:.1f} MPa")
    17.97 degrees, 115.6 MPa
    """

    group = youngs_modulus * play / (2 * load_per_length)
    if np.any(np.less_equal(group, FULL_CONTACT)):
        raise ModelError(
            "play must keep E play / (2 load_per_length) above -2/pi, got "
            f"{float(np.nanmin(np.asarray(group))):g}: the interference presses all round the pin."
        )
    half_angle = persson_half_angle(group)
    return ConformalContact(
        half_angle, persson_peak_group(half_angle) * 2 * load_per_length / pin_diameter
    )


@formula(interference="length")
def closed_contact_pressure(
    load_per_length: Values, *, interference: Values, pin_diameter: Values, youngs_modulus: Values
) -> Values:
    """Compute the largest pressure of a pin that an interference presses all around.

    p = E I / (2d) + 2q / (pi d): the pressure of the interference alone, after Lame, and a cosine
    that carries the load. It continues eq. 9 of Strand (2005), whose contact closes at
    I = 4q / (pi E).

    Parameters
    ----------
    load_per_length : float or array
        Line load q. [N/m]
    pin_diameter : float or array
        Diameter d of the pin. [m]
    interference, youngs_modulus : float or array
        Pin diameter less bore I, from 4q / (pi E) on [m], E of both bodies for plane stress [Pa].

    Returns
    -------
    float or array
        Largest pressure, on the line of load; on the other side it is 4q / (pi d) less. [Pa]

    Raises
    ------
    ModelError
        A value not positive or not finite, or an interference at which the contact is open.

    Examples
    --------
    Where the contact closes, the pressure is 4q / (pi d), as for eq. 7:

    >>> from erlif.models.contact import sinusoidal_pressure
    >>> case = {"pin_diameter": 0.08, "youngs_modulus": 200e9}
    >>> closing = 4 * 1e6 / (np.pi * 200e9)
    >>> pressure = closed_contact_pressure(1e6, interference=closing, **case)
    >>> print(f"{pressure / 1e6:.4f} MPa, {sinusoidal_pressure(1e6, pin_diameter=0.08) / 1e6:.4f}")
    15.9155 MPa, 15.9155
    """

    group = youngs_modulus * interference / (2 * load_per_length)
    if np.any(np.less(group, -FULL_CONTACT * (1 - 1e-9))):
        times = float(np.nanmin(np.asarray(group / -FULL_CONTACT)))
        raise ModelError(
            "interference must be at least 4 load_per_length / (pi E), below which the contact is "
            f"open, got {times:.3g} times that."
        )
    alone = youngs_modulus * interference / (2 * pin_diameter)
    return alone + 2 * load_per_length / (np.pi * pin_diameter)


@formula(half_angle="arc")
def persson_load(half_angle: Values, *, play: Values, youngs_modulus: Values) -> Values:
    """Compute the line load that spreads the contact to a half angle. Strand (2005), eq. 9.

    The inverse of `persson_contact`.

    Parameters
    ----------
    half_angle : float or array
        Half of the arc of contact. [rad]
    play : float or array
        Bore less pin diameter; negative for an interference. [m]
    youngs_modulus : float or array
        E of both bodies for plane stress; E/(1 - nu^2) for plane strain. [Pa]

    Returns
    -------
    float or array
        Line load q. [N/m]

    Raises
    ------
    ModelError
        A play of zero, or an angle that no load gives: a play opens contacts below 84.8 degrees, an
        interference above. A modulus not positive, or an infinite value.

    Examples
    --------
    The line load of `persson_contact` comes back:

    >>> from erlif.models.contact import persson_contact
    >>> contact = persson_contact(1e6, play=0.4e-3, pin_diameter=0.06, youngs_modulus=200e9)
    >>> print(f"{persson_load(contact.half_angle, play=0.4e-3, youngs_modulus=200e9):.1f} N/m")
    1000000.0 N/m
    """
    if np.any(np.equal(play, 0)):
        raise ModelError(
            "play must not be zero: the half contact angle is then 84.8 degrees at any load."
        )

    # play and group must share their sign, else no positive load belongs to the angle
    load = youngs_modulus * play / (2 * persson_group(half_angle))
    if not np.all(np.greater(load, 0) | np.isnan(load)):
        raise ModelError(
            "half_angle must be below 84.8 degrees with play and above it with an interference: no "
            "load gives this one."
        )
    return load
