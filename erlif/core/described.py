"""Results as datasets: every variable with its unit and its name in words."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeAlias

if TYPE_CHECKING:
    import xarray as xr

Columns: TypeAlias = dict[str, tuple[str | tuple[str, ...], Any, str, str]]
"""Dimensions, values, unit and name in words of each variable."""


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


def in_words(columns: dict[str, tuple[Any, str]], dims: str | tuple[str, ...] = ()) -> Columns:
    """Rows for `describe` of values and units whose names are their descriptions."""
    return {
        name: (dims, values, unit, name.replace("_", " "))
        for name, (values, unit) in columns.items()
    }
