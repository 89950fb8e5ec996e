"""The lock plate: its screw, weld, prongs and closed end. Strand (2005), eqs. 15 to 21."""

import numpy as np

from erlif.models.arguments import (
    Values,
    formula,
)

CLOSED_LOCK_MOMENT = 11 / 16
"""Bending moment at the root of a closed prong over F L: 1 - 2 x 5/32. [1]"""

CLOSED_LOCK_SHEAR = 27 / 32
"""Shear at the root of a closed prong over F: 1 - 5/32. [1]"""


@formula(
    lever="length",
    load="load or zero",
    friction_bushing="number or zero",
    friction_seat="number or zero",
)
def lock_force(
    load: Values,
    *,
    diameter: Values,
    lever: Values,
    friction_bushing: Values = 1.0,
    friction_seat: Values = 0.0,
) -> Values:
    """Compute the shear force on the screw of the lock plate. Strand (2005), eq. 15.

    d F (mu1 - mu2) / (2R).

    Parameters
    ----------
    load : float or array
        Load F. [N]
    diameter : float or array
        Diameter d of the pin. [m]
    lever : float or array
        Distance R of the screw from the pin axis. [m]
    friction_bushing, friction_seat : float or array
        Friction coefficients mu1 in the bushing and mu2 in the seats; the defaults are the worst
        case of the source. [1]

    Returns
    -------
    float or array
        Shear force, negative where the seats hold the pin more firmly than the bushing turns it.
        [N]

    Raises
    ------
    ModelError
        A length not positive, a load or friction negative, or an infinite value.

    Examples
    --------
    The torque F d / 2 of 4 kN m over a lever of 60 mm:

    >>> print(f"{lock_force(100e3, diameter=0.08, lever=0.06) / 1e3:.1f} kN")
    66.7 kN
    """
    # the bushing turns the pin, the seats hold it: their torques subtract
    return diameter * load * (friction_bushing - friction_seat) / (2 * lever)


@formula(throat="length", yield_stress="strength", safety="number")
def least_weld_diameter(
    load: Values, *, pin_diameter: Values, throat: Values, yield_stress: Values, safety: Values
) -> Values:
    """Compute the minimum inner diameter of the round weld of a lock plate. Strand (2005), eq. 16.

    sqrt(sqrt(3) F d eta / (pi a sigma_y)) - sqrt(2) a.

    Parameters
    ----------
    load : float or array
        Load F on the joint, with the friction of `lock_force` at its worst. [N]
    pin_diameter : float or array
        Diameter d of the pin. [m]
    throat : float or array
        Effective throat a of the weld. [m]
    yield_stress : float or array
        Yield stress sigma_y of the weld. [Pa]
    safety : float or array
        Safety factor eta. [1]

    Returns
    -------
    float or array
        Minimum inner diameter; not positive where a weld of any diameter is strong enough. [m]

    Raises
    ------
    ModelError
        A value not positive or not finite.

    Notes
    -----
    The weld has legs of sqrt(2) a, from the inner diameter D to D + 2 sqrt(2) a (eq. 17), so its
    mean diameter is D + sqrt(2) a. The text of the source at hand has lost its root signs and shows
    2a in both equations. The throat plane of a weld around the pin is nearer to the pin, at
    D + a / sqrt(2) in the mean. Static strength only, not fatigue.

    Examples
    --------
    Under the torque F d / 2 the weld is loaded with 300 MPa, half of its yield stress:

    >>> from math import pi, sqrt
    >>> case = {"pin_diameter": 0.08, "throat": 0.003, "yield_stress": 600e6, "safety": 2.0}
    >>> inner = least_weld_diameter(100e3, **case)
    >>> stress = sqrt(3) * 100e3 * 0.04 / (pi * 0.003 / 2 * (inner + sqrt(2) * 0.003) ** 2)
    >>> print(f"{inner * 1e3:.3f} mm, {stress / 1e6:.1f} MPa")
    65.762 mm, 300.0 MPa
    """
    # torque F d / 2 in a thin ring of the diameter of the weld, sheared at sigma_y / sqrt(3)
    mean = np.sqrt(np.sqrt(3) * load * pin_diameter * safety / (np.pi * throat * yield_stress))
    return mean - np.sqrt(2) * throat


@formula(throat="length")
def largest_internal_weld_diameter(pin_diameter: Values, *, throat: Values) -> Values:
    """Compute the largest inner diameter of an internal weld. Strand (2005), eq. 17.

    d - 2a (1 + sqrt(2)) keeps it clear of the hardened surface.

    Parameters
    ----------
    pin_diameter : float or array
        Diameter d of the pin. [m]
    throat : float or array
        Effective throat a of the weld. [m]

    Returns
    -------
    float or array
        Largest inner diameter; not positive where the throat is too large for the pin. [m]

    Raises
    ------
    ModelError
        A value not positive or not finite.

    Examples
    --------
    >>> print(f"{largest_internal_weld_diameter(0.08, throat=0.003) * 1e3:.2f} mm")
    65.51 mm
    """
    # the leg of a weld is sqrt(2) times its throat
    return pin_diameter - 2 * throat * (1 + np.sqrt(2))


@formula(yield_stress="strength", safety="number")
def least_open_prong_height(
    load: Values, *, thickness: Values, length: Values, yield_stress: Values, safety: Values
) -> Values:
    """Compute the minimum height of the prongs of an open lock plate. Strand (2005), eq. 18.

    h = sqrt(6F (F + sqrt(F^2 + 16 S^2 t^2 L^2))) / (2 S t), S = sigma_y / eta: bending and shear.

    Parameters
    ----------
    load : float or array
        Lock force F, see `lock_force`. [N]
    thickness : float or array
        Plate thickness t. [m]
    length : float or array
        Lever L of the force. [m]
    yield_stress : float or array
        Yield stress sigma_y of the plate. [Pa]
    safety : float or array
        Safety factor eta. [1]

    Returns
    -------
    float or array
        Minimum height h. [m]

    Raises
    ------
    ModelError
        A value not positive or not finite.

    Examples
    --------
    Bending and shear at the root add up to 300 MPa after von Mises:

    >>> plate = {"thickness": 0.01, "length": 0.03, "yield_stress": 600e6, "safety": 2.0}
    >>> h = least_open_prong_height(10e3, **plate)
    >>> bending, shear = 6 * 10e3 * 0.03 / (0.01 * h**2), 10e3 / (0.01 * h)
    >>> print(f"{h * 1e3:.2f} mm, {(bending**2 + 3 * shear**2) ** 0.5 / 1e6:.1f} MPa")
    24.84 mm, 300.0 MPa
    """
    plate = {"thickness": thickness, "length": length, "yield_stress": yield_stress}
    return _prong_height(load, moment=1.0, shear=1.0, safety=safety, **plate)


@formula(load="signed load")
def end_force_of_closed_lock(load: Values) -> Values:
    """Compute the force at the closed end of a lock plate: 5F/32. Strand (2005), eq. 19.

    Parameters
    ----------
    load : float or array
        Lock force F. [N]

    Returns
    -------
    float or array
        Force that the closed end passes to the unloaded prong. [N]

    Raises
    ------
    ModelError
        An infinite load.

    Examples
    --------
    >>> end_force_of_closed_lock(32.0)
    5.0
    """
    return 5 * load / 32  # equal deflection of both prongs at twice the lever of the force


@formula(yield_stress="strength", safety="number", root_shear="number")
def least_closed_prong_height(
    load: Values,
    *,
    thickness: Values,
    length: Values,
    yield_stress: Values,
    safety: Values,
    root_shear: Values = CLOSED_LOCK_SHEAR,
) -> Values:
    """Compute the minimum prong height of a closed lock plate. Strand (2005), eqs. 19 and 20.

    Bending and shear at the root, where the moment is 11 F L / 16.

    Parameters
    ----------
    load : float or array
        Lock force F, see `lock_force`. [N]
    thickness : float or array
        Plate thickness t. [m]
    length : float or array
        Lever L of the force. [m]
    yield_stress : float or array
        Yield stress sigma_y of the plate. [Pa]
    safety : float or array
        Safety factor eta. [1]
    root_shear : float or array
        Share of the force that shears the root. [1]

    Returns
    -------
    float or array
        Minimum height h. [m]

    Raises
    ------
    ModelError
        A value not positive or not finite.

    Notes
    -----
    The source takes F/2 for the shear; with 5F/32 taken at the closed end the root carries 27F/32.
    `root_shear=0.5` gives its equation.

    Examples
    --------
    As printed, with half of the force in shear:
    sqrt(6F (F + sqrt(F^2 + 121 S^2 t^2 L^2))) / (4 S t).

    >>> from math import sqrt
    >>> plate = {"thickness": 0.01, "length": 0.03, "yield_stress": 600e6, "safety": 2.0}
    >>> height = least_closed_prong_height(10e3, root_shear=0.5, **plate)
    >>> St, F = 300e6 * 0.01, 10e3
    >>> printed = sqrt(6 * F * (F + sqrt(F**2 + 121 * (St * 0.03) ** 2))) / (4 * St)
    >>> print(f"{height * 1e3:.3f} mm, {printed * 1e3:.3f} mm")
    20.413 mm, 20.413 mm
    """
    plate = {"thickness": thickness, "length": length, "yield_stress": yield_stress}
    return _prong_height(load, moment=CLOSED_LOCK_MOMENT, shear=root_shear, safety=safety, **plate)


@formula(load="number", yield_stress="strength", safety="number")
def least_closed_end_width(
    load: Values, *, thickness: Values, yield_stress: Values, safety: Values
) -> Values:
    """Compute the minimum width of the closed end of a lock plate. Strand (2005), first eq. 21.

    c = 5 F eta / (32 sigma_y t).

    Parameters
    ----------
    load : float or array
        Lock force F, see `lock_force`. [N]
    thickness : float or array
        Plate thickness t. [m]
    yield_stress : float or array
        Yield stress sigma_y of the plate. [Pa]
    safety : float or array
        Safety factor eta. [1]

    Returns
    -------
    float or array
        Minimum width c. [m]

    Raises
    ------
    ModelError
        A value not positive or not finite.

    Notes
    -----
    The source calls this the eyebar width and gives the number 21 to two equations.

    Examples
    --------
    The end force of 5 kN in a section of 10 mm at 300 MPa:

    >>> width = least_closed_end_width(32e3, thickness=0.01, yield_stress=600e6, safety=2.0)
    >>> print(f"{width * 1e3:.3f} mm")
    1.667 mm
    """
    return end_force_of_closed_lock(load) * safety / (yield_stress * thickness)


def _prong_height(
    load: Values,
    *,
    moment: float,
    shear: Values,
    thickness: Values,
    length: Values,
    yield_stress: Values,
    safety: Values,
) -> Values:
    """Height [m] at which a bending moment and a shear, over F L and F, reach yield at the root."""
    # von Mises: (bent / h^2)^2 + sheared / h^2 = allowed^2, a quadratic in h^2
    allowed = yield_stress * thickness / safety
    sheared = 3 * (shear * load) ** 2
    bent = 6 * moment * load * length
    return np.sqrt((sheared + np.sqrt(sheared**2 + (2 * allowed * bent) ** 2)) / 2) / allowed
