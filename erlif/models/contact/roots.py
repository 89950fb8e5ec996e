"""Roots and kinds of arrays that the contacts share."""

from collections.abc import Callable

import numpy as np

from erlif.models.arguments import Values

# Absolute and relative: the roots are exact to a few units of the last place.
_ROOT_TOLERANCE = 1e-14


def find_roots(
    function: Callable[..., Values], low: Values, high: Values, *arguments: Values
) -> Values:
    """Find the root of function(x, *arguments) between low and high, element by element."""
    from scipy.optimize import elementwise  # half a second, for theories that need a root

    return elementwise.find_root(
        function,
        (low, high),
        args=arguments,
        tolerances={"xatol": _ROOT_TOLERANCE, "xrtol": _ROOT_TOLERANCE},
    ).x


def like(example: Values, data: Values) -> Values:
    """`data` in the kind of array of `example`, of the same shape."""
    if hasattr(example, "dims"):  # a DataArray keeps its coordinates
        return example.copy(data=data)
    return data if np.ndim(data) else np.asarray(data).item()
