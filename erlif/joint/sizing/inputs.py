"""Numbers of a joint that are in a wrong unit."""

from __future__ import annotations

from typing import Any

from erlif.models import arguments


def warn_of_units(joint: Any, *, dimensions: bool = True) -> None:
    """Warn of numbers of a joint that are so far off that a slip of units is likely.

    Parameters
    ----------
    joint : Joint
    dimensions : bool
        Whether lengths are inputs; False for those that were chosen.

    Warns
    -----
    UnitWarning
        Names the numbers, as ``"housing.yield_stress"``.

    Examples
    --------
    A strength in MPa:

    >>> import warnings
    >>> from dataclasses import replace
    >>> from erlif.joint.sizing import example_joint
    >>> joint = example_joint()
    >>> soft = replace(joint, housing=replace(joint.housing, yield_stress=335.0))
    >>> with warnings.catch_warnings(record=True) as caught:
    ...     warnings.simplefilter("always")
    ...     warn_of_units(soft)
    >>> print(str(caught[0].message).split(" is ")[0])
    housing.yield_stress = 335 Pa
    """
    given = {name: value for name in _PLACES if (value := _value(joint, name)) is not None}
    for quantity, names in _CHECKS:
        arguments.warn_of_units(quantity, **{name: given[name] for name in names if name in given})
    if not dimensions:
        return
    arguments.warn_of_units("length", **{name: given[name] for name in _LENGTHS if name in given})

    # plays may be as small as rounding, but none is as large as a metre
    plays = {name: given[name] for name in ("play", "interference") if name in given}
    arguments.warn_of_units(
        "length", **{name: play for name, play in plays.items() if abs(play) > 1}
    )


_PARTS = ("pin", "bushing", "seat", "housing")

_CHECKS: tuple[tuple[str, tuple[str, ...]], ...] = (
    ("load", ("force", "mean_force")),
    ("film", ("pin_roughness", "bushing_roughness")),
    ("swing", ("half_swing",)),
    (
        "strength",
        (
            "lock.screw_yield",
            *(
                f"{part}.{stress}"
                for part in _PARTS
                for stress in ("yield_stress", "ultimate_stress")
            ),
        ),
    ),
    ("modulus", tuple(f"{part}.youngs_modulus" for part in _PARTS)),
    ("expansion", tuple(f"{part}.expansion" for part in _PARTS)),
    ("conductivity", tuple(f"{part}.conductivity" for part in _PARTS)),
    ("specific_wear", tuple(f"{part}.wear" for part in _PARTS)),
)
"""Numbers by their quantity, under the names that the user wrote."""

_LENGTHS = (
    *("largest_wear", "pin_diameter", "hole_diameter", "bushing_width", "wall", "seat_width"),
    *("housing_diameter", "lateral_play", "lock.lever", "lock.length", "lock.thickness"),
    *("lock.throat", "lock.height", "lock.end_width", "lock.weld_diameter", "lock.screw_diameter"),
)

_PLACES = (*(name for _, names in _CHECKS for name in names), *_LENGTHS, "play", "interference")


def _value(table: Any, name: str) -> float | None:
    """The number of a joint at a place such as ``"lock.screw_yield"``; None without a lock."""
    for part in name.split("."):
        table = None if table is None else getattr(table, part)
    return None if table is None else float(table)
