"""The eye of the housing."""

from __future__ import annotations

import math

from erlif.joint.sizing.joint import Joint, dimensions_of
from erlif.joint.sizing.steps import Step, make_step, missing_step
from erlif.models.bearing import RECOMMENDED_HOUSING, least_eyebar_diameter


def housing_steps(joint: Joint) -> list[Step]:
    """Check the eye of the housing.

    Parameters
    ----------
    joint : Joint
        With all dimensions.

    Returns
    -------
    list of Step
        Stress and proportion.

    Examples
    --------
    >>> from erlif.joint.sizing import example_joint
    >>> [step.key for step in housing_steps(example_joint())]
    ['housing_eye', 'housing_ratio']
    """
    return [_eye(joint), _ratio(joint)]


def _eye(joint: Joint) -> Step:
    key, title, equation = "housing_eye", "eye of the housing", "eq. 14"
    strength = joint.housing.yield_stress
    if strength is None:
        return missing_step(key, title, equation, "limit", "yield_stress of [housing]")
    size = dimensions_of(joint)
    bore, outer = size.fit, size.housing
    allowed = strength / joint.safety
    least = least_eyebar_diameter(
        joint.force, bore=bore, width=size.width, yield_stress=strength, safety=joint.safety
    )

    stress = math.inf
    if outer > bore:
        stress = joint.force * (bore / outer + outer / bore) / (size.width * (outer - bore))
    width = joint.force / (allowed * bore)
    others = (
        f"outer diameter of at least {least * 1e3:.4g} mm"
        if math.isfinite(least)
        else f"no outer diameter is enough; the eye must be wider than {width * 1e3:.4g} mm"
    )
    if math.isfinite(stress):
        strong = f"yield stress of at least {stress * joint.safety / 1e6:.4g} MPa"
        alternatives = (others, strong)
    else:
        alternatives = (
            f"the bushing of {bore * 1e3:.4g} mm does not fit into a housing of "
            f"{outer * 1e3:.4g} mm",
            others,
        )
    return make_step(
        key,
        title,
        equation,
        "limit",
        "stress beside the bore",
        "MPa",
        stress / 1e6,
        most=allowed / 1e6,
        validity="an eye as wide as the bushing, larger than its bore",
        reason="The load pulls the two sides of the eye apart; the bore concentrates the stress.",
        alternatives=alternatives,
        numbers=(("least outer diameter", least * 1e3, "mm"),),
    )


def _ratio(joint: Joint) -> Step:
    size = dimensions_of(joint)
    low, high = RECOMMENDED_HOUSING
    return make_step(
        "housing_ratio",
        "eye: outer over inner diameter",
        "section 2.1.6",
        "recommendation",
        "outer over inner diameter",
        "1",
        size.housing / size.fit,
        least=low,
        most=high,
        validity="common practice",
        reason="A stiff housing keeps its shape; one that is too stiff loads the edges.",
        alternatives=(
            f"outer diameter from {low * size.fit * 1e3:.4g} to {high * size.fit * 1e3:.4g} mm",
        ),
    )
