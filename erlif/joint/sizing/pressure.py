"""The sliding surface: pressures over the arc, width and hardness of the bushing."""

from __future__ import annotations

import math

from erlif.joint.models.bearing import RECOMMENDED_WIDTH, least_bushing_width, least_projected_area
from erlif.joint.sizing.joint import known
from erlif.joint.sizing.materials import BRINELL
from erlif.joint.sizing.state import JointState
from erlif.joint.sizing.steps import Result, strength_limit

# Sliding speed up to which half of the yield stress prevents seizure, eq. 5. [m/s]
SLOW = 0.02

# Half contact angle up to which the arc counts as flat, section 2.1.3. [rad]
HERTZ_LIMIT = math.radians(20.0)

# Half contact angle from which eq. 7 is not below eq. 9; the source has 72 degrees. [rad]
COSINE_LIMIT = math.radians(72.861)

# Ratio of the moduli up to which one combined modulus stands for both in eq. 9. [1]
ALIKE = 3.0

# Brinell by which the pin is harder than a bushing that wears in its place, section 2.2.2. [HB]
HARDER = 100.0


def seizure(state: JointState) -> Result:
    """Eq. 5."""
    joint, size, speed = state.joint, state.size, state.speed
    softer = min(known(joint.bushing.yield_stress), known(joint.pin.yield_stress, math.inf))
    area = least_projected_area(joint.force, yield_stress=softer)
    return strength_limit(
        area / size.pin,
        size.width,
        softer,
        2.0,  # half of the yield stress, eq. 5
        valid=speed <= SLOW,
        slow=SLOW,
        speed="speed not known" if math.isnan(speed) else f"{speed:.3g} m/s",
    )


def _most(state: JointState) -> float:
    """Maximum pressure by the hardness of the bushing; infinite if it is unknown. [MPa]"""
    return known(state.joint.bushing.hardness, math.inf) / state.joint.safety / 1e6


def projected(state: JointState) -> Result:
    """Eq. 6."""
    return Result(state.projected / 1e6, most=_most(state), valid=False)


def cosine(state: JointState) -> Result:
    """Eq. 7."""
    angle = math.nan if state.contact is None else state.contact.half_angle
    return Result(
        4 / math.pi * state.projected / 1e6,
        most=_most(state),
        valid=angle >= COSINE_LIMIT,
        values={"from_angle": math.degrees(COSINE_LIMIT), "angle": math.degrees(angle)},
    )


def hertz(state: JointState) -> Result:
    """Eq. 8."""
    contact, joint = state.contact, state.joint
    if contact is None:
        return Result()
    if joint.pin.poissons_ratio is None or joint.bushing.poissons_ratio is None:
        return Result(missing="poissons_ratio of [pin] and [bushing]")
    angle = math.degrees(contact.half_angle)
    return Result(
        contact.hertz_peak / 1e6,
        most=_most(state),
        valid=contact.half_angle < HERTZ_LIMIT,
        missing="a play above 0",
        values={"below_angle": math.degrees(HERTZ_LIMIT), "angle": angle},
    )


def peak(state: JointState) -> Result:
    """Eq. 9."""
    contact, joint = state.contact, state.joint
    if contact is None:
        return Result()
    moduli = known(joint.pin.youngs_modulus), known(joint.bushing.youngs_modulus)
    ratio = max(moduli) / min(moduli)
    return Result(
        contact.peak / 1e6,
        most=_most(state),
        valid=ratio <= ALIKE,
        values={
            "alike": ALIKE,
            "ratio": "alike" if ratio == 1 else f"{ratio:.3g} to 1",
            "hardness": contact.peak * joint.safety / BRINELL,
            "angle": math.degrees(contact.half_angle),
            "modulus": contact.modulus / 1e9,
        },
    )


def material_limit(state: JointState) -> Result:
    """Section 2.1.13."""
    limit = state.joint.bushing.pressure
    if limit is None:
        return Result()
    least = state.joint.force / (state.size.pin * limit)
    return Result(state.projected / 1e6, most=limit / 1e6, values={"least": least * 1e3})


def bushing_edge(state: JointState) -> Result:
    """Eq. 10."""
    joint, d, hardness = state.joint, state.size.pin, known(state.joint.bushing.hardness)
    least = least_bushing_width(joint.force, diameter=d, hardness=hardness, safety=joint.safety)
    return strength_limit(least, state.size.width, hardness, joint.safety)


def width_ratio(state: JointState) -> Result:
    """Eq. 11."""
    size, (low, high) = state.size, RECOMMENDED_WIDTH
    values = {"from_width": low * size.pin * 1e3, "to_width": high * size.pin * 1e3}
    return Result(size.width / size.pin, least=low, most=high, values=values)


def hardness_difference(state: JointState) -> Result:
    """Section 2.2.2."""
    pin, ring = known(state.joint.pin.hardness_low), known(state.joint.bushing.hardness_high)
    return Result(pin - ring, least=HARDER, values={"pin": ring + HARDER, "bushing": pin - HARDER})
