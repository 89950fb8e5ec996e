"""Film of a point or elliptical contact. Hamrock and Dowson (1977, 1978, 1979).

The formulas hold for steady motion, one temperature, smooth surfaces and a flooded inlet. The
entrainment speed is the mean of the two surface speeds towards the inlet, that is, half the sliding
speed of a pin in a fixed bushing; its sign does not matter.
"""

import warnings
from typing import NamedTuple

import numpy as np

from erlif.core.errors import RangeWarning
from erlif.models.arguments import Values, formula, warn_of_range
from erlif.models.contact import hertz_ellipse
from erlif.models.film.line import BLOK_CONSTANT
from erlif.models.film.regimes import BARUS_LIMIT, ContactFilm, govern, largest, note_motion

# Name of the formula by which figures, pages and tables call it.
HAMROCK_DOWSON_ELLIPTICAL = "Hamrock-Dowson, elliptical"

# Relative standard deviations of the four minima against solutions (docs/theory/film.md); `_BEYOND`
# where k is below 1, the elastic ones there by guess, twice those of the fits or more. [1]
_ERRORS = (0.03, 0.03, 0.06, 0.10)
_BEYOND = (0.10, 0.03, 0.20, 0.20)
_JOIN = 3.0  # power in which films add up where two regimes meet


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
    speed, modulus = entrainment_speed, contact_modulus
    U, W, k = _groups(speed, load, viscosity, radius_along, radius_across, modulus)
    G = pressure_viscosity * 2 * contact_modulus
    warn_of_range("The film of Hamrock and Dowson (1977)", "k", k, 1.0, 8.0)

    minimum = 3.63 * radius_along * U**0.68 * G**0.49 * W**-0.073 * (1 - np.exp(-0.68 * k))
    central = 2.69 * radius_along * U**0.67 * G**0.53 * W**-0.067 * (1 - 0.61 * np.exp(-0.73 * k))
    return EllipticalFilm(minimum, central)


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
    piezoviscous-rigid 1.666 (G U)^(2/3) (1 + 0.79/a)^(-2/3),
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

    The piezoviscous-rigid film is the one at which the reduced pressure of Barus is exhausted. The
    factor 0.79 is that of solutions of Reynolds' equation for a = 0.1 to 10, to 0.4 %; without
    cavities it is 2/3, as in the isoviscous film. The source has 1.66 (1 - exp(-0.68 k)), 26 % less
    for a ball.

    Where films of two regimes are close the true one exceeds both: it is about the third root of
    the sum of their third powers. `error` is that of the regime, and this excess. Where the bodies
    are not rigid and the piezoviscous-rigid film is thicker, half of that is part of it as well.

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
    speed, modulus = entrainment_speed, contact_modulus
    U, W, k = _groups(speed, load, viscosity, radius_along, radius_across, modulus)
    G, a = pressure_viscosity * 2 * contact_modulus, radius_across / radius_along
    side = 128 * a * (0.131 * np.arctan(a / 2) + 1.683) ** 2 / (1 + 2 / (3 * a)) ** 2
    rigid = side * radius_along * (U / W) ** 2
    viscous = BLOK_CONSTANT * radius_along * (G * U / (1 + 0.79 / a)) ** (2 / 3)
    soft = 7.43 * radius_along * U**0.65 * W**-0.21 * (1 - 0.85 * np.exp(-0.31 * k))
    soft_central = 7.32 * radius_along * U**0.64 * W**-0.22 * (1 - 0.72 * np.exp(-0.28 * k))

    # rigid bodies govern where they do in an oil of constant viscosity: beyond, the film of Barus
    # and rigid bodies exceeds that of hard bodies that are flat. A choice by products, which
    # broadcast over DataArrays as over floats.
    choice = rigid, viscous * (rigid >= soft), soft, hard.minimum
    film = largest(choice)
    central = film + (film == soft) * (soft_central - film)
    central = central + (film == hard.minimum) * (hard.central - central)

    dry = hertz_ellipse(
        load,
        radius=np.maximum(radius_along, radius_across),
        radius_across=np.minimum(radius_along, radius_across),
        contact_modulus=contact_modulus,
    )
    errors = _ERRORS if np.all(np.greater_equal(k, 1)) else _BEYOND
    regime, error, notes = govern(choice, HAMROCK_DOWSON_ELLIPTICAL, dry.pressure, errors)
    notes += tuple(str(one.message) for one in beyond if one.category is RangeWarning)
    along = dry.b if np.all(np.greater_equal(a, 1)) else dry.a
    notes += note_motion(entrainment_speed, along, stroke)
    with np.errstate(divide="ignore", invalid="ignore"):
        gV, gE = G * W**3 / U**2, W ** (8 / 3) / U**2
        excess = sum((one / film) ** _JOIN for one in choice) ** (1 / _JOIN) - 1
        # up to 0.5 GPa solutions of hard bodies reach the film of Barus and rigid ones
        rigid_excess = np.maximum(viscous / film - 1, 0) / 2 * (dry.pressure <= BARUS_LIMIT)
    error = np.hypot(np.hypot(error, excess), rigid_excess)
    films = rigid, viscous, soft, hard.minimum
    return ContactFilm(film, central, error, regime, *films, gV=gV, gE=gE, notes=notes)


def _groups(
    speed: Values,
    load: Values,
    viscosity: Values,
    radius_along: Values,
    radius_across: Values,
    contact_modulus: Values,
) -> tuple[Values, Values, Values]:
    """Groups U and W of Hamrock and Dowson, and the ellipticity k of the dry contact. [1]"""
    U = viscosity * np.abs(speed) / (2 * contact_modulus * radius_along)
    W = load / (2 * contact_modulus * radius_along**2)
    return U, W, 1.03 * (radius_across / radius_along) ** 0.64
