"""Film of a line contact: the four asymptotes, the curve through them, and squeeze.

The formulas hold for steady motion, one temperature, smooth surfaces and a flooded inlet. The
entrainment speed is the mean of the two surface speeds towards the inlet, that is, half the sliding
speed of a pin in a fixed bushing; its sign does not matter. The formula of Dowson and Higginson
and its descendants use E' = 2 E*.

Sources: Martin (1916), Blok (1950), Herrebrugh (1968), Dowson and Higginson (1966), Venner and
Lubrecht (2000), Johnson (1970); Farzaneh (2002) for the pin joint.
"""

import numpy as np

from erlif.models.arguments import Values, formula
from erlif.models.contact import hertz_line
from erlif.models.film.regimes import ContactFilm, govern, note_motion

# Name of the formula by which figures, pages and tables call it.
HAMROCK_DOWSON_LINE = "Hamrock-Dowson, line contact (2.65)"

# h W / (R U) of rigid cylinders with Reynolds' exit condition; 4.0 with that of Guembel.
MARTIN_CONSTANT = 4.894968

# h / R over (G U)^(2/3) of rigid cylinders where the pressure on the Barus oil is unbounded.
BLOK_CONSTANT = 1.666297

# Film where the pressure is highest over the minimum, 1 + c*^2 of rigid cylinders: there oil flows
# without a pressure gradient, which is what the curve of Moes is the film of.
CENTRAL_OVER_MINIMUM = 1.225748

# Relative standard deviations of the minimum by the curve of Moes in each regime, and by the
# formula of Dowson and Higginson in its own, against solutions (docs/theory/film.md). [1]
_ERRORS = (0.03, 0.03, 0.04, 0.06)
DOWSON_HIGGINSON_ERROR = 0.20


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
    It is 0.94 to 1.07 of solutions of Reynolds' equation.

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
    regime, error, notes = govern(asymptotes, HAMROCK_DOWSON_LINE, dry.pressure, _ERRORS)
    notes += note_motion(entrainment_speed, dry.half_width, stroke)
    film = central / CENTRAL_OVER_MINIMUM
    return ContactFilm(film, central, error, regime, *asymptotes, gV=gV, gE=gE, notes=notes)


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
