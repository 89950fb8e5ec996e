"""Quantities as text with a unit, "50 lbf" or "114 rpm", converted to floats in one fixed unit.

pint converts. This module refuses what pint would accept and misread: decimal commas, hertz as a
speed of rotation, pixels as a length, pounds as a force, arithmetic, and numbers that are not
finite.
"""

from __future__ import annotations

import math
import re
from functools import cache
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pint

_ONLY = {
    "rad/s": ("rpm", "rad/s", "deg/s", "rev/s"),
    "rad": ("deg", "degree", "degrees", "°", "rad", "mrad", "arcmin", "turn", "rev"),
}
"""Accepted units of rotation: pint reads 1 Hz as 1 rad/s and any pure number as an angle."""

_QUANTITY = re.compile(
    r"\s*([+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]{1,3})?)"
    r"\s*((?:1\s*/\s*)?[^\W\d](?:[\w ^/·()⁻-]|\*(?!\*)){0,40}|°C?)\s*\Z"
)
"""A decimal number and a short unit; pint would compute arithmetic such as 2**99999999."""

_HINTS = {
    "lb": 'write "lbf" for a force',
    "lbs": 'write "lbf" for a force',
    "kg": 'write "kgf" for a force',
}
"""What to write in place of a unit of mass where a force is expected."""


@cache
def _registry() -> pint.UnitRegistry[Any]:
    """Units of pint and those of cameras and encoders, made once because it takes a second."""
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
        Unit of the result, in pint's spelling.

    Returns
    -------
    float
        The value in `unit`.

    Raises
    ------
    ValueError
        If `text` is not a number with a unit, or its unit is of another kind.

    Examples
    --------
    >>> round(parse_quantity("50 lbf", "N"), 3)
    222.411
    >>> parse_quantity("1 Hz", "rad/s")
    Traceback (most recent call last):
    ValueError: a speed of rotation is given in rpm, rad/s, deg/s, rev/s; got '1 Hz'
    """
    expected = f'expected a number with a unit in quotes, such as "5 {unit}"'
    if not isinstance(text, str):
        raise ValueError(f"{expected}; got {text!r} without one")
    match = _QUANTITY.match(text)
    if match is None:
        comma = "; write a decimal point, not a comma" if "," in text else ""
        raise ValueError(f"{expected}; got {text!r}{comma}")

    # units that pint would convert to something else than meant
    number, name = float(match[1]), match[2].strip()
    if unit in _ONLY and name.replace(" ", "") not in _ONLY[unit]:
        kind = "a speed of rotation" if unit == "rad/s" else "an angle"
        raise ValueError(f"{kind} is given in {', '.join(_ONLY[unit])}; got {text!r}")
    if re.search(r"\b(px|pixels?)\b", name):
        raise ValueError(f"{expected}; got {text!r}, and a pixel is not a unit of length here")

    # pint raises errors of many classes, depending on the text
    spelling = name.replace("°C", "degC").replace("°", "deg")
    try:
        value = _registry().Quantity(number, spelling).to(unit).magnitude
    except Exception as error:
        hint = f"; {_HINTS[name]}" if name in _HINTS and unit == "N" else ""
        raise ValueError(f"{expected}; {text!r} cannot be converted to it{hint}") from error
    if not math.isfinite(value):
        raise ValueError(f"{expected}; {text!r} is not finite")
    return float(value)
