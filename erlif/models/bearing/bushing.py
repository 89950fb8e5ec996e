"""The bushing and the seats of the pin: area and widths. Strand (2005), eqs. 5, 10, 12 and 13."""

import numpy as np

from erlif.models.arguments import (
    Values,
    formula,
)

BRINELL_OVER_STRENGTH = 0.3
"""Brinell hardness in kgf/mm2 over tensile strength in MPa, for steel below 400 HB."""

STANDARD_GRAVITY = 9.80665
"""Newton in a kilogram-force. [N/kgf]"""

RECOMMENDED_WIDTH = (0.5, 1.5)
"""Bushing width over pin diameter, eq. 11. [1]"""


@formula(yield_stress="strength")
def least_projected_area(load: Values, *, yield_stress: Values) -> Values:
    """Compute the minimum projected area d w of a joint. Strand (2005), eq. 5.

    2F / sigma_y keeps the projected pressure at half the yield stress of the softer body, against
    seizure at speeds below 0.02 m/s.

    Parameters
    ----------
    load : float or array
        Load F. [N]
    yield_stress : float or array
        Yield stress sigma_y of the softer body. [Pa]

    Returns
    -------
    float or array
        Minimum of pin diameter times bushing width. [m2]

    Raises
    ------
    ModelError
        A value not positive or not finite.

    Examples
    --------
    >>> print(f"{least_projected_area(100e3, yield_stress=600e6) * 1e6:.1f} mm2")
    333.3 mm2
    """
    # half the yield stress is allowed, hence the factor 2
    return 2 * load / yield_stress


@formula(safety="number")
def least_bushing_width(
    load: Values, *, diameter: Values, hardness: Values, safety: Values
) -> Values:
    """Compute the minimum width of a bushing whose edges stay elastic. Strand (2005), eq. 10.

    w = 8 F eta / (pi d H): the line load at the edge is twice the mean (a triangle along the axis),
    the pressure a cosine around it.

    Parameters
    ----------
    load : float or array
        Load F. [N]
    diameter : float or array
        Diameter d of the pin. [m]
    hardness : float or array
        Hardness H of the bushing. [Pa]
    safety : float or array
        Safety factor eta. [1]

    Returns
    -------
    float or array
        Minimum width w. [m]

    Raises
    ------
    ModelError
        A value not positive or not finite.

    Examples
    --------
    At that width the peak of the cosine under twice the mean line load is half of 1.2 GPa:

    >>> from erlif.models.contact import sinusoidal_pressure
    >>> width = least_bushing_width(100e3, diameter=0.08, hardness=1.2e9, safety=2.0)
    >>> edge = sinusoidal_pressure(2 * 100e3 / width, pin_diameter=0.08)
    >>> print(f"{width * 1e3:.3f} mm, {edge / 1e6:.1f} MPa")
    5.305 mm, 600.0 MPa
    """
    # 2 from the triangle along the axis, 4/pi from the cosine around the pin
    return 8 * load * safety / (np.pi * diameter * hardness)


@formula()
def least_seat_width(load: Values, *, diameter: Values, hardness: Values, safety: Values) -> Values:
    """Compute the minimum width of each of the two pin seats. Strand (2005), eq. 12.

    s = 4 F eta / (pi d H); each seat carries F/2.

    Parameters
    ----------
    load : float or array
        Load F on the joint. [N]
    diameter : float or array
        Diameter d of the pin. [m]
    hardness : float or array
        Hardness H of the seat. [Pa]
    safety : float or array
        Safety factor eta. [1]

    Returns
    -------
    float or array
        Minimum width s of one seat. [m]

    Raises
    ------
    ModelError
        A value not positive or not finite.

    Examples
    --------
    Half of the width of a bushing of the same hardness:

    >>> width = least_seat_width(100e3, diameter=0.08, hardness=1.2e9, safety=2.0)
    >>> print(f"{width * 1e3:.3f} mm")
    2.653 mm
    """
    return least_bushing_width(load / 2, diameter=diameter, hardness=hardness, safety=safety)


@formula(ultimate_stress="strength")
def hardness_from_strength(ultimate_stress: Values) -> Values:
    """Estimate the Brinell hardness of a steel below 400 HB. Strand (2005), eq. 13.

    H = 0.3 x 9.80665 sigma.

    Parameters
    ----------
    ultimate_stress : float or array
        Tensile strength sigma. [Pa]

    Returns
    -------
    float or array
        Brinell hardness H. [Pa]

    Raises
    ------
    ModelError
        A strength not positive or not finite.

    Notes
    -----
    The source prints H = 0.3 sigma, which is the hardness in kgf/mm2 for a strength in MPa; in
    pascal the factor is 2.942.

    Examples
    --------
    A steel of 800 MPa has 240 HB, which is 2354 MPa:

    >>> hardness = hardness_from_strength(800e6)
    >>> print(f"{hardness / 1e6:.0f} MPa, {hardness / 9.80665e6:.0f} HB")
    2354 MPa, 240 HB
    """
    # kgf/mm2 to MPa; strength and hardness then share their unit
    return BRINELL_OVER_STRENGTH * STANDARD_GRAVITY * ultimate_stress
