"""Film formulas for line and elliptical contacts, the regime map and the film parameter.

The formulas hold for steady motion, one temperature, smooth surfaces and enough oil at the inlet. The entrainment speed
is the mean of the two surface speeds towards the inlet, so half the sliding speed of a pin in a fixed bushing; its sign
does not matter. The formulas of Dowson and Higginson and their descendants use E' = 2 E*.
"""

from dataclasses import dataclass

import numpy as np

from erlif.models.arguments import Values, require_not_negative, require_positive
from erlif.models.contact import hertz_line

FILM_REGIMES = (
    "isoviscous-rigid",
    "piezoviscous-rigid",
    "isoviscous-elastic",
    "piezoviscous-elastic",
)
"""The four asymptotes of the line contact, in the order of `LineContactFilm`."""

LUBRICATION_REGIMES = {
    "hydrodynamic": (5.0, 100.0),
    "elastohydrodynamic": (3.0, 10.0),
    "partial": (1.0, 5.0),
    "boundary": (0.0, 1.0),
}
"""Ranges of the film parameter, overlapping as printed in Farzaneh (2002), section 2.2.2."""


def isoviscous_rigid_film(
    entrainment_speed: Values, *, load_per_length: Values, viscosity: Values, radius: Values
) -> Values:
    """Film thickness [m] of rigid cylinders in an oil of constant viscosity: h/R = 4.895 U/W. Martin (1916).

    Parameters
    ----------
    entrainment_speed : float or array
        Mean of the two surface speeds. [m/s]
    load_per_length : float or array
        Line load. [N/m]
    viscosity : float or array
        Dynamic viscosity at the inlet. [Pa s]
    radius : float or array
        Reduced radius R, see `erlif.models.contact.conformal_radius`. [m]

    Notes
    -----
    U/W = eta u / q: the moduli cancel. The constant is 4.894968 with Reynolds' exit condition, 4.0 in Guembel's form;
    handbooks that count the sum of the speeds print half of it.
    """
    require_positive(load_per_length=load_per_length, viscosity=viscosity, radius=radius)
    return 4.894968 * radius * viscosity * np.abs(entrainment_speed) / load_per_length


def piezoviscous_rigid_film(
    entrainment_speed: Values, *, viscosity: Values, pressure_viscosity: Values, radius: Values
) -> Values:
    """Film thickness [m] of rigid cylinders in a Barus oil at high load: h/R = 1.666 (G U)^(2/3). Blok (1950).

    Parameters
    ----------
    entrainment_speed, viscosity, radius
        As in `isoviscous_rigid_film`.
    pressure_viscosity : float or array
        Barus coefficient alpha. [1/Pa]

    Notes
    -----
    G U = alpha eta u / R: the moduli cancel and the load does not enter.
    """
    require_positive(viscosity=viscosity, radius=radius)
    require_not_negative(pressure_viscosity=pressure_viscosity)
    return (
        1.666297
        * radius
        * (pressure_viscosity * viscosity * np.abs(entrainment_speed) / radius) ** (2 / 3)
    )


def isoviscous_elastic_film(
    entrainment_speed: Values,
    *,
    load_per_length: Values,
    viscosity: Values,
    radius: Values,
    contact_modulus: Values,
) -> Values:
    """Film thickness [m] of soft cylinders in an oil of constant viscosity: h/R = 3.10 U^0.6 W^-0.2. Herrebrugh (1968).

    Parameters
    ----------
    entrainment_speed, load_per_length, viscosity, radius
        As in `isoviscous_rigid_film`.
    contact_modulus : float or array
        E*; U and W are made with 2 E*. [Pa]
    """
    U, W = _speed_and_load_groups(
        entrainment_speed,
        load_per_length=load_per_length,
        viscosity=viscosity,
        radius=radius,
        contact_modulus=contact_modulus,
    )
    return 3.10 * radius * U**0.6 * W**-0.2


def dowson_higginson_film(
    entrainment_speed: Values,
    *,
    load_per_length: Values,
    viscosity: Values,
    pressure_viscosity: Values,
    radius: Values,
    contact_modulus: Values,
) -> Values:
    """Least film thickness [m] of a heavily loaded elastic line contact: h/R = 2.65 G^0.54 U^0.7 W^-0.13.

    G = alpha E', U = eta u / (E' R), W = q / (E' R), with E' = 2 E* and the mean speed u. Dowson and Higginson (1966);
    Farzaneh (2002), eq. 2.8, in its own symbols: see `thesis_film`.

    Parameters
    ----------
    entrainment_speed : float or array
        Mean of the two surface speeds. [m/s]
    load_per_length : float or array
        Line load q. [N/m]
    viscosity : float or array
        Dynamic viscosity at the inlet. [Pa s]
    pressure_viscosity : float or array
        Barus coefficient alpha. [1/Pa]
    radius : float or array
        Reduced radius R. [m]
    contact_modulus : float or array
        E*. [Pa]

    Notes
    -----
    Holds in the piezoviscous-elastic regime only; `line_contact_film` says where that is. For the acrylic optical joint
    at 50 lbf it is 67 times too small.
    """
    U, W = _speed_and_load_groups(
        entrainment_speed,
        load_per_length=load_per_length,
        viscosity=viscosity,
        radius=radius,
        contact_modulus=contact_modulus,
    )
    require_not_negative(pressure_viscosity=pressure_viscosity)
    G = pressure_viscosity * 2 * contact_modulus
    return 2.65 * radius * G**0.54 * U**0.7 * W**-0.13


def thesis_film(
    sliding_speed: Values,
    *,
    load_per_length: Values,
    viscosity: Values,
    pressure_viscosity: Values,
    radius: Values,
    contact_modulus: Values,
) -> Values:
    """Least film thickness [m] of Farzaneh (2002), eq. 2.8 as printed: E* in the place of E', full sliding speed.

    h/R = 2.65 G^0.54 V^0.7 W^-0.13 with G = alpha E*, V = eta v / (2 E* R), W = q / (E* R).

    Parameters as in `dowson_higginson_film`, with the full sliding speed v of the pin [m/s] in the place of the mean.

    Notes
    -----
    The slips nearly cancel: this is 1.0210 times the standard form with u = v/2. The thesis works its example with
    w = 222.5 kN for 100,000 lbf, which is 444.8 kN, and states no alpha, so its 0.54 um fits alphas of 1.23e-8 to
    1.52e-8 1/Pa.
    """
    require_positive(load_per_length=load_per_length, viscosity=viscosity, radius=radius)
    require_positive(contact_modulus=contact_modulus)
    require_not_negative(pressure_viscosity=pressure_viscosity)
    G = pressure_viscosity * contact_modulus
    V = viscosity * np.abs(sliding_speed) / (2 * contact_modulus * radius)
    W = load_per_length / (contact_modulus * radius)
    return 2.65 * radius * G**0.54 * V**0.7 * W**-0.13


@dataclass(frozen=True)
class LineContactFilm:
    """Film of a line contact with the four asymptotes it was chosen from and what limits its meaning."""

    film: Values
    """The largest of the four. [m]"""
    regime: Values
    """Name of the largest, from `FILM_REGIMES`; empty where the film is NaN."""
    isoviscous_rigid: Values
    piezoviscous_rigid: Values
    isoviscous_elastic: Values
    piezoviscous_elastic: Values
    gV: Values  # noqa: N815
    """Viscosity parameter G W^1.5 U^-0.5. [1]"""
    gE: Values  # noqa: N815
    """Elasticity parameter W U^-0.5. [1]"""
    notes: tuple[str, ...]
    """Limits to state beside the number."""


def line_contact_film(
    entrainment_speed: Values,
    *,
    load_per_length: Values,
    viscosity: Values,
    pressure_viscosity: Values,
    radius: Values,
    contact_modulus: Values,
    stroke: float | None = None,
) -> LineContactFilm:
    """Film of a line contact in whichever of the four regimes governs: the largest of the asymptotes.

    Parameters
    ----------
    entrainment_speed, load_per_length, viscosity, pressure_viscosity, radius, contact_modulus
        As in `dowson_higginson_film`.
    stroke : float, optional
        Peak-to-peak travel of the entrained oil, the integral of the entrainment speed over half a cycle: pin radius
        times half the swing. Given, the notes say whether a film formed at the inlet crosses the contact. [m]

    Returns
    -------
    LineContactFilm
        Film, regime, asymptotes, regime parameters and notes.

    Notes
    -----
    Johnson's regime map in the variables of Moes: gV = G W^1.5 U^-0.5 and gE = W U^-0.5.
    """
    rigid = isoviscous_rigid_film(
        entrainment_speed, load_per_length=load_per_length, viscosity=viscosity, radius=radius
    )
    viscous = piezoviscous_rigid_film(
        entrainment_speed, viscosity=viscosity, pressure_viscosity=pressure_viscosity, radius=radius
    )
    elastic = isoviscous_elastic_film(
        entrainment_speed,
        load_per_length=load_per_length,
        viscosity=viscosity,
        radius=radius,
        contact_modulus=contact_modulus,
    )
    both = dowson_higginson_film(
        entrainment_speed,
        load_per_length=load_per_length,
        viscosity=viscosity,
        pressure_viscosity=pressure_viscosity,
        radius=radius,
        contact_modulus=contact_modulus,
    )
    film = np.maximum(np.maximum(rigid, viscous), np.maximum(elastic, both))
    # ties, and the zero film of a standstill, go to the first of the four
    governing = (film != rigid) * (
        1 + (film != viscous) * (1 + (film != elastic) * (1 + (film != both) * 1))
    )
    U, W = _speed_and_load_groups(
        entrainment_speed,
        load_per_length=load_per_length,
        viscosity=viscosity,
        radius=radius,
        contact_modulus=contact_modulus,
    )
    with np.errstate(divide="ignore"):  # at a standstill both parameters are infinite
        gE = W / np.sqrt(U)
    gV = pressure_viscosity * 2 * contact_modulus * gE * np.sqrt(W)
    half_width, pressure = hertz_line(
        load_per_length, radius=radius, contact_modulus=contact_modulus
    )
    asymptotes = (rigid, viscous, elastic, both)
    notes = (
        "Steady motion, one temperature, smooth surfaces and a flooded inlet are assumed.",
        *_regime_notes(governing, film, asymptotes),
        *_motion_notes(entrainment_speed, half_width, stroke),
        *_pressure_notes(pressure),
    )
    return LineContactFilm(film, _named(governing), *asymptotes, gV=gV, gE=gE, notes=notes)


def hamrock_dowson_film(
    entrainment_speed: Values,
    *,
    load: Values,
    viscosity: Values,
    pressure_viscosity: Values,
    radius_along: Values,
    radius_across: Values,
    contact_modulus: Values,
) -> tuple[Values, Values]:
    """Least and central film thickness [m] of an elliptical contact. Hamrock and Dowson (1977).

    h_min/Rx = 3.63 U^0.68 G^0.49 W^-0.073 (1 - exp(-0.68 k)),
    h_c/Rx = 2.69 U^0.67 G^0.53 W^-0.067 (1 - 0.61 exp(-0.73 k)),  k = 1.03 (Ry/Rx)^0.64,
    with G = alpha E', U = eta u / (E' Rx), W = w / (E' Rx^2) and E' = 2 E*.

    Parameters
    ----------
    entrainment_speed, viscosity, pressure_viscosity, contact_modulus
        As in `dowson_higginson_film`.
    load : float or array
        Load w on the contact. [N]
    radius_along, radius_across : float or array
        Reduced radii Rx along and Ry across the motion. [m]

    Notes
    -----
    Fitted for hard contacts with k from 1 to 8, entrained along the minor axis. The lobed bushing of Farzaneh (2002)
    slides along the major axis of its contact (Rx 4.87 m, Ry 0.2 m): k is far below 1, outside the fit.
    """
    require_positive(
        load=load, viscosity=viscosity, radius_along=radius_along, radius_across=radius_across
    )
    require_positive(contact_modulus=contact_modulus)
    require_not_negative(pressure_viscosity=pressure_viscosity)
    G = pressure_viscosity * 2 * contact_modulus
    U = viscosity * np.abs(entrainment_speed) / (2 * contact_modulus * radius_along)
    W = load / (2 * contact_modulus * radius_along**2)
    k = 1.03 * (radius_across / radius_along) ** 0.64
    least = 3.63 * radius_along * U**0.68 * G**0.49 * W**-0.073 * (1 - np.exp(-0.68 * k))
    central = 2.69 * radius_along * U**0.67 * G**0.53 * W**-0.067 * (1 - 0.61 * np.exp(-0.73 * k))
    return least, central


def squeeze_time(
    film: Values, *, half_width: Values, load_per_length: Values, viscosity: Values
) -> Values:
    """Time [s] in which a load squeezes a parallel film down to a thickness: t = 4 eta b^3 / (q h^2).

    From a thick start; long strip of width 2b, constant viscosity, ambient pressure at both edges. Says how long the middle
    of a contact that the motion does not sweep keeps its oil.

    Parameters
    ----------
    film : float or array
        Thickness h at the end. [m]
    half_width : float or array
        b, as of `erlif.models.contact.hertz_line`. [m]
    load_per_length : float or array
        q. [N/m]
    viscosity : float or array
        Dynamic viscosity. [Pa s]
    """
    require_positive(
        film=film, half_width=half_width, load_per_length=load_per_length, viscosity=viscosity
    )
    return 4 * viscosity * half_width**3 / (load_per_length * film**2)


def film_parameter(film: Values, *, roughness_a: Values, roughness_b: Values) -> Values:
    """Film thickness over combined roughness [1]: Lambda = h / sqrt(Ra^2 + Rb^2). Farzaneh (2002), eq. 2.7.

    Parameters
    ----------
    film : float or array
        Least film thickness. [m]
    roughness_a, roughness_b : float or array
        Root-mean-square roughness of the two surfaces. [m]

    Notes
    -----
    The thesis prints 1.52e-6, metres divided by micrometres; its 0.54 um with 0.25 um on each surface gives 1.53,
    partial lubrication by its own list and not boundary lubrication. Its footnote defines the root mean square and
    calls it R_a.
    """
    require_not_negative(film=film, roughness_a=roughness_a, roughness_b=roughness_b)
    combined = np.sqrt(roughness_a**2 + roughness_b**2)
    require_positive(roughness=combined)
    return film / combined


def lubrication_regimes(film_parameter: float) -> tuple[str, ...]:
    """Every regime of `LUBRICATION_REGIMES` whose range holds a film parameter; the ranges overlap, as printed.

    Each range holds its lower end and not its upper one. Beyond 100 no regime is listed.
    """
    require_not_negative(film_parameter=film_parameter)
    return tuple(
        name for name, (low, high) in LUBRICATION_REGIMES.items() if low <= film_parameter < high
    )


def _speed_and_load_groups(
    entrainment_speed: Values,
    *,
    load_per_length: Values,
    viscosity: Values,
    radius: Values,
    contact_modulus: Values,
) -> tuple[Values, Values]:
    """U = eta u / (E' R) and W = q / (E' R) with E' = 2 E*."""
    require_positive(load_per_length=load_per_length, viscosity=viscosity, radius=radius)
    require_positive(contact_modulus=contact_modulus)
    stiffness = 2 * contact_modulus * radius
    return viscosity * np.abs(entrainment_speed) / stiffness, load_per_length / stiffness


def _named(governing: Values) -> Values:
    """Names of regimes given by number, in an array of the same kind; none for a missing film."""
    names = np.asarray([*FILM_REGIMES, ""])
    if hasattr(governing, "dims"):  # a DataArray keeps its coordinates
        return governing.copy(data=names[governing.data])
    return names[governing]


def _regime_notes(governing: Values, film: Values, asymptotes: tuple[Values, ...]) -> list[str]:
    notes = []
    if np.any(np.less(governing, 3)):
        notes.append(
            "The formula of Dowson and Higginson (piezoviscous-elastic) does not hold where another regime governs."
        )
    close = sum((asymptote > 0.9 * film) * 1 for asymptote in asymptotes)
    if np.any(np.greater(close, 1)):
        notes.append(
            "Two or more asymptotes lie within 10 %: near a border of the regime map, where a single one is least accurate."
        )
    return notes


def _motion_notes(entrainment_speed: Values, half_width: Values, stroke: float | None) -> list[str]:
    notes = []
    if np.any(np.less_equal(entrainment_speed, 0)) and np.any(
        np.greater_equal(entrainment_speed, 0)
    ):
        notes.append(
            "Entrainment reverses: steady formulas give no film there, a real film lives on squeeze and depends on the "
            "acceleration."
        )
    if stroke is None:
        notes.append("No stroke given: whether the motion sweeps the contact was not checked.")
    elif np.any(np.greater(half_width, stroke)):
        notes.append(
            f"The stroke of {stroke * 1e3:.3g} mm is less than the contact half width of "
            f"{float(np.max(half_width)) * 1e3:.3g} mm: oil entrained at the inlet never reaches the centre."
        )
    elif np.any(np.greater(2 * half_width, stroke)):
        notes.append(
            f"The stroke of {stroke * 1e3:.3g} mm is less than the contact width of "
            f"{float(np.max(2 * half_width)) * 1e3:.3g} mm: oil entrained at the inlet never crosses the contact."
        )
    return notes


def _pressure_notes(pressure: Values) -> list[str]:
    if np.any(np.greater(pressure, 0.5e9)):
        return ["The Hertz pressure exceeds 0.5 GPa, where the Barus law is too stiff."]
    return []
