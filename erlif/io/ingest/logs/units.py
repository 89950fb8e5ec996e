"""Units of the columns of a log."""

from __future__ import annotations

from typing import NamedTuple, get_args

from erlif.core.units import convert
from erlif.io.ingest.logs.table import NAMES
from erlif.io.settings.tables import (
    AngleUnit,
    ForceUnit,
    PulseEnergyUnit,
    SpeedUnit,
    TemperatureUnit,
    TimeUnit,
    TorqueUnit,
)

# Unit of a column whose clock times became seconds.
CLOCK = "clock time"


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


# Units by the quantity of a column; the first is that of the result.
UNITS: dict[str, tuple[str, ...]] = {
    "angle": get_args(AngleUnit),
    "time": get_args(TimeUnit),
    "load": get_args(ForceUnit),
    "torque": get_args(TorqueUnit),
    "temperature": get_args(TemperatureUnit),
    "speed": get_args(SpeedUnit),
    "pulse_energy": get_args(PulseEnergyUnit),
}

# Units of results as films spell them.
_RESULTS = {"deg": "degree", "degC": "degree_Celsius", "rad/s": "rad s-1", "m/s": "m s-1"}

# Units of another kind than the first of their quantity, and what they become.
_OTHER_RESULTS = {"m/s": "m/s", "mm/s": "m/s", "tick": "tick", "V": "V", "1": "1"}

_OFFSETS = {"K": Scale("degree_Celsius", 1.0, -273.15)}
_OFFSETS["degF"] = Scale("degree_Celsius", 5 / 9, -160 / 9)

# Other spellings of a unit, in lower case.
_SPELLINGS = {other: unit for unit, others in NAMES["spellings"].items() for other in others}

# Units of columns that are only copied; with them a row of units is recognised.
_OTHERS = frozenset({"v", "mv", "a", "ma", "bar", "pa", "hz", "khz", "%", "mm", "um", "nm", "dn"})


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
    name = unit if unit in known else _SPELLINGS.get(unit.lower(), "")
    if name not in known:
        return None
    if name in _OFFSETS:
        return _OFFSETS[name]
    result = _OTHER_RESULTS.get(name, known[0])
    factor = 1.0 if name == result else convert("1", name, result)
    return Scale(_RESULTS.get(result, result), factor)


def is_unit(text: str) -> bool:
    """Whether a text is the unit of some quantity.

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
