"""The housing and its fit: the eye, and the play that press fit and growth of warm parts leave."""

from __future__ import annotations

import math

from erlif.joint.models.bearing import RECOMMENDED_HOUSING, RECOMMENDED_PLAY, least_eyebar_diameter
from erlif.joint.sizing.heat import name_missing
from erlif.joint.sizing.joint import known
from erlif.joint.sizing.state import JointState
from erlif.joint.sizing.steps import Result

# Friction in the press fit for which the push-out force is stated; it grows in proportion. [1]
PUSH_OUT_FRICTION = 0.1


def eye(state: JointState) -> Result:
    """Eq. 14."""
    joint, bore, outer = state.joint, state.size.fit, state.size.housing
    strength, width = known(joint.housing.yield_stress), state.size.width
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


def eye_ratio(state: JointState) -> Result:
    """Section 2.1.6."""
    bore, (low, high) = state.size.fit, RECOMMENDED_HOUSING
    values = {"from_outer": low * bore * 1e3, "to_outer": high * bore * 1e3}
    return Result(state.size.housing / bore, least=low, most=high, values=values)


def press_fit(state: JointState) -> Result:
    """Eqs. 24 and 25."""
    size, pressure = state.size, state.fit_pressure
    push_out = PUSH_OUT_FRICTION * pressure * math.pi * size.fit * size.width

    # bushing and housing are as warm as the outside, and expand unlike
    joint = state.joint
    change = joint.outside_temperature - joint.assembly_temperature
    unlike = known(joint.bushing.expansion) - known(joint.housing.expansion)
    return Result(
        abs(2e6 * state.displacement),
        missing=_missing_for_fit(state),
        values={
            "play": state.play * 1e6,
            "warm": (joint.interference + size.fit * unlike * change) * 1e6,
            "pressure": pressure / 1e6,
            "push_out": push_out / 1e3,
            "friction": PUSH_OUT_FRICTION,
        },
    )


def _missing_for_fit(state: JointState, strength: str = "") -> str:
    if state.size.housing <= state.size.fit:
        return "a housing larger than the bushing"
    return strength + "youngs_modulus and poissons_ratio of [bushing] and [housing]"


def pressed(state: JointState, part: str) -> Result | None:
    """Stress at the bore of a pressed part, which is in proportion to the interference. Lame."""
    joint, size, pressure = state.joint, state.size, state.fit_pressure
    if joint.interference <= 0:
        return None
    strength = known(getattr(joint, part).yield_stress)
    if math.isnan(strength + pressure):
        return Result(missing=_missing_for_fit(state, f"yield_stress of [{part}]; "))

    # the bore of the bushing is free, that of the housing carries the pressure
    hoop, radial = -2 * pressure / (1 - (size.pin / size.fit) ** 2), 0.0
    if part == "housing":
        outer, inner = size.housing**2, size.fit**2
        hoop, radial = pressure * (outer + inner) / (outer - inner), -pressure
    stress = math.sqrt(hoop**2 - hoop * radial + radial**2)
    most = joint.interference * strength / stress if stress > 0 else math.inf
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
    """State why the loss of play by the press fit is uncertain; empty without a reason."""
    if math.isnan(state.displacement):
        return "; without what the press fit takes, which is not known"
    stresses = (pressed(state, part) for part in ("bushing", "housing"))
    yields = any(stress is not None and stress.share < 0 for stress in stresses)
    return "; elastic, though the press fit yields" if yields else ""


def relative_play(state: JointState) -> Result:
    """Eq. 23."""
    pin, (low, high) = state.size.pin, RECOMMENDED_PLAY
    wanted = low * 1e-3 * pin - state.gain
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


def warm_play(state: JointState) -> Result:
    """Eq. 30."""
    joint, loss, play, size = state.joint, state.growth_loss, state.play, state.size
    at_rest = not state.speed > 0
    doubts = _doubt_about_fit(state)
    if math.isnan(loss) and not at_rest and play < 0:
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
        missing=name_missing(
            joint, conductivity=("pin", "bushing"), expansion=("pin", "bushing", "housing")
        ),
        values={"doubts": doubts, "least": (size.play - warm) * 1e6, "loss": loss * 1e6},
    )
