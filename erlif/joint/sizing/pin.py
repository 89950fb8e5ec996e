"""The pin: shear, bending, seats, slenderness, and what keeps it from moving sideways."""

from __future__ import annotations

import math

from erlif.joint.sizing.joint import Joint, dimensions_of
from erlif.joint.sizing.materials import Material
from erlif.joint.sizing.steps import Step, make_step, margin_below, missing_step
from erlif.models.bearing import (
    LARGEST_HOLE_RATIO,
    RECOMMENDED_SLENDERNESS,
    hole_stress_concentration,
    lateral_force,
    lateral_shift,
    least_seat_width,
    pin_diameter_in_bending,
    pin_diameter_in_shear,
)

LARGEST_CONCENTRATION = 3.0
"""Stress concentration taken for a hole beyond the fit of eq. 4: that of a vanishing hole. [1]"""


def pin_steps(joint: Joint) -> list[Step]:
    """Check the pin and its seats.

    Parameters
    ----------
    joint : Joint
        With all dimensions.

    Returns
    -------
    list of Step
        Shear, bending, seats, slenderness, lateral force.

    Examples
    --------
    >>> from erlif.joint.sizing import example_joint
    >>> [step.equation for step in pin_steps(example_joint())]
    ['eq. 1', 'eq. 2', 'eq. 12', 'section 2.1.10', 'eqs. 21 and 22']
    """
    return [
        _shear(joint),
        _bending(joint),
        _seat(joint),
        _slenderness(joint),
        _lateral(joint),
    ]


def _shear(joint: Joint) -> Step:
    title, needs = "pin in shear", _needs_yield(joint.pin, "pin")
    if needs or joint.pin.yield_stress is None:
        return missing_step("pin_shear", title, "eq. 1", "limit", needs)
    d = dimensions_of(joint).pin
    strength = {"yield_stress": joint.pin.yield_stress, "safety": joint.safety}
    least = pin_diameter_in_shear(joint.force, **strength)
    stress = 2 * math.sqrt(3) * joint.force / (math.pi * d**2)
    return make_step(
        "pin_shear",
        title,
        "eq. 1",
        "limit",
        "equivalent stress",
        "MPa",
        stress / 1e6,
        most=joint.pin.yield_stress / joint.safety / 1e6,
        validity="any pin in double shear",
        reason="The load cuts the pin in the two planes between bushing and seats. The diameter is "
        "a first guess: bending asks for more.",
        alternatives=(
            f"pin diameter of at least {least * 1e3:.4g} mm",
            f"yield stress of the pin of at least {stress * joint.safety / 1e6:.4g} MPa",
        ),
        numbers=(("least diameter", least * 1e3, "mm"),),
    )


def _needs_yield(material: Material, part: str) -> str:
    return "" if material.yield_stress is not None else f"yield_stress of [{part}]"


def bending_factor(ratio: float) -> tuple[float, float]:
    """Return stress concentration and remaining section modulus of a pin with a hole. Eq. 4.

    Parameters
    ----------
    ratio : float
        Hole over pin diameter; 0 for no hole.

    Returns
    -------
    tuple of float
        K_t, and the section modulus over that of the whole pin; 0 where nothing remains.

    Examples
    --------
    >>> bending_factor(0.0), bending_factor(0.6)
    ((1.0, 1.0), (3.0, 0.0))
    """
    if ratio <= 0:
        return 1.0, 1.0
    inside = ratio <= LARGEST_HOLE_RATIO
    concentration = float(hole_stress_concentration(ratio)) if inside else LARGEST_CONCENTRATION
    return concentration, max(1 - 16 * ratio / (3 * math.pi), 0.0)


def _with_hole(unweakened: float, hole: float) -> float:
    """Least diameter of a pin with a hole, from that of one without. Eq. 4."""
    if hole <= 0:
        return unweakened

    # from 0.2 d on, a thicker pin has at most 3.05 times the stress of one without a hole
    low, high = unweakened, max(unweakened * 1.46, hole / LARGEST_HOLE_RATIO)
    for _ in range(_HALVINGS):
        middle = (low + high) / 2
        concentration, remaining = bending_factor(hole / middle)
        weak = concentration * (unweakened / middle) ** 3 > remaining
        low, high = (middle, high) if weak else (low, middle)
    return high


_HALVINGS = 60  # to the last digit


def _bending(joint: Joint) -> Step:
    """Eq. 2, or eq. 4 where a hole crosses the pin."""
    hole = joint.hole_diameter > 0
    key, title = "pin_bending", "pin in bending" + (" at its hole" if hole else "")
    equation, needs = "eq. 4" if hole else "eq. 2", _needs_yield(joint.pin, "pin")
    if needs or joint.pin.yield_stress is None:
        return missing_step(key, title, equation, "limit", needs)

    size = dimensions_of(joint)
    d, free = size.pin, size.width + joint.lateral_play
    ratio = joint.hole_diameter / d
    concentration, remaining = bending_factor(ratio)
    whole = 4 * joint.force * free / (math.pi * d**3)
    stress = whole * concentration / remaining if remaining > 0 else math.inf

    strength = {"yield_stress": joint.pin.yield_stress, "safety": joint.safety}
    unweakened = pin_diameter_in_bending(joint.force, free_length=free, **strength)
    least = _with_hole(float(unweakened), joint.hole_diameter)

    slender, in_fit = d <= free, ratio <= LARGEST_HOLE_RATIO
    limits = [
        f"pin diameter up to its free length ({d * 1e3:.4g} of {free * 1e3:.4g} mm)",
        "clamped in its seats; a pin that they only support has twice the stress",
    ]
    if hole:
        limits.append(
            f"hole up to {LARGEST_HOLE_RATIO:g} of the pin ({ratio:.3g}); beyond it the stress "
            f"concentration is taken as {LARGEST_CONCENTRATION:g}"
        )
    others = [f"pin diameter of at least {least * 1e3:.4g} mm"]
    if math.isfinite(stress):
        needed = stress * joint.safety / 1e6
        others.append(f"yield stress of the pin of at least {needed:.4g} MPa")
    others += [
        "a narrower bushing or less lateral play",
    ]
    if hole:
        others.append("the hole in the neutral layer, or lubrication from the housing")
    return make_step(
        key,
        title,
        equation,
        "limit",
        "bending stress",
        "MPa",
        stress / 1e6,
        most=joint.pin.yield_stress / joint.safety / 1e6,
        valid=slender and in_fit,
        validity="; ".join(limits),
        reason="The pin is a beam clamped in its seats and loaded in the middle; bending decides "
        "where the pin is not thicker than its free length.",
        alternatives=tuple(others),
        numbers=(
            ("least diameter", least * 1e3, "mm"),
            ("free length", free * 1e3, "mm"),
            ("stress concentration", concentration, "1"),
        ),
    )


def _seat(joint: Joint) -> Step:
    key, title = "seat_edge", "edges of the seats"
    hardness = joint.seat.hardness
    if hardness is None:
        return missing_step(key, title, "eq. 12", "limit", "hardness or ultimate_stress of [seat]")
    size = dimensions_of(joint)
    least = least_seat_width(joint.force, diameter=size.pin, hardness=hardness, safety=joint.safety)
    pressure = 4 * joint.force / (math.pi * size.pin * size.seat)
    from_strength = joint.seat.hardness_low is None
    brinell = hardness / 9.80665e6
    return make_step(
        key,
        title,
        "eqs. 12 and 13" if from_strength else "eq. 12",
        "limit",
        "edge pressure",
        "MPa",
        pressure / 1e6,
        most=hardness / joint.safety / 1e6,
        valid=not from_strength or brinell < LARGEST_BRINELL,
        validity=f"hardness from the tensile strength below {LARGEST_BRINELL:g} HB "
        f"({brinell:.3g} HB)"
        if from_strength
        else "line load that falls to 0 along each seat, cosine around it",
        reason="Each seat carries half of the load. Its inner edge carries twice the mean and must "
        "not yield.",
        alternatives=(
            f"seat width of at least {least * 1e3:.4g} mm",
            f"seat hardness of at least {pressure * joint.safety / 9.80665e6:.4g} HB",
        ),
        numbers=(("least width", least * 1e3, "mm"),),
    )


LARGEST_BRINELL = 400.0
"""Hardness up to which eq. 13 estimates it from the tensile strength. [HB]"""


def _slenderness(joint: Joint) -> Step:
    size = dimensions_of(joint)
    return make_step(
        "slenderness",
        "pin: length over diameter",
        "section 2.1.10",
        "recommendation",
        "length over diameter",
        "1",
        size.length / size.pin,
        most=RECOMMENDED_SLENDERNESS,
        validity="pins with a loose fit in their seats",
        reason="A long slender pin that bends walks out of the bore opposite the lock plate.",
        alternatives=("a tight fit in the seats", "a screwed end plate", "narrower seats"),
    )


def _lateral(joint: Joint) -> Step:
    key, title, equation = "lateral_force", "bent pin: slope, 1 where it folds", "eqs. 21 and 22"
    modulus = joint.pin.youngs_modulus
    if modulus is None:
        return missing_step(key, title, equation, "result", "youngs_modulus of [pin]")
    size = dimensions_of(joint)

    # sine of the slope of the two straight halves; beyond 1 the pin folds
    slope = 8 * joint.force * size.length**2 / (3 * math.pi * modulus * size.pin**4)
    bent = {"length": size.length, "diameter": size.pin, "youngs_modulus": modulus}
    folds = slope > 1
    shift = size.length if folds else lateral_shift(joint.force, **bent)
    area = math.pi / 4 * size.pin**2
    force = modulus * area if folds else lateral_force(joint.force, **bent)
    return make_step(
        key,
        title,
        equation,
        "limit",
        "sine of the slope of the bent pin",
        "1",
        slope,
        most=1.0,
        margin=margin_below(slope, 1.0),
        valid=slope <= _SMALL_SLOPE,
        validity=f"small slopes, up to {_SMALL_SLOPE:g} ({slope:.2g})",
        reason="The bent pin shortens between its ends. The lock or an end plate has to hold it "
        "against the lateral force.",
        alternatives=("a shorter or a thicker pin",),
        numbers=(("lateral shift", shift * 1e6, "um"), ("lateral force", force, "N")),
    )


_SMALL_SLOPE = 0.1  # sine of the slope up to which a beam bends as the equation assumes
