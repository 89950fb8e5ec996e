"""The lock plate: its screw, weld and prongs."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from erlif.joint.models.bearing import (
    CLOSED_LOCK_MOMENT,
    CLOSED_LOCK_SHEAR,
    largest_internal_weld_diameter,
    least_closed_end_width,
    least_closed_prong_height,
    least_open_prong_height,
    least_weld_diameter,
    lock_force,
    pin_diameter_in_shear,
)
from erlif.joint.sizing.joint import Joint, Lock, dimensions_of, known
from erlif.joint.sizing.practice import Series, round_up
from erlif.joint.sizing.state import JointState
from erlif.joint.sizing.steps import Result, strength_limit

# Inner diameter below which an internal weld cannot be made, section 2.1.8. [m]
SMALLEST_WELD = 20e-3

# Least effective throat, section 2.1.8. [m]
SMALLEST_THROAT = 2e-3

# Effective throat that is tried first, section 2.1.8. [m]
USUAL_THROAT = 3e-3

# Usual thickness of lock plates, section 2.1.9. [m]
PLATE = (5e-3, 15e-3)


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
    >>> from erlif.joint.sizing.design import example_joint
    >>> joint = example_joint()
    >>> sized = size_lock(joint, replace(joint.lock, height=None))
    >>> print(f"{sized.height * 1e3:.1f} mm")
    74.2 mm
    """
    lock = _choose_weld(joint, lock, series)
    least = _least_sizes(joint, lock)
    if lock.kind == "open":
        del least["end_width"]
    if lock.screw_yield is None:
        del least["screw_diameter"]
    # a part without load, or of unknown strength, has the size of the plate
    chosen: dict[str, Any] = {
        name: round_up(size if size > 0 else lock.thickness, series)
        for name, size in least.items()
        if getattr(lock, name) is None
    }
    return replace(lock, **chosen)


def _force_on(joint: Joint, lock: Lock) -> float:
    """Size of the lock force. Eq. 15. [N]"""
    force = lock_force(
        joint.force,
        diameter=dimensions_of(joint).pin,
        lever=lock.lever,
        friction_bushing=lock.friction_bushing,
        friction_seat=lock.friction_seat,
    )
    return abs(float(force))


def _least_sizes(joint: Joint, lock: Lock) -> dict[str, float]:
    """Least sizes of prong, closed end and screw: 0 without load, NaN without a strength. [m]"""
    force, safety = _force_on(joint, lock), joint.safety
    if not force > 0:
        return {"height": 0.0, "end_width": 0.0, "screw_diameter": 0.0}
    strength, of_screw = known(lock.plate.yield_stress), known(lock.screw_yield)
    plate = {"thickness": lock.thickness, "yield_stress": strength, "safety": safety}
    prong = least_closed_prong_height if lock.kind == "closed" else least_open_prong_height
    return {
        "height": float(prong(force, length=lock.length, **plate)),
        "end_width": float(least_closed_end_width(force, **plate)),
        # the force shears a screw in one plane, and a pin in two
        "screw_diameter": float(
            pin_diameter_in_shear(2 * force, yield_stress=of_screw, safety=safety)
        ),
    }


def _choose_weld(joint: Joint, lock: Lock, series: Series) -> Lock:
    """Kind, throat and inner diameter of the weld: internal where there is room, else external."""
    pin, strength = dimensions_of(joint).pin, lock.plate.yield_stress
    throat, weld, inner = known(lock.throat, USUAL_THROAT), lock.weld, pin
    if strength is not None:
        wanted = round_up(max(_least_weld(joint, throat, strength), SMALLEST_WELD), series)
        room = float(largest_internal_weld_diameter(pin, throat=throat))
        weld = weld or ("internal" if wanted <= room else "external")
        inner = wanted if weld == "internal" else pin
    inner = known(lock.weld_diameter, inner)
    if lock.throat is None and strength is not None:
        throat = round_up(max(throat, _least_throat(joint, inner, strength)), series)
    return replace(lock, weld=weld or "external", throat=throat, weld_diameter=inner)


def _least_weld(joint: Joint, throat: float, strength: float) -> float:
    """Eq. 16."""
    pin, safety = dimensions_of(joint).pin, joint.safety
    return float(
        least_weld_diameter(
            joint.force, pin_diameter=pin, throat=throat, yield_stress=strength, safety=safety
        )
    )


def _least_throat(joint: Joint, inner: float, strength: float) -> float:
    """Throat at which the weld of an inner diameter is strong enough, eq. 16 solved for a."""
    # of every throat that is just enough, a (i + sqrt(2) a)^2 is the same
    usual = USUAL_THROAT
    wanted = usual * (_least_weld(joint, usual, strength) + math.sqrt(2) * usual) ** 2

    # a cubic with one positive root
    roots = np.roots([2.0, 2 * math.sqrt(2) * inner, inner**2, -wanted])
    return float(max(roots.real[np.abs(roots.imag) < 1e-9 * np.abs(roots)]))


Equation = Callable[[JointState], Result | None]


def _of_lock(equation: Callable[[JointState, Lock], Result | None]) -> Equation:
    """Turn an equation of a lock into one of a joint, None for a joint without a lock."""

    def of_joint(state: JointState) -> Result | None:
        lock = state.joint.lock
        return None if lock is None else equation(state, lock)

    return of_joint


@_of_lock
def screw(state: JointState, lock: Lock) -> Result:
    """Eq. 15."""
    joint, force = state.joint, _force_on(state.joint, lock) / 1e3
    texts: dict[str, Any] = {"bushing": lock.friction_bushing, "seat": lock.friction_seat}
    texts["force"] = force
    if lock.screw_diameter is None or lock.screw_yield is None:
        return Result(force, variant="unknown", values=texts)
    least = _least_sizes(joint, lock)["screw_diameter"]
    size, strength = lock.screw_diameter, lock.screw_yield
    return strength_limit(least, size, strength, joint.safety, power=2, **texts)


@_of_lock
def weld(state: JointState, lock: Lock) -> Result:
    """Eq. 16."""
    joint, strength = state.joint, lock.plate.yield_stress
    inner, throat = lock.weld_diameter, lock.throat
    title = f"{lock.weld or ''} weld".strip()
    if strength is None or inner is None or throat is None:
        return Result(values={"weld": title})

    # the stress falls with the square of the mean diameter, which is a leg wider than the inner one
    least, leg = _least_weld(joint, throat, strength), math.sqrt(2) * throat
    mean = inner + leg

    # the throat plane starts in the corner of the legs and ends in the middle of the face
    on_plane = inner + (1.5 * leg if lock.weld == "internal" else 0.5 * leg)
    stress = strength / joint.safety * ((least + leg) / on_plane) ** 2
    return strength_limit(
        least + leg,
        mean,
        strength,
        joint.safety,
        power=2,
        valid=throat >= SMALLEST_THROAT,
        weld=title,
        smallest=SMALLEST_THROAT * 1e3,
        throat=throat * 1e3,
        least_throat=_least_throat(joint, inner, strength) * 1e3,
        least_shown=max(least, 0.0) * 1e3,
        least=least * 1e3,
        on_plane=stress / 1e6,
    )


@_of_lock
def weld_room(state: JointState, lock: Lock) -> Result | None:
    """Eq. 17."""
    if lock.weld == "external" or lock.plate.yield_stress is None:
        return None
    if lock.weld_diameter is None or lock.throat is None:
        return None
    largest = float(largest_internal_weld_diameter(state.size.pin, throat=lock.throat))
    return Result(lock.weld_diameter * 1e3, most=largest * 1e3, least=SMALLEST_WELD * 1e3)


@_of_lock
def prong(state: JointState, lock: Lock) -> Result:
    """Eqs. 18 to 20."""
    joint, closed, height = state.joint, lock.kind == "closed", known(lock.height)
    force = _force_on(joint, lock)
    moment, shear = (CLOSED_LOCK_MOMENT, CLOSED_LOCK_SHEAR) if closed else (1.0, 1.0)
    bending = 6 * moment * force * lock.length / (lock.thickness * height**2)
    sheared = shear * force / (lock.thickness * height)
    stress = math.sqrt(bending**2 + 3 * sheared**2)
    least = _least_sizes(joint, lock)["height"]
    return Result(
        stress / 1e6,
        most=known(lock.plate.yield_stress) / joint.safety / 1e6,
        variant="closed" if closed else "",
        values={"force": force / 1e3, "least": least * 1e3},
    )


@_of_lock
def end(state: JointState, lock: Lock) -> Result | None:
    """Eq. 21, first."""
    if lock.kind == "open":
        return None
    strength, width = known(lock.plate.yield_stress), known(lock.end_width)
    least = _least_sizes(state.joint, lock)["end_width"]
    return strength_limit(least, width, strength, state.joint.safety)


@_of_lock
def plate(_: JointState, lock: Lock) -> Result:
    """Section 2.1.9."""
    low, high = PLATE
    return Result(lock.thickness * 1e3, least=low * 1e3, most=high * 1e3)
