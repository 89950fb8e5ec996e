"""Dry contact of pin and bushing: Hertz, Persson, Winkler, the simple pressure laws, and scaling between materials.

A pin in a bushing touches over an arc; half of it is the half contact angle, measured at the pin axis. Hertz treats the
arc as flat and holds up to 20 degrees or so, Persson's law holds up to the full circle for equal materials, Winkler's
bushing stands for a compliant liner on a rigid shaft.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import elementwise
from scipy.special import elliprd, elliprf

from erlif.core.errors import ModelError
from erlif.models.arguments import (
    Values,
    require_between,
    require_poisson,
    require_positive,
)

FULL_CONTACT = -2 / np.pi
"""E Delta / 2q at which Persson's contact closes around the pin."""


def conformal_radius(pin_radius: Values, *, bushing_radius: Values) -> Values:
    """Reduced radius [m] of a pin in a bushing: R = R1 R2 / (R1 - R2). Farzaneh (2002), eq. 2.8.

    Parameters
    ----------
    pin_radius, bushing_radius : float or array
        Radii R2 of the pin and R1 of the bore. [m]

    Raises
    ------
    ModelError
        A radius not positive, or a bushing not larger than its pin.
    """
    require_positive(pin_radius=pin_radius, bushing_radius=bushing_radius)
    if np.any(np.less_equal(bushing_radius - pin_radius, 0)):
        raise ModelError(
            f"bushing_radius must exceed pin_radius for a clearance fit, got {np.min(np.asarray(bushing_radius)):g} m "
            f"and {np.max(np.asarray(pin_radius)):g} m."
        )
    return pin_radius * bushing_radius / (bushing_radius - pin_radius)


def contact_modulus(
    youngs_1: Values, *, poisson_1: Values, youngs_2: Values, poisson_2: Values
) -> Values:
    """Contact modulus E* [Pa]: 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2. Farzaneh (2002), eq. B.1.

    The E' of Strand (2005) is this E*; the E' of the film formulas of Dowson, Higginson and Hamrock is 2 E*.

    Parameters
    ----------
    youngs_1, youngs_2 : float or array
        Young's moduli. [Pa]
    poisson_1, poisson_2 : float or array
        Poisson's ratios. [1]
    """
    require_positive(youngs_1=youngs_1, youngs_2=youngs_2)
    require_poisson(poisson_1=poisson_1, poisson_2=poisson_2)
    return 1 / ((1 - poisson_1**2) / youngs_1 + (1 - poisson_2**2) / youngs_2)


def scale_load(
    load: Values,
    *,
    youngs_modulus: Values,
    model_youngs_modulus: Values,
    length_ratio: Values = 1.0,
) -> Values:
    """Load [N] that strains a model joint like the full one: F / (E D l) is kept. Farzaneh (2002), eq. 3.13.

    Parameters
    ----------
    load : float or array
        Load on the full joint. [N]
    youngs_modulus, model_youngs_modulus : float or array
        Young's moduli of the full joint and of the model. [Pa]
    length_ratio : float or array
        Lengths of the model over those of the full joint. [1]

    Notes
    -----
    Complete similarity also keeps D/l, d/l and Poisson's ratio; steel (0.3) and acrylic (0.37) differ in the last.
    Stresses then scale as the moduli, see `scale_stress`.
    """
    require_positive(youngs_modulus=youngs_modulus, model_youngs_modulus=model_youngs_modulus)
    require_positive(length_ratio=length_ratio)
    return load * model_youngs_modulus / youngs_modulus * length_ratio**2


def scale_stress(stress: Values, *, youngs_modulus: Values, model_youngs_modulus: Values) -> Values:
    """Stress [Pa] in a model joint under the load of `scale_load`: sigma / E is kept. Farzaneh (2002), eq. 3.13."""
    require_positive(youngs_modulus=youngs_modulus, model_youngs_modulus=model_youngs_modulus)
    return stress * model_youngs_modulus / youngs_modulus


def projected_pressure(load_per_length: Values, *, pin_diameter: Values) -> Values:
    """Load over projected area [Pa]: p = q / d. Strand (2005), eq. 6; q in N/m, d in m."""
    require_positive(pin_diameter=pin_diameter)
    return load_per_length / pin_diameter


def sinusoidal_pressure(load_per_length: Values, *, pin_diameter: Values) -> Values:
    """Greatest pressure [Pa] of a cosine over half the pin: p = 4q / (pi d). Strand (2005), eq. 7; q in N/m, d in m.

    Note: against Persson's law this is safe from a half contact angle of 72.9 degrees (printed: 72), and 2q/d from 38.8
    degrees (printed: 38).
    """
    require_positive(pin_diameter=pin_diameter)
    return 4 * load_per_length / (np.pi * pin_diameter)


def hertz_line(
    load_per_length: Values, *, radius: Values, contact_modulus: Values
) -> tuple[Values, Values]:
    """Half width [m] and greatest pressure [Pa] of a Hertzian line contact.

    b = sqrt(4 q R / (pi E*)),  p0 = sqrt(q E* / (pi R)). Strand (2005), eq. 8.

    Parameters
    ----------
    load_per_length : float or array
        Line load q. [N/m]
    radius : float or array
        Reduced radius R, see `conformal_radius`. [m]
    contact_modulus : float or array
        E*. [Pa]

    Notes
    -----
    The contact must be narrow against the pin: in a conformal joint Hertz is 0.3 % low in pressure at a half contact
    angle of 5 degrees, 1.2 % at 10, 4.8 % at 20 and 19 % at 40; use `persson_contact` there.
    """
    require_positive(
        load_per_length=load_per_length, radius=radius, contact_modulus=contact_modulus
    )
    half_width = np.sqrt(4 * load_per_length * radius / (np.pi * contact_modulus))
    return half_width, np.sqrt(load_per_length * contact_modulus / (np.pi * radius))


def relative_radii(
    radius_1: float,
    *,
    radius_1_across: float,
    radius_2: float,
    radius_2_across: float,
    angle: float = 0.0,
) -> tuple[float, float]:
    """Find the two reduced radii R' >= R'' [m] of two curved bodies. Farzaneh (2002), eqs. B.3 to B.6.

    A + B = (sum of the four curvatures)/2 and B - A from eq. B.4; R' = 1/(2A), R'' = 1/(2B).

    Parameters
    ----------
    radius_1, radius_1_across, radius_2, radius_2_across : float
        Principal radii of the two bodies, in the direction of the first and across it; negative where concave,
        `inf` where straight. [m]
    angle : float
        Angle between the principal directions of the two bodies. [rad]

    Raises
    ------
    ModelError
        A radius of zero, or bodies that would touch at more than a point.

    Notes
    -----
    Eq. B.3 prints the curvature 1/R2'' twice; one of them is 1/R2'.
    """
    if not all(
        abs(radius) > 0 for radius in (radius_1, radius_1_across, radius_2, radius_2_across)
    ):
        raise ModelError(
            "radius_1, radius_1_across, radius_2 and radius_2_across must not be zero."
        )
    k1, k1_across, k2, k2_across = (
        1 / radius_1,
        1 / radius_1_across,
        1 / radius_2,
        1 / radius_2_across,
    )
    total = (k1 + k1_across + k2 + k2_across) / 2
    first, second = k1 - k1_across, k2 - k2_across
    difference = (
        np.sqrt(max(first**2 + second**2 + 2 * first * second * np.cos(2 * angle), 0.0)) / 2
    )
    A, B = (total - difference) / 2, (total + difference) / 2
    if A <= 0:
        raise ModelError(
            f"radius_1, radius_2 and those across must leave a gap all round the point of contact, "
            f"got relative curvatures {2 * A:g} and {2 * B:g} 1/m."
        )
    return float(1 / (2 * A)), float(1 / (2 * B))


@dataclass(frozen=True)
class EllipticalContact:
    """Hertzian contact over an ellipse."""

    a: Values
    """Semi-axis in the direction of the larger reduced radius. [m]"""
    b: Values
    """Semi-axis across it. [m]"""
    pressure: Values
    """Greatest pressure. [Pa]"""
    approach: Values
    """Approach of the two bodies. [m]"""


def hertz_ellipse(
    load: Values, *, radius: Values, radius_across: Values, contact_modulus: Values
) -> EllipticalContact:
    """Hertzian contact over an ellipse, with exact elliptic integrals. Johnson (1985), Contact Mechanics, eqs. 4.26-4.28.

    With p = (b/a)^2 and Carlson's R_D, R_F:
    R'/R'' = R_D(0,1,p)/R_D(0,p,1),  F1^3 = 4 p^(3/4) sqrt(R_D(0,1,p) R_D(0,p,1)) / (3 pi),
    sqrt(ab) = (3 P Req / 4 E*)^(1/3) F1,  p0 = 3P/(2 pi a b),  delta = (9 P^2/(16 Req E*^2))^(1/3) F2,
    F2 = 2 p^(1/4) R_F(0,p,1) / (pi F1),  Req = sqrt(R' R'').

    Parameters
    ----------
    load : float or array
        Load P. [N]
    radius, radius_across : float or array
        The larger and the smaller reduced radius R', R'', see `relative_radii`. [m]
    contact_modulus : float or array
        E*. [Pa]

    Raises
    ------
    ModelError
        A value not positive, or `radius` below `radius_across`.

    Notes
    -----
    a and b are semi-axes; Farzaneh (2002), appendix B, calls them lengths of the axes. Both must be small against the
    radii of the bodies: on the lobed bushing of that source, at 100 klbf, a is 28.5 mm along the circumference of a pin
    of 33.4 mm radius, so there the numbers only compare designs.
    """
    require_positive(
        load=load, radius=radius, radius_across=radius_across, contact_modulus=contact_modulus
    )
    if np.any(np.less(radius, radius_across)):
        raise ModelError(
            "radius must be the larger reduced radius and radius_across the smaller one."
        )
    radius_ratio = radius / radius_across
    p = _like(radius_ratio, _axis_ratio(np.asarray(radius_ratio, float))) ** -2.0
    along, across = elliprd(0.0, 1.0, p), elliprd(0.0, p, 1.0)
    F1 = (4 * p**0.75 * np.sqrt(along * across) / (3 * np.pi)) ** (1 / 3)
    F2 = 2 * p**0.25 * elliprf(0.0, p, 1.0) / (np.pi * F1)
    return _ellipse(load, radius, radius_across, contact_modulus, axis_ratio=p**-0.5, F1=F1, F2=F2)


def thesis_ellipse(
    load: Values, *, radius: Values, radius_across: Values, contact_modulus: Values
) -> EllipticalContact:
    """Elliptical contact as Farzaneh (2002), appendix B, works it: a/b = (R'/R'')^(2/3), F1 = 0.89, F2 = 0.88.

    Parameters as in `hertz_ellipse` [N, m, Pa]. The two factors are those of the lobed bushing (R'/R'' = 24.4); the pressure there is
    0.4 % above the exact one.

    Notes
    -----
    Eq. B.10 lacks the exponent 1/3 and prints F1^(-2/3) for F1^-2; the worked value uses 3P/(2 pi a b), as here.
    """
    require_positive(
        load=load, radius=radius, radius_across=radius_across, contact_modulus=contact_modulus
    )
    axis_ratio = (radius / radius_across) ** (2 / 3)
    return _ellipse(
        load, radius, radius_across, contact_modulus, axis_ratio=axis_ratio, F1=0.89, F2=0.88
    )


def persson_group(half_angle: Values) -> Values:
    """E Delta / 2q [1] of a conformal contact with a given half contact angle [rad]. Persson (1964); Strand (2005), eq. 9.

    With b = tan(half_angle / 2): [2 - ln(1 + b^2) - 2 b^4] / [pi b^2 (1 + b^2)].
    Delta is the diametral play, q the line load, E Young's modulus of both bodies in plane stress; in plane strain
    put E/(1 - nu^2). It falls from infinity (a point contact) through zero at b = 0.9136 (no play) to -2/pi (contact all
    round, an interference).
    """
    _require_half_angle(half_angle)
    b2 = np.tan(half_angle / 2) ** 2
    return (2 - np.log1p(b2) - 2 * b2**2) / (np.pi * b2 * (1 + b2))


def persson_peak_group(half_angle: Values) -> Values:
    """d p_max / 2q [1] of a conformal contact with a given half contact angle [rad]. Persson (1964); Strand (2005), eq. 9.

    With b = tan(half_angle / 2): 2b / (pi sqrt(1 + b^2)) + asinh(b) / [pi b^2 (1 + b^2)].

    Note: the last row of Strand's table prints -2/pi for the closed contact; the limit is +2/pi.
    """
    _require_half_angle(half_angle)
    b = np.tan(half_angle / 2)
    return 2 * b / (np.pi * np.sqrt(1 + b**2)) + np.arcsinh(b) / (np.pi * b**2 * (1 + b**2))


def persson_half_angle(group: Values) -> Values:
    """Find the half contact angle [rad] from E Delta / 2q [1]: the inverse of `persson_group`.

    Raises
    ------
    ModelError
        A value at or below -2/pi, where the contact has closed around the pin and its arc means nothing.
    """
    if np.any(np.less_equal(group, FULL_CONTACT)):
        raise ModelError(
            f"group (E Delta / 2q) must exceed -2/pi, got {float(np.nanmin(np.asarray(group))):g}: the interference "
            "presses all round the pin."
        )
    wanted = np.log(np.asarray(group, float) - FULL_CONTACT)
    log_b = _solve(
        _log_of_persson_group_above_full_contact, -150.0, 17.0, wanted
    )  # half angles 1e-65 to pi - 1e-7
    return _like(group, 2 * np.arctan(np.exp(log_b)))


def persson_pressure(
    angle: Values, *, half_angle: Values, load_per_length: Values, pin_diameter: Values
) -> Values:
    """Pressure [Pa] at an angle [rad] from the line of load, zero outside the contact. Persson (1964).

    d p / 2q = 2u / [pi s (1 + y^2)] + ln[(s + u)/(s - u)] / [2 pi b^2 (1 + b^2)],
    with b = tan(half_angle / 2), y = tan(angle / 2), s = sqrt(1 + b^2), u = sqrt(b^2 - y^2).

    Parameters
    ----------
    angle : float or array
        From the line of load. [rad]
    half_angle : float or array
        Half contact angle. [rad]
    load_per_length : float or array
        Line load q. [N/m]
    pin_diameter : float or array
        d. [m]
    """
    _require_half_angle(half_angle)
    require_positive(pin_diameter=pin_diameter)
    b, y = np.tan(half_angle / 2), np.tan(angle / 2)
    s = np.sqrt(1 + b**2)
    u = np.sqrt(np.maximum(b**2 - y**2, 0.0))
    shape = 2 * u / (np.pi * s * (1 + y**2)) + np.arctanh(u / s) / (np.pi * b**2 * (1 + b**2))
    return shape * 2 * load_per_length / pin_diameter


def persson_contact(
    load_per_length: Values, *, play: Values, pin_diameter: Values, youngs_modulus: Values
) -> tuple[Values, Values]:
    """Half contact angle [rad] and greatest pressure [Pa] of a pin in a bushing of the same material. Strand (2005), eq. 9.

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

    Raises
    ------
    ModelError
        A value not positive, or an interference so large that the contact closes around the pin.

    Notes
    -----
    Equal elastic constants only; frictionless; infinite bodies around the hole.
    """
    require_positive(
        load_per_length=load_per_length, pin_diameter=pin_diameter, youngs_modulus=youngs_modulus
    )
    half_angle = persson_half_angle(youngs_modulus * play / (2 * load_per_length))
    return half_angle, persson_peak_group(half_angle) * 2 * load_per_length / pin_diameter


def persson_load(half_angle: Values, *, play: Values, youngs_modulus: Values) -> Values:
    """Line load [N/m] that spreads the contact to a half angle [rad]: the inverse of `persson_contact`.

    Parameters
    ----------
    half_angle : float or array
        Half contact angle. [rad]
    play, youngs_modulus : float or array
        As in `persson_contact`. [m, Pa]

    Raises
    ------
    ModelError
        An angle that no load gives: a play opens contacts below 84.8 degrees, an interference above.
    """
    require_positive(youngs_modulus=youngs_modulus)
    load = youngs_modulus * play / (2 * persson_group(half_angle))
    if not np.all(np.greater(load, 0) | np.isnan(load)):
        raise ModelError(
            "half_angle must be below 84.8 degrees with play and above it with an interference: no load gives this one."
        )
    return load


@dataclass(frozen=True)
class WinklerContact:
    """Contact of a rigid shaft with a bushing of independent springs."""

    half_angle: Values
    """Half of the arc of contact. [rad]"""
    eccentricity: Values
    """Distance of the shaft axis from the bushing axis. [m]"""
    pressure: Values
    """Greatest pressure, on the line of load. [Pa]"""
    torque_ratio: Values
    """Friction torque over friction coefficient times load times shaft radius, mu*. [1]"""


def winkler_modulus(youngs_modulus: Values, *, poisson: Values) -> Values:
    """Modulus [Pa] of a thin layer that cannot spread: E' = (1 - nu) E / [(1 + nu)(1 - 2 nu)]. Colbert et al. (2009), B3."""
    require_positive(youngs_modulus=youngs_modulus)
    require_poisson(poisson=poisson)
    if np.any(np.greater_equal(poisson, 0.5)):
        raise ModelError(
            "poisson must be below 0.5: an incompressible layer that cannot spread is rigid."
        )
    return (1 - poisson) * youngs_modulus / ((1 + poisson) * (1 - 2 * poisson))


def winkler_load(
    half_angle: Values,
    *,
    shaft_radius: Values,
    bushing_radius: Values,
    thickness: Values,
    modulus: Values,
) -> Values:
    """Line load [N/m] that spreads the contact of a Winkler bushing to a half angle [rad]. Colbert et al. (2009), B1-B10.

    Indentation delta = Rs - sqrt(Rb^2 - e^2 sin^2 theta) + e cos theta, pressure E' delta / t, and the eccentricity e at
    which the indentation ends at the half angle.

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
    """
    _require_fit(shaft_radius, bushing_radius)
    require_positive(thickness=thickness, modulus=modulus)
    require_between(0.0, np.pi / 2, half_angle=half_angle)
    fit = shaft_radius / bushing_radius
    grid = half_angle * fit  # the arrays laid over each other
    angle, ratio = np.asarray(0 * grid + half_angle, float), np.asarray(0 * grid + fit, float)
    supported, _ = _winkler_integrals(angle, ratio)
    return modulus * bushing_radius**2 / thickness * _like(grid, supported)


def winkler_contact(
    load_per_length: Values,
    *,
    shaft_radius: Values,
    bushing_radius: Values,
    thickness: Values,
    modulus: Values,
) -> WinklerContact:
    """Contact of a rigid shaft in a Winkler bushing under a line load [N/m]. Colbert et al. (2009), B1-B10.

    Parameters as in `winkler_load`.

    Raises
    ------
    ModelError
        A value not positive, a shaft not smaller than its bushing, or a load beyond the one that wraps the contact to
        90 degrees, where the model of the source ends.
    """
    _require_fit(shaft_radius, bushing_radius)
    require_positive(load_per_length=load_per_length, thickness=thickness, modulus=modulus)
    grid = (
        load_per_length
        * thickness
        / (modulus * bushing_radius**2)
        * (shaft_radius / bushing_radius)
    )
    ratio = np.asarray(0 * grid + shaft_radius / bushing_radius, float)
    group = np.asarray(grid, float) / ratio
    most, _ = _winkler_integrals(np.full(ratio.shape, np.pi / 2), ratio)
    if np.any(group > most):
        raise ModelError(
            "load_per_length must not exceed the load that wraps the contact to 90 degrees; "
            f"got {float(np.nanmax(group / most)):.3g} times that."
        )
    half_angle = _solve(
        lambda angle, wanted, fit: _winkler_integrals(angle, fit)[0] - wanted,
        1e-9,
        np.pi / 2,
        group,
        ratio,
    )
    supported, rubbed = _winkler_integrals(half_angle, ratio)
    eccentricity = _winkler_eccentricity(half_angle, ratio)
    return WinklerContact(
        half_angle=_like(grid, half_angle),
        eccentricity=_like(grid, eccentricity) * bushing_radius,
        pressure=modulus / thickness * bushing_radius * _like(grid, ratio - 1 + eccentricity),
        torque_ratio=_like(grid, rubbed / supported),
    )


def impact_stiffness(
    pin_radius: Values, *, bushing_radius: Values, contact_modulus: Values, as_printed: bool = False
) -> Values:
    """Stiffness K [N/m^1.5] of a pin meeting its bushing, for `impact_force`: K = (4/3) E* sqrt(R). Mukras et al. (2008), 13.

    R is the reduced radius of a pin inside a bushing. The source prints R1 R2/(R1 + R2), two balls outside each other,
    which with its numbers is 43.7 times too soft; `as_printed` gives that value.

    Parameters
    ----------
    pin_radius, bushing_radius : float or array
        [m]
    contact_modulus : float or array
        E*. [Pa]
    as_printed : bool
        Use the reduced radius that the source prints.
    """
    require_positive(contact_modulus=contact_modulus)
    inside = conformal_radius(pin_radius, bushing_radius=bushing_radius)
    outside = pin_radius * bushing_radius / (pin_radius + bushing_radius)
    return 4 / 3 * contact_modulus * np.sqrt(outside if as_printed else inside)


def impact_force(
    penetration: Values,
    *,
    rate: Values,
    impact_speed: Values,
    stiffness: Values,
    restitution: Values,
) -> Values:
    """Normal force [N] of an impact with hysteresis. Lankarani and Nikravesh (1994); Mukras et al. (2008), eq. 12.

    F = K delta^1.5 [1 + 3 (1 - e^2) rate / (4 impact_speed)], zero without penetration.

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
        Coefficient of restitution e, 0 to 1; the law is meant for values near 1.
    """
    require_positive(impact_speed=impact_speed, stiffness=stiffness)
    require_between(0.0, 1.0, restitution=restitution)
    damping = 1 + 0.75 * (1 - restitution**2) * rate / impact_speed
    return stiffness * np.maximum(penetration, 0.0) ** 1.5 * damping


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
    equivalent = np.sqrt(radius * radius_across)
    mean_axis = (3 * load * equivalent / (4 * modulus)) ** (1 / 3) * F1
    return EllipticalContact(
        a=mean_axis * np.sqrt(axis_ratio),
        b=mean_axis / np.sqrt(axis_ratio),
        pressure=3 * load / (2 * np.pi * mean_axis**2),
        approach=(9 * load**2 / (16 * equivalent * modulus**2)) ** (1 / 3) * F2,
    )


def _axis_ratio(radius_ratio: Values) -> Values:
    """Find a/b >= 1 from R'/R'' >= 1; close to the power 2/3."""

    def excess(log_axes: Values, wanted: Values) -> Values:
        p = np.exp(-2 * log_axes)
        return np.log(elliprd(0.0, 1.0, p) / elliprd(0.0, p, 1.0)) - np.log(wanted)

    log_axes = _solve(excess, -1e-9, np.log(radius_ratio) + 1.0, radius_ratio)
    return np.exp(np.maximum(log_axes, 0.0))


def _log_of_persson_group_above_full_contact(log_b: Values, wanted: Values) -> Values:
    """ln(E Delta / 2q + 2/pi) - wanted, which falls along b almost as a straight line."""
    b2 = np.exp(2 * log_b)
    return np.log((2 - np.log1p(b2) + 2 * b2) / (np.pi * (1 + b2))) - 2 * log_b - wanted


def _winkler_eccentricity(half_angle: Values, ratio: Values) -> Values:
    """e / Rb of Colbert et al. (2009), B10."""
    return np.sqrt(1 - ratio**2 * np.sin(half_angle) ** 2) - ratio * np.cos(half_angle)


def _winkler_integrals(half_angle: Values, ratio: Values) -> tuple[Values, Values]:
    """Rs int delta cos and Rs int delta over the arc, in units of Rb^2, by Gauss's rule."""
    nodes, weights = np.polynomial.legendre.leggauss(48)
    e = _winkler_eccentricity(half_angle, ratio)[..., None]
    theta = half_angle[..., None] * (nodes + 1) / 2
    fit = ratio[..., None]
    indentation = fit - np.sqrt(1 - e**2 * np.sin(theta) ** 2) + e * np.cos(theta)
    scale = ratio * half_angle  # both halves of the arc
    return (
        scale * np.sum(weights * indentation * np.cos(theta), axis=-1),
        scale * np.sum(weights * indentation, axis=-1),
    )


def _require_fit(shaft_radius: Values, bushing_radius: Values) -> None:
    require_positive(shaft_radius=shaft_radius, bushing_radius=bushing_radius)
    if np.any(np.less_equal(bushing_radius - shaft_radius, 0)):
        raise ModelError(
            "bushing_radius must exceed shaft_radius; an interference fit presses all round."
        )


def _require_half_angle(half_angle: Values) -> None:
    if np.any(np.less_equal(half_angle, 0)) or np.any(np.greater_equal(half_angle, np.pi)):
        raise ModelError("half_angle must lie between 0 and pi.")


def _solve(
    function: Callable[..., Values], low: Values, high: Values, *arguments: Values
) -> Values:
    """Root of function(x, *arguments) between low and high, for each element of the arguments."""
    shape = arguments[0].shape
    bracket: Values = (np.broadcast_to(low, shape).copy(), np.broadcast_to(high, shape).copy())
    return elementwise.find_root(
        function, bracket, args=arguments, tolerances={"xatol": 1e-14, "xrtol": 1e-14}
    ).x


def _like(example: Values, data: Values) -> Values:
    """`data` in the kind of array of `example`, of the same shape."""
    if hasattr(example, "dims"):  # a DataArray keeps its coordinates
        return example.copy(data=data)
    return data if np.ndim(data) else float(data)
