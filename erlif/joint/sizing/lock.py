"""The lock plate: its screw, weld and prongs."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from erlif.joint.sizing.joint import Joint, Lock, dimensions_of
from erlif.joint.sizing.preferred import Series, round_up
from erlif.joint.sizing.state import JointState
from erlif.joint.sizing.steps import Result
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


def force_on_lock(joint: Joint, lock: Lock) -> float:
    """Return the size of the lock force. Eq. 15.

    Parameters
    ----------
    joint : Joint
        With a pin diameter.
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
        diameter=_pin(joint),
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
    pin = _pin(joint)
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
            pin_diameter=_pin(joint),
            throat=throat,
            yield_stress=strength,
            safety=joint.safety,
        )
    )


def _least_throat(joint: Joint, inner: float, strength: float) -> float:
    """Throat at which the weld of an inner diameter is strong enough, eq. 16 solved for a."""
    torque = joint.force * _pin(joint) / 2
    wanted = 2 * math.sqrt(3) * torque * joint.safety / (math.pi * strength)

    # a (i + sqrt(2) a)^2 = wanted, a cubic with one positive root
    roots = np.roots([2.0, 2 * math.sqrt(2) * inner, inner**2, -wanted])
    return float(max(roots.real[np.abs(roots.imag) < 1e-9 * np.abs(roots)]))


def _pin(joint: Joint) -> float:
    return dimensions_of(joint).pin


def _screw(state: JointState) -> Result | None:
    joint, lock = state.joint, state.joint.lock
    if lock is None:
        return None
    force = force_on_lock(joint, lock)
    values = {
        "bushing": lock.friction_bushing,
        "seat": lock.friction_seat,
        "force": force / 1e3,
    }
    if lock.screw_diameter is None or lock.screw_yield is None:
        return Result(force / 1e3, variant="unknown", values=values)
    stress = math.sqrt(3) * force / (math.pi / 4 * lock.screw_diameter**2)
    least = _least_screw(joint, lock.screw_yield, force)
    return Result(
        stress / 1e6,
        most=lock.screw_yield / joint.safety / 1e6,
        values=values | {"least": least * 1e3},
    )


def _weld(state: JointState) -> Result | None:
    joint, lock = state.joint, state.joint.lock
    if lock is None:
        return None
    strength, inner, throat = lock.plate.yield_stress, lock.weld_diameter, lock.throat
    title = f"{lock.weld or ''} weld".strip()
    if strength is None or inner is None or throat is None:
        return Result(values={"weld": title})
    least = _least_weld(joint, throat, strength)
    stress = _weld_stress(joint, throat, inner + math.sqrt(2) * throat)

    # the throat plane starts in the corner of the legs and ends in the middle of the face
    corner = inner + (2 * math.sqrt(2) * throat if lock.weld == "internal" else 0.0)
    inward = -1 if lock.weld == "internal" else 1
    on_plane = _weld_stress(joint, throat, corner + inward * throat / math.sqrt(2))
    return Result(
        stress / 1e6,
        most=strength / joint.safety / 1e6,
        valid=throat >= SMALLEST_THROAT,
        values={
            "weld": title,
            "smallest": SMALLEST_THROAT * 1e3,
            "throat": throat * 1e3,
            "least_throat": _least_throat(joint, inner, strength) * 1e3,
            "least_shown": max(least, 0.0) * 1e3,
            "least": least * 1e3,
            "on_plane": on_plane / 1e6,
        },
    )


def _weld_stress(joint: Joint, throat: float, mean_diameter: float) -> float:
    """Equivalent stress of a thin ring under the torque of the worst friction, F d / 2."""
    torque = joint.force * _pin(joint) / 2
    return math.sqrt(3) * torque / (math.pi * throat / 2 * mean_diameter**2)


def _weld_room(state: JointState) -> Result | None:
    lock = state.joint.lock
    if lock is None or lock.weld == "external" or lock.plate.yield_stress is None:
        return None
    if lock.weld_diameter is None or lock.throat is None:
        return None
    largest = float(largest_internal_weld_diameter(state.size.pin, throat=lock.throat))
    return Result(lock.weld_diameter * 1e3, most=largest * 1e3, least=SMALLEST_WELD * 1e3)


def _prong(state: JointState) -> Result | None:
    joint, lock = state.joint, state.joint.lock
    if lock is None:
        return None
    closed, variant = lock.kind == "closed", "closed" if lock.kind == "closed" else ""
    strength, height = lock.plate.yield_stress, lock.height
    if strength is None or height is None:
        return Result(variant=variant)

    force = force_on_lock(joint, lock)
    moment, shear = (CLOSED_LOCK_MOMENT, CLOSED_LOCK_SHEAR) if closed else (1.0, 1.0)
    bending = 6 * moment * force * lock.length / (lock.thickness * height**2)
    sheared = shear * force / (lock.thickness * height)
    stress = math.sqrt(bending**2 + 3 * sheared**2)
    least = _least_height(joint, lock, strength, force) if force > 0 else 0.0
    return Result(
        stress / 1e6,
        most=strength / joint.safety / 1e6,
        variant=variant,
        values={"force": force / 1e3, "least": least * 1e3},
    )


def _end(state: JointState) -> Result | None:
    joint, lock = state.joint, state.joint.lock
    if lock is None or lock.kind == "open":
        return None
    strength, width = lock.plate.yield_stress, lock.end_width
    if strength is None or width is None:
        return Result()
    force = force_on_lock(joint, lock)
    stress = float(end_force_of_closed_lock(force)) / (width * lock.thickness)
    least = _least_end(joint, lock, strength, force) if force > 0 else 0.0
    allowed = strength / joint.safety / 1e6
    return Result(stress / 1e6, most=allowed, values={"least": least * 1e3})


def _plate(state: JointState) -> Result | None:
    lock, (low, high) = state.joint.lock, PLATE
    if lock is None:
        return None
    return Result(lock.thickness * 1e3, least=low * 1e3, most=high * 1e3)


EQUATIONS = {
    "lock_screw": _screw,
    "weld": _weld,
    "weld_room": _weld_room,
    "prong": _prong,
    "lock_end": _end,
    "plate": _plate,
}
