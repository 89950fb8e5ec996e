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

from erlif.core.tables import read_table

if TYPE_CHECKING:
    import pint

# Accepted units of rotation: pint reads 1 Hz as 1 rad/s and any pure number as an angle.
_ONLY = {
    "rad/s": ("rpm", "rad/s", "deg/s", "rev/s"),
    "rad": ("deg", "degree", "degrees", "°", "rad", "mrad", "arcmin", "turn", "rev"),
    "Hz": ("Hz", "kHz", "1/s", "1/min", "rpm"),
}

# What is measured in these units.
_KINDS = {"rad/s": "a speed of rotation", "rad": "an angle", "Hz": "a frequency"}


def _factor(text: str) -> Fraction:
    """A product of exact numbers and of pi."""
    numbers = (math.pi if word == "pi" else word for word in text.split())
    return math.prod(map(Fraction, numbers), start=Fraction(1))


# By the unit of the result, what one of each other usual unit is in it.
_USUAL = {
    unit: {name: _factor(text) for name, text in names.items()}
    for unit, names in read_table("erlif.core", "units.toml").items()
}

# A decimal number and a short unit; pint would compute arithmetic such as 2**99999999.
_QUANTITY = re.compile(
    r"\s*([+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]{1,3})?)"
    r"\s*((?:1\s*/\s*)?[^\W\d](?:[\w ^/·()⁻-]|\*(?!\*)){0,40}|°C?|%(?:\s?/\s?K)?)\s*\Z"
)

# Powers of a unit: one or two digits behind a letter. A power of a number or of another power, such
# as um^9^9^9, has more digits than can be computed.
_RAISED = "⁰¹²³⁴-⁹"
_POWER = re.compile(
    rf"(?<=[^\W\d{_RAISED}])(?:\^-?\d{{1,2}}|⁻?[{_RAISED}]{{1,2}})(?![\d^⁻{_RAISED}])"
)
_NO_POWER = re.compile(rf"[\^⁻{_RAISED}]|\d{{3}}")

# What to write in place of a unit of mass where a force is expected.
_HINTS = {
    "lb": 'write "lbf" for a force',
    "lbs": 'write "lbf" for a force',
    "kg": 'write "kgf" for a force',
}

# Quantities of usual size, by the unit of the result.
_EXAMPLES = {
    "m": "5 mm",
    "m/s": "10 mm/s",
    "rad": "5 deg",
    "rad/s": "114 rpm",
    "N": "200 N",
    "N/m": "12 N/mm",
    "Pa": "2 GPa",
    "Pa s": "0.1 Pa s",
    "1/Pa": "20 1/GPa",
    "nm": "580 nm",
    "degC": "25 degC",
    "delta_degC": "1 K",
    "percent": "5 %",
}


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
    quotes = "" if isinstance(text, str) else " in quotes"
    expected = f'expected a number with a unit{quotes}, such as "{example}"'
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
    """Suggest how to write a value whose unit is not known."""
    if name in _HINTS and unit == "N":
        return f"; {_HINTS[name]}"
    if unit == "Pa s" and name.endswith(("St", "m2/s", "m^2/s")):
        return (
            "; that is a kinematic viscosity: multiply it by the density of the oil (1 cSt at 880 "
            'kg/m3 is "0.88 mPa s")'
        )
    per = re.fullmatch(r"1\s*/\s*(s|min|h)|(Hz|rpm)", name)
    if unit == "s" and per and float(number) > 0:
        seconds = {"min": 60, "rpm": 60, "h": 3600}.get(per[1] or per[2], 1)
        return f'; that is a number per time: its period is "{seconds / float(number):.6g} s"'
    near = difflib.get_close_matches(name, _usual_units(unit), n=2)
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

    Raises
    ------
    ValueError
        For powers that pint would compute without end; pint raises errors of many classes.

    Examples
    --------
    >>> convert("60", "um", "m")
    6e-05
    """
    factor = _usual_units(unit).get(name.replace("µ", "u"))
    if factor is not None and math.isfinite(float(number)):
        # in fractions: "60 um" gives 6e-05 m, and not its neighbour
        return _nearest_float(Fraction(number) * factor)
    if _NO_POWER.search(_POWER.sub("", name.replace(" ", ""))):
        raise ValueError(f"{name} has a power that is none of a unit")
    spelling = name.replace("°C", "degC").replace("°", "deg")
    return float(_registry().Quantity(float(number), spelling).to(unit).magnitude)


def _usual_units(unit: str) -> dict[str, Fraction]:
    """The unit itself and the other usual ones, with what one of each is in it."""
    return {unit: Fraction(1)} | _USUAL.get(unit, {})


def _nearest_float(value: Fraction) -> float:
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
