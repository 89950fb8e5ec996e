"""The variables of the files that erlif writes: one table from which writing and checking follow.

The table is ``variables.toml`` beside this module; its head names the keys.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

import numpy.typing as npt
import xarray as xr

from erlif.core.tables import read_table

# Largest magnitude of a number of a trigger, in the units of the file.
LARGEST_NUMBER = 1e9


@dataclass(frozen=True)
class Variable:
    """A variable of a file.

    Attributes
    ----------
    name : str
        Name in the file.
    dims : tuple[str, ...]
        Its dims.
    dtype : str
        Type in the file; "text" for names.
    attrs : Mapping[str, str]
        Attributes in the file, after CF.
    meaning : str
        What the documentation states.
    when : str
        Condition under which it is in the file; empty: always.
    required : bool
        Whether a file without it is refused.
    needs : tuple[str, ...]
        Variables without which it stands for nothing.
    known : bool
        Whether some value must be a number and not NaN.
    low : float
        Smallest value.
    """

    name: str
    dims: tuple[str, ...]
    dtype: str = "float64"
    attrs: Mapping[str, str] = field(default_factory=dict)
    meaning: str = ""
    when: str = ""
    required: bool = False
    needs: tuple[str, ...] = ()
    known: bool = False
    low: float = -LARGEST_NUMBER

    @property
    def units(self) -> str:
        """Its unit in the notation of UDUNITS; empty where it has none."""
        return self.attrs.get("units", "")

    def fill(self, values: npt.ArrayLike, **attrs: Any) -> xr.Variable:
        """Values with dims and attributes of the table.

        Parameters
        ----------
        values : array
            On `dims`.
        **attrs
            Further attributes, or others in place of those of the table.

        Returns
        -------
        xarray.Variable

        Examples
        --------
        >>> FILM["film_mean"].fill([4.1, 4.3]).attrs["long_name"]
        'mean film thickness'
        """
        return xr.Variable(self.dims, values, {**self.attrs, **attrs})


_ATTRIBUTES = ("units", "long_name", "comment", "ancillary_variables")  # of a variable, after CF


# Keys that make a further variable, with its long_name, and how its name ends.
_FOLLOWING = {"std": "std", "random": "std_random"}


def _read_variables() -> dict[str, Mapping[str, Variable]]:
    """The variables by the file or group that they belong to."""
    rows: dict[str, dict[str, dict[str, Any]]] = {}
    for file, entries in read_table("erlif.core", "variables.toml").items():
        rows[file] = {}
        for name, keys in _ungroup(entries, {}):
            keys = rows.get(keys.pop("like", ""), {}).get(name, {}) | keys
            stds = {end: keys.pop(key, "") for key, end in _FOLLOWING.items()}
            rows[file][name] = keys
            same = {key: keys[key] for key in ("dims", "units", "when") if key in keys}
            same |= {"needs": name, "low": 0}
            rows[file] |= {
                f"{name}_{end}": same | {"long_name": title} for end, title in stds.items() if title
            }
    return {
        file: MappingProxyType({name: _make_variable(name, keys) for name, keys in each.items()})
        for file, each in rows.items()
    }


def _ungroup(entries: dict[str, Any], common: dict[str, Any]) -> Iterator[tuple[str, Any]]:
    """Names and keys of the variables, with the keys of the groups in which they stand."""
    common = common | {key: value for key, value in entries.items() if not isinstance(value, dict)}
    alike = common.pop("alike", "").split()
    for name, own in entries.items():
        if isinstance(own, dict) and ("alike" in own or dict in map(type, own.values())):
            yield from _ungroup(own, common)
        elif isinstance(own, dict):
            yield name, common | own
    for name in alike:
        yield name, dict(common)


def _make_variable(name: str, keys: dict[str, Any]) -> Variable:
    """The variable of a row; numbers have the unit 1 where none is stated."""
    keys = {"units": "" if keys.get("dtype") == "text" else "1"} | keys
    title = ": ".join(keys[key] for key in ("long_name", "comment") if keys.get(key))
    rest: dict[str, Any] = {"meaning": f"{title[:1].upper()}{title[1:]}."} | keys
    attrs = {key: rest.pop(key) for key in keys if key in _ATTRIBUTES}
    return Variable(
        name,
        dims=tuple(rest.pop("dims").split()),
        attrs={key: text for key, text in attrs.items() if text},
        needs=tuple(rest.pop("needs", "").split()),
        **rest,
    )


_TABLE = _read_variables()

# Variables of the root of film.nc.
FILM = _TABLE["film"]

# Variables of its group frames.
FRAMES = _TABLE["frames"]

# Variables of its group registration, and of that of calibration.nc.
REGISTRATION = _TABLE["registration"]

# Variables of calibration.nc.
CALIBRATION = _TABLE["calibration"]

# Variables of prediction.nc.
PREDICTION = _TABLE["prediction"]

# Variables of pressure.nc.
PRESSURE = _TABLE["pressure"]
