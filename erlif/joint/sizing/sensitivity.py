"""Sensitivities of the weakest margin, and other bushings of the same dimensions."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any

from erlif.joint.sizing.assessment import Assessment, assess_joint, margin_of
from erlif.joint.sizing.joint import Joint, Number, numbers_of
from erlif.joint.sizing.materials import Material
from erlif.joint.sizing.steps import Step

# Relative step of the central differences; the margins are smooth to nine digits. [1]
STEP = 1e-5

_PERCENT = 0.01
_LARGEST_RATIO = 0.4999  # Poisson's ratio up to which it can grow
_SMALLEST = 1e-8  # change of a margin that is rounding


@dataclass(frozen=True)
class Sensitivity:
    """Change of the weakest margin with one number of the joint.

    Attributes
    ----------
    name : str
        The number.
    by : str
        Its change: ``"1 %"`` or ``"1 K"``.
    change : float
        Change of the margin, to first order; positive where the margin grows. [1]
    """

    name: str
    by: str
    change: float


@dataclass(frozen=True)
class Substitute:
    """Another bushing at the same dimensions.

    Attributes
    ----------
    material : Material
    assessment : Assessment
        The steps with it.
    """

    material: Material
    assessment: Assessment

    @property
    def weakest(self) -> Step | None:
        """The limit of the sliding surface with the smallest margin; None where none is known."""
        return next((step for step in self.assessment.limits if step.key in _SURFACE), None)

    @property
    def unknown(self) -> tuple[Step, ...]:
        """The limits of the sliding surface that the table does not have for this material."""
        return tuple(
            step
            for step in self.assessment.steps
            if step.key in _SURFACE
            and (step.missing or (step.kind == "result" and step.key in _OF_MATERIAL))
        )


# Limits that depend on the bushing.
_SURFACE = (
    "seizure",
    "pressure_peak",
    "bushing_edge",
    "pressure_limit",
    "speed",
    "pv",
    "temperature",
    "warm_play",
    "press_bushing",
    "wear",
)

# Those that are results where the material has no limit; most have none of the speed.
_OF_MATERIAL = ("pressure_peak", "pv")


def sensitivities(assessment: Assessment) -> tuple[Sensitivity, ...]:
    """Return the derivatives of the weakest margin, the largest first.

    Parameters
    ----------
    assessment : Assessment

    Returns
    -------
    tuple of Sensitivity
        Numbers on which the margin does not depend are left out; empty where it is unlimited or no
        limit is known.

    Examples
    --------
    A prong in bending, the weakest part of the example, loses 1.0 % of its margin and of 1 with 1 %
    of load:

    >>> from erlif.joint.sizing import assess_joint
    >>> from erlif.joint.sizing.design import example_joint
    >>> found = {one.name: one.change for one in sensitivities(assess_joint(example_joint()))}
    >>> print(f"{found['load']:.4f}, {found['thickness of the plate']:.4f}")
    -0.0102, 0.0102
    """
    weakest = assessment.weakest
    if weakest is None or weakest.margin == float("inf"):
        return ()

    changes = []
    for number in numbers_of(assessment.joint):
        if not number.name or (number.by == "1 %" and not _can_grow(number)):
            continue
        above, below = (
            margin_of(_vary(assessment.joint, number.place, by, number.by), weakest.key)
            for by in (STEP, -STEP)
        )
        slope = (above - below) / (2 * STEP)
        change = slope * (_PERCENT if number.by == "1 %" else 1.0)
        if abs(change) > _SMALLEST:
            changes.append(Sensitivity(number.name, number.by, change))
    return tuple(sorted(changes, key=lambda one: -abs(one.change)))


def _can_grow(number: Number) -> bool:
    """Whether a number can be raised by one per cent."""
    at_end = number.place[-1] == "poissons_ratio" and number.value > _LARGEST_RATIO
    return bool(number.value) and not at_end


def _vary(table: Any, place: Sequence[str], by: float, unit: str) -> Any:
    """Return a copy of a table with one number changed by a share `by`, or by kelvin."""
    field, *inner = place
    if inner:
        return replace(table, **{field: _vary(getattr(table, field), inner, by, unit)})

    # both ends of the range of hardness change
    fields = ("hardness_low", "hardness_high") if field == "hardness" else (field,)
    known = {name: getattr(table, name) for name in fields}
    return replace(
        table,
        **{
            name: value + by if unit == "1 K" else value * (1 + by)
            for name, value in known.items()
            if value is not None
        },
    )


def substitutes(joint: Joint, materials: Iterable[Material]) -> tuple[Substitute, ...]:
    """Check other bushings at the dimensions of a joint, the best known first.

    A limit that is not known cannot be exceeded, so that the margins of materials of which more is
    known come first. The wear rate of the joint belongs to its own bushing; another has that of the
    table, or none.

    Parameters
    ----------
    joint : Joint
        With all dimensions.
    materials : iterable of Material
        Those for bushings are tried.

    Returns
    -------
    tuple of Substitute
        Those whose known limits hold; each part by the number of limits that are not known, then by
        falling weakest margin of the sliding surface.

    Examples
    --------
    >>> from erlif.joint.sizing import read_materials
    >>> from erlif.joint.sizing.design import example_joint
    >>> found = substitutes(example_joint(), read_materials().values())
    >>> found[0].weakest.holds
    True
    """
    tried = [
        Substitute(material, assess_joint(replace(joint, bushing=material)))
        for material in materials
        if material.use == "bushing" and material.name != joint.bushing.name
    ]

    def order(one: Substitute) -> tuple[bool, int, float]:
        weakest = one.weakest
        if weakest is None:
            return False, len(one.unknown), 0.0
        return not weakest.holds, len(one.unknown), -weakest.margin

    return tuple(sorted(tried, key=order))
