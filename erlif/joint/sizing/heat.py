"""Motion: speed, pv, friction, heat, temperature, wear and roughness."""

from __future__ import annotations

import math

from erlif.joint.sizing.joint import Joint, dimensions_of
from erlif.joint.sizing.steps import Step, make_step, margin_below, missing_step
from erlif.models.wear import (
    WornBushing,
    bushing_heat_share,
    friction_heat,
    pressure_velocity,
    steady_bushing_wear,
)

FRICTION = (0.1, 0.8)
"""Friction coefficients of grease-lubricated oscillating joints, section 2.1.14. [1]"""

LARGEST_ROUGHNESS = 1e-6
"""Ra of pin and bushing up to which wear is kept low, section 2.1.16. [m]"""

LEAST_SHARE = 0.1
"""Share of the heat in the bushing from which eq. 29 gives its temperature; the pin has no path for
the rest in the guide, which computes bushings of metal, about a half. An assumption. [1]"""

HALF_RING = math.pi
"""Arc through which heat flows: the loaded half of the bushing, as eq. 29 is printed. [rad]"""


def motion_steps(joint: Joint) -> list[Step]:
    """Check speed, pv, friction, temperature, roughness and wear.

    Parameters
    ----------
    joint : Joint
        With all dimensions.

    Returns
    -------
    list of Step

    Examples
    --------
    >>> from erlif.joint.sizing import example_joint
    >>> [step.key for step in motion_steps(example_joint())]
    ['speed', 'pv', 'friction', 'friction_moment', 'temperature', 'roughness', 'wear']
    """
    return [
        _speed(joint),
        _pv(joint),
        _friction(joint),
        _moment(joint),
        _temperature(joint),
        _roughness(joint),
        _wear(joint),
    ]


_MOTION = "[motion] half_swing and period"


def _speed(joint: Joint) -> Step:
    speed = joint.speed(dimensions_of(joint).pin)
    if speed is None:
        return missing_step("speed", "sliding speed", "eq. 26", "result", _MOTION)
    most = joint.bushing.speed
    return make_step(
        "speed",
        "sliding speed",
        "eq. 26",
        "result" if most is None else "limit",
        "mean sliding speed",
        "mm/s",
        speed * 1e3,
        most=math.inf if most is None else most * 1e3,
        validity="mean over a swing; the highest speed of a sinusoidal one is pi/2 times as large",
        reason="Sliding distance, heat and wear follow from it.",
        alternatives=("a thinner pin", "a slower or a smaller swing"),
    )


def _pv(joint: Joint) -> Step:
    key, title, equation = "pv", "pressure times speed", "section 2.1.13"
    size = dimensions_of(joint)
    speed = joint.speed(size.pin)
    if speed is None:
        return missing_step(key, title, equation, "limit", _MOTION)
    limit = joint.bushing.pv
    pv = pressure_velocity(joint.moving_force, diameter=size.pin, width=size.width, speed=speed)
    return make_step(
        key,
        title,
        equation,
        "result" if limit is None else "limit",
        "projected pressure times speed",
        "W/mm2",
        pv / 1e6,
        most=math.inf if limit is None else limit / 1e6,
        validity="thermal and mechanical damage; neither abrasion nor fretting",
        reason="Beyond the pv limit of the pair the surfaces take up no more heat and seize or "
        "melt. Joints of construction machines are far below it.",
        alternatives=("a wider bushing", "a bushing with a higher pv limit", "a slower swing"),
    )


def _friction(joint: Joint) -> Step:
    low, high = FRICTION
    size = dimensions_of(joint)
    force = joint.friction * joint.force
    return make_step(
        "friction",
        "friction force",
        "eq. 27",
        "result",
        "friction force",
        "kN",
        force / 1e3,
        valid=low <= joint.friction <= high,
        validity=f"friction from {low:g}, newly greased, to {high:g}, dry ({joint.friction:g})",
        reason="The friction moment loads the lock plate and the drive.",
        alternatives=("grease more often", "a bushing with solid lubricant"),
        numbers=(("friction moment", force * size.pin / 2, "N m"),),
    )


def _moment(joint: Joint) -> Step:
    size = dimensions_of(joint)
    return make_step(
        "friction_moment",
        "friction moment",
        "eq. 27",
        "result",
        "friction force times half of the pin diameter",
        "N m",
        joint.friction * joint.force * size.pin / 2,
        validity="as the friction force",
        reason="What the drive has to overcome and the lock plate has to hold.",
    )


def bushing_heat(joint: Joint, diameter: float) -> float | None:
    """Return the friction heat that enters the bushing. Eqs. 27 and 28.

    Parameters
    ----------
    joint : Joint
    diameter : float
        Of the pin. [m]

    Returns
    -------
    float or None
        None where motion or a conductivity is not known. [W]

    Examples
    --------
    >>> from erlif.joint.sizing import example_joint
    >>> print(f"{bushing_heat(example_joint(), 0.08):.1f} W")
    40.0 W
    """
    pin, ring = joint.pin.conductivity, joint.bushing.conductivity
    speed = joint.speed(diameter)
    if speed is None or pin is None or ring is None:
        return None
    heat = friction_heat(joint.moving_force, friction=joint.friction, speed=speed)
    return float(heat * bushing_heat_share(pin, bushing_conductivity=ring))


def heat_is_shared(joint: Joint) -> bool:
    """Return whether enough of the heat enters the bushing for eq. 29, or the share is not known.

    Parameters
    ----------
    joint : Joint

    Returns
    -------
    bool
        False for bushings that hardly conduct, of polymers.

    Examples
    --------
    >>> from dataclasses import replace
    >>> from erlif.joint.sizing import example_joint, read_materials
    >>> joint = example_joint()
    >>> heat_is_shared(joint), heat_is_shared(replace(joint, bushing=read_materials()["POM"]))
    (True, False)
    """
    pin, ring = joint.pin.conductivity, joint.bushing.conductivity
    if pin is None or ring is None:
        return True
    return bool(bushing_heat_share(pin, bushing_conductivity=ring) >= LEAST_SHARE)


def surface_rise(joint: Joint) -> float | None:
    """Return the rise of the sliding surface over the outside. Eq. 29, through the loaded half.

    Parameters
    ----------
    joint : Joint
        With all dimensions.

    Returns
    -------
    float or None
        None where the heat is not known. [K]

    Examples
    --------
    >>> from erlif.joint.sizing import example_joint
    >>> print(f"{surface_rise(example_joint()):.2f} K")
    0.73 K
    """
    size, conductivity = dimensions_of(joint), joint.bushing.conductivity
    heat = bushing_heat(joint, size.pin)
    if heat is None or conductivity is None:
        return None
    # conduction through a cylindrical wall; the rise itself keeps its digits where it is small
    return heat * math.log1p(2 * size.wall / size.pin) / (HALF_RING * size.width * conductivity)


def temperature_limit(joint: Joint) -> float:
    """Return the highest temperature of the surface: that of the grease or of the bushing. [degC]

    Parameters
    ----------
    joint : Joint

    Returns
    -------
    float

    Examples
    --------
    >>> from erlif.joint.sizing import example_joint
    >>> temperature_limit(example_joint())
    120.0
    """
    ring = joint.bushing.temperature
    return joint.grease_temperature if ring is None else min(joint.grease_temperature, ring)


def _temperature(joint: Joint) -> Step:
    key, title, equation = "temperature", "temperature of the surface", "eqs. 28 and 29"
    rise, heat = surface_rise(joint), bushing_heat(joint, dimensions_of(joint).pin)
    if rise is None or heat is None:
        missing = f"{_MOTION}, conductivity of [pin] and [bushing]"
        return missing_step(key, title, equation, "limit", missing)
    limit, outside = temperature_limit(joint), joint.outside_temperature
    shared = heat_is_shared(joint)
    validity = (
        "slow sliding, heat through the loaded half of the bushing, outside at "
        f"{outside:g} degC; at least a tenth of the heat in the bushing"
    )
    if not shared:
        validity += ", which hardly conducts: the pin becomes warmer than this, and pv governs"
        if joint.bushing.pv is None:
            validity += " (give pv_limit of [bushing])"
    alternatives: tuple[str, ...] = (
        "a wider bushing or a thinner wall",
        "a bushing that conducts better",
        "less friction or a slower swing",
    )
    if limit <= outside:
        # without any friction the surface is as warm as the outside
        part = "grease" if limit >= joint.grease_temperature else "bushing material"
        alternatives = (
            f"a {part} for more than {outside:g} degC",
            f"an outside colder than {limit:g} degC",
        )
    return make_step(
        key,
        title,
        equation,
        "limit",
        "surface temperature",
        "degC",
        outside + rise,
        most=limit,
        # the heat may rise by the margin before the limit is reached
        margin=-1.0 if limit < outside else margin_below(rise, limit - outside),
        basis="rise over the outside",
        valid=shared,
        validity=validity,
        reason="Above its limit the grease bleeds its oil and the bushing softens.",
        alternatives=alternatives,
        numbers=(
            ("heat into the bushing", heat, "W"),
            ("rise over the outside", rise, "K"),
        ),
    )


def _roughness(joint: Joint) -> Step:
    known = [ra for ra in (joint.pin_roughness, joint.bushing_roughness) if ra is not None]
    key, title, equation = "roughness", "roughness of the surfaces", "section 2.1.16"
    if not known:
        return missing_step(key, title, equation, "recommendation", "roughness of [pin], [bushing]")
    return make_step(
        key,
        title,
        equation,
        "recommendation",
        "largest Ra",
        "um",
        max(known) * 1e6,
        most=LARGEST_ROUGHNESS * 1e6,
        validity="any pair; pins are usually ground to Ra 0.2 to 1 um",
        reason="Rough surfaces wear; very smooth ones do not hold the lubricant.",
        alternatives=("a ground and hardened pin",),
    )


def wear_after(joint: Joint, distance: float) -> float | None:
    """Return the depth worn after a sliding distance. Eq. 32 under the cosine of eq. 7.

    Parameters
    ----------
    joint : Joint
        With all dimensions.
    distance : float
        Sliding distance. [m]

    Returns
    -------
    float or None
        None where the specific wear rate is not known. [m]

    Examples
    --------
    >>> from erlif.joint.sizing import example_joint
    >>> print(f"{wear_after(example_joint(), 1e4) * 1e6:.1f} um")
    4.8 um
    """
    return None if joint.bushing.wear is None else _worn(joint, distance, joint.bushing.wear).depth


def _worn(joint: Joint, distance: float, rate: float) -> WornBushing:
    """Depth and volume of one cosine, of which eq. 31 has the volume for a flat contact only."""
    size = dimensions_of(joint)
    return steady_bushing_wear(
        joint.moving_force,
        shaft_radius=size.pin / 2,
        width=size.width,
        sliding_distance=distance,
        specific_wear=rate,
    )


def _wear(joint: Joint) -> Step:
    key, title, equation = "wear", "wear in the life", "eqs. 31 and 32"
    per_diameter, rate = joint.sliding_distance, joint.bushing.wear
    if per_diameter is None or rate is None:
        missing = f"{_MOTION}, [life] time, wear of [bushing] from a test of the pair"
        return missing_step(key, title, equation, "limit", missing)
    distance = per_diameter * dimensions_of(joint).pin
    worn = _worn(joint, distance, rate)
    depth = float(worn.depth)
    most = joint.largest_wear
    life = joint.life or 0.0
    reached = math.inf if most is None or depth == 0 else life * most / depth
    return make_step(
        key,
        title,
        equation,
        "result" if most is None else "limit",
        "worn depth",
        "mm",
        depth * 1e3,
        most=math.inf if most is None else most * 1e3,
        validity="Archard's law with a rate measured on the same pair and grease; the worn bushing "
        "carries a cosine of pressure",
        reason="The worn depth adds to the play and ends the life of the joint.",
        alternatives=(
            "a wider bushing",
            "a smaller wear rate: another pair, more grease, better seals",
            "shorter life or more wear allowed",
        ),
        numbers=(
            ("sliding distance", distance / 1e3, "km"),
            ("worn volume", float(worn.volume) * 1e9, "mm3"),
            ("life to the largest wear", reached / 3600, "h"),
        ),
    )
