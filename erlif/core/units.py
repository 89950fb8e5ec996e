"""Quantities as people write them, "50 lbf" or "114 rpm", to floats in one fixed unit.

pint does the conversion; this module keeps out what pint would accept and misread: decimal commas, hertz as a speed
of rotation, pixels as a length, pounds as a force, arithmetic, and numbers that are not finite.
"""

from __future__ import annotations

import math
import re
from functools import cache
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pint

SPEED_UNITS = ("rpm", "rad/s", "deg/s", "rev/s")
"""A speed of rotation may be given in these only: pint takes 1 Hz for 1 rad/s."""

_QUANTITY = re.compile(
    r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d{1,3})?)\s*((?:1\s*/\s*)?[^\W\d](?:[^,;*]|\*(?!\*)){0,40}|°C?)\s*\Z"
)
_HINTS = {"lb": 'write "lbf" for a force', "lbs": 'write "lbf" for a force', "kg": 'write "kgf" for a force'}


@cache
def _registry() -> pint.UnitRegistry[Any]:
    import pint

    registry: pint.UnitRegistry[Any] = pint.UnitRegistry(cache_folder=None)
    registry.define("rev = turn")
    registry.define("electron = [charge_count]")
    registry.define("DN = [digital_number]")
    return registry


def parse_quantity(text: object, unit: str) -> float:
    """Read a quantity written with its unit.

    Parameters
    ----------
    text : str
        A number and a unit, such as ``"5.5 cm"`` or ``"12.4 1/GPa"``.
    unit : str
        The unit of the answer, in pint's spelling.

    Returns
    -------
    float
        The value in `unit`.

    Raises
    ------
    ValueError
        If `text` is no number with a unit, or its unit is of another kind.

    Examples
    --------
    >>> round(parse_quantity("50 lbf", "N"), 3)
    222.411
    """
    import pint

    example = f'expected a number with a unit in quotes, such as "5 {unit}"'
    if not isinstance(text, str):
        raise ValueError(f"{example}; got {text!r} without one")
    match = _QUANTITY.match(text)
    if match is None:
        comma = "; write a decimal point, not a comma" if "," in text else ""
        raise ValueError(f"{example}; got {text!r}{comma}")
    number, name = float(match[1]), match[2].strip()
    if unit == "rad/s" and name not in SPEED_UNITS:
        raise ValueError(f"a speed of rotation is given in {', '.join(SPEED_UNITS)}; got {text!r}")
    if re.search(r"\b(px|pixels?)\b", name):
        raise ValueError(f"{example}; got {text!r}, and a pixel is not a unit of length here")
    registry = _registry()
    try:
        value = registry.Quantity(number, name.replace("°C", "degC").replace("°", "deg")).to(unit).magnitude
    except (pint.PintError, AttributeError, TypeError, ValueError, AssertionError) as error:
        hint = f"; {_HINTS[name]}" if name in _HINTS and unit == "N" else ""
        raise ValueError(f"{example}; {text!r} cannot be read as one{hint}") from error
    if not math.isfinite(value):
        raise ValueError(f"{example}; {text!r} is not finite")
    return float(value)
