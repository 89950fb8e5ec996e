"""The pin: shear, bending, a lubrication hole, and what keeps it from moving sideways.

Strand (2005), eqs. 1, 2, 4, 21 and 22; the source has no equation 3.
"""

import numpy as np

from erlif.core.errors import ModelError
from erlif.models.arguments import (
    Values,
    formula,
    require_between,
)

LARGEST_HOLE_RATIO = 0.2
"""Hole over pin diameter up to which the stress concentration of eq. 4 is fitted. [1]"""

RECOMMENDED_SLENDERNESS = 3.0
"""Largest length over diameter of a pin that stays in place, section 2.1.10. [1]"""


@formula(yield_stress="strength", safety="number")
def pin_diameter_in_shear(load: Values, *, yield_stress: Values, safety: Values) -> Values:
    """Compute the minimum diameter of a pin in double shear. Strand (2005), eq. 1.

    d = sqrt(2 sqrt(3) F eta / (pi sigma_y)).

    Parameters
    ----------
    load : float or array
        Load F. [N]
    yield_stress : float or array
        Yield stress sigma_y of the pin. [Pa]
    safety : float or array
        Safety factor eta. [1]

    Returns
    -------
    float or array
        Minimum diameter d. [m]

    Raises
    ------
    ModelError
        A value not positive or not finite.

    Examples
    --------
    In the two sections the shear stress times sqrt(3) is the allowed stress of 300 MPa:

    >>> from math import pi, sqrt
    >>> diameter = pin_diameter_in_shear(100e3, yield_stress=600e6, safety=2.0)
    >>> print(f"{diameter * 1e3:.2f} mm, {sqrt(3) * 50e3 / (pi * diameter**2 / 4) / 1e6:.1f} MPa")
    19.17 mm, 300.0 MPa
    """
    # two sections carry F/2 each; after von Mises steel yields in shear at sigma_y / sqrt(3)
    return np.sqrt(2 * np.sqrt(3) * load * safety / (np.pi * yield_stress))


@formula(free_length="length", yield_stress="strength", safety="number")
def pin_diameter_in_bending(
    load: Values, *, free_length: Values, yield_stress: Values, safety: Values
) -> Values:
    """Compute the minimum diameter of a pin in bending. Strand (2005), eq. 2.

    d = (4 F L eta / (pi sigma_y))^(1/3): clamped at its seats, loaded in the middle.

    Parameters
    ----------
    load : float or array
        Load F. [N]
    free_length : float or array
        Length L between the seats: bushing and lateral play. [m]
    yield_stress : float or array
        Yield stress sigma_y of the pin. [Pa]
    safety : float or array
        Safety factor eta. [1]

    Returns
    -------
    float or array
        Minimum diameter d. [m]

    Raises
    ------
    ModelError
        A value not positive or not finite.

    Examples
    --------
    The bending moment F L / 8 over the section modulus is the allowed stress of 300 MPa:

    >>> from math import pi
    >>> case = {"free_length": 0.12, "yield_stress": 600e6, "safety": 2.0}
    >>> d = pin_diameter_in_bending(100e3, **case)
    >>> print(f"{d * 1e3:.2f} mm, {100e3 * 0.12 / 8 / (pi * d**3 / 32) / 1e6:.1f} MPa")
    37.07 mm, 300.0 MPa
    """
    # moment F L / 8 of a clamped beam over the section modulus pi d^3 / 32
    return (4 * load * free_length * safety / (np.pi * yield_stress)) ** (1 / 3)


@formula()
def hole_stress_concentration(hole_ratio: Values) -> Values:
    """Compute K_t of a transverse hole in a round pin in bending. Strand (2005), eq. 4.

    K_t = 3 - 11.3 x + 51.6 x^2 - 114.6 x^3 + 76.4 x^4, on the stress of the weakened section.

    Parameters
    ----------
    hole_ratio : float or array
        Hole diameter over pin diameter x, 0 to 0.2. [1]

    Returns
    -------
    float or array
        Stress concentration K_t. [1]

    Raises
    ------
    ModelError
        A ratio outside 0 to 0.2.

    Examples
    --------
    A vanishing hole triples the stress, as in a plate in tension:

    >>> hole_stress_concentration(0.0)
    3.0
    """
    require_between(0.0, LARGEST_HOLE_RATIO, hole_ratio=hole_ratio)
    x = hole_ratio  # a polynomial fit, which holds inside its range only
    return 3 + x * (-11.3 + x * (51.6 + x * (-114.6 + x * 76.4)))


@formula()
def pin_diameter_with_hole(
    load: Values, *, free_length: Values, hole_ratio: Values, yield_stress: Values, safety: Values
) -> Values:
    """Compute the minimum diameter of a pin with a lubrication hole. Strand (2005), eq. 4.

    d = [4 F L eta K_t / (pi sigma_y (1 - 16 x / (3 pi)))]^(1/3), with the hole across the pin where
    bending is largest.

    Parameters
    ----------
    load : float or array
        Load F. [N]
    free_length : float or array
        Length L between the seats: bushing and lateral play. [m]
    hole_ratio : float or array
        Hole diameter over pin diameter x, 0 to 0.2. [1]
    yield_stress : float or array
        Yield stress sigma_y of the pin. [Pa]
    safety : float or array
        Safety factor eta. [1]

    Returns
    -------
    float or array
        Minimum diameter d. [m]

    Raises
    ------
    ModelError
        A value not positive or not finite, or a ratio outside 0 to 0.2.

    Notes
    -----
    The section modulus of the weakened section is pi d^3/32 - hole d^2/6; the source prints
    8/(3 pi) for 16/(3 pi). The diameter then grows by 40 to 45 %, not 34 to 44 %.

    Examples
    --------
    A vanishing hole makes the pin thicker by the cube root of its K_t of 3:

    >>> from erlif.models.bearing import pin_diameter_in_bending
    >>> case = {"free_length": 0.12, "yield_stress": 600e6, "safety": 2.0}
    >>> factor = pin_diameter_with_hole(100e3, hole_ratio=0.0, **case)
    >>> factor /= pin_diameter_in_bending(100e3, **case)
    >>> print(f"{factor:.4f} {3 ** (1 / 3):.4f}")
    1.4422 1.4422
    """
    plain = pin_diameter_in_bending(
        load, free_length=free_length, yield_stress=yield_stress, safety=safety
    )
    # the stress is that of the weakened section, so both its loss and K_t thicken the pin
    return plain * (
        hole_stress_concentration(hole_ratio) / (1 - 16 * hole_ratio / (3 * np.pi))
    ) ** (1 / 3)


@formula(load="signed load")
def lateral_shift(
    load: Values, *, length: Values, diameter: Values, youngs_modulus: Values
) -> Values:
    """Compute the shortening of a bent pin between its ends. Strand (2005), second eq. 21.

    dL = L [1 - sqrt(1 - (F L^2 / (24 E I))^2)].

    Parameters
    ----------
    load : float or array
        Load F in the middle. [N]
    length : float or array
        Length L, both seats and the bushing. [m]
    diameter : float or array
        Diameter d of the pin, I = pi d^4 / 64. [m]
    youngs_modulus : float or array
        Young's modulus E of the pin. [Pa]

    Returns
    -------
    float or array
        Shortening dL. [m]

    Raises
    ------
    ModelError
        A dimension or modulus not positive, an infinite value, or a load that would bend the pin
        beyond a right angle.

    Notes
    -----
    Simply supported here and clamped in eq. 2. Two straight halves shorten by 5/6 of what the bent
    line does.

    Examples
    --------
    A steel pin of 80 mm over 180 mm under 100 kN: small slopes shorten by L slope^2 / 2.

    >>> from math import pi
    >>> shift = lateral_shift(100e3, length=0.18, diameter=0.08, youngs_modulus=206e9)
    >>> slope = 100e3 * 0.18**2 / (24 * 206e9 * pi * 0.08**4 / 64)
    >>> print(f"{shift * 1e9:.3f} nm, {0.18 * slope**2 / 2 * 1e9:.3f} nm")
    9.561 nm, 9.561 nm
    """

    # sine of the angle of the straight halves: the deflection in the middle over L/2
    slope = load * length**2 / (24 * youngs_modulus * np.pi * diameter**4 / 64)
    steepest = np.abs(slope)
    if np.any(np.greater(steepest, 1)):
        raise ModelError(
            "load must stay below 24 E I / length^2, where the straight halves of the pin would "
            f"fold, got {float(np.nanmax(np.asarray(steepest))):.3g} times that."
        )
    # the difference 1 - sqrt(1 - slope^2) without the loss of digits at small slopes
    return length * slope**2 / (1 + np.sqrt(1 - slope**2))


@formula(load="signed load")
def lateral_force(
    load: Values, *, length: Values, diameter: Values, youngs_modulus: Values
) -> Values:
    """Compute the force that keeps the end of a bent pin in place. Strand (2005), eq. 22.

    E A dL / L, with no friction in the seat.

    Parameters
    ----------
    load : float or array
        Load F in the middle. [N]
    length : float or array
        Length L, both seats and the bushing. [m]
    diameter : float or array
        Diameter d of the pin, A = pi d^2 / 4. [m]
    youngs_modulus : float or array
        Young's modulus E of the pin. [Pa]

    Returns
    -------
    float or array
        Axial force. [N]

    Raises
    ------
    ModelError
        As `lateral_shift`.

    Examples
    --------
    The shift of 9.561 nm over 180 mm as a strain of steel:

    >>> from math import pi
    >>> force = lateral_force(100e3, length=0.18, diameter=0.08, youngs_modulus=206e9)
    >>> print(f"{force:.1f} N, {206e9 * pi * 0.08**2 / 4 * 9.561e-9 / 0.18:.1f} N")
    55.0 N, 55.0 N
    """
    shift = lateral_shift(load, length=length, diameter=diameter, youngs_modulus=youngs_modulus)
    # the shortening as a strain of the whole pin
    return youngs_modulus * np.pi * diameter**2 / 4 * shift / length
