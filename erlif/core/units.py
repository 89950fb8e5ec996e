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

_ONLY = {
    "rad/s": ("rpm", "rad/s", "deg/s", "rev/s"),
    "rad": ("deg", "degree", "degrees", "°", "rad", "mrad", "arcmin", "turn", "rev"),
}
"""Units of rotation are listed, because pint takes 1 Hz for 1 rad/s and any pure number for an angle."""

_QUANTITY = re.compile(
    r"\s*([+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]{1,3})?)"
    r"\s*((?:1\s*/\s*)?[^\W\d](?:[\w ^/·()⁻-]|\*(?!\*)){0,40}|°C?)\s*\Z"
)
_HINTS = {
    "lb": 'write "lbf" for a force',
    "lbs": 'write "lbf" for a force',
    "kg": 'write "kgf" for a force',
}


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
    example = f'expected a number with a unit in quotes, such as "5 {unit}"'
    if not isinstance(text, str):
        raise ValueError(f"{example}; got {text!r} without one")
    match = _QUANTITY.match(text)
    if match is None:
        comma = "; write a decimal point, not a comma" if "," in text else ""
        raise ValueError(f"{example}; got {text!r}{comma}")
    number, name = float(match[1]), match[2].strip()
    if unit in _ONLY and name.replace(" ", "") not in _ONLY[unit]:
        kind = "a speed of rotation" if unit == "rad/s" else "an angle"
        raise ValueError(f"{kind} is given in {', '.join(_ONLY[unit])}; got {text!r}")
    if re.search(r"\b(px|pixels?)\b", name):
        raise ValueError(f"{example}; got {text!r}, and a pixel is not a unit of length here")
    registry = _registry()
    try:
        value = (
            registry.Quantity(number, name.replace("°C", "degC").replace("°", "deg"))
            .to(unit)
            .magnitude
        )
    except Exception as error:  # pint raises whatever the text leads it to
        hint = f"; {_HINTS[name]}" if name in _HINTS and unit == "N" else ""
        raise ValueError(f"{example}; {text!r} cannot be read as one{hint}") from error
    if not math.isfinite(value):
        raise ValueError(f"{example}; {text!r} is not finite")
    return float(value)
