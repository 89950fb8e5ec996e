"""Design of a grease-lubricated pin joint after Strand (2005), chapter 2, in corrected form.

One function for each equation (the source has no equation 3); `erlif.joint.sizing` takes a joint
through all of them. Equations 6 to 9 are in `erlif.models.contact`, 26 to 32 in
`erlif.joint.models.wear`. The argument `safety` is the safety factor that the source calls eta.
"""

import numpy as np

from erlif.core.errors import ModelError
from erlif.models.arguments import Values, formula, require_between, require_increasing

# Hole over pin diameter up to which the stress concentration of eq. 4 is fitted. [1]
LARGEST_HOLE_RATIO = 0.2

# Largest length over diameter of a pin that stays in place, section 2.1.10. [1]
RECOMMENDED_SLENDERNESS = 3.0

# Brinell hardness in kgf/mm2 over tensile strength in MPa, for steel below 400 HB.
BRINELL_OVER_STRENGTH = 0.3

# Newton in a kilogram-force. [N/kgf]
STANDARD_GRAVITY = 9.80665

# Bushing width over pin diameter, eq. 11. [1]
RECOMMENDED_WIDTH = (0.5, 1.5)

# Outer over inner diameter of the housing eye, section 2.1.6. [1]
RECOMMENDED_HOUSING = (2.0, 4.0)

# Bending moment at the root of a closed prong over F L: 1 - 2 x 5/32. [1]
CLOSED_LOCK_MOMENT = 11 / 16

# Shear at the root of a closed prong over F: 1 - 5/32. [1]
CLOSED_LOCK_SHEAR = 27 / 32

# Play over pin diameter, eq. 23. [per mille]
RECOMMENDED_PLAY = (0.3, 5.0)


@formula()
def pin_diameter_in_shear(load: Values, *, yield_stress: Values, safety: Values) -> Values:
    """Compute the minimum diameter of a pin in double shear. Strand (2005), eq. 1.

    d = sqrt(2 sqrt(3) F eta / (pi sigma_y)).

    Parameters
    ----------
    load : float or array
        Load F. [N]
    safety : float or array
        Safety factor eta. [1]
    yield_stress : float or array
        Yield stress sigma_y of the pin. [Pa]

    Returns
    -------
    float or array
        Minimum diameter d. [m]

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


@formula()
def pin_diameter_in_bending(
    load: Values, *, free_length: Values, yield_stress: Values, safety: Values
) -> Values:
    """Compute the minimum diameter of a pin in bending. Strand (2005), eq. 2.

    d = (4 F L eta / (pi sigma_y))^(1/3): clamped at its seats, loaded in the middle.

    Parameters
    ----------
    load : float or array
        Load F. [N]
    safety : float or array
        Safety factor eta. [1]
    free_length : float or array
        Length L between the seats: bushing and lateral play. [m]
    yield_stress : float or array
        Yield stress sigma_y of the pin. [Pa]

    Returns
    -------
    float or array
        Minimum diameter d. [m]

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
    safety : float or array
        Safety factor eta. [1]
    free_length : float or array
        Length L between the seats: bushing and lateral play. [m]
    hole_ratio : float or array
        Hole diameter over pin diameter x, 0 to 0.2. [1]
    yield_stress : float or array
        Yield stress sigma_y of the pin. [Pa]

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

    >>> from erlif.joint.models.bearing import pin_diameter_in_bending
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
    load, length, diameter, youngs_modulus : float or array
        Load F in the middle [N], length L, both seats and the bushing [m], diameter d of the pin, I
        = pi d^4 / 64 [m], Young's modulus E of the pin [Pa].

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
    load, length, diameter, youngs_modulus : float or array
        As of `lateral_shift` [N, m, m, Pa]; A = pi d^2 / 4.

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


@formula()
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

    Examples
    --------
    >>> print(f"{least_projected_area(100e3, yield_stress=600e6) * 1e6:.1f} mm2")
    333.3 mm2
    """
    # half the yield stress is allowed, hence the factor 2
    return 2 * load / yield_stress


@formula()
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
    safety : float or array
        Safety factor eta. [1]
    diameter, hardness : float or array
        Diameter d of the pin [m], hardness H of the bushing [Pa].

    Returns
    -------
    float or array
        Minimum width w. [m]

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
    safety : float or array
        Safety factor eta. [1]
    load, diameter, hardness : float or array
        Load F on the joint [N], diameter d of the pin [m], hardness H of the seat [Pa].

    Returns
    -------
    float or array
        Minimum width s of one seat. [m]

    Examples
    --------
    Half of the width of a bushing of the same hardness:

    >>> width = least_seat_width(100e3, diameter=0.08, hardness=1.2e9, safety=2.0)
    >>> print(f"{width * 1e3:.3f} mm")
    2.653 mm
    """
    return least_bushing_width(load / 2, diameter=diameter, hardness=hardness, safety=safety)


@formula()
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


@formula()
def least_eyebar_diameter(
    load: Values, *, bore: Values, width: Values, yield_stress: Values, safety: Values
) -> Values:
    """Compute the minimum outer diameter of a housing eye. Strand (2005), eq. 14.

    The diameter D at which F (D/d + d/D) / (s (D - d)) = sigma_y / eta.

    Parameters
    ----------
    load : float or array
        Load F. [N]
    safety : float or array
        Safety factor eta. [1]
    bore, width, yield_stress : float or array
        Inner diameter d [m], width s of the eye [m], yield stress sigma_y of the housing [Pa].

    Returns
    -------
    float or array
        Minimum outer diameter D; infinite where no outer diameter carries the load (F from
        sigma_y s d / eta on). [m]

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


@formula(load="load or zero")
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
    diameter, lever : float or array
        Diameter d of the pin [m], distance R of the screw from the pin axis [m].
    friction_bushing, friction_seat : float or array
        Friction coefficients mu1 in the bushing and mu2 in the seats; the defaults are the worst
        case of the source. [1]

    Returns
    -------
    float or array
        Shear force, negative where the seats hold the pin more firmly than the bushing turns
        it. [N]

    Examples
    --------
    The torque F d / 2 of 4 kN m over a lever of 60 mm:

    >>> print(f"{lock_force(100e3, diameter=0.08, lever=0.06) / 1e3:.1f} kN")
    66.7 kN
    """
    # the bushing turns the pin, the seats hold it: their torques subtract
    return diameter * load * (friction_bushing - friction_seat) / (2 * lever)


@formula()
def least_weld_diameter(
    load: Values, *, pin_diameter: Values, throat: Values, yield_stress: Values, safety: Values
) -> Values:
    """Compute the minimum inner diameter of the round weld of a lock plate. Strand (2005), eq. 16.

    sqrt(sqrt(3) F d eta / (pi a sigma_y)) - sqrt(2) a.

    Parameters
    ----------
    pin_diameter : float or array
        Diameter d of the pin. [m]
    safety : float or array
        Safety factor eta. [1]
    load, throat, yield_stress : float or array
        Load F on the joint, with the friction of `lock_force` at its worst [N], effective throat a
        of the weld [m], yield stress sigma_y of the weld [Pa].

    Returns
    -------
    float or array
        Minimum inner diameter; not positive where a weld of any diameter is strong enough. [m]

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


@formula()
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

    Examples
    --------
    >>> print(f"{largest_internal_weld_diameter(0.08, throat=0.003) * 1e3:.2f} mm")
    65.51 mm
    """
    # the leg of a weld is sqrt(2) times its throat
    return pin_diameter - 2 * throat * (1 + np.sqrt(2))


@formula()
def least_open_prong_height(
    load: Values, *, thickness: Values, length: Values, yield_stress: Values, safety: Values
) -> Values:
    """Compute the minimum height of the prongs of an open lock plate. Strand (2005), eq. 18.

    h = sqrt(6F (F + sqrt(F^2 + 16 S^2 t^2 L^2))) / (2 S t), S = sigma_y / eta: bending and shear.

    Parameters
    ----------
    safety : float or array
        Safety factor eta. [1]
    load : float or array
        Lock force F, see `lock_force`. [N]
    thickness, length, yield_stress : float or array
        Plate thickness t [m], lever L of the force [m], yield stress sigma_y of the plate [Pa].

    Returns
    -------
    float or array
        Minimum height h. [m]

    Examples
    --------
    Bending and shear at the root add up to 300 MPa after von Mises:

    >>> plate = {"thickness": 0.01, "length": 0.03, "yield_stress": 600e6, "safety": 2.0}
    >>> h = least_open_prong_height(10e3, **plate)
    >>> bending, shear = 6 * 10e3 * 0.03 / (0.01 * h**2), 10e3 / (0.01 * h)
    >>> print(f"{h * 1e3:.2f} mm, {(bending**2 + 3 * shear**2) ** 0.5 / 1e6:.1f} MPa")
    24.84 mm, 300.0 MPa
    """
    return _prong_height(load, length, yield_stress * thickness / safety)


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

    Examples
    --------
    >>> end_force_of_closed_lock(32.0)
    5.0
    """
    return 5 * load / 32  # equal deflection of both prongs at twice the lever of the force


@formula()
def least_closed_prong_height(
    load: Values, *, thickness: Values, length: Values, yield_stress: Values, safety: Values
) -> Values:
    """Compute the minimum prong height of a closed lock plate. Strand (2005), eqs. 19 and 20.

    Bending and shear at the root, where the moment is 11 F L / 16 and the shear 27 F / 32.

    Parameters
    ----------
    safety : float or array
        Safety factor eta. [1]
    load : float or array
        Lock force F, see `lock_force`. [N]
    thickness, length, yield_stress : float or array
        Plate thickness t [m], lever L of the force [m], yield stress sigma_y of the plate [Pa].

    Returns
    -------
    float or array
        Minimum height h. [m]

    Notes
    -----
    The source takes F/2 for the shear; with 5F/32 taken at the closed end the root carries 27F/32.

    Examples
    --------
    With 27/32 of the force in shear, and as printed with half of it:
    sqrt(6F (F + sqrt(F^2 + 121 S^2 t^2 L^2))) / (4 S t).

    >>> from math import sqrt
    >>> plate = {"thickness": 0.01, "length": 0.03, "yield_stress": 600e6, "safety": 2.0}
    >>> height = least_closed_prong_height(10e3, **plate)
    >>> St, F = 300e6 * 0.01, 10e3
    >>> printed = sqrt(6 * F * (F + sqrt(F**2 + 121 * (St * 0.03) ** 2))) / (4 * St)
    >>> print(f"{height * 1e3:.3f} mm, {printed * 1e3:.3f} mm")
    20.604 mm, 20.413 mm
    """
    allowed = yield_stress * thickness / safety
    return _prong_height(load, length, allowed, CLOSED_LOCK_MOMENT, CLOSED_LOCK_SHEAR)


@formula(load="number")
def least_closed_end_width(
    load: Values, *, thickness: Values, yield_stress: Values, safety: Values
) -> Values:
    """Compute the minimum width of the closed end of a lock plate. Strand (2005), first eq. 21.

    c = 5 F eta / (32 sigma_y t).

    Parameters
    ----------
    safety : float or array
        Safety factor eta. [1]
    load : float or array
        Lock force F, see `lock_force`. [N]
    thickness, yield_stress : float or array
        Plate thickness t [m], yield stress sigma_y of the plate [Pa].

    Returns
    -------
    float or array
        Minimum width c. [m]

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
    load: Values, length: Values, allowed: Values, moment: float = 1.0, shear: float = 1.0
) -> Values:
    """Height [m] at which a bending moment and a shear, over F L and F, reach yield at the root."""
    # von Mises: (bent / h^2)^2 + sheared / h^2 = allowed^2, a quadratic in h^2
    sheared = 3 * (shear * load) ** 2
    bent = 6 * moment * load * length
    return np.sqrt((sheared + np.sqrt(sheared**2 + (2 * allowed * bent) ** 2)) / 2) / allowed


@formula()
def relative_play(pin_diameter: Values, *, bore: Values) -> Values:
    """Compute the relative play of a joint: (D - d) / d. Strand (2005), eq. 23.

    Parameters
    ----------
    pin_diameter : float or array
        Diameter d of the pin. [m]
    bore : float or array
        Diameter D of the bore. [m]

    Returns
    -------
    float or array
        Relative play, negative for an interference; 0.3e-3 to 5e-3 is recommended. [1]

    Examples
    --------
    The joint of Farzaneh (2002) lies outside the recommended range:

    >>> print(f"{1e3 * relative_play(0.06672, bore=0.06718):.2f} per mille")
    6.89 per mille
    """
    return (bore - pin_diameter) / pin_diameter


@formula(interference="signed length")
def press_fit_displacement(
    interference: Values,
    *,
    bore: Values,
    fit_diameter: Values,
    housing_diameter: Values,
    youngs_bushing: Values,
    poisson_bushing: Values,
    youngs_housing: Values,
    poisson_housing: Values,
) -> Values:
    """Compute the displacement of the bore of a pressed-in bushing. Strand (2005), eqs. 24 and 25.

    u = -Delta d_b D / {E_b (D^2 - d_b^2) [(k_h + nu_h)/E_h + (k_b - nu_b)/E_b]},
    k_h = (D_h^2 + D^2)/(D_h^2 - D^2), k_b = (D^2 + d_b^2)/(D^2 - d_b^2): Lame's rings in plane
    stress. With one material this is eq. 24.

    Parameters
    ----------
    interference, bore, fit_diameter, housing_diameter : float or array
        Outer diameter of the bushing less bore of the housing, Delta [m], inner diameter d_b and
        outer diameter D of the bushing, outer diameter D_h of the housing [m].
    youngs_bushing, youngs_housing, poisson_bushing, poisson_housing : float or array
        Young's moduli E_b and E_h [Pa], Poisson's ratios nu_b and nu_h [1].

    Returns
    -------
    float or array
        Radial displacement u of the bore, negative where it shrinks (by 2u in diameter). [m]

    Raises
    ------
    ModelError
        A diameter or modulus not positive or not finite, a Poisson's ratio outside -1 to 0.5,
        diameters that do not grow from bore to housing, or an infinite interference.

    Notes
    -----
    Eq. 25 prints d_b D^2 (3 nu_h - 5)/4 where d_b D belongs; with equal materials the print does
    not become eq. 24. Delta is a play in the nomenclature of the source and an interference here.

    Examples
    --------
    A steel bushing in a steel housing, against eq. 24:

    >>> steel = {"youngs_bushing": 206e9, "youngs_housing": 206e9}
    >>> steel |= {"poisson_bushing": 0.3, "poisson_housing": 0.3}
    >>> u = press_fit_displacement(
    ...     60e-6, bore=0.07, fit_diameter=0.08, housing_diameter=0.16, **steel
    ... )
    >>> print(f"{u * 1e6:.3f} um, {-30 * 7 / 8 * (16**2 - 8**2) / (16**2 - 7**2):.3f} um")
    -24.348 um, -24.348 um
    """
    require_increasing(bore=bore, fit_diameter=fit_diameter, housing_diameter=housing_diameter)

    # radial displacement of each ring at the fit, over radius and pressure (Lame)
    k_h = (housing_diameter**2 + fit_diameter**2) / (housing_diameter**2 - fit_diameter**2)
    k_b = (fit_diameter**2 + bore**2) / (fit_diameter**2 - bore**2)
    compliance = (k_h + poisson_housing) / youngs_housing + (k_b - poisson_bushing) / youngs_bushing
    stiffness = youngs_bushing * (fit_diameter**2 - bore**2) * compliance
    return -interference * bore * fit_diameter / stiffness
