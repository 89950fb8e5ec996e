"""Units of the columns of a log."""

from __future__ import annotations

from typing import NamedTuple


class Scale(NamedTuple):
    """How the numbers of one unit become those of the log: factor times number plus offset.

    Attributes
    ----------
    unit : str
        Unit of the result, as films spell it.
    factor : float
    offset : float
    """

    unit: str
    factor: float = 1.0
    offset: float = 0.0


_DEGREE = "degree"
_CELSIUS = "degree_Celsius"
_TURN = 360.0

UNITS: dict[str, dict[str, Scale]] = {
    "angle": {
        "deg": Scale(_DEGREE),
        "rad": Scale(_DEGREE, 57.29577951308232),
        "mrad": Scale(_DEGREE, 0.05729577951308232),
        "turn": Scale(_DEGREE, _TURN),
        "tick": Scale("tick"),
    },
    "time": {
        "s": Scale("s"),
        "ms": Scale("s", 1e-3),
        "us": Scale("s", 1e-6),
        "ns": Scale("s", 1e-9),
        "min": Scale("s", 60.0),
        "h": Scale("s", 3600.0),
    },
    "load": {
        "N": Scale("N"),
        "kN": Scale("N", 1e3),
        "mN": Scale("N", 1e-3),
        "lbf": Scale("N", 4.4482216152605),
        "kgf": Scale("N", 9.80665),
    },
    "torque": {
        "N m": Scale("N m"),
        "kN m": Scale("N m", 1e3),
        "N mm": Scale("N m", 1e-3),
        "lbf ft": Scale("N m", 1.3558179483314004),
        "lbf in": Scale("N m", 0.1129848290276167),
    },
    "temperature": {
        "degC": Scale(_CELSIUS),
        "K": Scale(_CELSIUS, 1.0, -273.15),
        "degF": Scale(_CELSIUS, 5 / 9, -160 / 9),
    },
    "speed": {
        "rad/s": Scale("rad s-1"),
        "rpm": Scale("rad s-1", 0.10471975511965977),
        "deg/s": Scale("rad s-1", 0.017453292519943295),
        "rev/s": Scale("rad s-1", 6.283185307179586),
        "m/s": Scale("m s-1"),
        "mm/s": Scale("m s-1", 1e-3),
    },
    "pulse_energy": {
        "mJ": Scale("mJ"),
        "J": Scale("mJ", 1e3),
        "uJ": Scale("mJ", 1e-3),
        "V": Scale("V"),
        "1": Scale("1"),
    },
}
"""Units by the quantity of a column."""

_SPELLINGS = {
    "°": "deg",
    "degree": "deg",
    "degrees": "deg",
    "radian": "rad",
    "radians": "rad",
    "rev": "turn",
    "turns": "turn",
    "ticks": "tick",
    "count": "tick",
    "counts": "tick",
    "inc": "tick",
    "sec": "s",
    "second": "s",
    "seconds": "s",
    "µs": "us",
    "μs": "us",
    "newton": "N",
    "nm": "N m",
    "n·m": "N m",
    "n*m": "N m",
    "knm": "kN m",
    "nmm": "N mm",
    "ft lbf": "lbf ft",
    "in lbf": "lbf in",
    "ft-lbf": "lbf ft",
    "in-lbf": "lbf in",
    "c": "degC",
    "°c": "degC",
    "degree_celsius": "degC",
    "celsius": "degC",
    "f": "degF",
    "°f": "degF",
    "kelvin": "K",
    "1/min": "rpm",
    "min-1": "rpm",
    "min^-1": "rpm",
    "u/min": "rpm",
    "m s-1": "m/s",
    "rad s-1": "rad/s",
    "µj": "uJ",
    "-": "1",
}
"""Other spellings of a unit, in lower case."""

_OTHERS = frozenset({"v", "mv", "a", "ma", "bar", "pa", "hz", "khz", "%", "mm", "um", "nm", "dn"})
"""Units of columns that are only copied; with them a row of units is recognised."""


def find_scale(quantity: str, unit: str) -> Scale | None:
    """Scale of a unit.

    Parameters
    ----------
    quantity : str
        A key of `UNITS`.
    unit : str
        As written by a logger.

    Returns
    -------
    Scale or None
        None where the unit is none of this quantity.

    Examples
    --------
    >>> find_scale("temperature", "°C"), find_scale("load", "mm")
    (Scale(unit='degree_Celsius', factor=1.0, offset=0.0), None)
    """
    known = UNITS[quantity]
    return known.get(unit) or known.get(_SPELLINGS.get(unit.lower(), ""))


def is_unit(text: str) -> bool:
    """Whether a text is the unit of some quantity.

    Parameters
    ----------
    text : str

    Returns
    -------
    bool

    Examples
    --------
    >>> is_unit("deg"), is_unit("Encoder")
    (True, False)
    """
    lower = text.lower()
    return (
        lower in _SPELLINGS
        or lower in _OTHERS
        or any(text in units for units in UNITS.values())
        or not text
    )
