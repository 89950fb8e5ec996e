"""Results as datasets: every variable with its unit and its name in words."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

if TYPE_CHECKING:
    import xarray as xr

# Dimensions, values, unit and name in words of each variable.
Columns: TypeAlias = dict[str, tuple[str | tuple[str, ...], Any, str, str]]


def describe(variables: Columns, coordinates: Columns) -> xr.Dataset:
    """Collect variables in a dataset, with their units; an empty name in words is left out."""
    import xarray as xr  # at use, because the models load without it

    def column(
        dims: str | tuple[str, ...], values: Any, unit: str, text: str
    ) -> tuple[str | tuple[str, ...], Any, dict[str, str]]:
        return dims, values, {"units": unit, "long_name": text} if text else {"units": unit}

    return xr.Dataset(
        {name: column(*row) for name, row in variables.items()},
        {name: column(*row) for name, row in coordinates.items()},
    )


def describe_by(
    words: Mapping[str, Sequence[str]],
    variables: Mapping[str, tuple[str | tuple[str, ...], Any]],
    coordinates: Mapping[str, tuple[str | tuple[str, ...], Any]] | None = None,
) -> xr.Dataset:
    """Collect variables whose units and names in words stand in a table, under their own names."""
    return describe(
        {name: (*column, *words[name]) for name, column in variables.items()},
        {name: (*column, *words[name]) for name, column in (coordinates or {}).items()},
    )
