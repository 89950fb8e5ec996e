"""The pin: shear, bending, seats, slenderness, and what keeps it from moving sideways."""

from __future__ import annotations

import math

from erlif.joint.models.bearing import (
    LARGEST_HOLE_RATIO,
    RECOMMENDED_SLENDERNESS,
    hole_stress_concentration,
    lateral_force,
    lateral_shift,
    least_seat_width,
    pin_diameter_in_bending,
    pin_diameter_in_shear,
)
from erlif.joint.sizing.joint import known
from erlif.joint.sizing.materials import BRINELL
from erlif.joint.sizing.state import JointState
from erlif.joint.sizing.steps import Result, margin_below, strength_limit

# Stress concentration taken for a hole beyond the fit of eq. 4: that of a vanishing hole. [1]
LARGEST_CONCENTRATION = 3.0

# Hardness up to which eq. 13 estimates it from the tensile strength. [HB]
LARGEST_BRINELL = 400.0

_ROUNDING = 1 + 1e-12  # a hole of just the largest ratio lies within the fit
_SMALL_SLOPE = 0.1  # sine of the slope up to which a beam bends as the equation assumes


def shear(state: JointState) -> Result:
    """Eq. 1."""
    joint, strength = state.joint, known(state.joint.pin.yield_stress)
    least = pin_diameter_in_shear(joint.force, yield_stress=strength, safety=joint.safety)
    return strength_limit(least, state.size.pin, strength, joint.safety, power=2)


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
    """Minimum diameter of a pin with a hole, from that of a pin without. Eq. 4. [m]"""
    if hole <= 0 or math.isnan(unweakened):
        return unweakened

    from scipy.optimize import brentq  # few joints have a hole, and it is slow to load

    def excess(diameter: float) -> float:
        concentration, remaining = bending_factor(hole / diameter)
        return concentration * (unweakened / diameter) ** 3 - remaining

    # from 0.2 d on, a thicker pin has at most 3.05 times the stress of one without a hole
    high = max(unweakened * 1.46, hole / LARGEST_HOLE_RATIO * _ROUNDING)
    return float(brentq(excess, unweakened, high, xtol=1e-16, rtol=1e-15))


def bending(state: JointState) -> Result:
    """Compare the bending stress of the pin with its strength. Eq. 2; eq. 4 with a hole."""
    joint, size, strength = state.joint, state.size, known(state.joint.pin.yield_stress)

    # the hole raises the stress of a whole pin
    d, free = size.pin, size.width + joint.lateral_play
    ratio = joint.hole_diameter / d
    concentration, remaining = bending_factor(ratio)
    unweakened = pin_diameter_in_bending(
        joint.force, free_length=free, yield_stress=strength, safety=joint.safety
    )
    return strength_limit(
        unweakened,
        d,
        strength,
        joint.safety,
        power=3,
        factor=concentration / remaining if remaining > 0 else math.inf,
        valid=d <= free and ratio <= LARGEST_HOLE_RATIO,
        variant="hole" if joint.hole_diameter > 0 else "",
        least=_with_hole(float(unweakened), joint.hole_diameter) * 1e3,
        pin=d * 1e3,
        free=free * 1e3,
        concentration=concentration,
        ratio=ratio,
        largest_ratio=LARGEST_HOLE_RATIO,
        largest_concentration=LARGEST_CONCENTRATION,
    )


def seat_edge(state: JointState) -> Result:
    """Eqs. 12 and 13."""
    joint, size, hardness = state.joint, state.size, known(state.joint.seat.hardness)
    least = least_seat_width(joint.force, diameter=size.pin, hardness=hardness, safety=joint.safety)
    brinell = hardness / BRINELL
    estimated = joint.seat.hardness_low is None and not math.isnan(hardness)
    return strength_limit(
        least,
        size.seat,
        hardness,
        joint.safety,
        valid=not estimated or brinell < LARGEST_BRINELL,
        variant="from_strength" if estimated else "",
        brinell=brinell,
        largest_brinell=LARGEST_BRINELL,
    )


def slenderness(state: JointState) -> Result:
    """Section 2.1.10."""
    return Result(state.size.length / state.size.pin, most=RECOMMENDED_SLENDERNESS)


def slope(state: JointState) -> Result:
    """Eqs. 21 and 22."""
    joint, size, modulus = state.joint, state.size, known(state.joint.pin.youngs_modulus)

    # sine of the slope of the two straight halves; beyond 1 the pin folds
    sine = 8 * joint.force * size.length**2 / (3 * math.pi * modulus * size.pin**4)
    shift, force = size.length, modulus * math.pi / 4 * size.pin**2
    if sine <= 1:
        bent = {"length": size.length, "diameter": size.pin, "youngs_modulus": modulus}
        shift, force = lateral_shift(joint.force, **bent), lateral_force(joint.force, **bent)
    return Result(
        sine,
        most=1.0,
        margin=margin_below(sine, 1.0),
        valid=sine <= _SMALL_SLOPE,
        values={"small": _SMALL_SLOPE, "slope": sine, "shift": shift * 1e6, "force": force},
    )
