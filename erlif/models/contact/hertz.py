"""Contacts of Hertz: along a line, and over an ellipse (Johnson, 1985; Farzaneh, 2002, appendix B).

The arc of a contact along a line counts as flat, which holds up to about 20 degrees.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import scipy

from erlif.core.errors import ModelError
from erlif.models.arguments import Values, formula
from erlif.models.contact.roots import find_roots, like

# Factors of the ellipse that Farzaneh (2002), appendix B, reads for the lobed bushing. [1]
THESIS_F1, THESIS_F2 = 0.89, 0.88


class LineContact(NamedTuple):
    """Hertzian contact along a line.

    Attributes
    ----------
    half_width, pressure : Values
        Half width b of the contact [m], maximum pressure p0 [Pa].
    """

    half_width: Values
    pressure: Values


@formula()
def hertz_line(load_per_length: Values, *, radius: Values, contact_modulus: Values) -> LineContact:
    """Compute half width and maximum pressure of a Hertzian line contact. Strand (2005), eq. 8.

    b = sqrt(4 q R / (pi E*)),  p0 = sqrt(q E* / (pi R)).

    Parameters
    ----------
    load_per_length : float or array
        Line load q. [N/m]
    radius : float or array
        Reduced radius R, see `erlif.models.contact.conformal_radius`. [m]
    contact_modulus : float or array
        Contact modulus E*, see `erlif.models.contact.contact_modulus`. [Pa]

    Returns
    -------
    LineContact
        Half width [m] and maximum pressure [Pa].

    Notes
    -----
    The contact must be narrow against the pin. In a conformal joint Hertz is 0.3 % low in pressure
    at a half contact angle of 5 degrees, 1.2 % at 10, 4.8 % at 20 and 19 % at 40; use
    `persson_contact` there.

    Examples
    --------
    The acrylic joint of Farzaneh (2002) under 50 lbf over 237 mm:

    >>> from erlif.models.contact import contact_modulus
    >>> modulus = contact_modulus(2.7e9, poisson_1=0.37, youngs_2=2.7e9, poisson_2=0.37)
    >>> contact = hertz_line(222.4 / 0.237, radius=4.872, contact_modulus=modulus)
    >>> print(f"{contact.half_width * 1e3:.2f} mm, {contact.pressure / 1e6:.2f} MPa")
    1.93 mm, 0.31 MPa
    """
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


@formula(angle="signed number")
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


@formula()
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
    contact_modulus : float or array
        Contact modulus E*, see `erlif.models.contact.contact_modulus`. [Pa]
    load : float or array
        Load P. [N]
    radius, radius_across : float or array
        The larger and the smaller reduced radius R' and R'', see `relative_radii`. [m]

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
    if np.any(np.less(radius, radius_across)):
        raise ModelError(
            "radius must be the larger reduced radius and radius_across the smaller one."
        )

    # the axes follow from the shape alone; load and modulus only set their size
    radius_ratio = radius / radius_across
    p = like(radius_ratio, _axis_ratio(np.asarray(radius_ratio, float))) ** -2.0
    # the ratio of both integrals R_D is that of the radii
    across = like(radius_ratio, scipy.special.elliprd(0.0, np.asarray(p), 1.0))
    F1 = (4 * p**0.75 * np.sqrt(radius_ratio) * across / (3 * np.pi)) ** (1 / 3)
    F2 = 2 * p**0.25 * scipy.special.ellipkm1(p) / (np.pi * F1)
    return _ellipse(load, radius, radius_across, contact_modulus, axis_ratio=p**-0.5, F1=F1, F2=F2)


@formula()
def thesis_ellipse(
    load: Values, *, radius: Values, radius_across: Values, contact_modulus: Values
) -> EllipticalContact:
    """Solve the elliptical contact as Farzaneh (2002), appendix B, does.

    a/b = (R'/R'')^(2/3), F1 = 0.89, F2 = 0.88.

    Parameters
    ----------
    contact_modulus : float or array
        Contact modulus E*, see `erlif.models.contact.contact_modulus`. [Pa]
    load, radius, radius_across : float or array
        Load P [N], the larger and the smaller reduced radius R' and R'' [m].

    Returns
    -------
    EllipticalContact
        Semi-axes, maximum pressure and approach. [m, Pa]

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
    table = {"axis_ratio": (radius / radius_across) ** (2 / 3), "F1": THESIS_F1, "F2": THESIS_F2}
    return _ellipse(load, radius, radius_across, contact_modulus, **table)


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
    """Find a/b >= 1 from R'/R'' >= 1; between the powers 1/2 and 2/3."""
    log_radii = np.log(radius_ratio)
    log_axes = find_roots(
        lambda trial, wanted: _log_radius_ratio(trial) - wanted,
        log_radii / 2 - 1e-9,
        log_radii * 2 / 3 + 1e-9,
        log_radii,
    )
    return np.exp(np.maximum(log_axes, 0.0))


def _log_radius_ratio(log_axes: Values) -> Values:
    """ln R'/R'' of the contact with ln a/b."""
    p = np.exp(-2 * log_axes)
    return np.log(scipy.special.elliprd(0.0, 1.0, p) / scipy.special.elliprd(0.0, p, 1.0))
