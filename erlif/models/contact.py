"""Dry contact of a pin in a bushing, and the scaling of loads between materials.

A pin in a bushing touches over an arc. Half of that arc is the half contact angle, measured at the
axis of the pin. The models differ in how they treat the arc:

- the laws of projected and of sinusoidal pressure prescribe the pressure (Strand, 2005);
- Hertz takes the arc as flat, which holds up to about 20 degrees (Johnson, 1985; Farzaneh, 2002);
- Persson (1964) solves the arc for equal materials, up to contact all round the pin;
- Winkler's bushing is a compliant liner on a rigid shaft (Colbert et al., 2009).

The impact law is that of Lankarani and Nikravesh (1994) as used by Mukras et al. (2008).
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import scipy

from erlif.core.errors import ModelError
from erlif.models.arguments import (
    Values,
    broadcasting,
    check_length,
    check_line_load,
    check_load,
    check_modulus,
    check_reduced_radius,
    check_speed,
    require_between,
    require_finite,
    require_increasing,
    require_poisson,
    require_positive,
)
from erlif.models.winkler_arc import (
    arc_of_load,
    eccentricity_of_arc,
    indentation_of_arc,
    supported_by_arc,
)

if TYPE_CHECKING:
    from scipy.interpolate import BSpline

FULL_CONTACT = -2 / np.pi
"""E Delta / 2q at which Persson's contact closes around the pin. [1]"""

THESIS_F1, THESIS_F2 = 0.89, 0.88
"""Factors of the ellipse that Farzaneh (2002), appendix B, reads for the lobed bushing. [1]"""

_SMALLEST_LOG_B, _LARGEST_LOG_B = -150.0, 17.0
"""Search range of ln tan(half_angle / 2): half contact angles from 1e-65 to pi - 1e-7."""

_ROOT_TOLERANCE = 1e-14
"""Absolute and relative: the roots are exact to a few units of the last place."""

_LARGEST_LOG_AXES, _AXES_KNOTS = 20.0, 8192
"""Range and number of the tabulated ratios of axes: radii in a ratio of up to 1e16."""


@broadcasting
def conformal_radius(pin_radius: Values, *, bushing_radius: Values) -> Values:
    """Compute the reduced radius of a pin in a bushing. Farzaneh (2002), eq. 2.8.

    R = R1 R2 / (R1 - R2).

    Parameters
    ----------
    pin_radius, bushing_radius : float or array
        Radii R2 of the pin and R1 of the bore. [m]

    Returns
    -------
    float or array
        Reduced radius R. [m]

    Raises
    ------
    ModelError
        A radius not positive or not finite, or a bushing not larger than its pin.

    Examples
    --------
    The joint of Farzaneh (2002); the source gives 4.872 m.

    >>> print(f"{conformal_radius(0.03336, bushing_radius=0.03359):.3f} m")
    4.872 m
    """
    require_positive(pin_radius=pin_radius, bushing_radius=bushing_radius)
    require_increasing(pin_radius=pin_radius, bushing_radius=bushing_radius)
    check_length(pin_radius=pin_radius, bushing_radius=bushing_radius)
    return pin_radius * bushing_radius / (bushing_radius - pin_radius)


@broadcasting
def contact_modulus(
    youngs_1: Values, *, poisson_1: Values, youngs_2: Values, poisson_2: Values
) -> Values:
    """Compute the contact modulus E* of two bodies. Farzaneh (2002), eq. B.1.

    1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2.

    Parameters
    ----------
    youngs_1, youngs_2 : float or array
        Young's moduli. [Pa]
    poisson_1, poisson_2 : float or array
        Poisson's ratios. [1]

    Returns
    -------
    float or array
        Contact modulus E*. [Pa]

    Raises
    ------
    ModelError
        A modulus not positive or not finite, or a Poisson's ratio outside -1 to 0.5.

    Notes
    -----
    The E' of Strand (2005) is this E*. The E' of the film formulas of Dowson, Higginson and Hamrock
    is 2 E*.

    Examples
    --------
    Steel on steel, 200 GPa and 0.3: half of 200 / 0.91 GPa.

    >>> modulus = contact_modulus(200e9, poisson_1=0.3, youngs_2=200e9, poisson_2=0.3)
    >>> print(f"{modulus / 1e9:.2f} GPa")
    109.89 GPa
    """
    require_positive(youngs_1=youngs_1, youngs_2=youngs_2)
    require_poisson(poisson_1=poisson_1, poisson_2=poisson_2)
    check_modulus(youngs_1=youngs_1, youngs_2=youngs_2)
    return 1 / ((1 - poisson_1**2) / youngs_1 + (1 - poisson_2**2) / youngs_2)


@broadcasting
def scale_load(
    load: Values,
    *,
    youngs_modulus: Values,
    model_youngs_modulus: Values,
    length_ratio: Values = 1.0,
) -> Values:
    """Compute the load that strains a model joint like the full one. Farzaneh (2002), eq. 3.13.

    The group F / (E D l) is kept.

    Parameters
    ----------
    load : float or array
        Load F on the full joint. [N]
    youngs_modulus, model_youngs_modulus : float or array
        Young's moduli of the full joint and of the model. [Pa]
    length_ratio : float or array
        Lengths of the model over those of the full joint. [1]

    Returns
    -------
    float or array
        Load on the model. [N]

    Raises
    ------
    ModelError
        A modulus or length ratio not positive or not finite, or an infinite load.

    Notes
    -----
    Complete similarity also keeps D/l, d/l and Poisson's ratio. Steel (0.3) and acrylic (0.37)
    differ in the last. Stresses then scale as the moduli, see `scale_stress`.

    Examples
    --------
    An acrylic joint has 1/75 of the modulus of steel: 100,000 lbf become 1333 lbf, as the source
    states. The load keeps its unit.

    >>> load = scale_load(100e3, youngs_modulus=202.5e9, model_youngs_modulus=2.7e9)
    >>> print(f"{load:.0f} lbf")
    1333 lbf
    """
    require_finite(load=load)
    require_positive(youngs_modulus=youngs_modulus, model_youngs_modulus=model_youngs_modulus)
    require_positive(length_ratio=length_ratio)
    check_load(load=load)
    check_modulus(youngs_modulus=youngs_modulus, model_youngs_modulus=model_youngs_modulus)
    # area and modulus both scale the load of a given strain
    return load * model_youngs_modulus / youngs_modulus * length_ratio**2


@broadcasting
def scale_stress(stress: Values, *, youngs_modulus: Values, model_youngs_modulus: Values) -> Values:
    """Compute the stress in a model joint. Farzaneh (2002), eq. 3.13.

    Under the load of `scale_load` the ratio sigma / E is kept.

    Parameters
    ----------
    stress : float or array
        Stress in the full joint. [Pa]
    youngs_modulus, model_youngs_modulus : float or array
        Young's moduli of the full joint and of the model. [Pa]

    Returns
    -------
    float or array
        Stress in the model. [Pa]

    Raises
    ------
    ModelError
        A modulus not positive or not finite, or an infinite stress.

    Examples
    --------
    >>> stress = scale_stress(7.5e6, youngs_modulus=202.5e9, model_youngs_modulus=2.7e9)
    >>> print(f"{stress / 1e6:.2f} MPa")
    0.10 MPa
    """
    require_finite(stress=stress)
    require_positive(youngs_modulus=youngs_modulus, model_youngs_modulus=model_youngs_modulus)
    check_modulus(youngs_modulus=youngs_modulus, model_youngs_modulus=model_youngs_modulus)
    return stress * model_youngs_modulus / youngs_modulus


@broadcasting
def projected_pressure(load_per_length: Values, *, pin_diameter: Values) -> Values:
    """Compute the load over the projected area of a pin: p = q / d. Strand (2005), eq. 6.

    Parameters
    ----------
    load_per_length : float or array
        Line load q. [N/m]
    pin_diameter : float or array
        d. [m]

    Returns
    -------
    float or array
        Projected pressure p. [Pa]

    Raises
    ------
    ModelError
        A diameter not positive or not finite, or an infinite line load.

    Examples
    --------
    400 N on a bushing of 10 mm by 10 mm; Colbert et al. (2009) give 4 MPa.

    >>> print(f"{projected_pressure(400 / 0.010, pin_diameter=0.010) / 1e6:.1f} MPa")
    4.0 MPa
    """
    require_finite(load_per_length=load_per_length)
    require_positive(pin_diameter=pin_diameter)
    check_line_load(load_per_length=load_per_length)
    check_length(pin_diameter=pin_diameter)
    return load_per_length / pin_diameter


@broadcasting
def sinusoidal_pressure(load_per_length: Values, *, pin_diameter: Values) -> Values:
    """Compute the maximum of a cosine pressure over half the pin. Strand (2005), eq. 7.

    p = 4q / (pi d).

    Parameters
    ----------
    load_per_length : float or array
        Line load q. [N/m]
    pin_diameter : float or array
        d. [m]

    Returns
    -------
    float or array
        Maximum pressure p, on the line of load. [Pa]

    Raises
    ------
    ModelError
        A diameter not positive or not finite, or an infinite line load.

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
    require_finite(load_per_length=load_per_length)
    require_positive(pin_diameter=pin_diameter)
    check_line_load(load_per_length=load_per_length)
    check_length(pin_diameter=pin_diameter)
    # the load is int p cos^2(theta) d/2 over half the pin: p pi d / 4
    return 4 * load_per_length / (np.pi * pin_diameter)


class LineContact(NamedTuple):
    """Hertzian contact along a line.

    Attributes
    ----------
    half_width : Values
        Half width b of the contact. [m]
    pressure : Values
        Maximum pressure p0. [Pa]
    """

    half_width: Values
    pressure: Values


@broadcasting
def hertz_line(load_per_length: Values, *, radius: Values, contact_modulus: Values) -> LineContact:
    """Compute half width and maximum pressure of a Hertzian line contact. Strand (2005), eq. 8.

    b = sqrt(4 q R / (pi E*)),  p0 = sqrt(q E* / (pi R)).

    Parameters
    ----------
    load_per_length : float or array
        Line load q. [N/m]
    radius : float or array
        Reduced radius R, see `conformal_radius`. [m]
    contact_modulus : float or array
        E*, see `contact_modulus`. [Pa]

    Returns
    -------
    LineContact
        Half width [m] and maximum pressure [Pa].

    Raises
    ------
    ModelError
        A value not positive or not finite.

    Notes
    -----
    The contact must be narrow against the pin. In a conformal joint Hertz is 0.3 % low in pressure
    at a half contact angle of 5 degrees, 1.2 % at 10, 4.8 % at 20 and 19 % at 40; use
    `persson_contact` there.

    Examples
    --------
    The acrylic joint of Farzaneh (2002) under 50 lbf over 237 mm:

    >>> modulus = contact_modulus(2.7e9, poisson_1=0.37, youngs_2=2.7e9, poisson_2=0.37)
    >>> contact = hertz_line(222.4 / 0.237, radius=4.872, contact_modulus=modulus)
    >>> print(f"{contact.half_width * 1e3:.2f} mm, {contact.pressure / 1e6:.2f} MPa")
    1.93 mm, 0.31 MPa
    """
    require_positive(
        load_per_length=load_per_length, radius=radius, contact_modulus=contact_modulus
    )
    check_line_load(load_per_length=load_per_length)
    check_reduced_radius(radius=radius)
    check_modulus(contact_modulus=contact_modulus)
    half_width = np.sqrt(4 * load_per_length * radius / (np.pi * contact_modulus))
    return LineContact(half_width, np.sqrt(load_per_length * contact_modulus / (np.pi * radius)))


class RelativeRadii(NamedTuple):
    """Reduced radii of two curved bodies at their point of contact.

    Attributes
    ----------
    radius : Values
        The larger reduced radius R'. [m]
    radius_across : Values
        The smaller reduced radius R''. [m]
    """

    radius: Values
    radius_across: Values


@broadcasting
def relative_radii(
    radius_1: Values,
    *,
    radius_1_across: Values,
    radius_2: Values,
    radius_2_across: Values,
    angle: Values = 0.0,
) -> RelativeRadii:
    """Compute the two reduced radii of two curved bodies. Farzaneh (2002), eqs. B.3 to B.6.

    A + B is half of the sum of the four curvatures, B - A follows from eq. B.4, and
    R' = 1/(2A) >= R'' = 1/(2B).

    Parameters
    ----------
    radius_1, radius_1_across, radius_2, radius_2_across : float or array
        Principal radii of the two bodies, in the direction of the first and across it; negative
        where concave, `inf` where straight. [m]
    angle : float or array
        Angle between the principal directions of the two bodies. [rad]

    Returns
    -------
    RelativeRadii
        The larger and the smaller reduced radius. [m]

    Raises
    ------
    ModelError
        A radius of zero, or bodies that would touch at more than a point.

    Notes
    -----
    Eq. B.3 prints the curvature 1/R2'' twice; one of them is 1/R2'.

    Examples
    --------
    Crossed equal cylinders touch like a sphere of the same radius on a plane:

    >>> from math import inf, pi
    >>> relative_radii(
    ...     0.1, radius_1_across=inf, radius_2=0.1, radius_2_across=inf, angle=pi / 2
    ... )
    RelativeRadii(radius=0.1, radius_across=0.1)
    """
    radii = {
        "radius_1": radius_1,
        "radius_1_across": radius_1_across,
        "radius_2": radius_2,
        "radius_2_across": radius_2_across,
    }
    for name, radius in radii.items():
        if np.any(np.equal(radius, 0)):
            raise ModelError(f"{name} must not be zero.")
    require_finite(angle=angle)

    k1, k1_across, k2, k2_across = (1 / radius for radius in radii.values())
    total = (k1 + k1_across + k2 + k2_across) / 2
    first, second = k1 - k1_across, k2 - k2_across
    # rounding can leave the square of B - A below zero where the bodies are equal and crossed
    square = np.maximum(first**2 + second**2 + 2 * first * second * np.cos(2 * angle), 0.0)
    difference = np.sqrt(square) / 2
    A, B = (total - difference) / 2, (total + difference) / 2

    # at A = 0 the bodies touch along a line, below it they overlap beside the point of contact
    if np.any(np.less_equal(A, 0)):
        raise ModelError(
            "radius_1, radius_2 and those across must leave a gap all round the point of contact, "
            f"got a smallest relative curvature of {2 * float(np.nanmin(np.asarray(A))):g} 1/m."
        )
    return RelativeRadii(1 / (2 * A), 1 / (2 * B))


@dataclass(frozen=True)
class EllipticalContact:
    """Hertzian contact over an ellipse.

    Attributes
    ----------
    a : Values
        Semi-axis in the direction of the larger reduced radius. [m]
    b : Values
        Semi-axis across it. [m]
    pressure : Values
        Maximum pressure. [Pa]
    approach : Values
        Approach of the two bodies. [m]
    """

    a: Values
    b: Values
    pressure: Values
    approach: Values


@broadcasting
def hertz_ellipse(
    load: Values, *, radius: Values, radius_across: Values, contact_modulus: Values
) -> EllipticalContact:
    """Solve the Hertzian contact over an ellipse. Johnson (1985), eqs. 4.26 to 4.28.

    With p = (b/a)^2 and Carlson's elliptic integrals R_D and R_F:
    R'/R'' = R_D(0,1,p)/R_D(0,p,1),  F1^3 = 4 p^(3/4) sqrt(R_D(0,1,p) R_D(0,p,1)) / (3 pi),
    sqrt(ab) = (3 P Req / 4 E*)^(1/3) F1,  p0 = 3P/(2 pi a b),
    delta = (9 P^2/(16 Req E*^2))^(1/3) F2,  F2 = 2 p^(1/4) R_F(0,p,1) / (pi F1),
    Req = sqrt(R' R'').

    Parameters
    ----------
    load : float or array
        Load P. [N]
    radius, radius_across : float or array
        The larger and the smaller reduced radius R' and R'', see `relative_radii`. [m]
    contact_modulus : float or array
        E*, see `contact_modulus`. [Pa]

    Returns
    -------
    EllipticalContact
        Semi-axes, maximum pressure and approach. [m, Pa]

    Raises
    ------
    ModelError
        A value not positive or not finite, or `radius` below `radius_across`.

    Notes
    -----
    a and b are semi-axes; Farzaneh (2002), appendix B, calls them lengths of the axes. Both must be
    small against the radii of the bodies. On the lobed bushing of that source, at 100 klbf, a is
    28.5 mm along the circumference of a pin of 33.4 mm radius, so there the numbers only compare
    designs.

    Examples
    --------
    A ball of 20 mm radius on a plane: the radius of contact is (3 P R / 4 E*)^(1/3), and the
    approach its square over R.

    >>> found = hertz_ellipse(100.0, radius=0.02, radius_across=0.02, contact_modulus=1.1e11)
    >>> print(f"{found.a * 1e6:.2f} um, {(0.75 * 100.0 * 0.02 / 1.1e11) ** (1 / 3) * 1e6:.2f} um")
    238.91 um, 238.91 um
    >>> print(f"{found.approach * 1e6:.4f} um, {found.a**2 / 0.02 * 1e6:.4f} um")
    2.8539 um, 2.8539 um
    """
    _require_point_contact(load, radius, radius_across, contact_modulus)
    if np.any(np.less(radius, radius_across)):
        raise ModelError(
            "radius must be the larger reduced radius and radius_across the smaller one."
        )

    # the axes follow from the shape alone; load and modulus only set their size
    radius_ratio = radius / radius_across
    p = _like(radius_ratio, _axis_ratio(np.asarray(radius_ratio, float))) ** -2.0
    # the ratio of both integrals R_D is that of the radii
    across = scipy.special.elliprd(0.0, p, 1.0)
    F1 = (4 * p**0.75 * np.sqrt(radius_ratio) * across / (3 * np.pi)) ** (1 / 3)
    F2 = 2 * p**0.25 * scipy.special.elliprf(0.0, p, 1.0) / (np.pi * F1)
    return _ellipse(load, radius, radius_across, contact_modulus, axis_ratio=p**-0.5, F1=F1, F2=F2)


@broadcasting
def thesis_ellipse(
    load: Values, *, radius: Values, radius_across: Values, contact_modulus: Values
) -> EllipticalContact:
    """Solve the elliptical contact as Farzaneh (2002), appendix B, does.

    a/b = (R'/R'')^(2/3), F1 = 0.89, F2 = 0.88.

    Parameters
    ----------
    load : float or array
        Load P. [N]
    radius, radius_across : float or array
        The larger and the smaller reduced radius R' and R''. [m]
    contact_modulus : float or array
        E*. [Pa]

    Returns
    -------
    EllipticalContact
        Semi-axes, maximum pressure and approach. [m, Pa]

    Raises
    ------
    ModelError
        A value not positive or not finite.

    Notes
    -----
    The two factors are those of the lobed bushing (R'/R'' = 24.4); the pressure there is 0.4 %
    above the exact one of `hertz_ellipse`. Eq. B.10 lacks the exponent 1/3 and prints F1^(-2/3) for
    F1^-2; the worked value uses 3P/(2 pi a b), as here.

    Examples
    --------
    The lobed bushing at 50,000 lbf per lobe; the source prints 1024 MPa.

    >>> found = thesis_ellipse(
    ...     222.41e3, radius=4.87201, radius_across=0.2, contact_modulus=109.8901e9
    ... )
    >>> print(f"{found.pressure / 1e6:.0f} MPa")
    1024 MPa
    """
    _require_point_contact(load, radius, radius_across, contact_modulus)
    axis_ratio = (radius / radius_across) ** (2 / 3)
    return _ellipse(
        load,
        radius,
        radius_across,
        contact_modulus,
        axis_ratio=axis_ratio,
        F1=THESIS_F1,
        F2=THESIS_F2,
    )


@broadcasting
def persson_group(half_angle: Values) -> Values:
    """Compute E Delta / 2q of a conformal contact. Persson (1964); Strand (2005), eq. 9.

    [2 - ln(1 + b^2) - 2 b^4] / [pi b^2 (1 + b^2)] with b = tan(half_angle / 2).

    Parameters
    ----------
    half_angle : float or array
        Half contact angle, above 0 and below pi. [rad]

    Returns
    -------
    float or array
        E Delta / 2q. [1]

    Raises
    ------
    ModelError
        An angle outside 0 to pi.

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
    _require_half_angle(half_angle)
    b2 = np.tan(half_angle / 2) ** 2  # log1p keeps the digits of narrow contacts
    return (2 - np.log1p(b2) - 2 * b2**2) / (np.pi * b2 * (1 + b2))


@broadcasting
def persson_peak_group(half_angle: Values) -> Values:
    """Compute d p_max / 2q of a conformal contact. Persson (1964); Strand (2005), eq. 9.

    2b / (pi sqrt(1 + b^2)) + asinh(b) / [pi b^2 (1 + b^2)] with b = tan(half_angle / 2).

    Parameters
    ----------
    half_angle : float or array
        Half contact angle, above 0 and below pi. [rad]

    Returns
    -------
    float or array
        d p_max / 2q. [1]

    Raises
    ------
    ModelError
        An angle outside 0 to pi.

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
    _require_half_angle(half_angle)
    b = np.tan(half_angle / 2)
    return 2 * b / (np.pi * np.sqrt(1 + b**2)) + np.arcsinh(b) / (np.pi * b**2 * (1 + b**2))


@broadcasting
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
    require_finite(group=group)
    if np.any(np.less_equal(group, FULL_CONTACT)):
        raise ModelError(
            f"group (E Delta / 2q) must exceed -2/pi, got {float(np.nanmin(np.asarray(group))):g}: "
            "the interference presses all round the pin."
        )

    # the logarithm of the distance from the closed contact falls almost linearly in ln b, so the
    # search converges from any bracket
    wanted = np.log(np.asarray(group, float) - FULL_CONTACT)
    log_b = _solve(
        _log_of_persson_group_above_full_contact, _SMALLEST_LOG_B, _LARGEST_LOG_B, wanted
    )
    return _like(group, 2 * np.arctan(np.exp(log_b)))


@broadcasting
def persson_pressure(
    angle: Values, *, half_angle: Values, load_per_length: Values, pin_diameter: Values
) -> Values:
    """Compute the pressure along the arc of a conformal contact. Persson (1964).

    d p / 2q = 2u / [pi s (1 + y^2)] + ln[(s + u)/(s - u)] / [2 pi b^2 (1 + b^2)],
    with b = tan(half_angle / 2), y = tan(angle / 2), s = sqrt(1 + b^2), u = sqrt(b^2 - y^2).

    Parameters
    ----------
    angle : float or array
        Angle from the line of load. [rad]
    half_angle : float or array
        Half contact angle. [rad]
    load_per_length : float or array
        Line load q. [N/m]
    pin_diameter : float or array
        d. [m]

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

    >>> case = {"half_angle": 1.0, "load_per_length": 1e5, "pin_diameter": 0.08}
    >>> peak = persson_peak_group(1.0) * 2 * 1e5 / 0.08
    >>> print(f"{persson_pressure(0.0, **case) / peak:.9f}", persson_pressure(1.0, **case))
    1.000000000 0.0
    """
    _require_half_angle(half_angle)
    require_finite(angle=angle, load_per_length=load_per_length)
    require_positive(pin_diameter=pin_diameter)
    check_line_load(load_per_length=load_per_length)
    check_length(pin_diameter=pin_diameter)

    b, y = np.tan(half_angle / 2), np.tan(angle / 2)
    s = np.sqrt(1 + b**2)
    u = np.sqrt(np.maximum(b**2 - y**2, 0.0))  # zero outside the contact, and so is the pressure
    shape = 2 * u / (np.pi * s * (1 + y**2)) + np.arctanh(u / s) / (np.pi * b**2 * (1 + b**2))
    return shape * 2 * load_per_length / pin_diameter


class ConformalContact(NamedTuple):
    """Contact of a pin in a bushing of the same material.

    Attributes
    ----------
    half_angle : Values
        Half of the arc of contact. [rad]
    pressure : Values
        Maximum pressure, on the line of load. [Pa]
    """

    half_angle: Values
    pressure: Values


@broadcasting
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
        d. [m]
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
    require_positive(
        load_per_length=load_per_length, pin_diameter=pin_diameter, youngs_modulus=youngs_modulus
    )
    require_finite(play=play)
    check_line_load(load_per_length=load_per_length)
    check_length(play=play, pin_diameter=pin_diameter)
    check_modulus(youngs_modulus=youngs_modulus)

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


@broadcasting
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
    interference : float or array
        Pin diameter less bore I, from 4q / (pi E) on. [m]
    pin_diameter : float or array
        d. [m]
    youngs_modulus : float or array
        E of both bodies for plane stress. [Pa]

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

    >>> case = {"pin_diameter": 0.08, "youngs_modulus": 200e9}
    >>> closing = 4 * 1e6 / (np.pi * 200e9)
    >>> pressure = closed_contact_pressure(1e6, interference=closing, **case)
    >>> print(f"{pressure / 1e6:.4f} MPa, {sinusoidal_pressure(1e6, pin_diameter=0.08) / 1e6:.4f}")
    15.9155 MPa, 15.9155
    """
    require_positive(
        load_per_length=load_per_length,
        interference=interference,
        pin_diameter=pin_diameter,
        youngs_modulus=youngs_modulus,
    )
    check_line_load(load_per_length=load_per_length)
    check_length(interference=interference, pin_diameter=pin_diameter)
    check_modulus(youngs_modulus=youngs_modulus)

    group = youngs_modulus * interference / (2 * load_per_length)
    if np.any(np.less(group, -FULL_CONTACT * (1 - 1e-9))):
        raise ModelError(
            "interference must be at least 4 load_per_length / (pi E), below which the contact is "
            f"open, got {float(np.nanmin(np.asarray(group / -FULL_CONTACT))):.3g} times that."
        )
    alone = youngs_modulus * interference / (2 * pin_diameter)
    return alone + 2 * load_per_length / (np.pi * pin_diameter)


@broadcasting
def persson_load(half_angle: Values, *, play: Values, youngs_modulus: Values) -> Values:
    """Compute the line load that spreads the contact to a half angle. Strand (2005), eq. 9.

    The inverse of `persson_contact`.

    Parameters
    ----------
    half_angle : float or array
        Half contact angle. [rad]
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

    >>> contact = persson_contact(1e6, play=0.4e-3, pin_diameter=0.06, youngs_modulus=200e9)
    >>> print(f"{persson_load(contact.half_angle, play=0.4e-3, youngs_modulus=200e9):.1f} N/m")
    1000000.0 N/m
    """
    require_positive(youngs_modulus=youngs_modulus)
    require_finite(play=play)
    if np.any(np.equal(play, 0)):
        raise ModelError(
            "play must not be zero: the half contact angle is then 84.8 degrees at any load."
        )
    check_length(play=play)
    check_modulus(youngs_modulus=youngs_modulus)

    # play and group must share their sign, else no positive load belongs to the angle
    load = youngs_modulus * play / (2 * persson_group(half_angle))
    if not np.all(np.greater(load, 0) | np.isnan(load)):
        raise ModelError(
            "half_angle must be below 84.8 degrees with play and above it with an interference: "
            "no load gives this one."
        )
    return load


@dataclass(frozen=True)
class WinklerContact:
    """Contact of a rigid shaft with a bushing of independent springs.

    Attributes
    ----------
    half_angle : Values
        Half of the arc of contact. [rad]
    eccentricity : Values
        Distance of the shaft axis from the bushing axis. [m]
    pressure : Values
        Maximum pressure, on the line of load. [Pa]
    torque_ratio : Values
        Friction torque over friction coefficient times load times shaft radius, mu*. [1]
    """

    half_angle: Values
    eccentricity: Values
    pressure: Values
    torque_ratio: Values


@broadcasting
def winkler_modulus(youngs_modulus: Values, *, poisson: Values) -> Values:
    """Compute the modulus of a thin layer that cannot spread. Colbert et al. (2009), B3.

    E' = (1 - nu) E / [(1 + nu)(1 - 2 nu)].

    Parameters
    ----------
    youngs_modulus : float or array
        Young's modulus E of the layer. [Pa]
    poisson : float or array
        Poisson's ratio nu of the layer, above -1 and below 0.5. [1]

    Returns
    -------
    float or array
        E'. [Pa]

    Raises
    ------
    ModelError
        A modulus not positive or not finite, or a Poisson's ratio outside -1 to 0.5. An
        incompressible layer (0.5) that cannot spread is rigid.

    Examples
    --------
    At a Poisson's ratio of 1/3 the confined layer is 1.5 times as stiff:

    >>> print(f"{winkler_modulus(1.0e9, poisson=1 / 3) / 1e9:.2f} GPa")
    1.50 GPa
    """
    require_positive(youngs_modulus=youngs_modulus)
    require_poisson(poisson=poisson)
    if np.any(np.greater_equal(poisson, 0.5)):
        raise ModelError(
            "poisson must be below 0.5: an incompressible layer that cannot spread is rigid."
        )
    check_modulus(youngs_modulus=youngs_modulus)
    # strain across the layer only: the constrained modulus lambda + 2 mu of elasticity
    return (1 - poisson) * youngs_modulus / ((1 + poisson) * (1 - 2 * poisson))


@broadcasting
def winkler_load(
    half_angle: Values,
    *,
    shaft_radius: Values,
    bushing_radius: Values,
    thickness: Values,
    modulus: Values,
) -> Values:
    """Compute the line load that spreads a Winkler contact. Colbert et al. (2009), B1 to B10.

    The indentation is delta = Rs - sqrt(Rb^2 - e^2 sin^2 theta) + e cos theta, the pressure
    E' delta / t. The eccentricity e is the one at which the indentation ends at the half angle.

    Parameters
    ----------
    half_angle : float or array
        Half of the arc of contact, up to pi/2. [rad]
    shaft_radius, bushing_radius : float or array
        Rs and Rb. [m]
    thickness : float or array
        Wall thickness t of the bushing. [m]
    modulus : float or array
        E' of the wall, see `winkler_modulus`. [Pa]

    Returns
    -------
    float or array
        Line load. [N/m]

    Raises
    ------
    ModelError
        A value not positive or not finite, a shaft not smaller than its bushing, or an angle
        outside 0 to pi/2.

    Examples
    --------
    The load group q t / (E' Rb^2) of the contact at 90 degrees, where the model ends; the radius is
    1000 times the clearance.

    >>> from math import pi
    >>> load = winkler_load(
    ...     pi / 2, shaft_radius=0.01, bushing_radius=0.01001, thickness=1e-3, modulus=1e9
    ... )
    >>> print(f"{load * 1e-3 / (1e9 * 0.01001**2):.4f}")
    0.0688
    """
    _require_bushing(shaft_radius, bushing_radius, thickness, modulus)
    require_between(0.0, np.pi / 2, half_angle=half_angle)

    fit = shaft_radius / bushing_radius
    grid = half_angle * fit  # carries the dimensions of both; 0 * grid broadcasts each alone
    angle, ratio = np.asarray(0 * grid + half_angle, float), np.asarray(0 * grid + fit, float)
    supported = supported_by_arc(angle, fit=ratio)
    return modulus * bushing_radius**2 / thickness * _like(grid, supported)


@broadcasting
def winkler_contact(
    load_per_length: Values,
    *,
    shaft_radius: Values,
    bushing_radius: Values,
    thickness: Values,
    modulus: Values,
) -> WinklerContact:
    """Solve the contact of a rigid shaft in a Winkler bushing. Colbert et al. (2009), B1 to B10.

    The inverse of `winkler_load`.

    Parameters
    ----------
    load_per_length : float or array
        Line load. [N/m]
    shaft_radius, bushing_radius : float or array
        Rs and Rb. [m]
    thickness : float or array
        Wall thickness t of the bushing. [m]
    modulus : float or array
        E' of the wall, see `winkler_modulus`. [Pa]

    Returns
    -------
    WinklerContact
        Half contact angle [rad], eccentricity [m], maximum pressure [Pa] and torque ratio [1].

    Raises
    ------
    ModelError
        A value not positive or not finite, a shaft not smaller than its bushing, or a load beyond
        the one that wraps the contact to 90 degrees, where the model of the source ends.

    Examples
    --------
    A point of the chart of the source: radius 100 times the clearance, load group 0.01.

    >>> contact = winkler_contact(
    ...     1e6, shaft_radius=1.0 / 1.01, bushing_radius=1.0, thickness=0.1, modulus=1e7
    ... )
    >>> print(f"{contact.torque_ratio:.4f}")
    1.1065
    """
    _require_bushing(shaft_radius, bushing_radius, thickness, modulus)
    require_positive(load_per_length=load_per_length)
    check_line_load(load_per_length=load_per_length)

    # the load in units of E' Rb^2 / t; the last factor only brings in the dimensions of the fit and
    # is divided out again
    grid = (
        load_per_length
        * thickness
        / (modulus * bushing_radius**2)
        * (shaft_radius / bushing_radius)
    )
    ratio = np.asarray(0 * grid + shaft_radius / bushing_radius, float)
    group = np.asarray(grid, float) / ratio
    # one bushing and many loads is the usual case
    fits = ratio.flat[:1] if ratio.size and np.ptp(ratio) == 0 else ratio
    largest = supported_by_arc(np.full(fits.shape, np.pi / 2), fit=fits)
    if np.any(group > largest):
        raise ModelError(
            "load_per_length must not exceed the load that wraps the contact to 90 degrees; "
            f"got {float(np.nanmax(group / largest)):.3g} times that."
        )

    half_angle, torque_ratio = arc_of_load(group, fit=ratio)
    eccentricity = eccentricity_of_arc(half_angle, fit=ratio)
    return WinklerContact(
        half_angle=_like(grid, half_angle),
        eccentricity=_like(grid, eccentricity) * bushing_radius,
        pressure=modulus
        / thickness
        * bushing_radius
        * _like(grid, indentation_of_arc(half_angle, fit=ratio)),
        torque_ratio=_like(grid, torque_ratio),
    )


@broadcasting
def impact_stiffness(
    pin_radius: Values, *, bushing_radius: Values, contact_modulus: Values, as_printed: bool = False
) -> Values:
    """Compute the stiffness of a pin that hits its bushing. Mukras et al. (2008), eq. 13.

    K = (4/3) E* sqrt(R), for `impact_force`.

    Parameters
    ----------
    pin_radius, bushing_radius : float or array
        Radii of the pin and of the bore. [m]
    contact_modulus : float or array
        E*, see `contact_modulus`. [Pa]
    as_printed : bool
        Use the reduced radius that the source prints.

    Returns
    -------
    float or array
        Stiffness K. [N/m^1.5]

    Raises
    ------
    ModelError
        A value not positive or not finite, or a bushing not larger than its pin.

    Notes
    -----
    R is the reduced radius of a pin inside a bushing. The source prints R1 R2/(R1 + R2), two balls
    outside each other, which with its numbers is 43.7 times too soft; `as_printed` gives that
    value.

    Examples
    --------
    The joint of the source, steel in PTFE; 1.494e7 is its value.

    >>> modulus = contact_modulus(206.8e9, poisson_1=0.29, youngs_2=0.139e9, poisson_2=0.38)
    >>> case = {"bushing_radius": 9.535e-3, "contact_modulus": modulus}
    >>> print(f"{impact_stiffness(9.525e-3, **case, as_printed=True):.3e}")
    1.494e+07
    >>> print(f"{impact_stiffness(9.525e-3, **case):.3e}")
    6.523e+08
    """
    require_positive(contact_modulus=contact_modulus)
    check_modulus(contact_modulus=contact_modulus)
    # the bore is concave, so its curvature counts as negative; the print takes it for a ball
    inside = conformal_radius(pin_radius, bushing_radius=bushing_radius)
    outside = pin_radius * bushing_radius / (pin_radius + bushing_radius)
    return 4 / 3 * contact_modulus * np.sqrt(outside if as_printed else inside)


@broadcasting
def impact_force(
    penetration: Values,
    *,
    rate: Values,
    impact_speed: Values,
    stiffness: Values,
    restitution: Values,
) -> Values:
    """Compute the normal force of an impact. Lankarani and Nikravesh (1994).

    F = K delta^1.5 [1 + 3 (1 - e^2) rate / (4 impact_speed)], zero without penetration; Mukras et
    al. (2008), eq. 12.

    Parameters
    ----------
    penetration : float or array
        delta, negative while apart. [m]
    rate : float or array
        Rate of the penetration. [m/s]
    impact_speed : float or array
        Rate of the penetration at first touch. [m/s]
    stiffness : float or array
        K, see `impact_stiffness`. [N/m^1.5]
    restitution : float or array
        Coefficient of restitution e, 0 to 1; the law is meant for values near 1. [1]

    Returns
    -------
    float or array
        Normal force F. [N]

    Raises
    ------
    ModelError
        A speed or stiffness not positive, a restitution outside 0 to 1, or an infinite value.

    Examples
    --------
    At the first touch of an inelastic impact (e = 0) the factor of the damping is 1.75:

    >>> case = {"impact_speed": 0.1, "stiffness": 1e8}
    >>> print(f"{impact_force(1e-4, rate=0.1, restitution=1.0, **case):.1f} N")
    100.0 N
    >>> print(f"{impact_force(1e-4, rate=0.1, restitution=0.0, **case):.1f} N")
    175.0 N
    """
    require_finite(penetration=penetration, rate=rate)
    require_positive(impact_speed=impact_speed, stiffness=stiffness)
    require_between(0.0, 1.0, restitution=restitution)
    check_speed(rate=rate, impact_speed=impact_speed)
    # the hysteresis absorbs the kinetic energy that the restitution does not return
    damping = 1 + 0.75 * (1 - restitution**2) * rate / impact_speed
    return stiffness * np.maximum(penetration, 0.0) ** 1.5 * damping


def _require_point_contact(
    load: Values, radius: Values, radius_across: Values, contact_modulus: Values
) -> None:
    require_positive(
        load=load, radius=radius, radius_across=radius_across, contact_modulus=contact_modulus
    )
    check_load(load=load)
    check_reduced_radius(radius=radius, radius_across=radius_across)
    check_modulus(contact_modulus=contact_modulus)


def _ellipse(
    load: Values,
    radius: Values,
    radius_across: Values,
    modulus: Values,
    *,
    axis_ratio: Values,
    F1: Values,
    F2: Values,
) -> EllipticalContact:
    """Contact with a given ratio of its axes and the factors F1 and F2 that belong to it."""
    equivalent = np.sqrt(radius * radius_across)
    # the load is that of a semi-ellipsoid of pressure over the ellipse
    mean_axis = (3 * load * equivalent / (4 * modulus)) ** (1 / 3) * F1
    return EllipticalContact(
        a=mean_axis * np.sqrt(axis_ratio),
        b=mean_axis / np.sqrt(axis_ratio),
        pressure=3 * load / (2 * np.pi * mean_axis**2),
        approach=(9 * load**2 / (16 * equivalent * modulus**2)) ** (1 / 3) * F2,
    )


def _axis_ratio(radius_ratio: Values) -> Values:
    """Find a/b >= 1 from R'/R'' >= 1; close to the power 2/3."""
    log_radii = np.log(radius_ratio)
    log_axes = np.asarray(_log_axes_by_log_radii()(log_radii))
    beyond = log_radii > _log_radius_ratio(np.array(_LARGEST_LOG_AXES))
    if np.any(beyond):
        log_axes[beyond] = _solve(
            lambda trial, wanted: _log_radius_ratio(trial) - wanted,
            _LARGEST_LOG_AXES - 1,
            log_radii[beyond],
            log_radii[beyond],
        )
    return np.exp(np.maximum(log_axes, 0.0))


def _log_radius_ratio(log_axes: Values) -> Values:
    """ln R'/R'' of the contact with ln a/b."""
    p = np.exp(-2 * log_axes)
    return np.log(scipy.special.elliprd(0.0, 1.0, p) / scipy.special.elliprd(0.0, p, 1.0))


@cache
def _log_axes_by_log_radii() -> "BSpline":
    """The inverse of `_log_radius_ratio` as a spline of fifth order, exact to rounding.

    The function is odd, so that knots on both sides of the circle keep the order there.
    """
    from scipy.interpolate import make_interp_spline  # at use, as all solvers of the theories

    log_axes = np.linspace(0.0, _LARGEST_LOG_AXES, _AXES_KNOTS)
    log_radii = _log_radius_ratio(log_axes)
    mirrored = slice(8, 0, -1)
    return make_interp_spline(
        np.concatenate([-log_radii[mirrored], log_radii]),
        np.concatenate([-log_axes[mirrored], log_axes]),
        k=5,
    )


def _log_of_persson_group_above_full_contact(log_b: Values, wanted: Values) -> Values:
    """Compute ln(E Delta / 2q + 2/pi) - wanted, which falls almost linearly along ln b."""
    b2 = np.exp(2 * log_b)
    return np.log((2 - np.log1p(b2) + 2 * b2) / (np.pi * (1 + b2))) - 2 * log_b - wanted


def _require_bushing(
    shaft_radius: Values, bushing_radius: Values, thickness: Values, modulus: Values
) -> None:
    require_positive(
        shaft_radius=shaft_radius,
        bushing_radius=bushing_radius,
        thickness=thickness,
        modulus=modulus,
    )
    require_increasing(shaft_radius=shaft_radius, bushing_radius=bushing_radius)
    check_length(shaft_radius=shaft_radius, bushing_radius=bushing_radius, thickness=thickness)
    check_modulus(modulus=modulus)


def _require_half_angle(half_angle: Values) -> None:
    if np.any(np.less_equal(half_angle, 0)) or np.any(np.greater_equal(half_angle, np.pi)):
        outside = [pick(np.asarray(half_angle)) for pick in (np.nanmin, np.nanmax)]
        raise ModelError(
            f"half_angle must lie between 0 and pi, got {float(outside[0]):g} to "
            f"{float(outside[1]):g} rad."
        )


def _solve(
    function: Callable[..., Values], low: Values, high: Values, *arguments: Values
) -> Values:
    """Find the root of function(x, *arguments) between low and high, element by element."""
    shape = arguments[0].shape
    # copies, because broadcast views are read-only
    bracket: Values = (np.broadcast_to(low, shape).copy(), np.broadcast_to(high, shape).copy())
    from scipy.optimize import elementwise  # half a second, for theories that need a root

    return elementwise.find_root(
        function,
        bracket,
        args=arguments,
        tolerances={"xatol": _ROOT_TOLERANCE, "xrtol": _ROOT_TOLERANCE},
    ).x


def _like(example: Values, data: Values) -> Values:
    """`data` in the kind of array of `example`, of the same shape."""
    if hasattr(example, "dims"):  # a DataArray keeps its coordinates
        return example.copy(data=data)
    return data if np.ndim(data) else float(data)
