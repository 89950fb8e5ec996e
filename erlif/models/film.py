"""Film formulas for line and elliptical contacts, the regime map and the film parameter.

The formulas hold for steady motion, one temperature, smooth surfaces and a flooded inlet. The
entrainment speed is the mean of the two surface speeds towards the inlet, that is, half the sliding
speed of a pin in a fixed bushing; its sign does not matter. The formulas of Dowson and Higginson
and their descendants use E' = 2 E*.

Sources: Martin (1916), Blok (1950), Herrebrugh (1968) and Dowson and Higginson (1966) for the films
of a line contact, Venner and Lubrecht (2000) for the curve through them, Johnson (1970) for their
map; Hamrock and Dowson (1977, 1978, 1979) for elliptical contacts; Farzaneh (2002) for the pin
joint.
"""

import warnings
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from erlif.core.errors import ModelError, RangeWarning
from erlif.models.arguments import (
    Values,
    formula,
    require_not_negative,
    require_single,
    warn_of_range,
)
from erlif.models.contact import hertz_ellipse, hertz_line
from erlif.models.contact.roots import like

# Names of the two formulas known as Hamrock-Dowson, by which figures, pages and tables call them.
HAMROCK_DOWSON_LINE = "Hamrock-Dowson, line contact (2.65)"
HAMROCK_DOWSON_ELLIPTICAL = "Hamrock-Dowson, elliptical"

# The four asymptotes of a contact, in the order of `ContactFilm`.
FILM_REGIMES = (
    "isoviscous-rigid",
    "piezoviscous-rigid",
    "isoviscous-elastic",
    "piezoviscous-elastic",
)

# Ranges of the film parameter, overlapping as printed in Farzaneh (2002), section 2.2.2.
LUBRICATION_REGIMES = {
    "hydrodynamic": (5.0, 100.0),
    "elastohydrodynamic": (3.0, 10.0),
    "partial": (1.0, 5.0),
    "boundary": (0.0, 1.0),
}

# h W / (R U) of rigid cylinders with Reynolds' exit condition; 4.0 with that of Guembel.
MARTIN_CONSTANT = 4.894968

# h / R over (G U)^(2/3) of rigid cylinders where the pressure on the Barus oil is unbounded.
BLOK_CONSTANT = 1.666297

# Film where the pressure is highest over the minimum, 1 + c*^2 of rigid cylinders: there oil flows
# without a pressure gradient, which is what the curve of Moes is the film of.
CENTRAL_OVER_MINIMUM = 1.225748

# Pressure above which the law of Barus makes mineral oils too stiff. [Pa]
BARUS_LIMIT = 0.5e9

# Share of the largest asymptote from which a second one lies at a border of the regime map.
BORDER = 0.9


@formula()
def isoviscous_rigid_film(
    entrainment_speed: Values, *, load_per_length: Values, viscosity: Values, radius: Values
) -> Values:
    """Film thickness of rigid cylinders in an oil of constant viscosity: h/R = 4.895 U/W.

    Martin (1916).

    Parameters
    ----------
    entrainment_speed : float or array
        Mean u of the two surface speeds. [m/s]
    load_per_length : float or array
        Line load q. [N/m]
    viscosity : float or array
        Dynamic viscosity eta at ambient pressure. [Pa s]
    radius : float or array
        Reduced radius R, see `erlif.models.contact.conformal_radius`. [m]

    Returns
    -------
    float or array
        Film thickness at the line of centres, the minimum. [m]

    Notes
    -----
    U/W = eta u / q: the moduli cancel. The constant is 4.894968 with Reynolds' exit condition, 4.0
    in Guembel's form; handbooks that use the sum of the speeds print half of it, 2.45.

    Examples
    --------
    The acrylic pin joint of Farzaneh (2002) under 50 lbf on 237 mm, in micrometres:

    >>> film = isoviscous_rigid_film(
    ...     0.0421, load_per_length=222.411 / 0.237, viscosity=0.12, radius=4.87201
    ... )
    >>> round(film * 1e6, 1)
    128.4
    """
    # U/W with the moduli cancelled, so that rigid bodies need none
    return MARTIN_CONSTANT * radius * viscosity * np.abs(entrainment_speed) / load_per_length


@formula()
def piezoviscous_rigid_film(
    entrainment_speed: Values, *, viscosity: Values, pressure_viscosity: Values, radius: Values
) -> Values:
    """Film thickness of rigid cylinders in a Barus oil at high load: h/R = 1.666 (G U)^(2/3).

    Blok (1950).

    Parameters
    ----------
    entrainment_speed : float or array
        Mean u of the two surface speeds. [m/s]
    viscosity : float or array
        Dynamic viscosity eta at ambient pressure. [Pa s]
    pressure_viscosity : float or array
        Barus coefficient alpha at ambient pressure. [1/Pa]
    radius : float or array
        Reduced radius R, see `erlif.models.contact.conformal_radius`. [m]

    Returns
    -------
    float or array
        Minimum film thickness. [m]

    Notes
    -----
    G U = alpha eta u / R: the moduli cancel, and the film does not depend on the load.

    Examples
    --------
    The pin joint of Farzaneh (2002), in micrometres:

    >>> film = piezoviscous_rigid_film(
    ...     0.0421, viscosity=0.12, pressure_viscosity=2e-8, radius=4.87201
    ... )
    >>> round(film * 1e6, 3)
    0.613
    """
    # G U with the moduli cancelled, so that rigid bodies need none
    return (
        BLOK_CONSTANT
        * radius
        * (pressure_viscosity * viscosity * np.abs(entrainment_speed) / radius) ** (2 / 3)
    )


@formula()
def isoviscous_elastic_film(
    entrainment_speed: Values,
    *,
    load_per_length: Values,
    viscosity: Values,
    radius: Values,
    contact_modulus: Values,
) -> Values:
    """Film thickness of soft cylinders in an oil of constant viscosity: h/R = 3.10 U^0.6 W^-0.2.

    Herrebrugh (1968).

    Parameters
    ----------
    entrainment_speed : float or array
        Mean u of the two surface speeds. [m/s]
    load_per_length : float or array
        Line load q. [N/m]
    viscosity : float or array
        Dynamic viscosity eta at ambient pressure. [Pa s]
    radius : float or array
        Reduced radius R, see `erlif.models.contact.conformal_radius`. [m]
    contact_modulus : float or array
        E*, see `erlif.models.contact.contact_modulus`; U and W are formed with 2 E*. [Pa]

    Returns
    -------
    float or array
        Minimum film thickness. [m]

    Examples
    --------
    The acrylic pin joint of Farzaneh (2002) under 1333 lbf, in micrometres:

    >>> film = isoviscous_elastic_film(
    ...     0.0421,
    ...     load_per_length=5929.5 / 0.237,
    ...     viscosity=0.12,
    ...     radius=4.87201,
    ...     contact_modulus=1.5641e9,
    ... )
    >>> round(film * 1e6, 2)
    7.05
    """
    U, W = _groups(entrainment_speed, load_per_length, viscosity, contact_modulus * radius)
    return 3.10 * radius * U**0.6 * W**-0.2


@formula()
def dowson_higginson_film(
    entrainment_speed: Values,
    *,
    load_per_length: Values,
    viscosity: Values,
    pressure_viscosity: Values,
    radius: Values,
    contact_modulus: Values,
) -> Values:
    """Minimum film thickness of a loaded elastic line contact: h/R = 2.65 G^0.54 U^0.7 W^-0.13.

    G = alpha E', U = eta u / (E' R), W = q / (E' R), with E' = 2 E* and the mean speed u.
    Dowson and Higginson (1966); `thesis_film` is the form of Farzaneh (2002), eq. 2.8, in its own
    symbols.

    Parameters
    ----------
    entrainment_speed : float or array
        Mean u of the two surface speeds. [m/s]
    load_per_length : float or array
        Line load q. [N/m]
    viscosity : float or array
        Dynamic viscosity eta at ambient pressure. [Pa s]
    pressure_viscosity : float or array
        Barus coefficient alpha at ambient pressure. [1/Pa]
    radius : float or array
        Reduced radius R, see `erlif.models.contact.conformal_radius`. [m]
    contact_modulus : float or array
        Contact modulus E*, see `erlif.models.contact.contact_modulus`. [Pa]

    Returns
    -------
    float or array
        Minimum film thickness. [m]

    Notes
    -----
    Holds in the piezoviscous-elastic regime only; `line_contact_film` finds the regime. For the
    acrylic optical joint at 50 lbf it is 67 times too small.

    Examples
    --------
    The steel pin joint of Farzaneh (2002) under 444.8 kN, in micrometres:

    >>> joint = {"radius": 4.87201, "contact_modulus": 109.8901e9, "viscosity": 0.12}
    >>> joint |= {"load_per_length": 444.8e3 / 0.237, "pressure_viscosity": 2e-8}
    >>> film = dowson_higginson_film(0.042, **joint)
    >>> round(film * 1e6, 4)
    0.6272
    """
    U, W = _groups(entrainment_speed, load_per_length, viscosity, contact_modulus * radius)
    G = pressure_viscosity * 2 * contact_modulus
    return 2.65 * radius * G**0.54 * U**0.7 * W**-0.13


@formula()
def thesis_film(
    sliding_speed: Values,
    *,
    load_per_length: Values,
    viscosity: Values,
    pressure_viscosity: Values,
    radius: Values,
    contact_modulus: Values,
) -> Values:
    """Minimum film thickness by Farzaneh (2002), eq. 2.8, as printed: E* and full sliding speed.

    h/R = 2.65 G^0.54 V^0.7 W^-0.13 with G = alpha E*, V = eta v / (2 E* R), W = q / (E* R).

    Parameters
    ----------
    load_per_length : float or array
        Line load q. [N/m]
    viscosity : float or array
        Dynamic viscosity eta at ambient pressure. [Pa s]
    pressure_viscosity : float or array
        Barus coefficient alpha at ambient pressure. [1/Pa]
    radius : float or array
        Reduced radius R, see `erlif.models.contact.conformal_radius`. [m]
    contact_modulus : float or array
        Contact modulus E*, see `erlif.models.contact.contact_modulus`. [Pa]
    sliding_speed : float or array
        Full sliding speed v of the pin in its bushing. [m/s]

    Returns
    -------
    float or array
        Minimum film thickness. [m]

    Notes
    -----
    The two slips nearly cancel: this is 2^0.03 = 1.0210 times the standard form with u = v/2. The
    thesis computes its example with w = 222.5 kN for 100,000 lbf, which is 444.8 kN, and states no
    alpha, so its 0.54 um fits alphas of 1.23e-8 to 1.52e-8 1/Pa.

    Examples
    --------
    The printed 0.54 um with the load of the thesis, in micrometres:

    >>> film = thesis_film(
    ...     0.084,
    ...     load_per_length=222.5e3 / 0.237,
    ...     viscosity=0.12,
    ...     pressure_viscosity=1.2345e-8,
    ...     radius=4.87201,
    ...     contact_modulus=109.8901e9,
    ... )
    >>> round(film * 1e6, 3)
    0.54
    """

    # in the symbols of the source, which count the modulus once in G and W and twice in V
    G = pressure_viscosity * contact_modulus
    V = viscosity * np.abs(sliding_speed) / (2 * contact_modulus * radius)
    W = load_per_length / (contact_modulus * radius)
    return 2.65 * radius * G**0.54 * V**0.7 * W**-0.13


@dataclass(frozen=True)
class ContactFilm:
    """Film of a line or elliptical contact, the four regimes it comes from, and its limits.

    All film thicknesses are in m; gV and gE are dimensionless.

    Attributes
    ----------
    film : Values
        Minimum film thickness. [m]
    central : Values
        Film thickness at the centre of the contact. [m]
    regime : Values
        Name of the regime with the largest film, from `FILM_REGIMES`; empty where the film is NaN.
    isoviscous_rigid, piezoviscous_rigid : Values
        Minimum film thickness of rigid bodies in oil of constant viscosity, and of Barus. [m]
    isoviscous_elastic, piezoviscous_elastic : Values
        Minimum film thickness of elastic bodies in the same two oils. [m]
    gV : Values
        Viscosity parameter. [1]
    gE : Values
        Elasticity parameter. [1]
    notes : tuple[str, ...]
        Limits of the formulas, to be stated beside the film thickness.
    """

    film: Values
    central: Values
    regime: Values
    isoviscous_rigid: Values
    piezoviscous_rigid: Values
    isoviscous_elastic: Values
    piezoviscous_elastic: Values
    gV: Values  # noqa: N815
    gE: Values  # noqa: N815
    notes: tuple[str, ...]


@formula()
def line_contact_film(
    entrainment_speed: Values,
    *,
    load_per_length: Values,
    viscosity: Values,
    pressure_viscosity: Values,
    radius: Values,
    contact_modulus: Values,
    stroke: float | None = None,
) -> ContactFilm:
    """Film of a line contact by the smooth curve of Moes through the four regimes.

    Parameters
    ----------
    entrainment_speed : float or array
        Mean u of the two surface speeds. [m/s]
    load_per_length : float or array
        Line load q. [N/m]
    viscosity : float or array
        Dynamic viscosity eta at ambient pressure. [Pa s]
    pressure_viscosity : float or array
        Barus coefficient alpha at ambient pressure. [1/Pa]
    radius : float or array
        Reduced radius R, see `erlif.models.contact.conformal_radius`. [m]
    contact_modulus : float or array
        Contact modulus E*, see `erlif.models.contact.contact_modulus`. [Pa]
    stroke : float, optional
        Peak-to-peak travel of the entrained oil, the integral of the entrainment speed over half a
        cycle: pin radius times half the swing. With it the notes state whether a film formed at the
        inlet crosses the contact; infinite for a joint that turns all the way round. [m]

    Returns
    -------
    ContactFilm
        Film, regime, asymptotes, and the parameters gV = G W^1.5 U^-0.5 and gE = W U^-0.5 of the
        regime map of Johnson (1970).

    Raises
    ------
    ModelError
        A value that is not positive, a negative coefficient or stroke, or an infinite value.

    Notes
    -----
    With M = W (2U)^-1/2, L = G (2U)^1/4 and H = (h/R) (2U)^-1/2, Venner and Lubrecht (2000) join
    H_RI = 3/M, H_RP = 1.287 L^(2/3), H_EI = 2.621 M^(-1/5), H_EP = 1.311 M^(-1/8) L^(3/4) to
    H = [(H_RI^(7/3) + H_EI^(7/3))^(3s/7) + (H_RP^(-7/2) + H_EP^(-7/2))^(-2s/7)]^(1/s),
    s = (7 + 8 exp(-2 H_EI/H_RI))/5.

    H is the film where the pressure is highest; the minimum is taken as H/1.2257, which is exact
    for rigid cylinders. The regime is that of the largest of the four asymptotes of the minimum.

    Examples
    --------
    The pin joint of Farzaneh (2002), acrylic under 50 lbf and steel under 100,000 lbf:

    >>> joint = {"viscosity": 0.12, "pressure_viscosity": 2e-8, "radius": 4.87201}
    >>> optical = line_contact_film(
    ...     0.0421, load_per_length=938.4, contact_modulus=1.5641e9, **joint
    ... )
    >>> optical.regime, round(optical.film * 1e6, 1)
    ('isoviscous-rigid', 128.7)
    >>> machine = line_contact_film(
    ...     0.0421, load_per_length=1.8769e6, contact_modulus=109.8901e9, **joint
    ... )
    >>> machine.regime, round(machine.film * 1e6, 3)
    ('piezoviscous-elastic', 0.808)
    """
    # rigid bodies: the pressure is too low to flatten them; elastic bodies: the flat takes the load
    contact = {"load_per_length": load_per_length, "radius": radius}
    soft = {**contact, "contact_modulus": contact_modulus, "viscosity": viscosity}
    stiffening = {"viscosity": viscosity, "pressure_viscosity": pressure_viscosity}
    asymptotes = (
        isoviscous_rigid_film(entrainment_speed, viscosity=viscosity, **contact),
        piezoviscous_rigid_film(entrainment_speed, radius=radius, **stiffening),
        isoviscous_elastic_film(entrainment_speed, **soft),
        dowson_higginson_film(entrainment_speed, pressure_viscosity=pressure_viscosity, **soft),
    )

    U, W = _groups(entrainment_speed, load_per_length, viscosity, contact_modulus * radius)
    G = pressure_viscosity * 2 * contact_modulus
    central = radius * np.sqrt(2 * U) * _smooth_line(U, W, G)
    # at a standstill both parameters are infinite
    with np.errstate(divide="ignore"):
        gE = W / np.sqrt(U)
    gV = G * gE * np.sqrt(W)

    # width and pressure of the dry contact bound those of the lubricated one
    dry = hertz_line(load_per_length, radius=radius, contact_modulus=contact_modulus)
    regime, notes = _govern(asymptotes, HAMROCK_DOWSON_LINE, dry.pressure)
    notes += _motion_notes(entrainment_speed, dry.half_width, stroke)
    return ContactFilm(
        central / CENTRAL_OVER_MINIMUM, central, regime, *asymptotes, gV=gV, gE=gE, notes=notes
    )


@formula()
def elliptical_contact_film(
    entrainment_speed: Values,
    *,
    load: Values,
    viscosity: Values,
    pressure_viscosity: Values,
    radius_along: Values,
    radius_across: Values,
    contact_modulus: Values,
    stroke: float | None = None,
) -> ContactFilm:
    """Film of a point or elliptical contact in the regime that governs. Hamrock and Dowson (1979).

    With a = Ry/Rx and k = 1.03 a^0.64, the minimum h/Rx is
    isoviscous-rigid 128 a (0.131 atan(a/2) + 1.683)^2 (1 + 2/(3a))^-2 (U/W)^2,
    piezoviscous-rigid 1.66 (G U)^(2/3) (1 - exp(-0.68 k)),
    isoviscous-elastic 7.43 U^0.65 W^-0.21 (1 - 0.85 exp(-0.31 k)), and
    piezoviscous-elastic as `hamrock_dowson_film`. The largest governs, the second only where the
    first exceeds the third: else the bodies are not rigid.

    Parameters
    ----------
    entrainment_speed : float or array
        Mean u of the two surface speeds. [m/s]
    viscosity : float or array
        Dynamic viscosity eta at ambient pressure. [Pa s]
    pressure_viscosity : float or array
        Barus coefficient alpha at ambient pressure. [1/Pa]
    contact_modulus : float or array
        Contact modulus E*, see `erlif.models.contact.contact_modulus`. [Pa]
    load, radius_along, radius_across : float or array
        Load w on the contact [N], reduced radii Rx along and Ry across the motion [m].
    stroke : float, optional
        As for `line_contact_film`. [m]

    Returns
    -------
    ContactFilm
        Film, regime, the four films, and the parameters gV = G W^3/U^2 and gE = W^(8/3)/U^2.
        Where rigid bodies govern, the central film is the minimum.

    Notes
    -----
    Groups as for `hamrock_dowson_film`. The film of soft bodies is that of Hamrock and Dowson
    (1978), whose central one is 7.32 U^0.64 W^-0.22 (1 - 0.72 exp(-0.28 k)). The elastic films
    were fitted for k from 1 to 8; a note names a k outside.

    Examples
    --------
    A glass ball of 10 mm on acrylic under 1 N, in micrometres:

    >>> ball = {"radius_along": 0.01, "radius_across": 0.01, "contact_modulus": 3.0e9}
    >>> oil = {"viscosity": 0.1, "pressure_viscosity": 2e-8}
    >>> found = elliptical_contact_film(0.1, load=1.0, **ball, **oil)
    >>> found.regime, round(found.film * 1e6, 3)
    ('isoviscous-elastic', 0.205)
    """
    oil = {"viscosity": viscosity, "pressure_viscosity": pressure_viscosity}
    bodies = {"radius_across": radius_across, "contact_modulus": contact_modulus}
    with warnings.catch_warnings(record=True) as beyond:
        warnings.simplefilter("always")
        hard = hamrock_dowson_film(
            entrainment_speed, load=load, radius_along=radius_along, **bodies, **oil
        )

    # rigid bodies first, then soft ones: minimum and centre
    G = pressure_viscosity * 2 * contact_modulus
    U = viscosity * np.abs(entrainment_speed) / (2 * contact_modulus * radius_along)
    W = load / (2 * contact_modulus * radius_along**2)
    a = radius_across / radius_along
    k = 1.03 * a**0.64
    side = 128 * a * (0.131 * np.arctan(a / 2) + 1.683) ** 2 / (1 + 2 / (3 * a)) ** 2
    rigid = side * radius_along * (U / W) ** 2
    viscous = 1.66 * radius_along * (G * U) ** (2 / 3) * (1 - np.exp(-0.68 * k))
    soft = 7.43 * radius_along * U**0.65 * W**-0.21 * (1 - 0.85 * np.exp(-0.31 * k))
    soft_central = 7.32 * radius_along * U**0.64 * W**-0.22 * (1 - 0.72 * np.exp(-0.28 * k))

    # rigid bodies govern where they do in an oil of constant viscosity: beyond, the film of Barus
    # and rigid bodies exceeds that of hard bodies that are flat. A choice by products, which
    # broadcast over DataArrays as over floats.
    choice = rigid, viscous * (rigid >= soft), soft, hard.minimum
    film = _largest(choice)
    central = film + (film == soft) * (soft_central - film)
    central = central + (film == hard.minimum) * (hard.central - central)

    dry = hertz_ellipse(
        load,
        radius=np.maximum(radius_along, radius_across),
        radius_across=np.minimum(radius_along, radius_across),
        contact_modulus=contact_modulus,
    )
    regime, notes = _govern(choice, HAMROCK_DOWSON_ELLIPTICAL, dry.pressure)
    notes += tuple(str(one.message) for one in beyond if one.category is RangeWarning)
    along = dry.b if np.all(np.greater_equal(a, 1)) else dry.a
    notes += _motion_notes(entrainment_speed, along, stroke)
    with np.errstate(divide="ignore"):
        gV, gE = G * W**3 / U**2, W ** (8 / 3) / U**2
    films = rigid, viscous, soft, hard.minimum
    return ContactFilm(film, central, regime, *films, gV=gV, gE=gE, notes=notes)


class EllipticalFilm(NamedTuple):
    """Minimum and central film thickness of an elliptical contact, in m.

    Attributes
    ----------
    minimum : Values
        Minimum film thickness. [m]
    central : Values
        Film thickness at the centre of the contact. [m]
    """

    minimum: Values
    central: Values


@formula()
def hamrock_dowson_film(
    entrainment_speed: Values,
    *,
    load: Values,
    viscosity: Values,
    pressure_viscosity: Values,
    radius_along: Values,
    radius_across: Values,
    contact_modulus: Values,
) -> EllipticalFilm:
    """Minimum and central film thickness of an elliptical contact. Hamrock and Dowson (1977).

    h_min/Rx = 3.63 U^0.68 G^0.49 W^-0.073 (1 - exp(-0.68 k)),
    h_c/Rx = 2.69 U^0.67 G^0.53 W^-0.067 (1 - 0.61 exp(-0.73 k)),  k = 1.03 (Ry/Rx)^0.64,
    with G = alpha E', U = eta u / (E' Rx), W = w / (E' Rx^2) and E' = 2 E*.

    Parameters
    ----------
    entrainment_speed : float or array
        Mean u of the two surface speeds. [m/s]
    viscosity : float or array
        Dynamic viscosity eta at ambient pressure. [Pa s]
    pressure_viscosity : float or array
        Barus coefficient alpha at ambient pressure. [1/Pa]
    contact_modulus : float or array
        Contact modulus E*, see `erlif.models.contact.contact_modulus`. [Pa]
    load, radius_along, radius_across : float or array
        Load w on the contact [N], reduced radii Rx along and Ry across the motion [m].

    Returns
    -------
    EllipticalFilm
        Minimum and central film thickness. [m]

    Warns
    -----
    RangeWarning
        k below 1 or above 8, where the source has no contacts.

    Notes
    -----
    Fitted for hard contacts with k from 1 to 8, entrained along the minor axis. The lobed bushing
    of Farzaneh (2002) slides along the major axis of its contact (Rx 4.87 m, Ry 0.2 m): k is far
    below 1, outside the fit.

    Examples
    --------
    The minimum film of a ball is to that of an ellipse of k = 1.03 x 20^0.64 = 7.01 as
    1 - exp(-0.68 x 1.03) = 0.504 is to 1 - exp(-0.68 x 7.01) = 0.991:

    >>> contact = {"load": 100.0, "viscosity": 0.05, "pressure_viscosity": 2e-8}
    >>> contact |= {"radius_along": 0.01, "contact_modulus": 110e9}
    >>> ball = hamrock_dowson_film(1.0, radius_across=0.01, **contact)
    >>> barrel = hamrock_dowson_film(1.0, radius_across=0.2, **contact)
    >>> round(ball.minimum / barrel.minimum, 3)
    0.508
    """

    G = pressure_viscosity * 2 * contact_modulus
    U = viscosity * np.abs(entrainment_speed) / (2 * contact_modulus * radius_along)
    W = load / (2 * contact_modulus * radius_along**2)
    # ellipticity of the dry contact, by the fit of the source
    k = 1.03 * (radius_across / radius_along) ** 0.64
    warn_of_range("The film of Hamrock and Dowson (1977)", "k", k, 1.0, 8.0)

    minimum = 3.63 * radius_along * U**0.68 * G**0.49 * W**-0.073 * (1 - np.exp(-0.68 * k))
    central = 2.69 * radius_along * U**0.67 * G**0.53 * W**-0.067 * (1 - 0.61 * np.exp(-0.73 * k))
    return EllipticalFilm(minimum, central)


@formula(film="film")
def squeeze_time(
    film: Values, *, half_width: Values, load_per_length: Values, viscosity: Values
) -> Values:
    """Time in which a load squeezes a parallel film down to a thickness: t = 4 eta b^3 / (q h^2).

    From a thick start; long strip of width 2b, constant viscosity, ambient pressure at both edges.
    It estimates how long the middle of a contact that the motion does not sweep keeps its oil.
    Reynolds' equation integrated for parallel plates.

    Parameters
    ----------
    load_per_length : float or array
        Line load q. [N/m]
    viscosity : float or array
        Dynamic viscosity eta at ambient pressure. [Pa s]
    film : float or array
        Film thickness h at the end. [m]
    half_width : float or array
        Half width b of the strip, see `erlif.models.contact.hertz_line`. [m]

    Returns
    -------
    float or array
        Time from an infinitely thick film. [s]

    Examples
    --------
    The steel joint of Farzaneh (2002) under 100,000 lbf keeps 0.64 um for 0.68 s:

    >>> round(squeeze_time(
    ...     0.64e-6, half_width=10.2932e-3, load_per_length=1.8769e6, viscosity=0.12
    ... ), 2)
    0.68
    """
    return 4 * viscosity * half_width**3 / (load_per_length * film**2)


@formula(film="film or zero")
def film_parameter(film: Values, *, roughness_a: Values, roughness_b: Values) -> Values:
    """Film thickness over combined roughness: Lambda = h / sqrt(Ra^2 + Rb^2).

    Farzaneh (2002), eq. 2.7.

    Parameters
    ----------
    film, roughness_a, roughness_b : float or array
        Minimum film thickness h [m], root-mean-square roughness of the two surfaces, not negative
        and not both zero [m].

    Returns
    -------
    float or array
        Film parameter Lambda, see `lubrication_regimes`. [1]

    Raises
    ------
    ModelError
        A negative or infinite value, or two surfaces without roughness.

    Notes
    -----
    The thesis prints 1.52e-6, metres divided by micrometres; its 0.54 um with 0.25 um on each
    surface gives 1.53, partial lubrication by its own list and not boundary lubrication. Its
    footnote defines the root mean square and calls it R_a.

    Examples
    --------
    >>> round(film_parameter(0.54e-6, roughness_a=0.25e-6, roughness_b=0.25e-6), 2)
    1.53
    """

    # smooth surfaces leave the parameter undefined
    combined = np.sqrt(roughness_a**2 + roughness_b**2)
    if np.any(np.equal(combined, 0)):
        raise ModelError("roughness_a and roughness_b must not both be zero.")
    return film / combined


@formula(film_parameter="number or zero")
def lubrication_regimes(film_parameter: Values) -> Values:
    """List the regimes of `LUBRICATION_REGIMES` whose range contains a film parameter.

    The ranges overlap, as printed in Farzaneh (2002), section 2.2.2. A range contains its lower end
    and not its upper one.

    Parameters
    ----------
    film_parameter : float or array
        Film parameter Lambda. [1]

    Returns
    -------
    tuple of str, or array of tuples
        Names of the regimes, in the order of the table; empty above 100 and for NaN.

    Examples
    --------
    >>> lubrication_regimes(1.52)
    ('partial',)
    >>> lubrication_regimes(7.0)
    ('hydrodynamic', 'elastohydrodynamic')
    """
    # numpy would make a table of tuples of equal length, so the array is filled one by one
    flat = np.ravel(np.asarray(film_parameter))
    regimes = np.empty(flat.size, object)
    for i, value in enumerate(flat):
        regimes[i] = tuple(
            name for name, (low, high) in LUBRICATION_REGIMES.items() if low <= value < high
        )

    return like(film_parameter, regimes.reshape(np.shape(film_parameter)))


def _groups(
    speed: Values, load_per_length: Values, viscosity: Values, stiffness: Values
) -> tuple[Values, Values]:
    """U = eta u / (E' R) and W = q / (E' R) with half of the stiffness E' R = 2 E* R."""
    return viscosity * np.abs(speed) / (2 * stiffness), load_per_length / (2 * stiffness)


def _smooth_line(U: Values, W: Values, G: Values) -> Values:
    """Central film of a line contact over R (2U)^1/2. Venner and Lubrecht (2000)."""
    # at a standstill M is infinite and each film zero; without alpha the last two are
    with np.errstate(divide="ignore"):
        M, L = W / np.sqrt(2 * U), G * (2 * U) ** 0.25
        rigid, viscous = 3 / M, 1.287 * L ** (2 / 3)
        elastic, both = 2.621 * M**-0.2, 1.311 * M**-0.125 * L**0.75
        s = (7 + 8 * np.exp(-2 * 2.621 / 3 * M**0.8)) / 5
        isoviscous = (rigid ** (7 / 3) + elastic ** (7 / 3)) ** (3 * s / 7)
        return (isoviscous + (viscous**-3.5 + both**-3.5) ** (-2 * s / 7)) ** (1 / s)


def _largest(asymptotes: tuple[Values, ...]) -> Values:
    rigid, viscous, elastic, both = asymptotes
    return np.maximum(np.maximum(rigid, viscous), np.maximum(elastic, both))


def _govern(
    asymptotes: tuple[Values, ...], formula_name: str, pressure: Values
) -> tuple[Values, tuple[str, ...]]:
    """Name of the largest of the four asymptotes, empty where it is NaN, and notes on the choice.

    Ties, and the zero film of a standstill, belong to the first of them. Written with products
    because these broadcast over DataArrays as over floats.
    """
    rigid, viscous, elastic, both = asymptotes
    film = _largest(asymptotes)
    governing = (film != rigid) * (
        1 + (film != viscous) * (1 + (film != elastic) * (1 + (film != both) * 1))
    )

    notes: tuple[str, ...] = (
        "The film formulas assume steady motion, one temperature, smooth surfaces and a flooded "
        "inlet.",
    )
    if np.any(np.less(governing, 3)):
        notes += (
            f"{formula_name} (piezoviscous-elastic) does not hold where another regime governs.",
        )
    # near a border two effects act together and neither asymptote holds alone
    close = sum((asymptote > BORDER * film) * 1 for asymptote in asymptotes)
    if np.any(np.greater(close, 1)):
        notes += (
            f"Two or more asymptotes lie within {100 * (1 - BORDER):.0f} %: the contact lies near "
            "a border of the regime map.",
        )
    if np.any(np.greater(pressure, BARUS_LIMIT)):
        notes += ("The Hertz pressure exceeds 0.5 GPa, above which the law of Barus is too stiff.",)
    return like(governing, np.asarray([*FILM_REGIMES, ""])[np.asarray(governing)]), notes


def _motion_notes(
    entrainment_speed: Values, half_width: Values, stroke: float | None
) -> tuple[str, ...]:
    if stroke is not None and not np.all(np.isposinf(stroke)):
        require_single(stroke=stroke)
        require_not_negative(stroke=stroke)

    notes = []
    # speeds of both signs, or a standstill
    if np.any(np.less_equal(entrainment_speed, 0)) and np.any(
        np.greater_equal(entrainment_speed, 0)
    ):
        notes.append(
            "Entrainment reverses: the steady formulas give zero film there, while a real film is "
            "maintained by squeeze and depends on the acceleration."
        )

    # the half width first, since a film that misses the centre does not cross either
    if stroke is None:
        notes.append("No stroke given: whether the motion sweeps the contact was not checked.")
    elif np.any(np.greater(half_width, stroke)):
        widest = float(np.nanmax(np.asarray(half_width)))
        notes.append(
            f"The stroke of {stroke * 1e3:.3g} mm is less than the contact half width of "
            f"{widest * 1e3:.3g} mm: oil entrained at the inlet never reaches the centre."
        )
    elif np.any(np.greater(2 * half_width, stroke)):
        widest = float(np.nanmax(np.asarray(2 * half_width)))
        notes.append(
            f"The stroke of {stroke * 1e3:.3g} mm is less than the contact width of "
            f"{widest * 1e3:.3g} mm: oil entrained at the inlet never crosses the contact."
        )
    return tuple(notes)
