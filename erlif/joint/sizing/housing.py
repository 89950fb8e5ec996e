"""The eye of the housing."""

from __future__ import annotations

import math

from erlif.joint.sizing.state import JointState
from erlif.joint.sizing.steps import Result
from erlif.models.bearing import RECOMMENDED_HOUSING, least_eyebar_diameter


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


EQUATIONS = {"housing_eye": _eye, "housing_ratio": _ratio}
