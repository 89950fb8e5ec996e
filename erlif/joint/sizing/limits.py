"""The limits of a joint whose numbers are all known: utilisations and a report as text.

`erlif.joint.sizing.walk_guide` checks more and takes materials; this module states the same steps
as demand over capacity, for a joint of single numbers.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields

import numpy as np

from erlif.core.errors import ModelError
from erlif.joint.sizing.joint import Joint
from erlif.joint.sizing.materials import BRINELL, Material
from erlif.joint.sizing.steps import Step
from erlif.joint.sizing.walk import Walk, walk_guide
from erlif.models.arguments import (
    check_length,
    check_load,
    check_modulus,
    check_strength,
    check_swing,
    require_finite,
    require_increasing,
    require_not_negative,
    require_positive,
    require_single,
)
from erlif.models.bearing import LARGEST_HOLE_RATIO, lock_force
from erlif.models.wear import friction_heat


@dataclass(frozen=True)
class JointDesign:
    """A pin joint in the numbers of its designer.

    Each field is one number. A check whose optional fields are None is left out. A field that is
    NaN, infinite or out of range raises `erlif.core.errors.ModelError`.

    Attributes
    ----------
    load : float
        Load on the joint. [N]
    pin_diameter : float
        Diameter of the pin. [m]
    bushing_width : float
        Width of the bushing. [m]
    seat_width : float
        Width of each of the two seats. [m]
    play : float
        Bore less pin diameter; 0 for none, negative for an interference. [m]
    housing_bore : float
        Diameter of the bore of the housing eye, at least that of the pin. [m]
    housing_diameter : float
        Outer diameter of the housing eye. [m]
    pin_yield : float
        Yield stress of the pin. [Pa]
    bushing_yield : float
        Yield stress of the bushing. [Pa]
    housing_yield : float
        Yield stress of the housing. [Pa]
    bushing_hardness : float
        Hardness of the bushing. [Pa]
    seat_hardness : float
        Hardness of the seats. [Pa]
    youngs_modulus : float
        Young's modulus of pin and bushing. [Pa]
    safety : float
        Safety factor. [1]
    lateral_play : float
        Play between bushing and seats, both sides together. [m]
    hole_diameter : float
        Diameter of a lubrication hole across the pin, at most 0.2 pin diameters; 0 for none.
        [m]
    half_swing : float | None
        Half of the angle from end to end of a swing. [rad]
    period : float | None
        Time of a swing forth and back. [s]
    friction : float | None
        Friction coefficient. [1]
    lock_lever : float | None
        Distance of the lock screw from the pin axis. [m]
    pv_limit : float | None
        Limit of pressure times velocity of the pair of materials. [W/m2]
    """

    load: float
    pin_diameter: float
    bushing_width: float
    seat_width: float
    play: float
    housing_bore: float
    housing_diameter: float
    pin_yield: float
    bushing_yield: float
    housing_yield: float
    bushing_hardness: float
    seat_hardness: float
    youngs_modulus: float
    safety: float
    lateral_play: float = 0.0
    hole_diameter: float = 0.0
    half_swing: float | None = None
    period: float | None = None
    friction: float | None = None
    lock_lever: float | None = None
    pv_limit: float | None = None

    def __post_init__(self) -> None:
        given = {field.name: getattr(self, field.name) for field in fields(self)}
        given = {name: value for name, value in given.items() if value is not None}
        require_single(**given)
        for name, value in given.items():
            if isinstance(value, str) or np.isnan(value):
                raise ModelError(f"{name} must be a number, got {value!r}; give it in SI units.")

        # no play, no hole and no friction are designs too
        may_be_zero = ("lateral_play", "hole_diameter", "friction")
        positive = [name for name in given if name not in (*may_be_zero, "play")]
        require_positive(**{name: given[name] for name in positive})
        require_finite(play=self.play)
        require_not_negative(**{name: given[name] for name in may_be_zero if name in given})
        if self.housing_bore != self.pin_diameter:
            require_increasing(pin_diameter=self.pin_diameter, housing_bore=self.housing_bore)
        if self.hole_diameter / self.pin_diameter > LARGEST_HOLE_RATIO:
            raise ModelError(
                f"hole_diameter must be at most {LARGEST_HOLE_RATIO:g} pin_diameter, got "
                f"{self.hole_diameter / self.pin_diameter:.3g} of it; make the pin thicker."
            )
        self._check_units()

    def _check_units(self) -> None:
        check_load(load=self.load)
        check_length(
            pin_diameter=self.pin_diameter,
            bushing_width=self.bushing_width,
            seat_width=self.seat_width,
            play=self.play,
            housing_bore=self.housing_bore,
            housing_diameter=self.housing_diameter,
            lateral_play=self.lateral_play,
            hole_diameter=self.hole_diameter,
        )
        check_strength(
            pin_yield=self.pin_yield,
            bushing_yield=self.bushing_yield,
            housing_yield=self.housing_yield,
            bushing_hardness=self.bushing_hardness,
            seat_hardness=self.seat_hardness,
        )
        check_modulus(youngs_modulus=self.youngs_modulus)
        if self.half_swing is not None:
            check_swing(half_swing=self.half_swing)


@dataclass(frozen=True)
class DesignCheck:
    """One limit of the design.

    Attributes
    ----------
    name : str
        What is checked.
    equation : str
        Equation or section of Strand (2005).
    utilisation : float
        Demand over capacity; above 1 the limit is exceeded. [1]
    statement : str
        Demand and capacity in the units of a drawing.
    recommended : bool
        True for a range that experience recommends, False for a limit of strength.
    """

    name: str
    equation: str
    utilisation: float
    statement: str
    recommended: bool = False

    @property
    def holds(self) -> bool:
        """Whether demand stays within capacity."""
        return self.utilisation <= 1


@dataclass(frozen=True)
class DesignReport:
    """All limits of a joint, and figures that have no limit.

    Attributes
    ----------
    checks : tuple[DesignCheck, ...]
        The limits, in order of falling utilisation.
    figures : tuple[str, ...]
        Lateral shift and force; lock force, sliding speed and heat where the joint gives them.
    """

    checks: tuple[DesignCheck, ...]
    figures: tuple[str, ...]

    @property
    def governing(self) -> DesignCheck:
        """The limit of strength with the largest utilisation."""
        return next(check for check in self.checks if not check.recommended)

    @property
    def sound(self) -> bool:
        """Whether every limit of strength holds."""
        return all(check.holds for check in self.checks if not check.recommended)

    def as_text(self) -> str:
        """The report as lines to read."""
        verdict = "meets every limit" if self.sound else "exceeds a limit"
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
    """Check a joint against the limits of Strand (2005), chapter 2.

    Parameters
    ----------
    joint : JointDesign
        Dimensions [m], strengths [Pa] and load [N] of the joint.

    Returns
    -------
    DesignReport
        Checks in order of falling utilisation, and figures without a limit.

    Notes
    -----
    The utilisation of a limit on a dimension is required over actual dimension. That of a
    recommended range is taken at the nearer of its ends.

    Examples
    --------
    >>> joint = JointDesign(
    ...     load=100e3, pin_diameter=0.08, bushing_width=0.1, seat_width=0.04, play=0.16e-3,
    ...     housing_bore=0.09, housing_diameter=0.2, pin_yield=600e6, bushing_yield=300e6,
    ...     housing_yield=350e6, bushing_hardness=1.2e9, seat_hardness=1.2e9,
    ...     youngs_modulus=206e9, safety=2.0,
    ... )
    >>> report = design_report(joint)
    >>> report.sound, report.governing.name
    (True, 'housing eye')
    """
    walk = walk_guide(_joint_of(joint))
    checks = [_check(walk, step) for step in walk.steps if step.key in _NAMES]
    # the limit that is nearest to being exceeded comes first
    found = [check for check in checks if check is not None]
    found.sort(key=lambda check: -check.utilisation)
    return DesignReport(tuple(found), tuple(_figures(joint, walk)))


_NAMES = {
    "pin_shear": "pin in shear",
    "pin_bending": "pin in bending",
    "seat_edge": "pin seat",
    "slenderness": "lateral pin movement",
    "seizure": "projected pressure",
    "bushing_edge": "bushing edges",
    "pressure_peak": "peak pressure",
    "width_ratio": "width over diameter",
    "relative_play": "relative play",
    "housing_eye": "housing eye",
    "housing_ratio": "housing outer over inner diameter",
    "pv": "pv",
}
"""Steps that are reported, by key, under the names of the report."""

_DIMENSIONS = {
    "pin_shear": ("diameter", "least diameter", "pin_diameter"),
    "pin_bending": ("diameter", "least diameter", "pin_diameter"),
    "seat_edge": ("width", "least width", "seat_width"),
    "bushing_edge": ("width", "least width", "bushing_width"),
    "housing_eye": ("diameter", "least outer diameter", "housing_diameter"),
}
"""Limits on a dimension: what it is, its least value in the step, its field of the joint."""


def _joint_of(joint: JointDesign) -> Joint:
    """The joint with its materials, in the form that the guide is walked with."""
    stiffness = joint.youngs_modulus
    pin = Material("pin", yield_stress=joint.pin_yield, youngs_modulus=stiffness)
    bushing = Material(
        "bushing",
        yield_stress=joint.bushing_yield,
        hardness_low=joint.bushing_hardness / BRINELL,
        youngs_modulus=stiffness,
        pv=joint.pv_limit,
    )
    return Joint(
        force=joint.load,
        safety=joint.safety,
        pin=pin,
        bushing=bushing,
        seat=Material("seat", hardness_low=joint.seat_hardness / BRINELL),
        housing=Material("housing", yield_stress=joint.housing_yield),
        half_swing=joint.half_swing,
        period=joint.period,
        friction=joint.friction or 0.0,
        pin_diameter=joint.pin_diameter,
        hole_diameter=joint.hole_diameter,
        bushing_width=joint.bushing_width,
        wall=(joint.housing_bore - joint.pin_diameter) / 2,
        seat_width=joint.seat_width,
        housing_diameter=joint.housing_diameter,
        play=joint.play,
        lateral_play=joint.lateral_play,
    )


def _check(walk: Walk, step: Step) -> DesignCheck | None:
    """A step as demand over capacity; None without a limit, as of a pv that has none."""
    if step.missing or math.isnan(step.margin):
        return None
    name = _NAMES[step.key] + (" at its hole" if step.equation == "eq. 4" else "")
    if step.key in _DIMENSIONS:
        return _least(walk, step, name)
    used = math.inf if step.margin <= -1 else 1 / (1 + step.margin)
    return DesignCheck(name, step.equation, used, _statement(step), step.kind == "recommendation")


def _least(walk: Walk, step: Step, name: str) -> DesignCheck:
    dimension, number, field = _DIMENSIONS[step.key]
    required, present = step.number(number), 1e3 * getattr(walk.joint, field)
    needed = f"{required:.2f} mm required" if math.isfinite(required) else "of no size enough"
    statement = f"{dimension} {needed}, {present:.2f} mm present"
    return DesignCheck(name, step.equation, required / present, statement)


def _statement(step: Step) -> str:
    """Demand and capacity in the units of a drawing."""
    low, high = step.allowed
    unit = "" if step.unit == "1" else f" {step.unit}"
    if step.kind == "recommendation":
        ends = f"{low:g} to {high:g}" if math.isfinite(low) else f"up to {high:g}"
        what = "length over diameter " if step.key == "slenderness" else ""
        return f"{what}{step.present:.3g}{unit}, {ends} recommended"
    over = ""
    if step.key == "pressure_peak":
        over = f" over {2 * step.number('half contact angle'):.0f} degrees"
    return f"{step.present:.4g}{unit}{over}, {high:.4g}{unit} allowed"


def _figures(joint: JointDesign, walk: Walk) -> list[str]:
    """What has no limit: lateral movement, lock force, speed, heat."""
    bent = walk.step("lateral_force")
    figures = ["the pin folds under its load (eq. 21)"]
    if bent.present <= 1:
        figures = [
            f"lateral shift of the bent pin {bent.number('lateral shift') * 1e3:.3g} nm, "
            f"held by {bent.number('lateral force'):.3g} N (eqs. 21, 22)"
        ]
    if joint.lock_lever is not None:
        force = lock_force(joint.load, diameter=joint.pin_diameter, lever=joint.lock_lever)
        figures.append(f"lock force at worst {force / 1e3:.3g} kN (eq. 15)")

    speed = walk.step("speed")
    if not speed.missing:
        figures.append(f"mean sliding speed {speed.present:.3g} mm/s (eq. 26)")
        if joint.friction is not None:
            heat = friction_heat(joint.load, friction=joint.friction, speed=speed.present / 1e3)
            figures.append(f"friction heat {heat:.3g} W (eqs. 27, 28)")
    return figures
