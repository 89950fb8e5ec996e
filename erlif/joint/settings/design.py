"""The tables of joint.toml, from which `erlif design` sizes and checks a pin joint."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Literal

from annotated_types import Ge, Le
from pydantic import Field

from erlif.io.settings.reading import read_named
from erlif.io.settings.values import FileName, Settings, Text, quantity

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

    name: Text = Field(examples=["boom of a loader"])
    """Name, for report and tables."""
    materials: FileName | None = Field(None, examples=["materials.csv"])
    """Table of materials that adds to that of erlif, CSV, beside this file. `erlif design
    --materials` prints the columns."""


class LoadOfJoint(Settings):
    """Load and safety."""

    force: Force
    """Largest load on the joint."""
    mean_force: Force | None = Field(None, examples=["60 kN"])
    """Mean load in motion, for heat, pv and wear. Default: the largest load."""
    safety: float = Field(strict=True, ge=1, le=100, examples=[2.0])
    """Safety factor on every strength. The guide gives none, as it depends on the application."""

    def faults(self) -> Iterator[str]:
        if self.mean_force is not None and self.mean_force > self.force:
            yield (
                f"expected a mean_force up to the largest load, {self.force:g} N; got "
                f"{self.mean_force:g} N"
            )


class MotionOfJoint(Settings):
    """Oscillation. Without it speed, pv, temperature and wear are left out."""

    half_swing: HalfSwing
    """Half of the angle from end to end."""
    period: Time
    """Time of a swing forth and back."""


class LifeOfJoint(Settings):
    """Life. Without it wear is left out."""

    time: Time = Field(examples=["5000 h"])
    """Time in motion."""
    largest_wear: Length | None = Field(None, examples=["0.5 mm"])
    """Depth of the bushing that may wear away. Default: wear has no limit."""


class PartOfJoint(Settings):
    """A part of the joint by its material; the other keys change values of the table."""

    material: Text = Field("", examples=["42CrMo4 QT"])
    """Name in the table of materials. Default: none, all values are given here."""
    yield_stress: Pressure | None = None
    """Yield stress or 0.2 % proof stress."""
    ultimate_stress: Pressure | None = Field(None, examples=["900 MPa"])
    """Tensile strength, from which hardness follows where it is not known."""
    hardness: Hardness | None = None
    """Hardness of the surface, in HB, HV or MPa."""
    youngs_modulus: Pressure | None = Field(None, examples=["210 GPa"])
    """Young's modulus."""
    poissons_ratio: float | None = Field(None, strict=True, ge=0, le=0.5, examples=[0.3])
    """Poisson's ratio."""
    expansion: Expansion | None = Field(None, examples=["12e-6 1/K"])
    """Coefficient of linear thermal expansion."""
    conductivity: Conductivity | None = Field(None, examples=["42 W/m/K"])
    """Thermal conductivity."""


class PinOfJoint(PartOfJoint):
    """The pin."""

    diameter: Length | None = None
    """Diameter. Default: it is chosen."""
    hole: LengthOrZero = 0.0
    """Lubrication hole across the pin, where bending is largest."""
    roughness: Length | None = Field(None, examples=["0.4 um"])
    """Ra."""


class BushingOfJoint(PartOfJoint):
    """The bushing."""

    width: Length | None = Field(None, examples=["100 mm"])
    """Width. Default: it is chosen."""
    wall: Length | None = Field(None, examples=["8 mm"])
    """Wall thickness. Default: a tenth of the pin."""
    roughness: Length | None = Field(None, examples=["0.8 um"])
    """Ra."""
    largest_temperature: Temperature | None = Field(None, examples=["230 degC"])
    """Highest temperature of use."""
    largest_pressure: Pressure | None = Field(None, examples=["140 MPa"])
    """Largest projected pressure in motion."""
    largest_speed: SlidingSpeed | None = None
    """Largest sliding speed."""
    pv_limit: PressureVelocity | None = None
    """Largest product of projected pressure and speed."""
    wear: WearRate | None = None
    """Specific wear rate k of eq. 32, from a test of the same pair and grease. Without it wear is
    left out."""


class SeatOfJoint(PartOfJoint):
    """The two seats of the pin."""

    width: Length | None = Field(None, examples=["40 mm"])
    """Width of each seat. Default: it is chosen."""


class HousingOfJoint(PartOfJoint):
    """The eye that holds the bushing."""

    diameter: Length | None = Field(None, examples=["200 mm"])
    """Outer diameter. Default: it is chosen."""


class FitOfJoint(Settings):
    """Play and press fit."""

    play: SignedLength | None = Field(None, examples=["160 um"])
    """Bore of the bushing, before it is pressed in, less diameter of the pin; negative for an
    interference. Default: it is chosen."""
    interference: LengthOrZero = Field(0.0, examples=["60 um"])
    """Outer diameter of the bushing less bore of the housing."""
    lateral_play: LengthOrZero = Field(0.0, examples=["1 mm"])
    """Play between bushing and seats, both sides together."""


class LubricationOfJoint(Settings):
    """Friction and temperatures."""

    friction: float = Field(0.1, strict=True, ge=0, le=2)
    """Friction coefficient: 0.1 newly greased, up to 0.8 dry."""
    outside_temperature: Temperature = 60.0
    """Temperature on the outside of the bushing, one value: design once for each end of a range."""
    assembly_temperature: Temperature = 20.0
    """Temperature at which play is measured."""
    largest_temperature: Temperature = 120.0
    """Highest temperature of the grease."""


class LockOfJoint(PartOfJoint):
    """Lock plate of the pin. Without it there is none."""

    kind: Literal["open", "closed"]
    """Slot of the plate."""
    lever: Length
    """Distance of the screw from the axis of the pin."""
    length: Length = Field(examples=["30 mm"])
    """Lever of the screw on the prongs, to their root."""
    thickness: Length = Field(10e-3, examples=["10 mm"])
    """Thickness of the plate."""
    height: Length | None = Field(None, examples=["60 mm"])
    """Height of a prong. Default: it is chosen."""
    end_width: Length | None = Field(None, examples=["10 mm"])
    """Width of the closed end. Default: it is chosen."""
    weld: Literal["internal", "external"] | None = None
    """Default: internal where there is room, else external."""
    throat: Length | None = Field(None, examples=["3 mm"])
    """Effective throat of the weld. Default: 3 mm, or more where it must be."""
    weld_diameter: Length | None = Field(None, examples=["60 mm"])
    """Inner diameter of the weld. Default: it is chosen."""
    screw_diameter: Length | None = Field(None, examples=["24 mm"])
    """Diameter of the screw where it is sheared. Default: it is chosen, if screw_yield is given."""
    screw_yield: Pressure | None = Field(None, examples=["640 MPa"])
    """Yield stress of the screw."""
    friction_bushing: float = Field(1.0, strict=True, ge=0, le=2)
    """Worst friction in the bushing, which turns the pin."""
    friction_seat: float = Field(0.0, strict=True, ge=0, le=2)
    """Worst friction in the seats, which holds it."""


class SizingOptions(Settings):
    """How dimensions are chosen."""

    series: Literal["none", "R10", "R20", "R40"] = "none"
    """Preferred numbers of ISO 3 to which chosen lengths are rounded up, with a seat of at least a
    quarter of the pin and a play of at least a tolerance of ISO 286-1, grade 7; "none" leaves the
    least ones."""
    eye_ratio: float = Field(3.0, strict=True, ge=2, le=4)
    """Outer over inner diameter of a housing eye that is chosen. A smaller eye is lighter and needs
    a wider bushing."""
    largest_diameter: Length | None = Field(None, examples=["40 mm"])
    """Largest pin diameter that is chosen. Where no pin up to it is enough, the steps that fail are
    stated. Default: none."""


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
