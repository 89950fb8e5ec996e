"""Angles and lengths within the reach of a linkage, with room for rounding at its dead points."""

import numpy as np

from erlif.core.errors import ModelError
from erlif.models.arguments import Values

TURN = 2 * np.pi
"""A full turn. [rad]"""

DEAD_POINT_TOLERANCE = 1e-9
"""How far beyond a dead point an encoder angle may lie by rounding alone. [rad, m]"""


def sign(rising: Values) -> Values:
    """1 where rising, -1 where falling, of the type of `rising`."""
    return 2 * (rising * 1) - 1


def within_reach(value: Values, limits: tuple[float, float], tolerance: float, name: str) -> Values:
    """`value` clipped to `limits`, refused where it lies further out than `tolerance`."""
    low, high = limits
    outside = np.less(value, low - tolerance) | np.greater(value, high + tolerance)
    if np.any(outside):
        worst = float(np.asarray(value)[np.asarray(outside)].flat[0])
        raise ModelError(
            f"{name} must lie in the reach of the linkage, {_with_unit(low, name)} to "
            f"{_with_unit(high, name)}, got {_with_unit(worst, name)}."
        )
    return np.clip(value, low, high)


def _with_unit(value: float, name: str) -> str:
    """Text of an angle in both of its usual units, or of a length."""
    return (
        f"{value:.6g} rad ({np.degrees(value):.4f} degrees)"
        if name.endswith("angle")
        else f"{value:.6g} m"
    )
