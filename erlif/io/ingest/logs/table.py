"""The table in the file of a data logger: named columns of numbers, with what is not a number.

Columns are converted by their units.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple, get_args

import numpy as np

from erlif.core.arrays import AnyArray, Array
from erlif.core.errors import EncoderError, ErlifError
from erlif.core.tables import read_table
from erlif.core.units import convert
from erlif.io.settings.values import (
    AngleUnit,
    ForceUnit,
    PulseEnergyUnit,
    SpeedUnit,
    TemperatureUnit,
    TimeUnit,
    TorqueUnit,
)

# Size above which the file of a log is not read: an hour of four columns at 2 kHz. [byte]
LARGEST_FILE = 256 * 2**20

# Values above which a table is not read; they take 256 MB.
MOST_CELLS = 32_000_000

# Cells without a number above which a file is no table of numbers.
MOST_TEXTS = 2_000_000


# Names by which columns and their units are found.
NAMES: dict[str, dict[str, Any]] = read_table("erlif.io.ingest.logs", "names.toml")


def check_cells(count: int, name: str) -> None:
    """Refuse a file whose header states more numbers than are read.

    Raises
    ------
    EncoderError
    """
    if count > MOST_CELLS:
        raise EncoderError(
            f"Expected at most {MOST_CELLS} numbers in {name}; its header states {count}. "
            "Export the part of the log that belongs to the run."
        )


@dataclass(frozen=True)
class LogUse:
    """For what a log is read: the error that refuses it, and what its messages propose.

    Attributes
    ----------
    error : type[ErlifError]
    column : str
        How a column is chosen, with the fields ``{quantity}`` and ``{choice}``.
    unit : str
        How its unit is chosen, with the same fields.
    bad_rows : str
        What can be done about rows without a number.
    name : str
        Where the name of the file is given.
    """

    error: type[ErlifError]
    column: str
    unit: str
    bad_rows: str
    name: str


# The log of the encoder of a run.
ENCODER = LogUse(
    EncoderError,
    column='{quantity} = "{choice}" in [encoder] of run.toml',
    unit='units = {{ {quantity} = "{choice}" }} in [encoder] of run.toml',
    bad_rows="Correct the value, or take the row and its frame of both cameras out and number the "
    "rows anew.",
    name="file in [encoder] of run.toml",
)


@dataclass(frozen=True, eq=False)
class LogColumn:
    """One column of a log.

    Attributes
    ----------
    name : str
        As in the header, or the path in a binary file.
    unit : str
        From a unit row or an attribute, else from brackets in the name; empty where unknown.
    values : Array
        NaN where a cell holds no number. (row,)
    texts : Mapping[int, str]
        Cells that hold no finite number, by their place from 0.
    """

    name: str
    unit: str
    values: Array
    texts: Mapping[int, str] = field(default_factory=dict)

    def free(self) -> AnyArray:
        """Numbers where all cells that are not empty are numbers, text otherwise."""
        if not any(text and not _is_number(text) for text in self.texts.values()):
            return self.values
        texts = [f"{value:.15g}" for value in self.values]
        for place, text in self.texts.items():
            texts[place] = text
        return np.array(texts)


@dataclass(frozen=True)
class LogTable:
    """The table in the file of a data logger.

    Attributes
    ----------
    file : str
        Name of the file, for messages.
    columns : tuple[LogColumn, ...]
        In the order of the file, all of one length.
    rows : Sequence[int]
        Number of each row in the file, counted from 1.
    remarks : tuple[str, ...]
        How the file was read, where that was not plain.
    use : LogUse
        For what it is read.
    """

    file: str
    columns: tuple[LogColumn, ...]
    rows: Sequence[int]
    remarks: tuple[str, ...] = ()
    use: LogUse = ENCODER

    @property
    def names(self) -> list[str]:
        """Names of the columns."""
        return [column.name for column in self.columns]

    @property
    def listed(self) -> str:
        """The first names, for a message."""
        return f"its columns are {', '.join(repr(one) for one in self.names[:20] if one)}"


def name_patterns(log: str) -> dict[str, str]:
    """Regular expressions of the names of columns by quantity, for the log of names.toml."""
    return {quantity: "|".join(names) for quantity, names in NAMES[log].items()}


def split_unit(name: str) -> tuple[str, str]:
    """Part the name of a column from the unit in it.

    Parameters
    ----------
    name : str
        ``"Encoder [deg]"``, ``"Force (N)"``, ``"Kraft / N"`` or a plain name.

    Returns
    -------
    (str, str)
        Name and unit; the unit is empty where there is none.

    Examples
    --------
    >>> split_unit("Encoder [deg]"), split_unit("Kraft / N"), split_unit("note")
    (('Encoder', 'deg'), ('Kraft', 'N'), ('note', ''))
    """
    if match := re.fullmatch(r"(.*\S)\s*[\[(<（]\s*([^\[\]()<>（）]*?)\s*[\])>）]", name):
        return match[1].rstrip(" _"), match[2]
    if match := re.fullmatch(r"(.*\S)\s+(?:/|in)\s+(\S{1,8})", name):
        return match[1], match[2]
    return name, ""


def _is_number(text: str) -> bool:
    """Whether a text is a number, finite or not; "1_000" is none, though Python reads it."""
    try:
        float(text)
    except ValueError:
        return False
    return "_" not in text


# Unit of a column whose clock times became seconds.
CLOCK = "clock time"


class Scale(NamedTuple):
    """Conversion of a unit to that of the log: factor times number plus offset.

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
    "position": ("mm", "um", "nm", "cm", "m"),
    "film": ("um", "mm", "nm", "m"),
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
