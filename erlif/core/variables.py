"""The variables of the files that erlif writes: one table from which writing and checking follow.

The table is ``variables.toml`` beside this module; its head names the keys.
"""

from __future__ import annotations

from collections.abc import Mapping
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


def _read_variables() -> dict[str, Mapping[str, Variable]]:
    """The variables by the file or group that they belong to."""
    table = read_table("erlif.core", "variables.toml")
    return {
        file: MappingProxyType(
            {name: _read_variable(file, name, table) for name in variables if name != "dims"}
        )
        for file, variables in table.items()
    }


_ATTRIBUTES = ("units", "long_name", "comment", "ancillary_variables")  # of a variable, after CF


def _read_variable(file: str, name: str, table: dict[str, Any]) -> Variable:
    """Read an entry of the table; missing keys are taken from the file that `like` names."""
    like = table[file][name].get("like", file)
    keys = {"dims": table[like]["dims"], **table[like][name], **table[file][name]}
    keys.pop("like", None)
    attrs = {key: keys.pop(key) for key in list(keys) if key in _ATTRIBUTES}
    title = attrs.get("long_name", "")
    keys.setdefault("meaning", f"{title[:1].upper()}{title[1:]}.")
    return Variable(
        name,
        dims=tuple(keys.pop("dims").split()),
        attrs={key: text for key, text in attrs.items() if text},
        needs=tuple(keys.pop("needs", "").split()),
        **keys,
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
