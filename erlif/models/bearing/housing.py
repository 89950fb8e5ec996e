"""The eye of the housing. Strand (2005), eq. 14."""

import numpy as np

from erlif.models.arguments import (
    Values,
    formula,
)

RECOMMENDED_HOUSING = (2.0, 4.0)
"""Outer over inner diameter of the housing eye, section 2.1.6. [1]"""


@formula(bore="length", yield_stress="strength", safety="number")
def least_eyebar_diameter(
    load: Values, *, bore: Values, width: Values, yield_stress: Values, safety: Values
) -> Values:
    """Compute the minimum outer diameter of a housing eye. Strand (2005), eq. 14.

    The diameter D at which F (D/d + d/D) / (s (D - d)) = sigma_y / eta.

    Parameters
    ----------
    load : float or array
        Load F. [N]
    bore : float or array
        Inner diameter d. [m]
    width : float or array
        Width s of the eye. [m]
    yield_stress : float or array
        Yield stress sigma_y of the housing. [Pa]
    safety : float or array
        Safety factor eta. [1]

    Returns
    -------
    float or array
        Minimum outer diameter D; infinite where no outer diameter carries the load (F from
        sigma_y s d / eta on). [m]

    Raises
    ------
    ModelError
        A value not positive or not finite.

    Notes
    -----
    The source prints w in the place of s under the root.

    Examples
    --------
    The stress at that diameter is the allowed one of 300 MPa:

    >>> case = {"bore": 0.08, "width": 0.04, "yield_stress": 600e6, "safety": 2.0}
    >>> D = least_eyebar_diameter(100e3, **case)
    >>> stress = 100e3 * (D / 0.08 + 0.08 / D) / (0.04 * (D - 0.08))
    >>> print(f"{D * 1e3:.2f} mm, {stress / 1e6:.1f} MPa")
    96.98 mm, 300.0 MPa
    """

    # the largest load of an eye of infinite diameter
    capacity = yield_stress / safety * width * bore
    carried = np.minimum(load / capacity, 1.0)
    # eq. 14 is a quadratic in D, whose other root is negative
    root = np.sqrt(1 + 4 * carried - 4 * carried**2)
    with np.errstate(divide="ignore"):
        return bore * (1 + root) / np.asarray(2 * (1 - carried))[()]
