"""Quantities as text with a unit, "50 lbf" or "114 rpm", converted to floats in one fixed unit.

The usual units are converted here by their definitions, all others by pint. This module refuses
what pint would accept and misread: decimal commas, hertz as a speed of rotation, pixels as a
length, pounds as a force, arithmetic, and numbers that are not finite.
"""

from __future__ import annotations

import difflib
import math
import re
from fractions import Fraction
from functools import cache
from typing import TYPE_CHECKING, Any, Self

if TYPE_CHECKING:
    import pint

_ONLY = {
    "rad/s": ("rpm", "rad/s", "deg/s", "rev/s"),
    "rad": ("deg", "degree", "degrees", "°", "rad", "mrad", "arcmin", "turn", "rev"),
    "Hz": ("Hz", "kHz", "1/s", "1/min", "rpm"),
}
"""Accepted units of rotation: pint reads 1 Hz as 1 rad/s and any pure number as an angle."""

_KINDS = {"rad/s": "a speed of rotation", "rad": "an angle", "Hz": "a frequency"}
"""What is measured in these units."""

_PI = Fraction(math.pi)
_DEGREES = Fraction("57.29577951308232087679815")  # in a radian
_LBF, _KGF, _INCH = Fraction("4.4482216152605"), Fraction("9.80665"), Fraction("0.0254")

_POWERS = {"G": 9, "M": 6, "k": 3, "": 0, "c": -2, "m": -3, "u": -6, "µ": -6, "n": -9}
"""Powers of ten by their prefixes."""


def _multiples(prefixes: str, *units: str) -> dict[str, Fraction | int]:
    """Decimal multiples of a unit and of its other spellings, by their names."""
    return {
        prefix + unit: Fraction(10) ** _POWERS[prefix]
        for unit in units
        for prefix in ["", *prefixes]
    }


_USUAL: dict[str, dict[str, Fraction | int]] = {
    "m": _multiples("cmuµn", "m"),
    "nm": {"nm": 1, "um": 10**3, "µm": 10**3},
    "N": _multiples("km", "N") | {"lbf": _LBF, "kgf": _KGF},
    "N/m": {"N/m": 1, "N/mm": 10**3, "kN/mm": 10**6, "N/um": 10**6, "N/µm": 10**6},
    "Pa": _multiples("kMG", "Pa"),
    "1/Pa": {"1/Pa": 1, "1/MPa": Fraction(1, 10**6), "1/GPa": Fraction(1, 10**9)},
    "Pa s": {"Pa s": 1, "mPa s": Fraction(1, 10**3), "cP": Fraction(1, 10**3)},
    "rad/s": {"rad/s": 1, "rpm": _PI / 30, "deg/s": _PI / 180, "rev/s": 2 * _PI},
    "rad": {"rad": 1, "deg": _PI / 180},
    "deg": {"deg": 1, "rad": _DEGREES, "mrad": _DEGREES / 1000, "turn": 360},
    "N m": _multiples("k", "N m")
    | {"N mm": Fraction(1, 10**3), "lbf ft": _LBF * 12 * _INCH, "lbf in": _LBF * _INCH},
    # a cycle is one turn: pint would count 1 rpm as 0.105 Hz
    "Hz": _multiples("k", "Hz") | {"1/s": 1, "1/min": Fraction(1, 60), "rpm": Fraction(1, 60)},
    "s": _multiples("mun", "s") | {"min": 60, "h": 3600},
    "J": _multiples("muµ", "J"),
    "mJ": {"mJ": 1, "J": 10**3, "uJ": Fraction(1, 10**3)},
    "mol/L": _multiples("muµ", "mol/L", "mol/l") | _multiples("mu", "M"),
    "L/mol/cm": {"L/mol/cm": 1, "l/mol/cm": 1, "1/M/cm": 1},
    "1/nm": {"1/nm": 1},
    "electron/DN": {"electron/DN": 1},
    "electron": {"electron": 1},
    "DN": {"DN": 1},
    "degC": {"degC": 1},
    # hardness as a pressure of a kilogram-force on a square millimetre; Vickers after ISO 18265,
    # whose Brinell numbers of steel are 0.95 of it
    "HB": {
        "HB": 1,
        "HBW": 1,
        "HBS": 1,
        "HV": Fraction(95, 100),
        "MPa": Fraction(100000, 980665),
        "N/mm^2": Fraction(100000, 980665),
        "GPa": Fraction(100000000, 980665),
    },
    "m^2/N": {
        "mm3/N/m": Fraction(1, 10**9),
        "mm^3/N/m": Fraction(1, 10**9),
        "mm3/(N m)": Fraction(1, 10**9),
        "1/Pa": 1,
        "1/MPa": Fraction(1, 10**6),
    },
    "W/m^2": {"W/m^2": 1, "W/mm^2": 10**6, "W/mm2": 10**6, "MPa m/s": 10**6, "N/mm2 m/s": 10**6},
    "W/m/K": {"W/m/K": 1, "W/(m K)": 1},
    "1/K": {"1/K": 1},
    "m/s": {"m/s": 1, "mm/s": Fraction(1, 10**3)},
    "delta_degC": {"K": 1},
}
"""By the unit of the result, what one of each usual unit is in it; loading pint takes 0.2 s."""

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

_EXAMPLES = {"m": "5 mm", "m/s": "10 mm/s", "Pa": "2 GPa", "Pa s": "0.1 Pa s", "N": "200 N"}
"""Quantities of usual size, by the unit of the result."""


@cache
def _registry() -> pint.UnitRegistry[Any]:
    """Units of pint and those of cameras and encoders, made once because it takes a second."""
    import pint

    registry: pint.UnitRegistry[Any] = pint.UnitRegistry(cache_folder=None)
    registry.define("rev = turn")
    registry.define("electron = [charge_count]")
    registry.define("DN = [digital_number]")
    return registry


class Quantity(float):
    """A number in a fixed unit that remembers how the user wrote it.

    It computes and compares as the float that it is; results of arithmetic are plain floats.

    Attributes
    ----------
    text : str
        Number and unit as written, "50 um".

    Examples
    --------
    >>> pitch = Quantity(5e-05, "50 um")
    >>> pitch * 2, pitch.text
    (0.0001, '50 um')
    """

    text: str

    def __new__(cls, value: float, text: str) -> Self:
        """A quantity of this value, written as `text`."""
        quantity = super().__new__(cls, value)
        quantity.text = text
        return quantity

    def __getnewargs__(self) -> tuple[float, str]:  # type: ignore[override]
        """Arguments with which a copy in another process is made."""
        return float(self), self.text


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
    example = _EXAMPLES.get(unit, f"5 {unit}")
    expected = f'expected a number with a unit in quotes, such as "{example}"'
    if not isinstance(text, str):
        raise ValueError(f"{expected}; got {text!r} without one")
    match = _QUANTITY.match(text)
    if match is None:
        comma = "; write a decimal point, not a comma" if "," in text else ""
        raise ValueError(f"{expected}; got {text!r}{comma}")

    # units that pint would convert to something else than meant
    name = match[2].strip()
    if unit in _ONLY and name.replace(" ", "") not in _ONLY[unit]:
        raise ValueError(f"{_KINDS[unit]} is given in {', '.join(_ONLY[unit])}; got {text!r}")
    if re.search(r"\b(px|pixels?)\b", name):
        raise ValueError(f"{expected}; got {text!r}, and a pixel is not a unit of length here")

    try:
        value = convert(match[1], name, unit)
    except Exception as error:  # pint raises errors of many classes, depending on the text
        hint = _hint(match[1], name, unit)
        raise ValueError(f"{expected}; {text!r} cannot be converted to it{hint}") from error
    if not math.isfinite(value):
        raise ValueError(f"{expected}; {text!r} is not finite")
    return value


def _hint(number: str, name: str, unit: str) -> str:
    """What to write in place of a unit that is not known."""
    if name in _HINTS and unit == "N":
        return f"; {_HINTS[name]}"
    near = difflib.get_close_matches(name, _USUAL.get(unit, {}), n=2)
    return f"; did you mean {' or '.join(f'{number} {each}' for each in near)}?" if near else ""


def convert(number: str, name: str, unit: str) -> float:
    """A number of one unit as a number of another, rounded once.

    Parameters
    ----------
    number : str
        A decimal number.
    name : str
        Its unit.
    unit : str
        Unit of the result, in pint's spelling.

    Returns
    -------
    float
        Infinite beyond the largest float.

    Examples
    --------
    >>> convert("60", "um", "m")
    6e-05
    """
    usual = _USUAL.get(unit, {})
    if name in usual and math.isfinite(float(number)):
        # in fractions: "60 um" gives 6e-05 m, and not its neighbour
        return _nearest(Fraction(number) * usual[name])
    spelling = name.replace("°C", "degC").replace("°", "deg")
    return float(_registry().Quantity(float(number), spelling).to(unit).magnitude)


def _nearest(value: Fraction) -> float:
    """The float nearest to a fraction; infinite beyond the largest float."""
    try:
        return float(value)
    except OverflowError:
        return math.inf


def count_of(number: int, what: str) -> str:
    """A number with what it counts, in the plural where there is not one.

    Parameters
    ----------
    number : int
    what : str
        In the singular, with a regular plural.

    Returns
    -------
    str

    Examples
    --------
    >>> count_of(1, "cycle"), count_of(4, "cycle")
    ('1 cycle', '4 cycles')
    """
    return f"{number} {what}" if number == 1 else f"{number} {what}s"
