"""The lock plate: its screw, weld and prongs."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

from erlif.joint.sizing.joint import Joint, Lock, dimensions_of
from erlif.joint.sizing.preferred import Series, round_up
from erlif.joint.sizing.steps import Step, make_step, missing_step
from erlif.models.bearing import (
    CLOSED_LOCK_MOMENT,
    CLOSED_LOCK_SHEAR,
    end_force_of_closed_lock,
    largest_internal_weld_diameter,
    least_closed_end_width,
    least_closed_prong_height,
    least_open_prong_height,
    least_weld_diameter,
    lock_force,
)

SMALLEST_WELD = 20e-3
"""Inner diameter below which an internal weld cannot be made, section 2.1.8. [m]"""

SMALLEST_THROAT = 2e-3
"""Least effective throat, section 2.1.8. [m]"""

USUAL_THROAT = 3e-3
"""Effective throat that is tried first, section 2.1.8. [m]"""

PLATE = (5e-3, 15e-3)
"""Usual thickness of lock plates, section 2.1.9. [m]"""


def lock_steps(joint: Joint) -> list[Step]:
    """Check the lock plate of a joint.

    Parameters
    ----------
    joint : Joint
        With all dimensions.

    Returns
    -------
    list of Step
        Empty for a joint without a lock plate.

    Examples
    --------
    >>> from erlif.joint.sizing import example_joint
    >>> [step.equation for step in lock_steps(example_joint())]
    ['eq. 15', 'eq. 16', 'eq. 18', 'section 2.1.9']
    """
    lock = joint.lock
    if lock is None:
        return []
    steps = [_screw(joint, lock), *_weld_steps(joint, lock), _prong(joint, lock)]
    if lock.kind == "closed":
        steps.append(_end(joint, lock))
    return [*steps, _thickness(lock)]


def force_on_lock(joint: Joint, lock: Lock) -> float:
    """Return the size of the lock force. Eq. 15.

    Parameters
    ----------
    joint : Joint
        With the diameter of its pin.
    lock : Lock

    Returns
    -------
    float
        [N]

    Examples
    --------
    >>> from erlif.joint.sizing import example_joint
    >>> joint = example_joint()
    >>> print(f"{force_on_lock(joint, joint.lock) / 1e3:.1f} kN")
    50.0 kN
    """
    force = lock_force(
        joint.force,
        diameter=dimensions_of(joint).pin,
        lever=lock.lever,
        friction_bushing=lock.friction_bushing,
        friction_seat=lock.friction_seat,
    )
    return abs(float(force))


def size_lock(joint: Joint, lock: Lock, *, series: Series = "none") -> Lock:
    """Choose the dimensions of a lock plate that are not given, as the least that are enough.

    Parameters
    ----------
    joint : Joint
        With all other dimensions.
    lock : Lock
    series : str
        Preferred numbers to which lengths are rounded up.

    Returns
    -------
    Lock

    Examples
    --------
    >>> from dataclasses import replace
    >>> from erlif.joint.sizing import example_joint
    >>> joint = example_joint()
    >>> sized = size_lock(joint, replace(joint.lock, height=None))
    >>> print(f"{sized.height * 1e3:.1f} mm")
    74.2 mm
    """
    strength, force = lock.plate.yield_stress, force_on_lock(joint, lock)
    lock = _choose_weld(joint, lock, strength, series)
    chosen: dict[str, Any] = {}
    if lock.height is None:
        chosen["height"] = round_up(_least_height(joint, lock, strength, force), series)
    if lock.kind == "closed" and lock.end_width is None:
        chosen["end_width"] = round_up(_least_end(joint, lock, strength, force), series)
    if lock.screw_diameter is None and lock.screw_yield is not None:
        least = _least_screw(joint, lock.screw_yield, force)
        # a screw without load has the size of the plate
        chosen["screw_diameter"] = round_up(least, series) if force > 0 else lock.thickness
    return replace(lock, **chosen)


def _least_screw(joint: Joint, strength: float, force: float) -> float:
    return math.sqrt(4 * math.sqrt(3) * force * joint.safety / (math.pi * strength))


def _least_height(joint: Joint, lock: Lock, strength: float | None, force: float) -> float:
    """Eq. 18 or 20; the thickness of the plate where there is nothing to hold or no strength."""
    if strength is None or force == 0:
        return lock.thickness
    closed = lock.kind == "closed"
    least = least_closed_prong_height if closed else least_open_prong_height
    plate = {"thickness": lock.thickness, "length": lock.length}
    return float(least(force, yield_stress=strength, safety=joint.safety, **plate))


def _least_end(joint: Joint, lock: Lock, strength: float | None, force: float) -> float:
    if strength is None or force == 0:
        return lock.thickness
    return float(
        least_closed_end_width(
            force, thickness=lock.thickness, yield_stress=strength, safety=joint.safety
        )
    )


def _choose_weld(joint: Joint, lock: Lock, strength: float | None, series: Series) -> Lock:
    """Kind, throat and inner diameter of the weld: internal where there is room, else external."""
    pin = dimensions_of(joint).pin
    throat = USUAL_THROAT if lock.throat is None else lock.throat
    if strength is None:
        weld = lock.weld or "external"
        inner = pin if lock.weld_diameter is None else lock.weld_diameter
        return replace(lock, weld=weld, throat=throat, weld_diameter=inner)

    inner = round_up(max(_least_weld(joint, throat, strength), SMALLEST_WELD), series)
    room = float(largest_internal_weld_diameter(pin, throat=throat))
    weld = lock.weld or ("internal" if inner <= room else "external")
    if weld == "external":
        inner = pin
    if lock.weld_diameter is not None:
        inner = lock.weld_diameter
    if lock.throat is None:
        throat = round_up(max(throat, _least_throat(joint, inner, strength)), series)
    return replace(lock, weld=weld, throat=throat, weld_diameter=inner)


def _least_weld(joint: Joint, throat: float, strength: float) -> float:
    """Eq. 16."""
    return float(
        least_weld_diameter(
            joint.force,
            pin_diameter=dimensions_of(joint).pin,
            throat=throat,
            yield_stress=strength,
            safety=joint.safety,
        )
    )


def _least_throat(joint: Joint, inner: float, strength: float) -> float:
    """Throat at which the weld of an inner diameter is strong enough, eq. 16 solved for a."""
    torque = joint.force * dimensions_of(joint).pin / 2
    wanted = 2 * math.sqrt(3) * torque * joint.safety / (math.pi * strength)
    low, high = 0.0, math.cbrt(wanted / 2)  # a weld on a point
    for _ in range(_HALVINGS):
        middle = (low + high) / 2
        if middle * (inner + math.sqrt(2) * middle) ** 2 < wanted:
            low = middle
        else:
            high = middle
    return high


_HALVINGS = 60  # to the last digit


def _screw(joint: Joint, lock: Lock) -> Step:
    key, title, equation = "lock_screw", "screw of the lock plate", "eq. 15"
    force = force_on_lock(joint, lock)
    validity = (
        f"friction {lock.friction_bushing:g} in the bushing and {lock.friction_seat:g} in the "
        "seats, plain shank in the shear plane"
    )
    reason = "The screw keeps the pin from turning with the bushing."
    numbers = (("lock force", force / 1e3, "kN"),)
    if lock.screw_diameter is None or lock.screw_yield is None:
        return make_step(
            key,
            title,
            equation,
            "result",
            "lock force",
            "kN",
            force / 1e3,
            validity=validity,
            reason=reason,
            numbers=numbers,
        )
    least = _least_screw(joint, lock.screw_yield, force)
    stress = math.sqrt(3) * force / (math.pi / 4 * lock.screw_diameter**2)
    return make_step(
        key,
        title,
        equation,
        "limit",
        "equivalent stress",
        "MPa",
        stress / 1e6,
        most=lock.screw_yield / joint.safety / 1e6,
        validity=validity,
        reason=reason,
        alternatives=(f"screw of at least {least * 1e3:.4g} mm", "a longer lever"),
        numbers=(*numbers, ("least diameter", least * 1e3, "mm")),
    )


def _weld_steps(joint: Joint, lock: Lock) -> list[Step]:
    """Strength of the weld, and room for an internal one."""
    strength, inner, throat = lock.plate.yield_stress, lock.weld_diameter, lock.throat
    if strength is None or inner is None or throat is None:
        return [
            missing_step("weld", _weld_title(lock), "eq. 16", "limit", "yield_stress of [lock]")
        ]
    strong = _weld_strength(joint, lock, strength, inner, throat)
    return [strong] if lock.weld == "external" else [strong, _weld_room(joint, inner, throat)]


def _weld_title(lock: Lock) -> str:
    return f"{lock.weld or ''} weld of the lock plate".strip()


def _weld_strength(joint: Joint, lock: Lock, strength: float, inner: float, throat: float) -> Step:
    least = _least_weld(joint, throat, strength)
    stress = _weld_stress(joint, throat, inner + math.sqrt(2) * throat)

    # the throat plane starts in the corner of the legs and ends in the middle of the face
    corner = inner + (2 * math.sqrt(2) * throat if lock.weld == "internal" else 0.0)
    inward = -1 if lock.weld == "internal" else 1
    on_plane = _weld_stress(joint, throat, corner + inward * throat / math.sqrt(2))

    return make_step(
        "weld",
        _weld_title(lock),
        "eq. 16",
        "limit",
        "equivalent stress",
        "MPa",
        stress / 1e6,
        most=strength / joint.safety / 1e6,
        valid=throat >= SMALLEST_THROAT,
        validity=f"static strength, no fatigue; throat from {SMALLEST_THROAT * 1e3:g} mm "
        f"({throat * 1e3:.3g} mm)",
        reason="The weld carries the torque of the friction from the pin into the plate.",
        alternatives=(
            f"throat of at least {_least_throat(joint, inner, strength) * 1e3:.4g} mm",
            f"inner diameter of at least {max(least, 0.0) * 1e3:.4g} mm",
        ),
        numbers=(
            ("least inner diameter", least * 1e3, "mm"),
            ("stress on the throat plane", on_plane / 1e6, "MPa"),
        ),
    )


def _weld_stress(joint: Joint, throat: float, mean_diameter: float) -> float:
    """Equivalent stress of a thin ring under the torque of the worst friction, F d / 2."""
    torque = joint.force * dimensions_of(joint).pin / 2
    return math.sqrt(3) * torque / (math.pi * throat / 2 * mean_diameter**2)


def _weld_room(joint: Joint, inner: float, throat: float) -> Step:
    largest = float(largest_internal_weld_diameter(dimensions_of(joint).pin, throat=throat))
    return make_step(
        "weld_room",
        "room for the internal weld",
        "eq. 17",
        "limit",
        "inner diameter",
        "mm",
        inner * 1e3,
        most=largest * 1e3,
        least=SMALLEST_WELD * 1e3,
        validity="weld inside of an induction-hardened pin",
        reason="A weld near the hardened surface draws its temper; one that is too small cannot be "
        "made.",
        alternatives=("a smaller throat", "an external weld", "a thicker pin"),
    )


def _prong(joint: Joint, lock: Lock) -> Step:
    closed = lock.kind == "closed"
    key, equation = "prong", "eqs. 19 and 20" if closed else "eq. 18"
    title = f"prongs of the {lock.kind} lock plate"
    strength, height = lock.plate.yield_stress, lock.height
    if strength is None or height is None:
        return missing_step(key, title, equation, "limit", "yield_stress of [lock]")
    force = force_on_lock(joint, lock)
    moment, shear = (CLOSED_LOCK_MOMENT, CLOSED_LOCK_SHEAR) if closed else (1.0, 1.0)
    bending = 6 * moment * force * lock.length / (lock.thickness * height**2)
    sheared = shear * force / (lock.thickness * height)
    stress = math.sqrt(bending**2 + 3 * sheared**2)
    least = _least_height(joint, lock, strength, force) if force > 0 else 0.0
    return make_step(
        key,
        title,
        equation,
        "limit",
        "equivalent stress at the root",
        "MPa",
        stress / 1e6,
        most=strength / joint.safety / 1e6,
        validity="prongs as beams clamped at their roots, large radii",
        reason="The screw bends and shears a prong. Prongs are short and thick, so shear counts.",
        alternatives=(
            f"prong height of at least {least * 1e3:.4g} mm",
            "a thicker plate, a longer lever",
            "" if closed else "a closed slot",
        )[: 2 if closed else 3],
        numbers=(("lock force", force / 1e3, "kN"), ("least height", least * 1e3, "mm")),
    )


def _end(joint: Joint, lock: Lock) -> Step:
    key, title, equation = "lock_end", "closed end of the lock plate", "eq. 21, first"
    strength, width = lock.plate.yield_stress, lock.end_width
    if strength is None or width is None:
        return missing_step(key, title, equation, "limit", "yield_stress of [lock]")
    force = force_on_lock(joint, lock)
    stress = float(end_force_of_closed_lock(force)) / (width * lock.thickness)
    least = _least_end(joint, lock, strength, force) if force > 0 else 0.0
    return make_step(
        key,
        title,
        equation,
        "limit",
        "tensile stress",
        "MPa",
        stress / 1e6,
        most=strength / joint.safety / 1e6,
        validity="5/32 of the lock force passes through the closed end",
        reason="The closed end pulls the unloaded prong along.",
        alternatives=(f"end width of at least {least * 1e3:.4g} mm", "a thicker plate"),
        numbers=(("least width", least * 1e3, "mm"),),
    )


def _thickness(lock: Lock) -> Step:
    low, high = PLATE
    return make_step(
        "plate",
        "thickness of the lock plate",
        "section 2.1.9",
        "recommendation",
        "thickness",
        "mm",
        lock.thickness * 1e3,
        least=low * 1e3,
        most=high * 1e3,
        validity="low-alloy structural steel",
        reason="Usual plates; thinner ones buckle, thicker ones are not needed.",
    )
