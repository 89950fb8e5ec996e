"""Rigid shaft in a compliant liner, whose elements deflect one by one (Colbert et al., 2009)."""

from dataclasses import dataclass

import numpy as np

from erlif.core.errors import ModelError
from erlif.models.arguments import Values, formula, require_increasing
from erlif.models.contact.arc import (
    arc_of_load,
    eccentricity_of_arc,
    indentation_of_arc,
    supported_by_arc,
)
from erlif.models.contact.roots import like


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


@formula()
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
    if np.any(np.greater_equal(poisson, 0.5)):
        raise ModelError(
            "poisson must be below 0.5: an incompressible layer that cannot spread is rigid."
        )
    # strain across the layer only: the constrained modulus lambda + 2 mu of elasticity
    return (1 - poisson) * youngs_modulus / ((1 + poisson) * (1 - 2 * poisson))


@formula()
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
        Half of the arc of contact. [rad]
    modulus : float or array
        E' of the wall, see `erlif.models.contact.winkler_modulus`. [Pa]
    shaft_radius, bushing_radius, thickness : float or array
        Rs and Rb [m], wall thickness t of the bushing [m].

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

    require_increasing(shaft_radius=shaft_radius, bushing_radius=bushing_radius)
    fit = shaft_radius / bushing_radius
    grid = half_angle * fit  # carries the dimensions of both; 0 * grid broadcasts each alone
    angle, ratio = np.asarray(0 * grid + half_angle, float), np.asarray(0 * grid + fit, float)
    supported = supported_by_arc(angle, fit=ratio)
    return modulus * bushing_radius**2 / thickness * like(grid, supported)


@formula()
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
        Line load q. [N/m]
    modulus : float or array
        E' of the wall, see `erlif.models.contact.winkler_modulus`. [Pa]
    shaft_radius, bushing_radius, thickness : float or array
        Rs and Rb [m], wall thickness t of the bushing [m].

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

    require_increasing(shaft_radius=shaft_radius, bushing_radius=bushing_radius)
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
            "load_per_length must not exceed the load that wraps the contact to 90 degrees; got "
            f"{float(np.nanmax(group / largest)):.3g} times that."
        )

    half_angle, torque_ratio = arc_of_load(group, fit=ratio)
    eccentricity = eccentricity_of_arc(half_angle, fit=ratio)
    return WinklerContact(
        half_angle=like(grid, half_angle),
        eccentricity=like(grid, eccentricity) * bushing_radius,
        pressure=modulus
        / thickness
        * bushing_radius
        * like(grid, indentation_of_arc(half_angle, fit=ratio)),
        torque_ratio=like(grid, torque_ratio),
    )
