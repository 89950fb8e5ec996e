"""The sliding surface: pressures over the arc, width and hardness of the bushing."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from erlif.core.arrays import Array
from erlif.joint.sizing.fit import assembled_play
from erlif.joint.sizing.joint import Joint, dimensions_of
from erlif.joint.sizing.materials import BRINELL
from erlif.joint.sizing.steps import Step, make_step, missing_step
from erlif.models.bearing import RECOMMENDED_WIDTH, least_bushing_width, least_projected_area
from erlif.models.contact import (
    FULL_CONTACT,
    closed_contact_pressure,
    contact_modulus,
    hertz_line,
    persson_half_angle,
    persson_peak_group,
    persson_pressure,
)

SLOW = 0.02
"""Sliding speed up to which half of the yield stress prevents seizure, eq. 5. [m/s]"""

HERTZ_LIMIT = math.radians(20.0)
"""Half contact angle up to which the arc counts as flat, section 2.1.3. [rad]"""

COSINE_LIMIT = math.radians(72.861)
"""Half contact angle from which eq. 7 is not below eq. 9; the source has 72 degrees. [rad]"""

ALIKE = 3.0
"""Ratio of the moduli up to which one combined modulus stands for both in eq. 9. [1]"""

HARDER = 100.0
"""Brinell by which the pin is harder than a bushing that wears in its place, section 2.2.2. [HB]"""


def pressure_steps(joint: Joint) -> list[Step]:
    """Check the pressures between pin and bushing, its width and its hardness.

    Parameters
    ----------
    joint : Joint
        With all dimensions.

    Returns
    -------
    list of Step

    Examples
    --------
    >>> from erlif.joint.sizing import example_joint
    >>> [step.equation for step in pressure_steps(example_joint())][:5]
    ['eq. 5', 'eq. 6', 'eq. 7', 'eq. 8', 'eq. 9']
    """
    contact = contact_of(joint)
    return [
        _seizure(joint),
        _projected(joint),
        _cosine(joint, contact),
        _hertz(joint, contact),
        _persson(joint, contact),
        _material_pressure(joint),
        _edge(joint),
        _width_ratio(joint),
        _hardness_difference(joint),
    ]


@dataclass(frozen=True)
class Contact:
    """The contact of a pin in its bushing, after eqs. 8 and 9.

    Attributes
    ----------
    half_angle : float
        Half contact angle; pi where the pin is pressed all around. [rad]
    peak : float
        Largest pressure. [Pa]
    modulus : float
        Combined modulus of pin and bushing for eq. 9. [Pa]
    hertz_peak : float
        Largest pressure of a flat arc; NaN without play or a Poisson's ratio. [Pa]
    hertz_half_angle : float
        Its half contact angle; NaN where the pressure is. [rad]
    moduli : tuple[float, float]
        Young's moduli of pin and bushing. [Pa]
    """

    half_angle: float
    peak: float
    modulus: float
    hertz_peak: float
    hertz_half_angle: float
    moduli: tuple[float, float]


def combined_modulus(joint: Joint) -> float | None:
    """Return the modulus of two equal bodies that are as stiff as pin and bushing, plane stress.

    Parameters
    ----------
    joint : Joint

    Returns
    -------
    float or None
        None where a modulus is not known. [Pa]

    Examples
    --------
    >>> from erlif.joint.sizing import example_joint
    >>> print(f"{combined_modulus(example_joint()) / 1e9:.1f} GPa")
    152.7 GPa
    """
    one, two = joint.pin.youngs_modulus, joint.bushing.youngs_modulus
    return None if one is None or two is None else 2 / (1 / one + 1 / two)


@lru_cache(maxsize=64)
def contact_of(joint: Joint) -> Contact | None:
    """Solve the contact of pin and bushing with the assembled play.

    Parameters
    ----------
    joint : Joint
        With all dimensions.

    Returns
    -------
    Contact or None
        None where a modulus is not known.

    Examples
    --------
    >>> from erlif.joint.sizing import example_joint
    >>> contact = contact_of(example_joint())
    >>> print(f"{contact.peak / 1e6:.0f} MPa over {2 * math.degrees(contact.half_angle):.0f} deg")
    32 MPa over 59 deg
    """
    modulus, size = combined_modulus(joint), dimensions_of(joint)
    one, two = joint.pin, joint.bushing
    if modulus is None or one.youngs_modulus is None or two.youngs_modulus is None:
        return None
    load, play = joint.force / size.width, assembled_play(joint)

    if modulus * play / (2 * load) <= FULL_CONTACT:
        half_angle = math.pi
        peak = closed_contact_pressure(
            load, interference=-play, pin_diameter=size.pin, youngs_modulus=modulus
        )
    else:
        half_angle = persson_half_angle(modulus * play / (2 * load))
        peak = persson_peak_group(half_angle) * 2 * load / size.pin

    flat = flat_angle = math.nan
    ratios = one.poissons_ratio, two.poissons_ratio
    if play > 0 and None not in ratios:
        radius = size.pin * (size.pin + play) / (2 * play)
        both = contact_modulus(
            one.youngs_modulus,
            poisson_1=ratios[0],
            youngs_2=two.youngs_modulus,
            poisson_2=ratios[1],
        )
        line = hertz_line(load, radius=radius, contact_modulus=both)
        flat = float(line.pressure)
        flat_angle = math.asin(min(float(line.half_width) / (size.pin / 2), 1.0))
    moduli = (one.youngs_modulus, two.youngs_modulus)
    return Contact(float(half_angle), float(peak), modulus, flat, flat_angle, moduli)


def pressure_over_arc(joint: Joint, angle: Array) -> Array:
    """Return the pressure over the arc after eq. 9.

    Parameters
    ----------
    joint : Joint
        With all dimensions.
    angle : array, (n,)
        Angle from the line of load. [rad]

    Returns
    -------
    array, (n,)
        Pressure; 0 outside of the contact, NaN where a modulus is not known. [Pa]

    Examples
    --------
    >>> from erlif.joint.sizing import example_joint
    >>> joint = example_joint()
    >>> pressure = pressure_over_arc(joint, np.array([0.0, 1.0, 2.0]))
    >>> abs(float(pressure[0]) / contact_of(joint).peak - 1) < 1e-9, float(pressure[2])
    (True, 0.0)
    """
    contact, size = contact_of(joint), dimensions_of(joint)
    if contact is None:
        return np.full(angle.shape, np.nan)
    load = joint.force / size.width
    if contact.half_angle >= math.pi:
        cosine: Array = contact.peak + 2 * load / (math.pi * size.pin) * (np.cos(angle) - 1)
        return cosine
    pressure: Array = persson_pressure(
        angle, load_per_length=load, half_angle=contact.half_angle, pin_diameter=size.pin
    )
    return pressure


def _projected_pressure(joint: Joint) -> float:
    size = dimensions_of(joint)
    return joint.force / (size.pin * size.width)


def _seizure(joint: Joint) -> Step:
    key, title, equation = "seizure", "seizure under projected pressure", "eq. 5"
    known = [part.yield_stress for part in (joint.pin, joint.bushing)]
    strengths = [stress for stress in known if stress is not None]
    if joint.bushing.yield_stress is None or not strengths:
        return missing_step(key, title, equation, "limit", "yield_stress of [bushing]")
    softer = min(strengths)
    size, pressure = dimensions_of(joint), _projected_pressure(joint)
    area = least_projected_area(joint.force, yield_stress=softer)
    speed = joint.speed(size.pin)
    slow = "speed not known" if speed is None else f"{speed:.3g} m/s"
    return make_step(
        key,
        title,
        equation,
        "limit",
        "projected pressure",
        "MPa",
        pressure / 1e6,
        most=softer / 2e6,
        valid=speed is not None and speed <= SLOW,
        validity=f"sliding speed up to {SLOW:g} m/s ({slow})",
        reason="Half of the yield stress of the softer body prevents seizure of a slow joint.",
        alternatives=(
            f"bushing width of at least {area / size.pin * 1e3:.4g} mm",
            f"yield stress of the softer body of at least {2 * pressure / 1e6:.4g} MPa",
        ),
        numbers=(("least width", area / size.pin * 1e3, "mm"),),
    )


def _against_hardness(
    joint: Joint,
    key: str,
    title: str,
    equation: str,
    pressure: float,
    *,
    valid: bool,
    validity: str,
    reason: str,
) -> Step:
    """Another equation for the pressure, beside that of eq. 9."""
    hardness = joint.bushing.hardness
    most = math.inf if hardness is None else hardness / joint.safety / 1e6
    return make_step(
        key,
        title,
        equation,
        "comparison",
        "pressure",
        "MPa",
        pressure / 1e6,
        most=most,
        valid=valid,
        validity=validity,
        reason=reason,
    )


def _projected(joint: Joint) -> Step:
    return _against_hardness(
        joint,
        "pressure_projected",
        "projected pressure",
        "eq. 6",
        _projected_pressure(joint),
        valid=False,
        validity="a mean; the peak is larger for every contact angle",
        reason="Catalogues state it. It has no peak.",
    )


def _cosine(joint: Joint, contact: Contact | None) -> Step:
    angle = math.nan if contact is None else math.degrees(contact.half_angle)
    return _against_hardness(
        joint,
        "pressure_cosine",
        "pressure as a cosine",
        "eq. 7",
        4 / math.pi * _projected_pressure(joint),
        valid=contact is not None and contact.half_angle >= COSINE_LIMIT,
        validity=f"half contact angle from {math.degrees(COSINE_LIMIT):.3g} deg ({angle:.3g} deg)",
        reason="A press-fitted or worn joint has about this pressure; it needs no modulus.",
    )


def _hertz(joint: Joint, contact: Contact | None) -> Step:
    key, title, equation = "pressure_hertz", "pressure of a flat arc (Hertz)", "eq. 8"
    missing = ""
    if contact is None:
        missing = "youngs_modulus of [pin] and [bushing]"
    elif None in (joint.pin.poissons_ratio, joint.bushing.poissons_ratio):
        missing = "poissons_ratio of [pin] and [bushing]"
    elif math.isnan(contact.hertz_peak):
        missing = "a play above 0"
    if contact is None or missing:
        return missing_step(key, title, equation, "comparison", missing)
    return _against_hardness(
        joint,
        key,
        title,
        equation,
        contact.hertz_peak,
        valid=contact.half_angle < HERTZ_LIMIT,
        validity=f"half contact angle below {math.degrees(HERTZ_LIMIT):.3g} deg "
        f"({math.degrees(contact.half_angle):.3g} deg)",
        reason="Materials and play enter it in one line; it holds for a large play.",
    )


def _persson(joint: Joint, contact: Contact | None) -> Step:
    key, title, equation = "pressure_peak", "peak pressure", "eq. 9"
    if contact is None:
        missing = "youngs_modulus of [pin] and [bushing]"
        return missing_step(key, title, equation, "limit", missing)
    hardness = joint.bushing.hardness
    ratio = max(contact.moduli) / min(contact.moduli)
    alike = "alike" if ratio == 1 else f"{ratio:.3g} to 1"
    angle = math.degrees(contact.half_angle)
    return make_step(
        key,
        title,
        equation,
        "result" if hardness is None else "limit",
        "peak pressure",
        "MPa",
        contact.peak / 1e6,
        most=math.inf if hardness is None else hardness / joint.safety / 1e6,
        valid=ratio <= ALIKE,
        validity=f"equal moduli, plane stress; up to {ALIKE:g} to 1 with the combined modulus "
        f"({alike})",
        reason="The peak over the arc follows from load, play and stiffness for every contact "
        "angle; above the hardness the surface flows.",
        alternatives=(
            "less play",
            "a wider bushing",
            f"bushing hardness of at least {contact.peak * joint.safety / BRINELL:.4g} HB",
        ),
        numbers=(
            ("half contact angle", angle, "deg"),
            ("combined modulus", contact.modulus / 1e9, "GPa"),
        ),
    )


def _material_pressure(joint: Joint) -> Step:
    key, title, equation = "pressure_limit", "pressure limit of the bushing", "section 2.1.13"
    limit = joint.bushing.pressure
    if limit is None:
        return missing_step(key, title, equation, "limit", "largest_pressure of [bushing]")
    size, pressure = dimensions_of(joint), _projected_pressure(joint)
    least = joint.force / (size.pin * limit)
    return make_step(
        key,
        title,
        equation,
        "limit",
        "projected pressure",
        "MPa",
        pressure / 1e6,
        most=limit / 1e6,
        validity="as the maker of the bushing states it",
        reason="The left limit of the pv diagram: the mechanical strength of the bushing.",
        alternatives=(
            f"bushing width of at least {least * 1e3:.4g} mm",
            "a bushing with a higher limit",
        ),
        numbers=(("least width", least * 1e3, "mm"),),
    )


def _edge(joint: Joint) -> Step:
    key, title, equation = "bushing_edge", "edges of the bushing", "eq. 10"
    hardness = joint.bushing.hardness
    if hardness is None:
        return missing_step(key, title, equation, "limit", "hardness of [bushing]")
    size = dimensions_of(joint)
    least = least_bushing_width(
        joint.force, diameter=size.pin, hardness=hardness, safety=joint.safety
    )
    pressure = 8 / math.pi * _projected_pressure(joint)
    return make_step(
        key,
        title,
        equation,
        "limit",
        "edge pressure",
        "MPa",
        pressure / 1e6,
        most=hardness / joint.safety / 1e6,
        validity="line load that falls to 0 along the bushing, cosine around it",
        reason="A bent or tilted pin loads one edge with twice the mean; a yielding edge is "
        "pressed out.",
        alternatives=(
            f"bushing width of at least {least * 1e3:.4g} mm",
            f"bushing hardness of at least {pressure * joint.safety / BRINELL:.4g} HB",
        ),
        numbers=(("least width", least * 1e3, "mm"),),
    )


def _width_ratio(joint: Joint) -> Step:
    size = dimensions_of(joint)
    low, high = RECOMMENDED_WIDTH
    return make_step(
        "width_ratio",
        "bushing: width over diameter",
        "eq. 11",
        "recommendation",
        "width over diameter",
        "1",
        size.width / size.pin,
        least=low,
        most=high,
        validity="about 1.3 has the least leakage of grease",
        reason="A short bushing tilts, a long one is loaded at its edges by the bent pin.",
        alternatives=(f"width from {low * size.pin * 1e3:.4g} to {high * size.pin * 1e3:.4g} mm",),
    )


def _hardness_difference(joint: Joint) -> Step:
    key, title, equation = "hardness_difference", "pin harder than bushing", "section 2.2.2"
    pin, ring = joint.pin.hardness_low, joint.bushing.hardness_high
    if pin is None or ring is None:
        missing = "hardness of [pin] and [bushing]"
        return missing_step(key, title, equation, "recommendation", missing)
    return make_step(
        key,
        title,
        equation,
        "recommendation",
        "softest pin less hardest bushing",
        "HB",
        pin - ring,
        least=HARDER,
        validity="bushing as the part that wears",
        reason="The cheaper bushing is to wear, not the pin.",
        alternatives=(
            f"pin surface of at least {ring + HARDER:.4g} HB",
            f"bushing of at most {pin - HARDER:.4g} HB",
        ),
    )
