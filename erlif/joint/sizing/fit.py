"""Play: what is left of it by the press fit and by the growth of warm parts."""

from __future__ import annotations

import math
from functools import lru_cache

from erlif.joint.sizing.heat import heat_is_shared, surface_rise
from erlif.joint.sizing.joint import Joint, dimensions_of
from erlif.joint.sizing.steps import Kind, Step, make_step, missing_step
from erlif.models.bearing import RECOMMENDED_PLAY, press_fit_displacement
from erlif.models.wear import thermal_growth

PUSH_OUT_FRICTION = 0.1
"""Friction in the press fit for which the push-out force is stated; it grows in proportion. [1]"""


def fit_steps(joint: Joint) -> list[Step]:
    """Check the play of a joint, cold and warm.

    Parameters
    ----------
    joint : Joint
        With all dimensions.

    Returns
    -------
    list of Step
        Press fit, its stresses where there is one, relative play, warm play.

    Examples
    --------
    >>> from erlif.joint.sizing import example_joint
    >>> [step.key for step in fit_steps(example_joint())]
    ['press_fit', 'press_bushing', 'press_housing', 'relative_play', 'warm_play']
    """
    stresses = [_pressed_bushing(joint), _pressed_housing(joint)] if joint.interference > 0 else []
    return [_press_fit(joint), *stresses, _relative_play(joint), _warm_play(joint)]


@lru_cache(maxsize=64)  # several steps need it
def bore_displacement(joint: Joint) -> float | None:
    """Return the radial displacement of the bore by the press fit. Eqs. 24 and 25.

    Parameters
    ----------
    joint : Joint
        With all dimensions.

    Returns
    -------
    float or None
        Negative where the bore shrinks; 0 without interference, None where an elastic constant is
        not known or the housing is not larger than the fit. [m]

    Examples
    --------
    >>> from dataclasses import replace
    >>> from erlif.joint.sizing import example_joint
    >>> bore_displacement(replace(example_joint(), interference=0.0))
    0.0
    """
    if joint.interference <= 0:
        return 0.0
    size = dimensions_of(joint)
    inner, outer = joint.bushing, joint.housing
    if size.housing <= size.fit or size.wall <= 0:
        return None
    if inner.youngs_modulus is None or inner.poissons_ratio is None:
        return None
    if outer.youngs_modulus is None or outer.poissons_ratio is None:
        return None
    displacement: float = press_fit_displacement(
        joint.interference,
        bore=size.pin,
        fit_diameter=size.fit,
        housing_diameter=size.housing,
        youngs_bushing=inner.youngs_modulus,
        poisson_bushing=inner.poissons_ratio,
        youngs_housing=outer.youngs_modulus,
        poisson_housing=outer.poissons_ratio,
    )
    return displacement


def assembled_play(joint: Joint) -> float:
    """Return the play with the bushing pressed in. [m]

    Parameters
    ----------
    joint : Joint
        With all dimensions.

    Returns
    -------
    float
        Negative for an interference. Without elastic constants the bushing counts as rigid.

    Examples
    --------
    >>> from erlif.joint.sizing import example_joint
    >>> joint = example_joint()
    >>> assembled_play(joint) < joint.play
    True
    """
    return dimensions_of(joint).play + 2 * (bore_displacement(joint) or 0.0)


def _press_fit(joint: Joint) -> Step:
    key, title, equation = "press_fit", "press fit of the bushing", "eqs. 24 and 25"
    displacement = bore_displacement(joint)
    if displacement is None:
        return missing_step(key, title, equation, "result", _missing_for_fit(joint))

    play = assembled_play(joint)
    fit = press_fit_pressure(joint) or 0.0
    size = dimensions_of(joint)
    push_out = PUSH_OUT_FRICTION * fit * math.pi * size.fit * size.width
    return make_step(
        key,
        title,
        equation,
        "result",
        "loss of play",
        "um",
        abs(2e6 * displacement),
        validity="elastic rings in plane stress, bushing as wide as its housing",
        reason="The pressed bushing shrinks by about as much as its tolerances; the play is what "
        "is left.",
        alternatives=("less interference", "a bore machined after pressing"),
        numbers=(
            ("play assembled", play * 1e6, "um"),
            ("pressure in the fit", fit / 1e6, "MPa"),
            (f"push-out force at a friction of {PUSH_OUT_FRICTION:g}", push_out / 1e3, "kN"),
        ),
    )


def _missing_for_fit(joint: Joint, strength: str = "") -> str:
    size = dimensions_of(joint)
    if size.housing <= size.fit:
        return "a housing larger than the bushing"
    return strength + "youngs_modulus and poissons_ratio of [bushing] and [housing]"


def press_fit_pressure(joint: Joint) -> float | None:
    """Return the pressure between bushing and housing, from the displacement of the bore. Lame.

    Parameters
    ----------
    joint : Joint
        With all dimensions.

    Returns
    -------
    float or None
        0 without interference, None where an elastic constant is not known or the housing is not
        larger than the fit. [Pa]

    Examples
    --------
    >>> from erlif.joint.sizing import example_joint
    >>> print(f"{press_fit_pressure(example_joint()) / 1e6:.1f} MPa")
    13.5 MPa
    """
    displacement, modulus = bore_displacement(joint), joint.bushing.youngs_modulus
    if displacement is None or modulus is None:
        return 0.0 if displacement == 0 else None
    size = dimensions_of(joint)
    # the bore is free of pressure: its hoop strain has its hoop stress alone
    hoop = modulus * abs(displacement) / (size.pin / 2)
    return hoop * (1 - (size.pin / size.fit) ** 2) / 2


_NO_SAFETY = (
    "elastic rings in plane stress; against the yield stress itself, without the safety factor, "
    "which is one on the load"
)


def _pressed_bushing(joint: Joint) -> Step:
    key, title = "press_bushing", "bushing pressed into its housing"
    pressure, strength = press_fit_pressure(joint), joint.bushing.yield_stress
    if pressure is None or strength is None:
        missing = _missing_for_fit(joint, "yield_stress of [bushing]; ")
        return missing_step(key, title, _LAME, "limit", missing)

    size = dimensions_of(joint)
    stress = 2 * pressure / (1 - (size.pin / size.fit) ** 2)
    return _pressed(joint, key, title, stress, strength, pressure, -stress, "bore of the bushing")


def _pressed_housing(joint: Joint) -> Step:
    key, title = "press_housing", "housing around the pressed bushing"
    pressure, strength = press_fit_pressure(joint), joint.housing.yield_stress
    if pressure is None or strength is None:
        missing = _missing_for_fit(joint, "yield_stress of [housing]; ")
        return missing_step(key, title, _LAME, "limit", missing)

    size = dimensions_of(joint)
    outer, inner = size.housing**2, size.fit**2
    hoop = pressure * (outer + inner) / (outer - inner)
    stress = math.sqrt(hoop**2 + hoop * pressure + pressure**2)  # von Mises, radial -p
    return _pressed(joint, key, title, stress, strength, pressure, hoop, "bore of the housing")


_LAME = "Lame, eq. 25"


def _pressed(
    joint: Joint,
    key: str,
    title: str,
    stress: float,
    strength: float,
    pressure: float,
    hoop: float,
    where: str,
) -> Step:
    """A stress of the press fit, which is in proportion to the interference."""
    most = joint.interference * strength / stress if stress > 0 else math.inf
    return make_step(
        key,
        title,
        _LAME,
        "limit",
        f"von Mises stress at the {where}",
        "MPa",
        stress / 1e6,
        most=strength / 1e6,
        validity=_NO_SAFETY,
        reason="Beyond its yield stress the part flows: the fit loosens, and the play is not that "
        "of eq. 25.",
        alternatives=(
            f"interference of at most {most * 1e6:.4g} um",
            f"yield stress of at least {stress / 1e6:.4g} MPa",
        ),
        numbers=(
            ("pressure in the fit", pressure / 1e6, "MPa"),
            ("hoop stress", hoop / 1e6, "MPa"),
        ),
    )


def _doubt_about_fit(joint: Joint) -> str:
    """Why the play that the press fit takes may be another one; empty where there is no reason."""
    if bore_displacement(joint) is None:
        return "; without what the press fit takes, which is not known"
    if joint.interference <= 0:
        return ""
    stresses = (_pressed_bushing(joint), _pressed_housing(joint))
    return "" if all(step.holds for step in stresses) else "; elastic, though the press fit yields"


def _relative_play(joint: Joint) -> Step:
    size, play = dimensions_of(joint), assembled_play(joint)
    low, high = RECOMMENDED_PLAY
    wanted = low * 1e-3 * size.pin - 2 * (bore_displacement(joint) or 0.0)
    doubt = _doubt_about_fit(joint)
    return make_step(
        "relative_play",
        "play over diameter",
        "eq. 23",
        "recommendation",
        "play over diameter, assembled",
        "per mille",
        1e3 * play / size.pin,
        least=low,
        most=high,
        valid=not doubt,
        validity=f"heavily loaded grease-lubricated joints with metal bushings{doubt}",
        reason="Slow oscillating joints have as little play as possible: it raises the peak "
        "pressure and leaves less for wear.",
        alternatives=(
            f"play before pressing from {wanted * 1e6:.4g} to "
            f"{(wanted + (high - low) * 1e-3 * size.pin) * 1e6:.4g} um",
        ),
    )


@lru_cache(maxsize=64)
def growth_loss(joint: Joint) -> float | None:
    """Return the play that the growth of warm parts takes. Eq. 30.

    The pin has the temperature of the surface. The bore of a free bushing grows as its diameter; in
    a housing it follows the housing less the growth of its wall. The smaller of the two counts.

    Parameters
    ----------
    joint : Joint
        With all dimensions.

    Returns
    -------
    float or None
        Negative where play is gained, None where temperature or expansion is not known. [m]

    Examples
    --------
    >>> from erlif.joint.sizing import example_joint
    >>> print(f"{growth_loss(example_joint()) * 1e6:.0f} um")
    6 um
    """
    rise = surface_rise(joint)
    pin, ring, housing = joint.pin.expansion, joint.bushing.expansion, joint.housing.expansion
    if rise is None or pin is None or ring is None or housing is None:
        return None
    size = dimensions_of(joint)
    outside = joint.outside_temperature - joint.assembly_temperature
    wall_rise = outside + rise / 2

    grown_pin = thermal_growth(size.pin, expansion=pin, temperature_change=outside + rise)
    free = thermal_growth(size.pin, expansion=ring, temperature_change=wall_rise)
    held = thermal_growth(size.fit, expansion=housing, temperature_change=outside)
    held -= 2 * size.wall * ring * wall_rise
    return float(grown_pin - min(free, held))


def _warm_play(joint: Joint) -> Step:
    key, title = "warm_play", "play when warm"
    loss, play, size = growth_loss(joint), assembled_play(joint), dimensions_of(joint)
    # a joint at rest may be tight
    kind: Kind = "limit" if joint.speed(size.pin) else "recommendation"
    doubts = [doubt] if (doubt := _doubt_about_fit(joint)) else []
    if loss is None:
        if kind == "recommendation" or play >= 0:
            missing = "[motion], and expansion and conductivity of the materials"
            return missing_step(key, title, "eq. 30", kind, missing)
        # tight when cold: what growth takes decides nothing
        loss = 0.0
        doubts.append("; without growth, for which expansion or conductivity is not known")
    if not heat_is_shared(joint):
        doubts.append("; most of the heat stays in the pin, which becomes warmer than this")
    warm = play - loss
    return make_step(
        key,
        title,
        "eq. 30",
        kind,
        "play when warm",
        "um",
        warm * 1e6,
        least=0.0,
        # a play has no ratio to nothing: its margin is that over the least play of eq. 23
        margin=warm / (RECOMMENDED_PLAY[0] * 1e-3 * size.pin),
        basis="least play of eq. 23",
        valid=not doubts,
        validity="pin at the temperature of the surface, bushing at its mean temperature"
        + "".join(doubts),
        reason="Press fit and warm parts take as much as the play is large; without play a joint "
        "that moves seizes.",
        alternatives=(
            f"play before pressing of at least {(size.play - warm) * 1e6:.4g} um",
            "a bushing that expands less, or a thinner wall",
        ),
        numbers=(("play taken by growth", loss * 1e6, "um"),),
    )


def least_play(joint: Joint) -> float:
    """Return the least play before pressing that is recommended, cold and warm. [m]

    Parameters
    ----------
    joint : Joint
        With all dimensions; its own play does not matter.

    Returns
    -------
    float

    Examples
    --------
    >>> from dataclasses import replace
    >>> from erlif.joint.sizing import example_joint
    >>> joint = example_joint()
    >>> tight = replace(joint, play=least_play(joint))
    >>> min(step.margin for step in fit_steps(tight)[1:]) > -1e-9
    True
    """
    size = dimensions_of(joint)
    loss = growth_loss(joint) or 0.0
    wanted = max(RECOMMENDED_PLAY[0] * 1e-3 * size.pin, loss if math.isfinite(loss) else 0.0)
    return wanted - 2 * (bore_displacement(joint) or 0.0)
