"""Materials: strength, hardness, limits and sources; a table of the user adds to that of erlif."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import Any

from erlif.core.bounded import read_rows
from erlif.core.errors import ConfigError
from erlif.core.tables import read_table
from erlif.joint.models.bearing import hardness_from_strength

# Pascal of one Brinell: a kilogram-force on a square millimetre. [Pa]
BRINELL = 9.80665e6

# What a material of the table is meant for; none is refused elsewhere.
USES = ("pin", "bushing", "structure")

_LARGEST_FILE = 2**20  # byte


@dataclass(frozen=True)
class Material:
    """A material in SI units, hardness in Brinell; None where a value is not known.

    Attributes
    ----------
    name : str
        Name in the table.
    use : str
        ``"pin"``, ``"bushing"`` or ``"structure"``.
    yield_stress : float | None
        Yield stress or 0.2 % proof stress. [Pa]
    ultimate_stress : float | None
        Tensile strength. [Pa]
    hardness_low : float | None
        Lowest hardness of the surface. [HB]
    hardness_high : float | None
        Highest hardness of the surface. [HB]
    youngs_modulus : float | None
        Young's modulus. [Pa]
    poissons_ratio : float | None
        Poisson's ratio. [1]
    expansion : float | None
        Coefficient of linear thermal expansion. [1/K]
    conductivity : float | None
        Thermal conductivity. [W/(m K)]
    temperature : float | None
        Highest temperature of use. [degC]
    pressure : float | None
        Largest projected pressure in motion. [Pa]
    speed : float | None
        Largest sliding speed. [m/s]
    pv : float | None
        Largest product of pressure and speed. [W/m2]
    wear : float | None
        Specific wear rate k of eq. 32. [1/Pa]
    source : str
        Where the values come from.
    """

    name: str
    use: str = "bushing"
    yield_stress: float | None = None
    ultimate_stress: float | None = None
    hardness_low: float | None = None
    hardness_high: float | None = None
    youngs_modulus: float | None = None
    poissons_ratio: float | None = None
    expansion: float | None = None
    conductivity: float | None = None
    temperature: float | None = None
    pressure: float | None = None
    speed: float | None = None
    pv: float | None = None
    wear: float | None = None
    source: str = ""

    @property
    def hardness(self) -> float | None:
        """Lowest hardness as a pressure; from the tensile strength where it is not known. [Pa]"""
        if self.hardness_low is not None:
            return self.hardness_low * BRINELL
        if self.ultimate_stress is None:
            return None
        return float(hardness_from_strength(self.ultimate_stress))


def read_materials(path: Path | None = None) -> MappingProxyType[str, Material]:
    """Read the table of materials, with that of the user merged into it.

    A material of the user's table with a known name changes the values that it states and keeps the
    others; with a new name it joins the table.

    Parameters
    ----------
    path : Path, optional
        CSV file with the columns ``name``, ``source`` and any of the columns of numbers.

    Returns
    -------
    mapping of str to Material
        By name, in the order of the tables.

    Raises
    ------
    ConfigError
        If the file cannot be read or holds what the table does not have.

    Examples
    --------
    >>> bronze = read_materials()["CuAl10Ni5Fe4"]
    >>> bronze.hardness_low, bronze.hardness_high
    (140.0, 230.0)
    """
    known = _own_table()
    return MappingProxyType(known if path is None else _merge(known, path))


@cache
def _own_table() -> dict[str, Material]:
    return _merge({}, Path(__file__).with_name("materials.csv"))


@cache
def _columns() -> dict[str, dict[str, Any]]:
    """Field, unit and accepted values by the headings of the numbers."""
    fields = read_table("erlif.joint.sizing", "quantities.toml")["material"].items()
    return {
        known["column"]: {"field": name, **known} for name, known in fields if "column" in known
    }


def _merge(known: dict[str, Material], path: Path) -> dict[str, Material]:
    """The known materials with those of a table; ConfigError with the row and the column."""
    try:
        rows = read_rows(path, largest=_LARGEST_FILE)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise ConfigError(
            f"Expected a table of materials in {path}; it cannot be read: {reason}. Name a CSV "
            "file, text in UTF-8, beside joint.toml with `materials`."
        ) from error
    head = rows[0][1] if rows else []
    allowed = ["name", "use", *_columns(), "source"]
    unknown = [cell for cell in head if cell not in allowed]
    if "name" not in head or unknown or len(set(head)) < len(head):
        got = f"the column {unknown[0]!r}" if unknown else ", ".join(head) or "an empty file"
        raise ConfigError(
            f"Expected a table of materials in {path} with the columns name and any of "
            f"{', '.join(allowed[1:])}, each once; got {got}. Correct the first row."
        )

    merged = dict(known)
    for number, row in rows[1:]:
        where = f"row {number} of {path}"
        if len(row) != len(head):
            raise ConfigError(
                f"Expected {len(head)} cells in {where}; got {len(row)}. Put text that holds a "
                "comma in quotes."
            )
        cells = dict(zip(head, row, strict=True))
        material = _read_row(cells, merged, where)
        merged[material.name] = material
    return merged


def _read_row(cells: dict[str, str], known: dict[str, Material], where: str) -> Material:
    name, use = cells["name"], cells.get("use", "")
    if not name:
        raise ConfigError(
            f"Expected the name of a material in {where}; got an empty cell. Give it one."
        )
    if use not in ("", *USES):
        raise ConfigError(
            f"Expected one of {', '.join(USES)} as use in {where}; got {use!r}. Write one of them."
        )

    changed: dict[str, Any] = {key: cells[key] for key in ("use", "source") if cells.get(key)}
    for title, column in _columns().items():
        if cell := cells.get(title):
            changed[column["field"]] = _read_cell(cell, title, column, where)
    material = replace(known.get(name, Material(name)), **changed)
    low, high = material.hardness_low or 0.0, material.hardness_high or math.inf
    if low > high:
        raise ConfigError(
            f"Expected hardness_low_HB up to hardness_high_HB in {where}; got {low:g} above "
            f"{high:g}. Exchange them."
        )
    return material


def _read_cell(cell: str, title: str, column: dict[str, Any], where: str) -> float:
    low, high = column["low"], column["high"]
    try:
        value = float(cell)
    except ValueError:
        value = math.nan
    if not low <= value <= high:
        raise ConfigError(
            f"Expected a number from {low:g} to {high:g} as {title} in {where}; got {cell!r}. "
            "Correct the cell, or leave it empty."
        )
    return float(value * column["unit"])
