"""What the models accept as a number, and how they refuse one."""

from typing import Any, TypeAlias

import numpy as np

from erlif.core.errors import ModelError

Values: TypeAlias = Any
"""A float, a numpy array or an xarray DataArray, in SI units; no static type covers the three without importing xarray."""


def require_positive(**arguments: Values) -> None:
    """Raise ModelError naming the first argument that holds zero or a negative number."""
    for name, value in arguments.items():
        if np.any(np.less_equal(value, 0)):
            raise ModelError(f"{name} must be positive, got {_worst(value, np.nanmin)}.")


def require_not_negative(**arguments: Values) -> None:
    """Raise ModelError naming the first argument that holds a negative number."""
    for name, value in arguments.items():
        if np.any(np.less(value, 0)):
            raise ModelError(f"{name} must not be negative, got {_worst(value, np.nanmin)}.")


def require_between(lowest: float, highest: float, **arguments: Values) -> None:
    """Raise ModelError naming the first argument outside the closed range from `lowest` to `highest`."""
    for name, value in arguments.items():
        if np.any(np.less(value, lowest)):
            raise ModelError(
                f"{name} must lie in {lowest:g} to {highest:g}, got {_worst(value, np.nanmin)}."
            )
        if np.any(np.greater(value, highest)):
            raise ModelError(
                f"{name} must lie in {lowest:g} to {highest:g}, got {_worst(value, np.nanmax)}."
            )


def require_poisson(**arguments: Values) -> None:
    """Raise ModelError naming the first Poisson's ratio outside -1 to 0.5, the range of a stable isotropic solid."""
    for name, value in arguments.items():
        if np.any(np.less_equal(value, -1)):
            raise ModelError(f"{name} must lie above -1, got {_worst(value, np.nanmin)}.")
        if np.any(np.greater(value, 0.5)):
            raise ModelError(f"{name} must be at most 0.5, got {_worst(value, np.nanmax)}.")


def _worst(value: Values, pick: Any) -> str:
    return f"{float(pick(np.asarray(value))):g}"
