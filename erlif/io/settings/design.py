"""The tables of joint.toml, from which `erlif design` sizes and checks a pin joint."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from annotated_types import Ge, Le
from pydantic import Field, model_validator

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

    name: Text = Field(description="Name, for report and tables.", examples=["boom of a loader"])
    materials: FileName | None = Field(
        None,
        description="Table of materials that adds to that of erlif, CSV, beside this file. `erlif "
        "design --materials` prints the columns.",
        examples=["materials.csv"],
    )


class LoadOfJoint(Settings):
    """Load and safety."""

    force: Force = Field(description="Largest load on the joint.", examples=["100 kN"])
    mean_force: Force | None = Field(
        None,
        description="Mean load in motion, for heat, pv and wear. Default: the largest load.",
        examples=["60 kN"],
    )
    safety: float = Field(
        ge=1,
        le=100,
        description="Safety factor on every strength. The guide gives none, as it depends on the "
        "application.",
        examples=[2.0],
    )

    @model_validator(mode="after")
    def _mean_is_not_larger(self) -> Self:
        if self.mean_force is not None and self.mean_force > self.force:
            raise ValueError(
                f"expected a mean_force up to the largest load, {self.force:g} N; got "
                f"{self.mean_force:g} N"
            )
        return self


class MotionOfJoint(Settings):
    """Oscillation. Without it speed, pv, temperature and wear are left out."""

    half_swing: HalfSwing = Field(description="Half of the angle from end to end.")
    period: Time = Field(description="Time of a swing forth and back.")


class LifeOfJoint(Settings):
    """Life. Without it wear is left out."""

    time: Time = Field(description="Time in motion.", examples=["5000 h"])
    largest_wear: Length | None = Field(
        None,
        description="Depth of the bushing that may wear away. Default: wear has no limit.",
        examples=["0.5 mm"],
    )


class PartOfJoint(Settings):
    """A part of the joint by its material; the other keys change values of the table."""

    material: Text = Field(
        "",
        description="Name in the table of materials. Default: none, all values are given here.",
        examples=["42CrMo4 QT"],
    )
    yield_stress: Pressure | None = Field(
        None, description="Yield stress or 0.2 % proof stress.", examples=["650 MPa"]
    )
    ultimate_stress: Pressure | None = Field(
        None,
        description="Tensile strength, from which hardness follows where it is not known.",
        examples=["900 MPa"],
    )
    hardness: Hardness | None = Field(
        None, description="Hardness of the surface, in HB, HV or MPa.", examples=["200 HB"]
    )
    youngs_modulus: Pressure | None = Field(
        None, description="Young's modulus.", examples=["210 GPa"]
    )
    poissons_ratio: float | None = Field(
        None, ge=0, le=0.5, description="Poisson's ratio.", examples=[0.3]
    )
    expansion: Expansion | None = Field(
        None, description="Coefficient of linear thermal expansion.", examples=["12e-6 1/K"]
    )
    conductivity: Conductivity | None = Field(
        None, description="Thermal conductivity.", examples=["42 W/m/K"]
    )


class PinOfJoint(PartOfJoint):
    """The pin."""

    diameter: Length | None = Field(
        None, description="Diameter. Default: it is chosen.", examples=["80 mm"]
    )
    hole: LengthOrZero = Field(
        0.0,
        description="Lubrication hole across the pin, where bending is largest.",
        validate_default=False,
    )
    roughness: Length | None = Field(None, description="Ra.", examples=["0.4 um"])


class BushingOfJoint(PartOfJoint):
    """The bushing."""

    width: Length | None = Field(
        None, description="Width. Default: it is chosen.", examples=["100 mm"]
    )
    wall: Length | None = Field(
        None, description="Wall thickness. Default: a tenth of the pin.", examples=["8 mm"]
    )
    roughness: Length | None = Field(None, description="Ra.", examples=["0.8 um"])
    largest_temperature: Temperature | None = Field(
        None, description="Highest temperature of use.", examples=["230 degC"]
    )
    largest_pressure: Pressure | None = Field(
        None, description="Largest projected pressure in motion.", examples=["140 MPa"]
    )
    largest_speed: SlidingSpeed | None = Field(None, description="Largest sliding speed.")
    pv_limit: PressureVelocity | None = Field(
        None, description="Largest product of projected pressure and speed."
    )
    wear: WearRate | None = Field(
        None,
        description="Specific wear rate k of eq. 32, from a test of the same pair and grease. "
        "Without it wear is left out.",
    )


class SeatOfJoint(PartOfJoint):
    """The two seats of the pin."""

    width: Length | None = Field(
        None, description="Width of each seat. Default: it is chosen.", examples=["40 mm"]
    )


class HousingOfJoint(PartOfJoint):
    """The eye that holds the bushing."""

    diameter: Length | None = Field(
        None, description="Outer diameter. Default: it is chosen.", examples=["200 mm"]
    )


class FitOfJoint(Settings):
    """Play and press fit."""

    play: SignedLength | None = Field(
        None,
        description="Bore of the bushing, before it is pressed in, less diameter of the pin; "
        "negative for an interference. Default: it is chosen.",
        examples=["160 um"],
    )
    interference: LengthOrZero = Field(
        0.0,
        description="Outer diameter of the bushing less bore of the housing.",
        validate_default=False,
        examples=["60 um"],
    )
    lateral_play: LengthOrZero = Field(
        0.0,
        description="Play between bushing and seats, both sides together.",
        validate_default=False,
        examples=["1 mm"],
    )


class LubricationOfJoint(Settings):
    """Friction and temperatures."""

    friction: float = Field(
        0.1,
        ge=0,
        le=2,
        description="Friction coefficient: 0.1 newly greased, up to 0.8 dry.",
    )
    outside_temperature: Temperature = Field(
        60.0, description="Temperature on the outside of the bushing.", validate_default=False
    )
    assembly_temperature: Temperature = Field(
        20.0, description="Temperature at which play is measured.", validate_default=False
    )
    largest_temperature: Temperature = Field(
        120.0, description="Highest temperature of the grease.", validate_default=False
    )


class LockOfJoint(PartOfJoint):
    """Lock plate of the pin. Without it there is none."""

    kind: Literal["open", "closed"] = Field(description="Slot of the plate.")
    lever: Length = Field(
        description="Distance of the screw from the axis of the pin.", examples=["80 mm"]
    )
    length: Length = Field(
        description="Lever of the screw on the prongs, to their root.", examples=["30 mm"]
    )
    thickness: Length = Field(
        10e-3, description="Thickness of the plate.", validate_default=False, examples=["10 mm"]
    )
    height: Length | None = Field(
        None, description="Height of a prong. Default: it is chosen.", examples=["60 mm"]
    )
    end_width: Length | None = Field(
        None,
        description="Width of the closed end. Default: it is chosen.",
        examples=["10 mm"],
    )
    weld: Literal["internal", "external"] | None = Field(
        None, description="Default: internal where there is room, else external."
    )
    throat: Length | None = Field(
        None,
        description="Effective throat of the weld. Default: 3 mm, or more where it must be.",
        examples=["3 mm"],
    )
    weld_diameter: Length | None = Field(
        None, description="Inner diameter of the weld. Default: it is chosen.", examples=["60 mm"]
    )
    screw_diameter: Length | None = Field(
        None,
        description="Diameter of the screw where it is sheared. Default: it is chosen, if "
        "screw_yield is given.",
        examples=["24 mm"],
    )
    screw_yield: Pressure | None = Field(
        None, description="Yield stress of the screw.", examples=["640 MPa"]
    )
    friction_bushing: float = Field(
        1.0, ge=0, le=2, description="Worst friction in the bushing, which turns the pin."
    )
    friction_seat: float = Field(
        0.0, ge=0, le=2, description="Worst friction in the seats, which holds it."
    )


class SizingOptions(Settings):
    """How dimensions are chosen."""

    series: Literal["none", "R10", "R20", "R40"] = Field(
        "none",
        description="Preferred numbers of ISO 3 to which chosen lengths are rounded up; "
        '"none" leaves the least ones.',
    )
    eye_ratio: float = Field(
        3.0,
        ge=2,
        le=4,
        description="Outer over inner diameter of a housing eye that is chosen: the bushing is "
        "made wide enough for it. A smaller eye is lighter and needs a wider bushing.",
    )


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

    @model_validator(mode="after")
    def _hole_is_smaller_than_the_pin(self) -> Self:
        if self.pin.diameter is not None and self.pin.hole >= self.pin.diameter:
            raise ValueError(
                f"expected a hole smaller than the pin, {self.pin.diameter * 1e3:g} mm; got "
                f"{self.pin.hole * 1e3:g} mm"
            )
        return self
