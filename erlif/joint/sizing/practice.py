"""Practice: preferred numbers of ISO 3, and notes on what no step of the guide checks."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator
from typing import Literal

from erlif.joint.sizing.joint import DIMENSIONS, Joint
from erlif.joint.sizing.state import JointState

# Swings forth and back beyond which the missing check of fatigue is stated. [1]
MANY_SWINGS = 1e5

# Bores of solid bushings of copper alloys, ISO 4379. [m]
STANDARD_BORES = (6e-3, 200e-3)

# Size up to which ISO 286-1 has tolerances. [m]
LARGEST_TOLERANCED = 3.15

# Load beyond which its weight is stated: that of a thousand tonnes. [N]
LARGEST_LOAD = 10e6

# Chosen length below which strength does not decide. [m]
SMALLEST_MADE = 1e-3

# Seat width over the pin diameter below which it hardly clamps the pin as eq. 2 assumes. [1]
#
# An assumption; no source was found.
NARROW_SEAT = 0.25

# Half swing below which fretting is stated: the loaded arc never leaves its contact. [rad]
#
# An assumption; no source of a limit for pins was found.
SMALL_SWING = math.radians(5.0)

_GRAVITY = 9.80665
_LARGEST_FACTOR = 0.5  # m, size up to which the tolerance factor of ISO 286-1 is stated


def practice_notes(joint: Joint, *, chosen: Collection[str] = ()) -> tuple[str, ...]:
    """State what the guide does not check, and sizes that are unusual in practice.

    Parameters
    ----------
    joint : Joint
        With all dimensions.
    chosen : collection of str
        Its dimensions that were chosen.

    Returns
    -------
    tuple of str
        Sentences, each with its reason or source.

    Examples
    --------
    >>> from erlif.joint.sizing.design import example_joint
    >>> practice_notes(example_joint())
    ('Fatigue is not checked at 3e+06 cycles: the guide has no step for it.',)
    """
    return tuple(_notes(joint, chosen))


def unchecked(joint: Joint) -> tuple[str, ...]:
    """Name the failures that no step of the guide checks and that this joint does not exclude.

    Parameters
    ----------
    joint : Joint

    Returns
    -------
    tuple of str
        ``"fatigue"`` unless the cycles are known to be few, ``"fretting"`` in a small swing.

    Examples
    --------
    >>> from erlif.joint.sizing.design import example_joint
    >>> unchecked(example_joint())
    ('fatigue',)
    """
    few = 0.0 < _cycles(joint) <= MANY_SWINGS
    fretting = joint.half_swing and joint.half_swing < SMALL_SWING
    return (*(() if few else ("fatigue",)), *(("fretting",) if fretting else ()))


def _cycles(joint: Joint) -> float:
    """Swings forth and back in the life; NaN where they are not known. [1]"""
    if joint.life is None or joint.period is None or not joint.half_swing:
        return math.nan
    return joint.life / joint.period


def _notes(joint: Joint, chosen: Collection[str]) -> Iterator[str]:
    state = JointState(joint)
    size = state.size
    if (cycles := _cycles(joint)) > MANY_SWINGS:
        yield f"Fatigue is not checked at {cycles:.2g} cycles: the guide has no step for it."

    if joint.half_swing and joint.half_swing < SMALL_SWING:
        path = 1e3 * joint.half_swing * size.pin
        yield (
            f"Fretting is not checked: in a swing of ±{math.degrees(joint.half_swing):.3g} degrees "
            f"the pin slides by {path:.2g} mm each way, so that debris and old oil stay in the "
            "loaded arc. Wear and friction of a full swing may not hold."
        )

    if joint.force > LARGEST_LOAD:
        weight = joint.force / _GRAVITY / 1e3
        yield f"The load of {joint.force / 1e6:.3g} MN is the weight of {weight:.4g} t: check it."
    low, high = STANDARD_BORES
    if not low <= size.pin <= high:
        yield (
            f"A pin of {size.pin * 1e3:.4g} mm is outside of the bores of ISO 4379, {low * 1e3:g} "
            f"to {high * 1e3:g} mm, copper alloys."
        )
    largest = max(size.width, size.housing)
    if largest > LARGEST_TOLERANCED:
        yield (
            f"A part of {largest:.3g} m is larger than any tolerance of ISO 286-1, which ends at "
            f"{LARGEST_TOLERANCED:g} m."
        )

    play, tolerance = state.play, tolerance_grade_7(size.pin)
    if 0 < play < tolerance and size.pin <= _LARGEST_FACTOR:
        chosen_least = "play" in chosen
        why = ", or choose one with [sizing] series, which no play below it has" * chosen_least
        yield (
            f"The play of {play * 1e6:.3g} um is below a tolerance of ISO 286-1, grade 7 "
            f"({tolerance * 1e6:.2g} um): pair pin and bore{why}."
        )
    for name in DIMENSIONS[:-1]:
        value = getattr(joint, name)
        if name in chosen and value < SMALLEST_MADE:
            yield (
                f"The {name.replace('_', ' ')} of {value * 1e3:.2g} mm is all that strength needs; "
                "manufacture decides it."
            )
    if size.seat < NARROW_SEAT * size.pin * (1 - _TOLERANCE):
        yield (
            f"A seat of {size.seat * 1e3:.3g} mm is narrower than a quarter of the pin and hardly "
            "clamps it as eq. 2 assumes."
        )
    if "seat_width" in chosen and size.seat == SMALLEST_MADE:
        yield f"The seat width of {size.seat * 1e3:g} mm is the least that is made."


def tolerance_grade_7(diameter: float) -> float:
    """Return the standard tolerance of grade 7 of ISO 286-1 at a diameter up to 500 mm. [m]

    16 i with i = 0.45 D^(1/3) + 0.001 D in um, D in mm. The standard takes the mean of a range of
    sizes for D and rounds.

    The table has 25 um from 30 to 50 mm:

    >>> print(f"{tolerance_grade_7(0.0387) * 1e6:.1f} um")
    25.0 um
    """
    millimetres = diameter * 1e3
    return 16e-6 * (0.45 * float(millimetres ** (1 / 3)) + 0.001 * millimetres)


Series = Literal["none", "R10", "R20", "R40"]

_R40 = (
    1.0, 1.06, 1.12, 1.18, 1.25, 1.32, 1.4, 1.5, 1.6, 1.7, 1.8, 1.9, 2.0, 2.12, 2.24, 2.36, 2.5,
    2.65, 2.8, 3.0, 3.15, 3.35, 3.55, 3.75, 4.0, 4.25, 4.5, 4.75, 5.0, 5.3, 5.6, 6.0, 6.3, 6.7, 7.1,
    7.5, 8.0, 8.5, 9.0, 9.5,
)  # fmt: skip

_TOLERANCE = 1e-9  # a length that is a preferred number but for rounding stays


def round_up(length: float, series: Series) -> float:
    """Round a length up to the next preferred number in mm.

    Parameters
    ----------
    length : float
        Above 0. [m]
    series : str
        ``"R10"``, ``"R20"``, ``"R40"``, or ``"none"`` to leave it.

    Returns
    -------
    float
        [m]

    Examples
    --------
    >>> [round(round_up(37.067e-3, series) * 1e3, 6) for series in ("none", "R10", "R20", "R40")]
    [37.067, 40.0, 40.0, 37.5]
    """
    if series == "none" or not 0 < length < math.inf:
        return length
    numbers = _R40[:: {"R10": 4, "R20": 2, "R40": 1}[series]]
    millimetres = length * 1e3
    decade = math.floor(math.log10(millimetres))
    # the decimal numbers of the series, without the rounding of a product
    return next(
        float(f"{number:g}e{power - 3}")
        for power in (decade, decade + 1)
        for number in numbers
        if float(f"{number:g}e{power}") >= millimetres * (1 - _TOLERANCE)
    )
