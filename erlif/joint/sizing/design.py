"""From joint.toml to a sized and checked pin joint, and what its weakest margin depends on."""

from __future__ import annotations

import difflib
import math
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields, replace
from functools import cache, cached_property
from pathlib import Path
from typing import Any

from erlif.core.errors import ConfigError
from erlif.core.tables import read_table
from erlif.core.units import Quantity
from erlif.io.settings import settings_of, to_toml, write_example
from erlif.joint.settings import DesignSettings, LockOfJoint, PartOfJoint, read_design_settings
from erlif.joint.sizing.assessment import Assessment, assess_joint
from erlif.joint.sizing.joint import (
    DIMENSIONS,
    PARTS,
    Joint,
    Lock,
    dimensions_of,
    without_unit_warnings,
)
from erlif.joint.sizing.materials import Material, read_materials
from erlif.joint.sizing.practice import practice_notes, unchecked
from erlif.joint.sizing.sensitivity import Sensitivity, Substitute, sensitivities, substitutes
from erlif.joint.sizing.size import size_joint


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
    own : tuple[str, ...]
        Properties of materials that joint.toml gives, as ``"wear rate of the bushing"``.
    """

    name: str
    assessment: Assessment
    chosen: tuple[str, ...]
    series: str
    settings: str
    materials: tuple[Material, ...]
    assumed: tuple[str, ...] = ()
    own: tuple[str, ...] = ()

    def __repr__(self) -> str:
        size, weakest = dimensions_of(self.joint), self.assessment.weakest
        sizes = f"pin {size.pin * 1e3:.4g} mm, bushing {size.width * 1e3:.4g} mm"
        verdict = "no limit known"
        if weakest is not None:
            failed = len(self.assessment.failed)
            verdict = f"limits exceeded: {failed}"
            if self.sound:
                verdict = "all limits that are checked hold"
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
    def unchecked(self) -> tuple[str, ...]:
        """Failures without a step, and limits that could not be computed."""
        limits = (step.title for step in self.assessment.missing if step.kind == "limit")
        return (*unchecked(self.joint), *limits)

    @property
    def notes(self) -> tuple[str, ...]:
        """Notes on failures that the guide does not check, and on sizes unusual in practice."""
        notes = practice_notes(self.joint, chosen=self.chosen)
        clamped = self.assessment.step("pin_bending").margin
        if not math.isfinite(clamped):
            return notes
        supported = 100 * ((1 + clamped) / 2 - 1)
        support = (
            "The pin is taken as clamped in its seats. One that they only support has twice the "
            f"bending stress, a margin of {supported:+.0f} %."
        )
        return (support, *notes)

    @cached_property
    def sensitivities(self) -> tuple[Sensitivity, ...]:
        """Sensitivities of the weakest margin, the largest first."""
        return sensitivities(self.assessment)

    @cached_property
    def substitutes(self) -> tuple[Substitute, ...]:
        """Other bushings of the table at the same dimensions."""
        return substitutes(self.joint, self.materials)


def example_joint_file() -> str:
    """Write a commented joint.toml that works as it is.

    Returns
    -------
    str
        TOML.

    Examples
    --------
    >>> example_joint_file().count("[pin]")
    1
    """
    return write_example(DesignSettings, "erlif.joint.sizing", "example.toml")


def design(source: Path | str | DesignSettings, *, folder: Path | None = None) -> BearingDesign:
    """Size a pin joint and check it step by step, after Strand (2005), chapter 2.

    Parameters
    ----------
    source : Path or DesignSettings
        The file joint.toml, or its tables.
    folder : Path, optional
        Directory of the user's table of materials. Default: that of joint.toml.

    Returns
    -------
    BearingDesign
        A joint that exceeds a limit is a result too: its margin is negative.

    Raises
    ------
    ConfigError
        If the settings or the table of materials cannot be used.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as directory:
    ...     path = Path(directory, "joint.toml")
    ...     _ = path.write_text(example_joint_file(), encoding="utf-8")
    ...     designed = design(path)
    >>> designed.sound, f"{designed.joint.pin_diameter * 1e3:g} mm"
    (True, '31.5 mm')
    """
    settings, folder = settings_of(source, read_design_settings, folder)
    wanted = joint_of(settings, folder)
    with without_unit_warnings():  # quantities of joint.toml have units
        sized = size_joint(wanted, series=settings.sizing.series)
        assessment = assess_joint(sized)
    return BearingDesign(
        name=settings.name,
        assessment=assessment,
        chosen=tuple(name for name in DIMENSIONS if getattr(wanted, name) is None),
        series=settings.sizing.series,
        settings=to_toml(sized_settings(settings, sized)),
        materials=tuple(_materials(settings, folder).values()),
        assumed=tuple(
            part for part in ("seat", "housing") if part not in settings.model_fields_set
        ),
        own=tuple(_own_values(settings)),
    )


@cache
def example_joint() -> Joint:
    """Return the joint of the examples, of a wheel loader, with all dimensions.

    Returns
    -------
    Joint

    Examples
    --------
    >>> example_joint().pin_diameter
    0.08
    """
    example = read_table("erlif.joint.sizing", "example.toml")["joint"]
    return joint_of(DesignSettings.model_validate(example), Path())


@cache
def example_design() -> BearingDesign:
    """Return the design of the joint that `erlif design --example` prints.

    Returns
    -------
    BearingDesign

    Examples
    --------
    >>> example_design().name
    'boom of a loader'
    """
    return design(DesignSettings.model_validate(tomllib.loads(example_joint_file())))


def joint_of(settings: DesignSettings, folder: Path) -> Joint:
    """Return the joint of a settings file in SI units.

    Parameters
    ----------
    settings : DesignSettings
    folder : Path
        Directory of the user's table of materials.

    Returns
    -------
    Joint
        Dimensions that are not given are None.

    Raises
    ------
    ConfigError
        If a material is not in the table, or the table cannot be read.

    Examples
    --------
    >>> import tomllib
    >>> settings = DesignSettings.model_validate(tomllib.loads(example_joint_file()))
    >>> joint_of(settings, Path()).bushing.name
    'CuAl10Ni5Fe4'
    """
    materials = _materials(settings, folder)
    numbers = {
        name: float(value)
        for name, (table, key) in _places().items()
        if (value := getattr(getattr(settings, table), key, None)) is not None
    }
    _require_known(settings, materials)
    parts = {part: _material(getattr(settings, part), materials) for part in PARTS}
    lock = None if settings.lock is None else _lock(settings.lock, materials)
    return Joint(**numbers, **parts, lock=lock)  # type: ignore[arg-type]


@cache
def _places() -> dict[str, tuple[str, str]]:
    """Table and key of each number of a joint."""
    numbers = read_table("erlif.joint.sizing", "quantities.toml")["joint"]
    return {name: tuple(number["place"].split(".")) for name, number in numbers.items()}


def _materials(settings: DesignSettings, folder: Path) -> Mapping[str, Material]:
    own = settings.joint.materials
    return read_materials(None if own is None else folder / own)


def _require_known(settings: DesignSettings, materials: Mapping[str, Material]) -> None:
    """Refuse materials that are not in the table, all at once."""
    faults = []
    for table in (*PARTS, "lock"):
        name = getattr(getattr(settings, table), "material", "")
        if name and name not in materials:
            near = difflib.get_close_matches(name, materials, n=3, cutoff=0.4)
            hint = f"did you mean {' or '.join(map(repr, near))}?" if near else "nothing is near"
            faults.append(f"[{table}] material = {name!r}: {hint}")
    if faults:
        raise ConfigError(
            f"Expected materials of the table; got {'; '.join(faults)}. "
            "Correct the names; erlif design --materials lists them."
        )


def _material(part: PartOfJoint, materials: Mapping[str, Material]) -> Material:
    """Material of a part, with the values that joint.toml changes."""
    known = materials[part.material] if part.material else Material("", source="joint.toml")
    changed: dict[str, Any] = {
        field: float(value)
        for field, number in read_table("erlif.joint.sizing", "quantities.toml")["material"].items()
        if (value := getattr(part, number.get("place", ""), None)) is not None
    }
    if not known.name:
        return replace(known, name="as given", **changed)
    other = any(getattr(known, field) not in (None, value) for field, value in changed.items())
    return replace(known, name=f"{known.name}, changed" if other else known.name, **changed)


def _lock(lock: LockOfJoint, materials: Mapping[str, Material]) -> Lock:
    known = {field.name: getattr(lock, field.name) for field in fields(Lock)[2:]}
    return Lock(lock.kind, _material(lock, materials), **known)


def _own_values(settings: DesignSettings) -> Iterator[str]:
    """Names of the properties that joint.toml gives, of the parts with a material of the table."""
    numbers = read_table("erlif.joint.sizing", "quantities.toml")["material"].values()
    names = {one["place"]: one.get("name", one["place"]) for one in numbers if "place" in one}
    for part in (*PARTS, "lock"):
        table = getattr(settings, part)
        for key, name in names.items():
            if table is not None and table.material and getattr(table, key, None) is not None:
                yield f"{name} of the {part}"


_LOCK_LENGTHS = ("height", "end_width", "throat", "weld_diameter", "screw_diameter")


def sized_settings(settings: DesignSettings, joint: Joint) -> DesignSettings:
    """Return the settings with the dimensions that were chosen.

    Parameters
    ----------
    settings : DesignSettings
    joint : Joint
        With all dimensions.

    Returns
    -------
    DesignSettings

    Examples
    --------
    >>> import tomllib
    >>> settings = DesignSettings.model_validate(tomllib.loads(example_joint_file()))
    >>> sized = size_joint(joint_of(settings, Path()), series="R20")
    >>> sized_settings(settings, sized).pin.diameter.text
    '31.5 mm'
    """
    lengths = {_places()[name]: getattr(joint, name) for name in DIMENSIONS}
    changed: dict[str, dict[str, Any]] = {}
    if joint.lock is not None:
        lengths |= {("lock", key): getattr(joint.lock, key) for key in _LOCK_LENGTHS}
        changed["lock"] = {"weld": joint.lock.weld}
    for (table, key), length in lengths.items():
        if getattr(getattr(settings, table), key) is None and length is not None:
            # with all its digits
            text = f"{length * 1e3:.12g} mm"
            changed.setdefault(table, {})[key] = Quantity(length, text)
    tables = {
        table: getattr(settings, table).model_copy(update=keys) for table, keys in changed.items()
    }
    return settings.model_copy(update=tables)
