"""Motion: speed, pv, friction, heat, temperature, wear and roughness."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from erlif.joint.models.wear import pressure_velocity, steady_bushing_wear
from erlif.joint.sizing.joint import Joint, known
from erlif.joint.sizing.state import JointState
from erlif.joint.sizing.steps import Result, margin_below

# Friction coefficients of grease-lubricated oscillating joints, section 2.1.14. [1]
FRICTION = (0.1, 0.8)

# Ra of pin and bushing up to which wear is kept low, section 2.1.16. [m]
LARGEST_ROUGHNESS = 1e-6


def name_missing(
    joint: Joint, values: Mapping[str, float | None] | None = None, **properties: Sequence[str]
) -> str:
    """List what is not given of the motion and of further values, by its place in joint.toml.

    Parameters
    ----------
    joint : Joint
        Joint that the values belong to.
    values : Mapping[str, float or None]
        Further values by their place.
    **properties : Sequence[str]
        Parts of the joint whose material needs the property of this name.

    Examples
    --------
    >>> from erlif.joint.sizing.design import example_joint
    >>> name_missing(example_joint(), {"[life] time": None}, expansion=["pin", "bushing"])
    '[life] time'
    """
    moves = joint.half_swing is not None and joint.period is not None
    places = {"[motion] half_swing and period": joint.half_swing if moves else None}
    places |= values or {}
    for name, parts in properties.items():
        places |= {f"{name} of [{part}]": getattr(joint.parts[part], name) for part in parts}
    return ", ".join(place for place, value in places.items() if value is None)


def speed(state: JointState) -> Result:
    """Eq. 26."""
    limit = known(state.joint.bushing.speed, math.inf) * 1e3
    return Result(state.speed * 1e3, most=limit)


def pv(state: JointState) -> Result:
    """Section 2.1.13."""
    joint, size = state.joint, state.size
    pv = pressure_velocity(
        joint.moving_force, diameter=size.pin, width=size.width, speed=state.speed
    )
    limit = known(joint.bushing.pv, math.inf) / 1e6
    return Result(pv / 1e6, most=limit)


def friction(state: JointState) -> Result:
    """Eq. 27."""
    (low, high), friction = FRICTION, state.joint.friction
    force = friction * state.joint.force
    moment = force * state.size.pin / 2
    return Result(
        force / 1e3,
        valid=low <= friction <= high,
        values={"low": low, "high": high, "friction": friction, "moment": moment},
    )


def moment(state: JointState) -> Result:
    """Eq. 27."""
    return Result(state.joint.friction * state.joint.force * state.size.pin / 2)


def temperature(state: JointState) -> Result:
    """Eqs. 28 and 29."""
    joint, rise, limit = state.joint, state.rise, state.temperature_limit
    outside, doubt = joint.outside_temperature, ""
    if not state.heat_is_shared:
        doubt = ", which hardly conducts: the pin becomes warmer than this, and pv governs"
        if joint.bushing.pv is None:
            doubt += " (give pv_limit of [bushing])"
    return Result(
        outside + rise,
        most=limit,
        # the heat may rise by the margin before the limit is reached
        margin=-1.0 if limit < outside else margin_below(rise, limit - outside),
        valid=not doubt,
        variant="hot_outside" if limit <= outside else "",
        missing=name_missing(joint, conductivity=("pin", "bushing")),
        values={
            "outside": outside,
            "doubt": doubt,
            "limit": limit,
            "part": "grease" if limit >= joint.grease_temperature else "bushing material",
            "heat": state.heat,
            "rise": rise,
        },
    )


def roughness(state: JointState) -> Result:
    """Section 2.1.16."""
    joint = state.joint
    known = [ra for ra in (joint.pin_roughness, joint.bushing_roughness) if ra is not None]
    return Result(max(known) * 1e6, most=LARGEST_ROUGHNESS * 1e6) if known else Result()


def wear(state: JointState) -> Result:
    """Eqs. 31 and 32."""
    joint, size, most = state.joint, state.size, known(state.joint.largest_wear, math.inf)

    # depth and volume of one cosine, of which eq. 31 has the volume for a flat contact only
    distance = joint.sliding_distance * size.pin
    worn = steady_bushing_wear(
        joint.moving_force,
        shaft_radius=size.pin / 2,
        width=size.width,
        sliding_distance=distance,
        specific_wear=known(joint.bushing.wear),
    )
    depth = float(worn.depth)
    reached = math.inf if depth == 0 else known(joint.life) * most / depth
    return Result(
        depth * 1e3,
        most=most * 1e3,
        missing=name_missing(
            joint,
            {
                "[life] time": joint.life,
                "wear of [bushing], from a test of the pair": joint.bushing.wear,
            },
        ),
        values={
            "distance": distance / 1e3,
            "volume": float(worn.volume) * 1e9,
            "reached": reached / 3600,
        },
    )
