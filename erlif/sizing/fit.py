"""Play: what is left of it by the press fit and by the growth of warm parts."""

from __future__ import annotations

import math
from functools import lru_cache

from erlif.models.bearing import RECOMMENDED_PLAY, press_fit_displacement
from erlif.models.wear import thermal_growth
from erlif.sizing.heat import surface_rise
from erlif.sizing.joint import Joint, dimensions_of
from erlif.sizing.steps import Step, make_step, missing_step


def fit_steps(joint: Joint) -> list[Step]:
    """Check the play of a joint, cold and warm.

    Parameters
    ----------
    joint : Joint
        With all dimensions.

    Returns
    -------
    list of Step
        Press fit, relative play, warm play.

    Examples
    --------
    >>> from erlif.sizing import example_joint
    >>> [step.key for step in fit_steps(example_joint())]
    ['press_fit', 'relative_play', 'warm_play']
    """
    return [_press_fit(joint), _relative_play(joint), _warm_play(joint)]


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
    >>> from erlif.sizing import example_joint
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
    >>> from erlif.sizing import example_joint
    >>> joint = example_joint()
    >>> assembled_play(joint) < joint.play
    True
    """
    return dimensions_of(joint).play + 2 * (bore_displacement(joint) or 0.0)


def _press_fit(joint: Joint) -> Step:
    key, title, equation = "press_fit", "press fit of the bushing", "eqs. 24 and 25"
    displacement = bore_displacement(joint)
    if displacement is None:
        size = dimensions_of(joint)
        missing = "youngs_modulus and poissons_ratio of [bushing] and [housing]"
        if size.housing <= size.fit:
            missing = "a housing larger than the bushing"
        return missing_step(key, title, equation, "result", missing)

    play = assembled_play(joint)
    return make_step(
        key,
        title,
        equation,
        "result",
        "loss of play",
        "um",
        -2e6 * displacement,
        validity="elastic rings in plane stress, bushing as wide as its housing",
        reason="The pressed bushing shrinks by about as much as its tolerances; the play is what "
        "is left.",
        alternatives=("less interference", "a bore machined after pressing"),
        numbers=(("play assembled", play * 1e6, "um"),),
    )


_UNKNOWN_FIT = "; without what the press fit takes, which is not known"


def _relative_play(joint: Joint) -> Step:
    size, play = dimensions_of(joint), assembled_play(joint)
    low, high = RECOMMENDED_PLAY
    wanted = low * 1e-3 * size.pin - 2 * (bore_displacement(joint) or 0.0)
    known = bore_displacement(joint) is not None
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
        valid=known,
        validity="heavily loaded grease-lubricated joints with metal bushings"
        + ("" if known else _UNKNOWN_FIT),
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
    >>> from erlif.sizing import example_joint
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
    loss = growth_loss(joint)
    if loss is None:
        return missing_step(
            key,
            title,
            "eq. 30",
            "recommendation",
            "[motion], and expansion and conductivity of the materials",
        )
    play, size = assembled_play(joint), dimensions_of(joint)
    warm = play - loss
    known = bore_displacement(joint) is not None
    return make_step(
        key,
        title,
        "eq. 30",
        "recommendation",
        "play when warm",
        "um",
        warm * 1e6,
        least=0.0,
        # a play has no ratio to nothing: its margin is that over the least play of eq. 23
        margin=warm / (RECOMMENDED_PLAY[0] * 1e-3 * size.pin),
        basis="least play of eq. 23",
        valid=known,
        validity="pin at the temperature of the surface, bushing at its mean temperature"
        + ("" if known else _UNKNOWN_FIT),
        reason="Warm parts grow by as much as the play is large; without play the joint seizes.",
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
    >>> from erlif.sizing import example_joint
    >>> joint = example_joint()
    >>> tight = replace(joint, play=least_play(joint))
    >>> min(step.margin for step in fit_steps(tight)[1:]) > -1e-9
    True
    """
    size = dimensions_of(joint)
    loss = growth_loss(joint) or 0.0
    wanted = max(RECOMMENDED_PLAY[0] * 1e-3 * size.pin, loss if math.isfinite(loss) else 0.0)
    return wanted - 2 * (bore_displacement(joint) or 0.0)
