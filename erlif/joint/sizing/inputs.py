"""Numbers of a joint: which are refused, and which are in a wrong unit."""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import fields
from typing import Any

import numpy as np

from erlif.core.errors import ModelError
from erlif.models.arguments import (
    check_conductivity,
    check_expansion,
    check_film,
    check_length,
    check_load,
    check_modulus,
    check_specific_wear,
    check_strength,
    check_swing,
    require_finite,
    require_not_negative,
    require_positive,
    require_single,
)


def require_numbers(
    table: Any, *, may_be_zero: Collection[str] = (), any_sign: Collection[str] = ()
) -> None:
    """Refuse numbers of a dataclass that are NaN, infinite or of a wrong sign.

    Parameters
    ----------
    table : dataclass
        Fields that hold text, None or another dataclass are left out.
    may_be_zero : collection of str
        Fields that may be zero.
    any_sign : collection of str
        Fields that may be negative as well. All others must be positive.

    Raises
    ------
    ModelError
        Names the field.

    Examples
    --------
    >>> from erlif.joint.sizing.materials import Material
    >>> require_numbers(Material("steel", youngs_modulus=-210e9))
    Traceback (most recent call last):
    erlif.core.errors.ModelError: youngs_modulus must be positive, got -2.1e+11.
    """
    for field in fields(table):
        name, value = field.name, getattr(table, field.name)
        if not isinstance(value, _NUMBERS) or (isinstance(value, float) and 0 < value < math.inf):
            continue
        require_single(**{name: value})
        if np.isnan(value):
            raise ModelError(f"{name} must not be NaN; give None where it is not known.")
        if name in any_sign:
            require_finite(**{name: value})
        elif name in may_be_zero:
            require_not_negative(**{name: value})
        else:
            require_positive(**{name: value})


_NUMBERS = (int, float, np.generic, np.ndarray, list, tuple)


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
    check_load(**_given(joint, "", ("force", "mean_force")))
    check_film(**_given(joint, "", ("pin_roughness", "bushing_roughness")))
    check_swing(**_given(joint, "", ("half_swing",)))
    if joint.lock is not None:
        check_strength(**_given(joint.lock, "lock.", ("screw_yield",)))
    if dimensions:
        check_length(**_given(joint, "", _LENGTHS))
        # plays may be as small as rounding, but none is as large as a metre
        plays = _given(joint, "", ("play", "interference"))
        check_length(**{name: play for name, play in plays.items() if abs(play) > 1})
        if joint.lock is not None:
            check_length(**_given(joint.lock, "lock.", _LOCK_LENGTHS))
    for part in ("pin", "bushing", "seat", "housing"):
        material = getattr(joint, part)
        check_strength(**_given(material, f"{part}.", ("yield_stress", "ultimate_stress")))
        check_modulus(**_given(material, f"{part}.", ("youngs_modulus",)))
        check_expansion(**_given(material, f"{part}.", ("expansion",)))
        check_conductivity(**_given(material, f"{part}.", ("conductivity",)))
        check_specific_wear(**_given(material, f"{part}.", ("wear",)))


_LENGTHS = (
    *("largest_wear", "pin_diameter", "hole_diameter", "bushing_width", "wall", "seat_width"),
    *("housing_diameter", "lateral_play"),
)
_LOCK_LENGTHS = (
    *("lever", "length", "thickness", "throat", "height", "end_width"),
    *("weld_diameter", "screw_diameter"),
)


def _given(table: Any, prefix: str, names: Collection[str]) -> dict[str, float]:
    """The numbers of a dataclass that are known, under the names that its user wrote."""
    known = {name: getattr(table, name) for name in names}
    return {prefix + name: value for name, value in known.items() if value is not None}
