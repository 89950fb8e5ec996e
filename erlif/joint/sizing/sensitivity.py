"""What the weakest margin depends on, and other bushings at the same dimensions."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from erlif.joint.sizing.joint import Joint
from erlif.joint.sizing.materials import Material
from erlif.joint.sizing.steps import Step
from erlif.joint.sizing.walk import Walk, margin_of, walk_guide

STEP = 1e-5
"""Relative step of the central differences; the margins are smooth to nine digits. [1]"""

_PERCENT = 0.01
_LARGEST_RATIO = 0.4999  # Poisson's ratio up to which it can grow
_YIELD = "yield_stress"
_SMALLEST = 1e-8  # change of a margin that is rounding

_NUMBERS = {
    "force": "load",
    "mean_force": "mean load",
    "safety": "safety factor",
    "half_swing": "half swing",
    "period": "period",
    "life": "life",
    "largest_wear": "largest wear",
    "friction": "friction",
    "pin_diameter": "pin diameter",
    "hole_diameter": "hole in the pin",
    "bushing_width": "bushing width",
    "wall": "bushing wall",
    "seat_width": "seat width",
    "housing_diameter": "housing diameter",
    "play": "play before pressing",
    "interference": "interference",
    "lateral_play": "lateral play",
    "pin_roughness": "roughness of the pin",
    "bushing_roughness": "roughness of the bushing",
}
"""Numbers of a joint that are varied by 1 %, as a reader names them."""

_TEMPERATURES = {
    "outside_temperature": "temperature outside",
    "assembly_temperature": "temperature of assembly",
    "grease_temperature": "temperature of the grease",
}
"""Those that are varied by 1 K."""

_LOCK = {
    "lever": "lever of the lock",
    "length": "length of the prongs",
    "thickness": "thickness of the plate",
    "throat": "throat of the weld",
    "height": "height of the prongs",
    "end_width": "width of the closed end",
    "weld_diameter": "diameter of the weld",
    "screw_diameter": "diameter of the screw",
    "screw_yield": "yield stress of the screw",
    "friction_bushing": "worst friction in the bushing",
    "friction_seat": "worst friction in the seats",
}

_PARTS = {"pin": "pin", "bushing": "bushing", "seat": "seats", "housing": "housing"}

_PROPERTIES = {
    "yield_stress": "yield stress",
    "ultimate_stress": "tensile strength",
    "hardness": "hardness",
    "youngs_modulus": "modulus",
    "poissons_ratio": "Poisson's ratio",
    "expansion": "expansion",
    "conductivity": "conductivity",
    "temperature": "temperature limit",
    "pressure": "pressure limit",
    "speed": "speed limit",
    "pv": "pv limit",
    "wear": "wear rate",
}


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
    walk : Walk
        The steps with it.
    """

    material: Material
    walk: Walk

    @property
    def weakest(self) -> Step | None:
        """The limit of the sliding surface with the smallest margin; None where none is known."""
        return next((step for step in self.walk.limits if step.key in _SURFACE), None)

    @property
    def missing(self) -> tuple[Step, ...]:
        """The limits of the sliding surface that could not be computed."""
        return tuple(step for step in self.walk.missing if step.key in _SURFACE)

    @property
    def unknown(self) -> tuple[Step, ...]:
        """The limits of the sliding surface that the table does not have for this material."""
        return tuple(
            step
            for step in self.walk.steps
            if step.key in _SURFACE
            and (step.missing or (step.kind == "result" and step.key in _OF_MATERIAL))
        )


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
"""Limits that depend on the bushing."""

_OF_MATERIAL = ("pressure_peak", "pv")
"""Those that are results where the material has no limit; most have none of the speed."""


def sensitivities(walk: Walk) -> tuple[Sensitivity, ...]:
    """Return the derivatives of the weakest margin, the largest first.

    Parameters
    ----------
    walk : Walk

    Returns
    -------
    tuple of Sensitivity
        Numbers on which the margin does not depend are left out; empty where it is unlimited or no
        limit is known.

    Examples
    --------
    A prong in bending, the weakest part of the example, loses 1.0 % of its margin and of 1 with 1 %
    of load:

    >>> from erlif.joint.sizing import example_joint, walk_guide
    >>> found = {one.name: one.change for one in sensitivities(walk_guide(example_joint()))}
    >>> print(f"{found['load']:.4f}, {found['thickness of the plate']:.4f}")
    -0.0102, 0.0102
    """
    weakest = walk.weakest
    if weakest is None or weakest.margin == float("inf"):
        return ()

    found = []
    for name, by, vary in _variations(walk.joint):
        above, below = (margin_of(vary(step), weakest.key) for step in (STEP, -STEP))
        slope = (above - below) / (2 * STEP)
        change = slope * (_PERCENT if by == "1 %" else 1.0)
        if abs(change) > _SMALLEST:
            found.append(Sensitivity(name, by, change))
    return tuple(sorted(found, key=lambda one: -abs(one.change)))


def _variations(joint: Joint) -> Iterator[tuple[str, str, Callable[[float], Joint]]]:
    """Name, change and the joint after a relative change, or one in kelvin."""
    for field, name in _NUMBERS.items():
        if getattr(joint, field):
            yield name, "1 %", partial(_vary, joint, (field,))
    for field, name in _TEMPERATURES.items():
        yield name, "1 K", partial(_vary, joint, (field,), shift=True)
    if joint.lock is not None:
        for field, name in _LOCK.items():
            if getattr(joint.lock, field):
                yield name, "1 %", partial(_vary, joint, ("lock", field))
        yield "yield stress of the plate", "1 %", partial(_vary, joint, ("lock", "plate", _YIELD))
    for part, title in _PARTS.items():
        for field, name in _PROPERTIES.items():
            value = getattr(getattr(joint, part), field)
            at_end = field == "poissons_ratio" and value is not None and value > _LARGEST_RATIO
            if value and not at_end:
                yield f"{name} of the {title}", "1 %", partial(_vary, joint, (part, field))


def _vary(table: Any, place: Sequence[str], by: float, *, shift: bool = False) -> Any:
    """A joint, lock or material whose number at a place is scaled, or shifted."""
    field, *inner = place
    if inner:
        return replace(table, **{field: _vary(getattr(table, field), inner, by, shift=shift)})

    # both ends of the range of hardness change
    fields = ("hardness_low", "hardness_high") if field == "hardness" else (field,)
    known = {name: getattr(table, name) for name in fields}
    return replace(
        table,
        **{
            name: value + by if shift else value * (1 + by)
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
    >>> from erlif.joint.sizing import example_joint, read_materials
    >>> found = substitutes(example_joint(), read_materials().values())
    >>> found[0].weakest.holds
    True
    """
    tried = [
        Substitute(material, walk_guide(replace(joint, bushing=material)))
        for material in materials
        if material.use == "bushing" and material.name != joint.bushing.name
    ]

    def order(one: Substitute) -> tuple[bool, int, float]:
        weakest = one.weakest
        if weakest is None:
            return False, len(one.unknown), 0.0
        return not weakest.holds, len(one.unknown), -weakest.margin

    return tuple(sorted(tried, key=order))
