"""The guide step by step: Strand (2005), chapter 2."""

from __future__ import annotations

import warnings
from dataclasses import dataclass

from erlif.core.errors import UnitWarning
from erlif.joint.sizing.fit import fit_steps
from erlif.joint.sizing.heat import motion_steps
from erlif.joint.sizing.housing import housing_steps
from erlif.joint.sizing.inputs import warn_of_units
from erlif.joint.sizing.joint import Joint
from erlif.joint.sizing.lock import lock_steps
from erlif.joint.sizing.pin import pin_steps
from erlif.joint.sizing.pressure import pressure_steps
from erlif.joint.sizing.steps import Step

_ORDER = (
    "pin_shear",
    "pin_bending",
    "seizure",
    "pressure_projected",
    "pressure_cosine",
    "pressure_hertz",
    "pressure_peak",
    "bushing_edge",
    "width_ratio",
    "seat_edge",
    "housing_eye",
    "housing_ratio",
    "lock_screw",
    "weld",
    "weld_room",
    "prong",
    "lock_end",
    "plate",
    "slenderness",
    "lateral_force",
    "press_fit",
    "press_bushing",
    "press_housing",
    "relative_play",
    "speed",
    "pressure_limit",
    "pv",
    "friction",
    "friction_moment",
    "temperature",
    "warm_play",
    "roughness",
    "wear",
    "hardness_difference",
)
"""Steps in the order of the guide."""


@dataclass(frozen=True, repr=False)
class Walk:
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
        return f"<Walk: {len(self.steps)} steps, {len(self.failed)} limits exceeded>"

    def step(self, key: str) -> Step:
        """The step of a name.

        Examples
        --------
        >>> from erlif.joint.sizing import example_joint, walk_guide
        >>> walk_guide(example_joint()).step("pin_shear").equation
        'eq. 1'
        """
        return next(step for step in self.steps if step.key == key)

    @property
    def limits(self) -> tuple[Step, ...]:
        """The limits that have a margin, the weakest first."""
        found = [step for step in self.steps if step.governs]
        return tuple(sorted(found, key=lambda step: step.margin))

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


def walk_guide(joint: Joint) -> Walk:
    """Check a joint step by step. No joint raises: what exceeds a limit is part of the result.

    Parameters
    ----------
    joint : Joint
        With all dimensions, as `erlif.joint.sizing.size_joint` returns it.

    Returns
    -------
    Walk

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
    >>> from erlif.joint.sizing import example_joint
    >>> walk = walk_guide(example_joint())
    >>> walk.sound, walk.weakest.key
    (True, 'prong')
    """
    warn_of_units(joint, dimensions=False)
    with warnings.catch_warnings():
        # unusual joints are reported by their margins
        warnings.simplefilter("ignore", UnitWarning)
        steps = [
            *pin_steps(joint),
            *pressure_steps(joint),
            *housing_steps(joint),
            *lock_steps(joint),
            *fit_steps(joint),
            *motion_steps(joint),
        ]
    steps.sort(key=lambda step: _ORDER.index(step.key))
    return Walk(joint, tuple(steps))
