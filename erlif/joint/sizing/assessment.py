"""The guide step by step: Strand (2005), chapter 2."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

from erlif.joint.sizing import fit, heat, lock, pin, pressure
from erlif.joint.sizing.joint import Joint, warn_of_units, without_unit_warnings
from erlif.joint.sizing.state import JointState
from erlif.joint.sizing.steps import Result, Step, make_step

# The equation of each step, in the order of the guide; None where a joint has no such step.
EQUATIONS: dict[str, Callable[[JointState], Result | None]] = {
    "pin_shear": pin.shear,
    "pin_bending": pin.bending,
    "seizure": pressure.seizure,
    "pressure_projected": pressure.projected,
    "pressure_cosine": pressure.cosine,
    "pressure_hertz": pressure.hertz,
    "pressure_peak": pressure.peak,
    "bushing_edge": pressure.bushing_edge,
    "width_ratio": pressure.width_ratio,
    "seat_edge": pin.seat_edge,
    "housing_eye": fit.eye,
    "housing_ratio": fit.eye_ratio,
    "lock_screw": lock.screw,
    "weld": lock.weld,
    "weld_room": lock.weld_room,
    "prong": lock.prong,
    "lock_end": lock.end,
    "plate": lock.plate,
    "slenderness": pin.slenderness,
    "lateral_force": pin.slope,
    "press_fit": fit.press_fit,
    "press_bushing": partial(fit.pressed, part="bushing"),
    "press_housing": partial(fit.pressed, part="housing"),
    "relative_play": fit.relative_play,
    "speed": heat.speed,
    "pressure_limit": pressure.material_limit,
    "pv": heat.pv,
    "friction": heat.friction,
    "friction_moment": heat.moment,
    "temperature": heat.temperature,
    "warm_play": fit.warm_play,
    "roughness": heat.roughness,
    "wear": heat.wear,
    "hardness_difference": pressure.hardness_difference,
}


@dataclass(frozen=True, repr=False)
class Assessment:
    """The steps of a joint, in the order of the guide.

    Attributes
    ----------
    joint : Joint
        With all dimensions.
    steps : tuple[Step, ...]
    """

    joint: Joint
    steps: tuple[Step, ...]

    def __repr__(self) -> str:
        return f"<Assessment: {len(self.steps)} steps, {len(self.failed)} limits exceeded>"

    def step(self, key: str) -> Step:
        """The step of a name.

        Examples
        --------
        >>> from erlif.joint.sizing import assess_joint
        >>> from erlif.joint.sizing.design import example_joint
        >>> assess_joint(example_joint()).step("pin_shear").equation
        'eq. 1'
        """
        return next(step for step in self.steps if step.key == key)

    @property
    def limits(self) -> tuple[Step, ...]:
        """The limits that have a margin, the weakest first."""
        limits = [step for step in self.steps if step.governs]
        return tuple(sorted(limits, key=lambda step: step.margin))

    @property
    def weakest(self) -> Step | None:
        """The limit with the smallest margin; None where no limit is known."""
        return next(iter(self.limits), None)

    @property
    def sound(self) -> bool:
        """Whether all limits hold."""
        return all(step.holds for step in self.limits)

    @property
    def failed(self) -> tuple[Step, ...]:
        """The limits that are exceeded, the weakest first."""
        return tuple(step for step in self.limits if not step.holds)

    @property
    def doubtful(self) -> tuple[Step, ...]:
        """The limits outside the validity of their equations."""
        return tuple(step for step in self.limits if not step.valid)

    @property
    def unusual(self) -> tuple[Step, ...]:
        """The recommendations that are not met."""
        return tuple(
            step for step in self.steps if step.kind == "recommendation" and not step.holds
        )

    @property
    def missing(self) -> tuple[Step, ...]:
        """The steps that could not be computed."""
        return tuple(step for step in self.steps if step.missing)


def margin_of(joint: Joint, key: str) -> float:
    """Return the margin of one step; NaN where it is not known.

    Parameters
    ----------
    joint : Joint
        With all dimensions.
    key : str
        Name of the step.

    Returns
    -------
    float

    Examples
    --------
    >>> from erlif.joint.sizing.design import example_joint
    >>> margin_of(example_joint(), "weld") > 0
    True
    """
    with without_unit_warnings():
        result = EQUATIONS[key](JointState(joint))
    return float("nan") if result is None else result.share


def assess_joint(joint: Joint) -> Assessment:
    """Check a joint step by step. No joint raises: what exceeds a limit is part of the result.

    Parameters
    ----------
    joint : Joint
        With all dimensions, as `erlif.joint.sizing.size_joint` returns it.

    Returns
    -------
    Assessment

    Raises
    ------
    ModelError
        If a dimension is not known.

    Warns
    -----
    UnitWarning
        If load, swing or a strength is off by orders of magnitude; `size_joint` checks the lengths
        too.

    Examples
    --------
    >>> from erlif.joint.sizing.design import example_joint
    >>> assessment = assess_joint(example_joint())
    >>> assessment.sound, assessment.weakest.key
    (True, 'prong')
    """
    warn_of_units(joint, dimensions=False)
    state, steps = JointState(joint), []
    with without_unit_warnings():
        for key, equation in EQUATIONS.items():
            if (result := equation(state)) is not None:
                steps.append(make_step(key, result))
    return Assessment(joint, tuple(steps))
