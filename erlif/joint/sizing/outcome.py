"""The design of a joint: its steps, what was chosen, and what the weakest margin depends on."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from erlif.joint.sizing.assessment import Assessment
from erlif.joint.sizing.joint import Joint
from erlif.joint.sizing.materials import Material
from erlif.joint.sizing.practice import practice_notes
from erlif.joint.sizing.sensitivity import Sensitivity, Substitute, sensitivities, substitutes


@dataclass(frozen=True, repr=False)
class BearingDesign:
    """A designed joint.

    Attributes
    ----------
    name : str
        Name of the joint.
    assessment : Assessment
        All steps of the guide.
    chosen : tuple[str, ...]
        Dimensions that were chosen, in the order of `erlif.joint.sizing.DIMENSIONS`.
    series : str
        Preferred numbers to which they were rounded up; ``"none"`` for the least ones.
    settings : str
        The joint with all its dimensions, TOML.
    materials : tuple[Material, ...]
        The table of materials.
    assumed : tuple[str, ...]
        Parts whose material was not given and is the default.
    """

    name: str
    assessment: Assessment
    chosen: tuple[str, ...]
    series: str
    settings: str
    materials: tuple[Material, ...]
    assumed: tuple[str, ...] = ()

    def __repr__(self) -> str:
        joint, weakest = self.joint, self.assessment.weakest
        sizes = (
            f"pin {_millimetres(joint.pin_diameter)}, bushing {_millimetres(joint.bushing_width)}"
        )
        verdict = "no limit known"
        if weakest is not None:
            failed = len(self.assessment.failed)
            verdict = "all limits hold" if self.sound else f"limits exceeded: {failed}"
            verdict += f"; weakest {weakest.title}, margin {100 * weakest.margin:+.3g} %"
        return f"<BearingDesign {self.name!r}: {sizes}; {verdict}>"

    @property
    def joint(self) -> Joint:
        """The joint with all dimensions. SI units."""
        return self.assessment.joint

    @property
    def sound(self) -> bool:
        """Whether all limits hold."""
        return self.assessment.sound

    @property
    def notes(self) -> tuple[str, ...]:
        """What the guide does not check, and sizes that are unusual in practice."""
        return practice_notes(self.joint, chosen=self.chosen)

    @cached_property
    def sensitivities(self) -> tuple[Sensitivity, ...]:
        """What the weakest margin depends on, the largest first."""
        return sensitivities(self.assessment)

    @cached_property
    def substitutes(self) -> tuple[Substitute, ...]:
        """Other bushings of the table at the same dimensions."""
        return substitutes(self.joint, self.materials)


def _millimetres(length: float | None) -> str:
    return "unknown" if length is None else f"{length * 1e3:.4g} mm"
