"""Design of a grease-lubricated pin joint: the equations of Strand (2005), chapter 2, in corrected form, and a walk through.

Equations 6 to 9 are in `erlif.models.contact`, 26 to 32 in `erlif.models.wear`; the source has no equation 3. `safety` is
its safety factor, called eta there.
"""

from dataclasses import dataclass

import numpy as np

from erlif.core.errors import ModelError
from erlif.models.arguments import (
    Values,
    require_between,
    require_not_negative,
    require_poisson,
    require_positive,
)
from erlif.models.contact import persson_contact
from erlif.models.wear import friction_heat, mean_sliding_speed, pressure_velocity


def pin_diameter_in_shear(load: Values, *, yield_stress: Values, safety: Values) -> Values:
    """Least diameter [m] of a pin in double shear: d = sqrt(2 sqrt(3) F eta / (pi sigma_y)). Strand (2005), eq. 1.

    Parameters
    ----------
    load : float or array
        F. [N]
    yield_stress : float or array
        sigma_y of the pin. [Pa]
    safety : float or array
        Safety factor. [1]
    """
    require_positive(load=load, yield_stress=yield_stress, safety=safety)
    return np.sqrt(2 * np.sqrt(3) * load * safety / (np.pi * yield_stress))


def pin_diameter_in_bending(
    load: Values, *, free_length: Values, yield_stress: Values, safety: Values
) -> Values:
    """Least diameter [m] of a pin clamped at its seats, loaded in the middle: (4 F L eta / (pi sigma_y))^(1/3). Eq. 2.

    Parameters as in `pin_diameter_in_shear`, with the length L between the seats, bushing and lateral play [m].
    """
    require_positive(load=load, free_length=free_length, yield_stress=yield_stress, safety=safety)
    return (4 * load * free_length * safety / (np.pi * yield_stress)) ** (1 / 3)


def hole_stress_concentration(hole_ratio: Values) -> Values:
    """K_t [1] of a transverse hole in a round pin in bending, on the stress of the weakened section. Strand (2005), eq. 4.

    3 - 11.3 x + 51.6 x^2 - 114.6 x^3 + 76.4 x^4 with x hole over pin diameter, 0 to 0.2.
    """
    require_between(0.0, 0.2, hole_ratio=hole_ratio)
    x = hole_ratio
    return 3 + x * (-11.3 + x * (51.6 + x * (-114.6 + x * 76.4)))


def pin_diameter_with_hole(
    load: Values, *, free_length: Values, hole_ratio: Values, yield_stress: Values, safety: Values
) -> Values:
    """Least diameter [m] of a pin with a lubrication hole across it, where bending is largest. Strand (2005), eq. 4.

    d = [4 F L eta K_t / (pi sigma_y (1 - 16 x / (3 pi)))]^(1/3), x hole over pin diameter.

    Parameters as in `pin_diameter_in_bending` and `hole_stress_concentration`.

    Notes
    -----
    The section modulus of the weakened section is pi d^3/32 - hole d^2/6; the source prints 8/(3 pi) for 16/(3 pi). The
    diameter then grows by 40 to 45 %, not 34 to 44 %.
    """
    plain = pin_diameter_in_bending(
        load, free_length=free_length, yield_stress=yield_stress, safety=safety
    )
    return plain * (
        hole_stress_concentration(hole_ratio) / (1 - 16 * hole_ratio / (3 * np.pi))
    ) ** (1 / 3)


def least_projected_area(load: Values, *, yield_stress: Values) -> Values:
    """Least projected area d w [m2] that keeps p at half the yield stress of the softer body: 2F / sigma_y. Eq. 5.

    Against seizure at speeds below 0.02 m/s. Load in N, stress in Pa.
    """
    require_positive(load=load, yield_stress=yield_stress)
    return 2 * load / yield_stress


def least_bushing_width(
    load: Values, *, diameter: Values, hardness: Values, safety: Values
) -> Values:
    """Least width [m] of a bushing whose edges stay elastic: w = 8 F eta / (pi d H). Strand (2005), eq. 10.

    The line load at the edge is twice the mean (a triangle), the pressure a cosine around it.

    Parameters
    ----------
    load : float or array
        F. [N]
    diameter : float or array
        Of the pin. [m]
    hardness : float or array
        H of the bushing. [Pa]
    safety : float or array
        [1]
    """
    require_positive(load=load, diameter=diameter, hardness=hardness, safety=safety)
    return 8 * load * safety / (np.pi * diameter * hardness)


def least_seat_width(load: Values, *, diameter: Values, hardness: Values, safety: Values) -> Values:
    """Least width [m] of each of the two pin seats: s = 4 F eta / (pi d H). Strand (2005), eq. 12.

    Parameters as in `least_bushing_width`, with the hardness of the seat; each seat carries F/2.
    """
    return least_bushing_width(load / 2, diameter=diameter, hardness=hardness, safety=safety)


def hardness_from_strength(ultimate_stress: Values) -> Values:
    """Brinell hardness [Pa] of a steel below 400 HB from its tensile strength [Pa]: H = 0.3 x 9.80665 sigma. Eq. 13.

    Note: the source prints H = 0.3 sigma, which is the hardness in kgf/mm2 for a strength in MPa; in pascal the factor is
    2.942.
    """
    require_positive(ultimate_stress=ultimate_stress)
    return 0.3 * 9.80665 * ultimate_stress


def least_eyebar_diameter(
    load: Values, *, bore: Values, width: Values, yield_stress: Values, safety: Values
) -> Values:
    """Least outer diameter [m] of a housing eye: F (D/d + d/D) / (s (D - d)) = sigma_y / eta. Strand (2005), eq. 14.

    Parameters
    ----------
    load : float or array
        F. [N]
    bore : float or array
        Inner diameter d. [m]
    width : float or array
        Width s of the eye. [m]
    yield_stress, safety : float or array
        [Pa, 1]

    Raises
    ------
    ModelError
        A value not positive, or a load that no outer diameter carries (F above sigma_y s d / eta).

    Notes
    -----
    The source prints w in the place of s under the root.
    """
    require_positive(load=load, bore=bore, width=width, yield_stress=yield_stress, safety=safety)
    capacity = yield_stress / safety * width * bore
    if np.any(np.less_equal(capacity - load, 0)):
        raise ModelError(
            "load must stay below yield stress times width times bore over safety for any eye to carry it."
        )
    root = np.sqrt(capacity**2 + 4 * capacity * load - 4 * load**2)
    return bore * (capacity + root) / (2 * (capacity - load))


def lock_force(
    load: Values,
    *,
    diameter: Values,
    lever: Values,
    friction_bushing: Values = 1.0,
    friction_seat: Values = 0.0,
) -> Values:
    """Shear force [N] on the screw of the lock plate: d F (mu1 - mu2) / (2R). Strand (2005), eq. 15.

    The default friction coefficients are the worst case of the source; lever R from the pin axis to the screw [m].
    """
    require_positive(diameter=diameter, lever=lever)
    require_not_negative(load=load, friction_bushing=friction_bushing, friction_seat=friction_seat)
    return diameter * load * (friction_bushing - friction_seat) / (2 * lever)


def least_weld_diameter(
    load: Values, *, pin_diameter: Values, throat: Values, yield_stress: Values, safety: Values
) -> Values:
    """Least inner diameter [m] of the round weld of a lock plate: sqrt(sqrt(3) F d eta / (pi a sigma_y)) - 2a. Eq. 16.

    Parameters
    ----------
    load : float or array
        F, with the friction of `lock_force` at its worst. [N]
    pin_diameter : float or array
        d. [m]
    throat : float or array
        Effective throat a of the weld. [m]
    yield_stress, safety : float or array
        [Pa, 1]

    Notes
    -----
    The print is illegible between 2a and sqrt(2) a in the last term. Static strength only, not fatigue.
    """
    require_positive(
        load=load,
        pin_diameter=pin_diameter,
        throat=throat,
        yield_stress=yield_stress,
        safety=safety,
    )
    return (
        np.sqrt(np.sqrt(3) * load * pin_diameter * safety / (np.pi * throat * yield_stress))
        - 2 * throat
    )


def largest_internal_weld_diameter(pin_diameter: Values, *, throat: Values) -> Values:
    """Largest inner diameter [m] of an internal weld, clear of the hardened surface: d - 2a (1 + sqrt(2)). Eq. 17."""
    require_positive(pin_diameter=pin_diameter, throat=throat)
    return pin_diameter - 2 * throat * (1 + np.sqrt(2))


def least_open_prong_height(
    load: Values, *, thickness: Values, length: Values, yield_stress: Values, safety: Values
) -> Values:
    """Least height [m] of the prongs of an open lock plate, in bending and shear. Strand (2005), eq. 18.

    h = sqrt(6F (F + sqrt(F^2 + 16 S^2 t^2 L^2))) / (2 S t), S = sigma_y / eta.

    Parameters
    ----------
    load : float or array
        Lock force F. [N]
    thickness, length : float or array
        Plate thickness t and lever L of the force. [m]
    yield_stress, safety : float or array
        [Pa, 1]
    """
    return _prong_height(load, 1.0, 1.0, thickness, length, yield_stress, safety)


def end_force_of_closed_lock(load: Values) -> Values:
    """Force [N] at the closed end of a lock plate: 5F/32. Strand (2005), eq. 19."""
    return 5 * load / 32


def least_closed_prong_height(
    load: Values,
    *,
    thickness: Values,
    length: Values,
    yield_stress: Values,
    safety: Values,
    root_shear: Values = 27 / 32,
) -> Values:
    """Least height [m] of the prongs of a closed lock plate, in bending and shear at the root. Strand (2005), eqs. 19, 20.

    The bending moment at the root is 11 F L / 16.

    Parameters as in `least_open_prong_height`, and the share of the force that shears the root.

    Notes
    -----
    The source takes F/2 for the shear; with 5F/32 taken at the closed end the root carries 27F/32.
    `root_shear=0.5` gives its equation.
    """
    require_positive(root_shear=root_shear)
    return _prong_height(load, 11 / 16, root_shear, thickness, length, yield_stress, safety)


def least_closed_end_width(
    load: Values, *, thickness: Values, yield_stress: Values, safety: Values
) -> Values:
    """Least width [m] of the closed end of a lock plate: c = 5 F eta / (32 sigma_y t). Strand (2005), first eq. 21.

    Note: the source calls this the eyebar width and gives the number 21 to two equations.
    """
    require_positive(load=load, thickness=thickness, yield_stress=yield_stress, safety=safety)
    return end_force_of_closed_lock(load) * safety / (yield_stress * thickness)


def lateral_shift(
    load: Values, *, length: Values, diameter: Values, youngs_modulus: Values
) -> Values:
    """Shortening [m] of a bent pin between its ends: dL = L [1 - sqrt(1 - (F L^2 / (24 E I))^2)]. Second eq. 21.

    Parameters
    ----------
    load : float or array
        F in the middle. [N]
    length : float or array
        L, both seats and the bushing. [m]
    diameter : float or array
        d, I = pi d^4 / 64. [m]
    youngs_modulus : float or array
        [Pa]

    Notes
    -----
    Simply supported here and clamped in eq. 2. Two straight halves shorten by 5/6 of what the bent line does.
    """
    require_positive(length=length, diameter=diameter, youngs_modulus=youngs_modulus)
    slope = load * length**2 / (24 * youngs_modulus * np.pi * diameter**4 / 64)
    require_between(-1.0, 1.0, slope=slope)
    return length * slope**2 / (1 + np.sqrt(1 - slope**2))


def lateral_force(
    load: Values, *, length: Values, diameter: Values, youngs_modulus: Values
) -> Values:
    """Force [N] that keeps the end of a bent pin in place: E A dL / L. Strand (2005), eq. 22; no friction in the seat.

    Parameters as in `lateral_shift`.
    """
    shift = lateral_shift(load, length=length, diameter=diameter, youngs_modulus=youngs_modulus)
    return youngs_modulus * np.pi * diameter**2 / 4 * shift / length


def relative_play(pin_diameter: Values, *, bore: Values) -> Values:
    """Relative play [1] of a joint: (D - d) / d; 0.3e-3 to 5e-3 is recommended. Strand (2005), eq. 23."""
    require_positive(pin_diameter=pin_diameter, bore=bore)
    return (bore - pin_diameter) / pin_diameter


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
    """Radial displacement [m] of the bore of a bushing pressed into its housing, negative. Strand (2005), eqs. 24 and 25.

    u = -Delta d_b D / {E_b (D^2 - d_b^2) [(k_h + nu_h)/E_h + (k_b - nu_b)/E_b]},
    k_h = (D_h^2 + D^2)/(D_h^2 - D^2), k_b = (D^2 + d_b^2)/(D^2 - d_b^2): Lame's rings in plane stress. Delta is
    diametral; the bore shrinks by 2u in diameter. With one material this is eq. 24.

    Parameters
    ----------
    interference : float or array
        Outer diameter of the bushing less bore of the housing. [m]
    bore, fit_diameter, housing_diameter : float or array
        Inner diameter d_b and outer diameter D of the bushing, outer diameter D_h of the housing. [m]
    youngs_bushing, poisson_bushing, youngs_housing, poisson_housing : float or array
        Elastic constants. [Pa, 1]

    Notes
    -----
    Eq. 25 prints d_b D^2 (3 nu_h - 5)/4 where d_b D belongs; with equal materials the print does not become eq. 24.
    Delta is a play in the nomenclature of the source and an interference here.
    """
    require_positive(bore=bore, youngs_bushing=youngs_bushing, youngs_housing=youngs_housing)
    require_poisson(poisson_bushing=poisson_bushing, poisson_housing=poisson_housing)
    require_positive(wall=fit_diameter - bore, housing_wall=housing_diameter - fit_diameter)
    k_h = (housing_diameter**2 + fit_diameter**2) / (housing_diameter**2 - fit_diameter**2)
    k_b = (fit_diameter**2 + bore**2) / (fit_diameter**2 - bore**2)
    compliance = (k_h + poisson_housing) / youngs_housing + (k_b - poisson_bushing) / youngs_bushing
    return (
        -interference
        * bore
        * fit_diameter
        / (youngs_bushing * (fit_diameter**2 - bore**2) * compliance)
    )


@dataclass(frozen=True)
class JointDesign:
    """A pin joint as its designer knows it; what is left at None is not checked."""

    load: float
    """[N]"""
    pin_diameter: float
    """[m]"""
    bushing_width: float
    """[m]"""
    seat_width: float
    """Of each of the two seats. [m]"""
    play: float
    """Bore less pin diameter. [m]"""
    housing_bore: float
    """Diameter of the bore of the housing eye. [m]"""
    housing_diameter: float
    """Outer diameter of the housing eye. [m]"""
    pin_yield: float
    """[Pa]"""
    bushing_yield: float
    """[Pa]"""
    housing_yield: float
    """[Pa]"""
    bushing_hardness: float
    """[Pa]"""
    seat_hardness: float
    """[Pa]"""
    youngs_modulus: float
    """Of pin and bushing. [Pa]"""
    safety: float
    """[1]"""
    lateral_play: float = 0.0
    """Between bushing and seats, both sides together. [m]"""
    hole_diameter: float = 0.0
    """Of a lubrication hole across the pin. [m]"""
    half_swing: float | None = None
    """[rad]"""
    period: float | None = None
    """Of a swing forth and back. [s]"""
    friction: float | None = None
    """[1]"""
    lock_lever: float | None = None
    """From pin axis to lock screw. [m]"""
    pv_limit: float | None = None
    """Of the pair of materials. [W/m2]"""

    def __post_init__(self) -> None:
        given = {name: value for name, value in vars(self).items() if value is not None}
        may_be_zero = {"lateral_play", "hole_diameter", "friction"}
        require_positive(
            **{name: value for name, value in given.items() if name not in may_be_zero}
        )
        require_not_negative(
            **{name: value for name, value in given.items() if name in may_be_zero}
        )


@dataclass(frozen=True)
class DesignCheck:
    """One limit of the design."""

    name: str
    equation: str
    """Of Strand (2005)."""
    utilisation: float
    """Demand over capacity; above 1 the limit is broken. [1]"""
    statement: str
    """Both numbers, in the units of a drawing."""
    recommended: bool = False
    """A range that experience recommends, rather than a limit of strength."""

    @property
    def holds(self) -> bool:
        return self.utilisation <= 1


@dataclass(frozen=True)
class DesignReport:
    """Every limit of a joint, most used first, and figures that have no limit."""

    checks: tuple[DesignCheck, ...]
    figures: tuple[str, ...]

    @property
    def governing(self) -> DesignCheck:
        """The limit that is used most, recommended ranges left aside."""
        return next(check for check in self.checks if not check.recommended)

    @property
    def sound(self) -> bool:
        """Whether every limit holds, recommended ranges left aside."""
        return all(check.holds for check in self.checks if not check.recommended)

    def as_text(self) -> str:
        """The report as lines to read."""
        verdict = "holds every limit" if self.sound else "breaks a limit"
        lines = [f"The joint {verdict}; {self.governing.name} governs ({self.governing.equation})."]
        missed = [check.name for check in self.checks if check.recommended and not check.holds]
        if missed:
            lines.append(f"Outside the recommended range: {', '.join(missed)}.")
        lines += [
            f"  {check.utilisation:6.2f}  {check.name}: {check.statement} ({check.equation})"
            for check in self.checks
        ]
        return "\n".join([*lines, *(f"  {figure}" for figure in self.figures)])


def design_report(joint: JointDesign) -> DesignReport:
    """Walk a joint through the limits of Strand (2005), chapter 2, and say which one governs.

    Parameters
    ----------
    joint : JointDesign
        The joint.

    Returns
    -------
    DesignReport
        Checks, the most used first.

    Notes
    -----
    A limit on a dimension is used by required over actual dimension; a recommended range by the nearer of its ends.
    """
    checks = sorted(
        [*_pin_checks(joint), *_bushing_checks(joint)], key=lambda check: -check.utilisation
    )
    return DesignReport(tuple(checks), tuple(_figures(joint)))


def _pin_checks(joint: JointDesign) -> list[DesignCheck]:
    d, free = joint.pin_diameter, joint.bushing_width + joint.lateral_play
    strength = {"yield_stress": joint.pin_yield, "safety": joint.safety}
    checks = [
        _least(
            "pin in shear", "eq. 1", pin_diameter_in_shear(joint.load, **strength), d, "diameter"
        )
    ]
    if joint.hole_diameter > 0:
        bent = pin_diameter_with_hole(
            joint.load, free_length=free, hole_ratio=joint.hole_diameter / d, **strength
        )
        checks.append(_least("pin in bending at its hole", "eq. 4", bent, d, "diameter"))
    else:
        bent = pin_diameter_in_bending(joint.load, free_length=free, **strength)
        checks.append(_least("pin in bending", "eq. 2", bent, d, "diameter"))
    seat = least_seat_width(
        joint.load, diameter=d, hardness=joint.seat_hardness, safety=joint.safety
    )
    checks.append(_least("pin seat", "eq. 12", seat, joint.seat_width, "width"))
    slender = (2 * joint.seat_width + joint.bushing_width) / d
    statement = f"length over diameter {slender:.2f}, below 3 recommended"
    checks.append(
        DesignCheck(
            "lateral pin movement", "section 2.1.10", slender / 3, statement, recommended=True
        )
    )
    return checks


def _bushing_checks(joint: JointDesign) -> list[DesignCheck]:
    d, w = joint.pin_diameter, joint.bushing_width
    area = least_projected_area(joint.load, yield_stress=min(joint.bushing_yield, joint.pin_yield))
    width = least_bushing_width(
        joint.load, diameter=d, hardness=joint.bushing_hardness, safety=joint.safety
    )
    half_angle, peak = persson_contact(
        joint.load / w, play=joint.play, pin_diameter=d, youngs_modulus=joint.youngs_modulus
    )
    strength = {"yield_stress": joint.housing_yield, "safety": joint.safety}
    eye = least_eyebar_diameter(joint.load, bore=joint.housing_bore, width=w, **strength)
    checks = [
        DesignCheck(
            "projected pressure",
            "eq. 5",
            area / (d * w),
            f"area {area * 1e6:.0f} mm2 required, {d * w * 1e6:.0f} mm2 there",
        ),
        _least("bushing edges", "eq. 10", width, w, "width"),
        DesignCheck(
            "peak pressure",
            "eq. 9",
            joint.safety * peak / joint.bushing_hardness,
            f"{peak / 1e6:.0f} MPa over {2 * np.degrees(half_angle):.0f} degrees, "
            f"{joint.bushing_hardness / joint.safety / 1e6:.0f} MPa allowed",
        ),
        _range("width over diameter", "eq. 11", w / d, 0.5, 1.5, ""),
        _range("relative play", "eq. 23", 1e3 * joint.play / d, 0.3, 5.0, " per mille"),
        _least("housing eye", "eq. 14", eye, joint.housing_diameter, "diameter"),
        _range(
            "housing outer over inner diameter",
            "section 2.1.6",
            joint.housing_diameter / joint.housing_bore,
            2,
            4,
            "",
        ),
    ]
    if joint.pv_limit is not None and joint.half_swing is not None and joint.period is not None:
        speed = mean_sliding_speed(joint.half_swing, diameter=d, period=joint.period)
        pv = pressure_velocity(joint.load, diameter=d, width=w, speed=speed)
        checks.append(
            DesignCheck(
                "pv",
                "section 2.1.13",
                pv / joint.pv_limit,
                f"{pv / 1e6:.3g} W/mm2, {joint.pv_limit / 1e6:.3g} W/mm2 allowed",
            )
        )
    return checks


def _figures(joint: JointDesign) -> list[str]:
    d, length = joint.pin_diameter, 2 * joint.seat_width + joint.bushing_width
    bent = {"length": length, "diameter": d, "youngs_modulus": joint.youngs_modulus}
    figures = [
        f"lateral shift of the bent pin {lateral_shift(joint.load, **bent) * 1e9:.3g} nm, "
        f"held by {lateral_force(joint.load, **bent):.3g} N (eqs. 21, 22)"
    ]
    if joint.lock_lever is not None:
        force = lock_force(joint.load, diameter=d, lever=joint.lock_lever)
        figures.append(f"lock force at worst {force / 1e3:.3g} kN (eq. 15)")
    if joint.half_swing is not None and joint.period is not None:
        speed = mean_sliding_speed(joint.half_swing, diameter=d, period=joint.period)
        figures.append(f"mean sliding speed {speed * 1e3:.3g} mm/s (eq. 26)")
        if joint.friction is not None:
            heat = friction_heat(joint.load, friction=joint.friction, speed=speed)
            figures.append(f"friction heat {heat:.3g} W (eqs. 27, 28)")
    return figures


def _least(
    name: str, equation: str, required: Values, actual: float, dimension: str
) -> DesignCheck:
    statement = f"{dimension} {required * 1e3:.2f} mm required, {actual * 1e3:.2f} mm there"
    return DesignCheck(name, equation, float(required) / actual, statement)


def _range(
    name: str, equation: str, value: float, low: float, high: float, unit: str
) -> DesignCheck:
    statement = f"{value:.3g}{unit}, {low:g} to {high:g} recommended"
    return DesignCheck(name, equation, max(value / high, low / value), statement, recommended=True)


def _prong_height(
    load: Values,
    moment: float,
    shear: Values,
    thickness: Values,
    length: Values,
    yield_stress: Values,
    safety: Values,
) -> Values:
    """Height [m] at which bending by moment F L and shear by shear F reach yield after von Mises at the root."""
    require_positive(
        load=load, thickness=thickness, length=length, yield_stress=yield_stress, safety=safety
    )
    allowed = yield_stress * thickness / safety
    sheared = 3 * (shear * load) ** 2
    bent = 6 * moment * load * length
    # (bent / h^2)^2 + sheared / h^2 = allowed^2
    return np.sqrt((sheared + np.sqrt(sheared**2 + (2 * allowed * bent) ** 2)) / 2) / allowed
