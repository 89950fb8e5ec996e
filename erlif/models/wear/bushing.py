"""The bushing that is worn to the shape of its shaft. Colbert et al. (2009), appendix A."""

from dataclasses import dataclass

import numpy as np

from erlif.models.arguments import Values, formula
from erlif.models.wear.laws import wear_depth


@dataclass(frozen=True)
class WornBushing:
    """A bushing into which the shaft has worn to its steady state.

    Attributes
    ----------
    depth : Values
        Worn depth on the line of load, which falls off as the cosine. [m]
    pressure : Values
        Pressure on the line of load, which falls off as the cosine. [Pa]
    volume : Values
        Worn volume. [m3]
    """

    depth: Values
    pressure: Values
    volume: Values


@formula(load="load or zero")
def steady_bushing_wear(
    load: Values,
    *,
    shaft_radius: Values,
    width: Values,
    sliding_distance: Values,
    specific_wear: Values,
) -> WornBushing:
    """Compute the steady wear of a bushing by a rigid shaft. Colbert et al. (2009), appendix A.

    The shaft sinks straight in, so depth and pressure are cosines: P0 = 2F / (pi R w),
    depth0 = k P0 s, V = 2 R w depth0. The torque ratio is
    `erlif.models.friction.cosine_torque_ratio` at 90 degrees.

    Parameters
    ----------
    shaft_radius, width, specific_wear : float or array
        Radius R of the shaft [m], width w of the bushing [m], specific wear rate k [1/Pa].

    Returns
    -------
    WornBushing
        Depth [m] and pressure [Pa] on the line of load, and worn volume [m3].

    Notes
    -----
    The middle of eq. A4 should read k P0 D cos(theta); the text that inserts "(A1)" means (A5).

    Examples
    --------
    The volume is that of Archard for the friction path of the whole arc, k (4/pi) F s:

    >>> worn = steady_bushing_wear(
    ...     400.0, shaft_radius=0.005, width=0.01, sliding_distance=1e3, specific_wear=5e-13
    ... )
    >>> print(f"{worn.volume * 1e9:.4f} mm3, {5e-13 * 4 / np.pi * 400.0 * 1e3 * 1e9:.4f} mm3")
    254.6479 mm3, 254.6479 mm3
    """

    # a rigid shaft that sinks along the load wears as cos(theta), so the pressure is a cosine too
    pressure = 2 * load / (np.pi * shaft_radius * width)
    depth = wear_depth(pressure, sliding_distance=sliding_distance, specific_wear=specific_wear)
    return WornBushing(depth, pressure, 2 * shaft_radius * width * depth)
