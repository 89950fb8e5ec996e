"""The housing and its fit: the eye, and the play that press fit and growth of warm parts leave."""

from __future__ import annotations

import math
from collections.abc import Callable

from erlif.joint.sizing.state import JointState
from erlif.joint.sizing.steps import Result
from erlif.models.bearing import RECOMMENDED_HOUSING, RECOMMENDED_PLAY, least_eyebar_diameter

PUSH_OUT_FRICTION = 0.1
"""Friction in the press fit for which the push-out force is stated; it grows in proportion. [1]"""


def _eye(state: JointState) -> Result:
    joint, bore, outer = state.joint, state.size.fit, state.size.housing
    strength, width = joint.housing.yield_stress, state.size.width
    if strength is None:
        return Result()
    allowed, fits = strength / joint.safety, outer > bore
    least = least_eyebar_diameter(
        joint.force, bore=bore, width=width, yield_stress=strength, safety=joint.safety
    )
    stress = math.inf
    if fits:
        stress = joint.force * (bore / outer + outer / bore) / (width * (outer - bore))
    return Result(
        stress / 1e6,
        most=allowed / 1e6,
        values={
            "least": least * 1e3,
            # these are stated only where they apply
            "wider": math.nan if math.isfinite(least) else joint.force / (allowed * bore) * 1e3,
            "too_large": math.nan if fits else bore * 1e3,
            "outer": outer * 1e3,
            "strength": stress * joint.safety / 1e6,
        },
    )


def _ratio(state: JointState) -> Result:
    bore, (low, high) = state.size.fit, RECOMMENDED_HOUSING
    values = {"from_outer": low * bore * 1e3, "to_outer": high * bore * 1e3}
    return Result(state.size.housing / bore, least=low, most=high, values=values)


def _if_pressed(equation: Callable[[JointState], Result]) -> Callable[[JointState], Result | None]:
    """An equation of stresses that only a press fit has."""
    return lambda state: equation(state) if state.joint.interference > 0 else None


def _press_fit(state: JointState) -> Result:
    if state.displacement is None:
        return Result(missing=_missing_for_fit(state))
    size, pressure = state.size, state.fit_pressure or 0.0
    push_out = PUSH_OUT_FRICTION * pressure * math.pi * size.fit * size.width
    return Result(
        abs(2e6 * state.displacement),
        values={
            "play": state.play * 1e6,
            "pressure": pressure / 1e6,
            "push_out": push_out / 1e3,
            "friction": PUSH_OUT_FRICTION,
        },
    )


def _missing_for_fit(state: JointState, strength: str = "") -> str:
    if state.size.housing <= state.size.fit:
        return "a housing larger than the bushing"
    return strength + "youngs_modulus and poissons_ratio of [bushing] and [housing]"


def _pressed_bushing(state: JointState) -> Result:
    pressure, strength = state.fit_pressure, state.joint.bushing.yield_stress
    if pressure is None or strength is None:
        return Result(missing=_missing_for_fit(state, "yield_stress of [bushing]; "))
    stress = 2 * pressure / (1 - (state.size.pin / state.size.fit) ** 2)
    return _pressed(state, stress, strength, pressure, -stress)


def _pressed_housing(state: JointState) -> Result:
    pressure, strength = state.fit_pressure, state.joint.housing.yield_stress
    if pressure is None or strength is None:
        return Result(missing=_missing_for_fit(state, "yield_stress of [housing]; "))
    outer, inner = state.size.housing**2, state.size.fit**2
    hoop = pressure * (outer + inner) / (outer - inner)
    stress = math.sqrt(hoop**2 + hoop * pressure + pressure**2)  # von Mises, radial -p
    return _pressed(state, stress, strength, pressure, hoop)


def _pressed(
    state: JointState, stress: float, strength: float, pressure: float, hoop: float
) -> Result:
    """A stress of the press fit, which is in proportion to the interference."""
    most = state.joint.interference * strength / stress if stress > 0 else math.inf
    return Result(
        stress / 1e6,
        most=strength / 1e6,
        values={
            "interference": most * 1e6,
            "stress": stress / 1e6,
            "pressure": pressure / 1e6,
            "hoop": hoop / 1e6,
        },
    )


def _doubt_about_fit(state: JointState) -> str:
    """Why the play that the press fit takes may be another one; empty where there is no reason."""
    if state.displacement is None:
        return "; without what the press fit takes, which is not known"
    if state.joint.interference <= 0:
        return ""
    shares = _pressed_bushing(state).share, _pressed_housing(state).share
    return "; elastic, though the press fit yields" if any(one < 0 for one in shares) else ""


def _relative_play(state: JointState) -> Result:
    pin, (low, high) = state.size.pin, RECOMMENDED_PLAY
    wanted = low * 1e-3 * pin - 2 * (state.displacement or 0.0)
    doubt = _doubt_about_fit(state)
    return Result(
        1e3 * state.play / pin,
        least=low,
        most=high,
        valid=not doubt,
        values={
            "doubt": doubt,
            "from_play": wanted * 1e6,
            "to_play": (wanted + (high - low) * 1e-3 * pin) * 1e6,
        },
    )


def _warm_play(state: JointState) -> Result:
    loss, play, size = state.growth_loss, state.play, state.size
    at_rest = not state.speed
    doubts = _doubt_about_fit(state)
    if loss is None:
        if at_rest or play >= 0:
            return Result(variant="at_rest" if at_rest else "")
        # tight when cold: what growth takes decides nothing
        loss = 0.0
        doubts += "; without growth, for which expansion or conductivity is not known"
    if not state.heat_is_shared:
        doubts += "; most of the heat stays in the pin, which becomes warmer than this"
    warm = play - loss
    return Result(
        warm * 1e6,
        least=0.0,
        # a play has no ratio to nothing: its margin is that over the least play of eq. 23
        margin=warm / (RECOMMENDED_PLAY[0] * 1e-3 * size.pin),
        valid=not doubts,
        variant="at_rest" if at_rest else "",
        values={"doubts": doubts, "least": (size.play - warm) * 1e6, "loss": loss * 1e6},
    )


EQUATIONS = {
    "housing_eye": _eye,
    "housing_ratio": _ratio,
    "press_fit": _press_fit,
    "press_bushing": _if_pressed(_pressed_bushing),
    "press_housing": _if_pressed(_pressed_housing),
    "relative_play": _relative_play,
    "warm_play": _warm_play,
}
