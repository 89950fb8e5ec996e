"""The tables of joint.toml, from which `erlif design` sizes and checks a pin joint."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Literal

from annotated_types import Ge, Le
from pydantic import Field

from erlif.io.settings.reading import read_named
from erlif.io.settings.tables import FileName, Settings, Text, quantity

# wide bounds, beyond which a value is a slip and the equations leave the range of numbers
Force = Annotated[float, *quantity("force", "100 kN", "N", Ge(1e-3), Le(1e10))]
Length = Annotated[float, *quantity("length", "80 mm", "m", Ge(1e-8), Le(100.0))]
SignedLength = Annotated[float, *quantity("length", "-20 um", "m", Ge(-1.0), Le(1.0))]
LengthOrZero = Annotated[float, *quantity("length", "0 mm", "m", Ge(0), Le(100.0))]
Pressure = Annotated[float, *quantity("pressure", "650 MPa", "Pa", Ge(1e3), Le(1e13))]
HalfSwing = Annotated[float, *quantity("angle", "30 deg", "rad", Ge(0), Le(3.1415926536))]
Time = Annotated[float, *quantity("time", "6 s", "s", Ge(1e-6), Le(1e12))]
Temperature = Annotated[float, *quantity("temperature", "60 degC", "degC", Ge(-200), Le(2000))]
Hardness = Annotated[float, *quantity("hardness", "200 HB", "HB", Ge(0.01), Le(1e4))]
Expansion = Annotated[float, *quantity("thermal expansion", "18e-6 1/K", "1/K", Ge(0), Le(0.01))]
Conductivity = Annotated[
    float, *quantity("thermal conductivity", "39 W/m/K", "W/m/K", Ge(1e-3), Le(1e4))
]
SlidingSpeed = Annotated[float, *quantity("sliding speed", "0.4 m/s", "m/s", Ge(1e-6), Le(1e3))]
PressureVelocity = Annotated[float, *quantity("pv", "1.5 W/mm^2", "W/m^2", Ge(1.0), Le(1e12))]
WearRate = Annotated[
    float, *quantity("specific wear rate", "1e-8 mm3/N/m", "m^2/N", Ge(0), Le(1e-6))
]


class NameOfJoint(Settings):
    """The joint."""

    name: Text
    materials: FileName | None = None


class LoadOfJoint(Settings):
    """Load and safety."""

    force: Force
    mean_force: Force | None = None
    safety: float = Field(strict=True, ge=1, le=100)

    def faults(self) -> Iterator[str]:
        if self.mean_force is not None and self.mean_force > self.force:
            yield (
                f"expected a mean_force up to the largest load, {self.force:g} N; got "
                f"{self.mean_force:g} N"
            )


class MotionOfJoint(Settings):
    """Oscillation. Without it speed, pv, temperature and wear are left out."""

    half_swing: HalfSwing
    period: Time


class LifeOfJoint(Settings):
    """Life. Without it wear is left out."""

    time: Time
    largest_wear: Length | None = None


class PartOfJoint(Settings):
    """A part of the joint by its material; the other keys change values of the table."""

    material: Text = ""
    yield_stress: Pressure | None = None
    ultimate_stress: Pressure | None = None
    hardness: Hardness | None = None
    youngs_modulus: Pressure | None = None
    poissons_ratio: float | None = Field(None, strict=True, ge=0, le=0.5)
    expansion: Expansion | None = None
    conductivity: Conductivity | None = None


class PinOfJoint(PartOfJoint):
    """The pin."""

    diameter: Length | None = None
    hole: LengthOrZero = 0.0
    roughness: Length | None = None


class BushingOfJoint(PartOfJoint):
    """The bushing."""

    width: Length | None = None
    wall: Length | None = None
    roughness: Length | None = None
    largest_temperature: Temperature | None = None
    largest_pressure: Pressure | None = None
    largest_speed: SlidingSpeed | None = None
    pv_limit: PressureVelocity | None = None
    wear: WearRate | None = None


class SeatOfJoint(PartOfJoint):
    """The two seats of the pin."""

    width: Length | None = None


class HousingOfJoint(PartOfJoint):
    """The eye that holds the bushing."""

    diameter: Length | None = None


class FitOfJoint(Settings):
    """Play and press fit."""

    play: SignedLength | None = None
    interference: LengthOrZero = 0.0
    lateral_play: LengthOrZero = 0.0


class LubricationOfJoint(Settings):
    """Friction and temperatures."""

    friction: float = Field(0.1, strict=True, ge=0, le=2)
    outside_temperature: Temperature = 60.0
    assembly_temperature: Temperature = 20.0
    largest_temperature: Temperature = 120.0


class LockOfJoint(PartOfJoint):
    """Lock plate of the pin. Without it there is none."""

    kind: Literal["open", "closed"]
    lever: Length
    length: Length
    thickness: Length = 10e-3
    height: Length | None = None
    end_width: Length | None = None
    weld: Literal["internal", "external"] | None = None
    throat: Length | None = None
    weld_diameter: Length | None = None
    screw_diameter: Length | None = None
    screw_yield: Pressure | None = None
    friction_bushing: float = Field(1.0, strict=True, ge=0, le=2)
    friction_seat: float = Field(0.0, strict=True, ge=0, le=2)


class SizingOptions(Settings):
    """How dimensions are chosen."""

    series: Literal["none", "R10", "R20", "R40"] = "none"
    eye_ratio: float = Field(3.0, strict=True, ge=2, le=4)
    largest_diameter: Length | None = None


class DesignSettings(Settings):
    """joint.toml."""

    joint: NameOfJoint
    load: LoadOfJoint
    motion: MotionOfJoint | None = None
    life: LifeOfJoint | None = None
    pin: PinOfJoint
    bushing: BushingOfJoint
    seat: SeatOfJoint = SeatOfJoint(material="S355")
    housing: HousingOfJoint = HousingOfJoint(material="S355")
    fit: FitOfJoint = FitOfJoint()
    lubrication: LubricationOfJoint = LubricationOfJoint()
    lock: LockOfJoint | None = None
    sizing: SizingOptions = SizingOptions()

    @property
    def name(self) -> str:
        """Name of the joint."""
        return self.joint.name

    def faults(self) -> Iterator[str]:
        if self.pin.diameter is not None and self.pin.hole >= self.pin.diameter:
            yield (
                f"expected a hole smaller than the pin, {self.pin.diameter * 1e3:g} mm; got "
                f"{self.pin.hole * 1e3:g} mm"
            )


def read_design_settings(path: Path) -> DesignSettings:
    """Read and check a joint, the input of `erlif.joint.design`.

    Errors as for `erlif.io.settings.read_run_settings`; `path` is the file, joint.toml.

    Returns
    -------
    DesignSettings

    Examples
    --------
    >>> read_design_settings(Path("no joint.toml"))  # doctest: +ELLIPSIS
    Traceback (most recent call last):
        ...
    erlif.core.errors.ConfigError: Expected a joint in no joint.toml; there is no such file. ...
    """
    hint = "Make one with: erlif design --example > joint.toml"
    return read_named(path, DesignSettings, holds="a joint", hint=hint)
