"""run.toml and fixture.toml as frozen, checked settings.

Quantities arrive as text with a unit and are kept as floats in the unit that each field's description names
(SI throughout, but nm for a band, electrons and DN for a camera, degC for Vogel's temperature).
"""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, PlainSerializer, model_validator

from erlif.core.units import parse_quantity


def _quantity(unit: str) -> Any:
    """Annotations of a field that is written with its unit and kept as a float in `unit`."""
    return (
        BeforeValidator(lambda text: parse_quantity(text, unit)),
        PlainSerializer(lambda value: f"{value!r} {unit}", return_type=str),
    )


Length = Annotated[float, *_quantity("m"), Field(gt=0)]


Angle = Annotated[float, *_quantity("rad")]


Speed = Annotated[float, *_quantity("rad/s"), Field(gt=0)]


Force = Annotated[float, *_quantity("N"), Field(gt=0)]


Pressure = Annotated[float, *_quantity("Pa"), Field(gt=0)]


Viscosity = Annotated[float, *_quantity("Pa s"), Field(gt=0)]


PressureViscosity = Annotated[float, *_quantity("1/Pa"), Field(ge=0)]


Wavelength = Annotated[float, *_quantity("nm"), Field(gt=0)]


Counts = Annotated[float, *_quantity("DN"), Field(ge=0)]


Gain = Annotated[float, *_quantity("electron/DN"), Field(gt=0)]


Electrons = Annotated[float, *_quantity("electron"), Field(gt=0)]


Temperature = Annotated[float, *_quantity("degC")]


TemperatureDifference = Annotated[float, *_quantity("delta_degC"), Field(gt=0)]


Interval = tuple[float, float]


Text = Annotated[str, Field(pattern=r"^[^\x00-\x1f\x7f]*$")]


FileName = Annotated[str, Field(min_length=1, pattern=r"^[^\x00-\x1f\x7f]*$")]


class Settings(BaseModel):
    """A table of a settings file: frozen, and closed to keys it does not know."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


class CameraSettings(Settings):
    """One camera: where its frames are and how its counts become electrons."""

    files: FileName = Field(
        description="pattern of the frame files, or one multi-page file, relative to the settings file"
    )
    band: Wavelength = Field(description="centre of the filter band [nm]")
    bit_depth: int = Field(12, ge=8, le=16, description="bits per pixel")
    dark: FileName | None = Field(None, description="file of dark frames")
    offset: Counts | None = Field(
        None, description="dark level where no dark frames were taken [DN]"
    )
    flat: FileName | None = Field(
        None, description="file of flat frames, of one or several light levels"
    )
    gain: Gain | None = Field(
        None, description="photo-electrons per count; measured from the flats if absent"
    )
    read_noise: Electrons | None = Field(
        None, description="rms read noise; measured from the darks if absent"
    )

    @property
    def full_scale(self) -> int:
        """The largest count the camera can give [DN]."""
        return (1 << self.bit_depth) - 1

    @model_validator(mode="after")
    def _dark_or_offset(self) -> Self:
        if self.dark is not None and self.offset is not None:
            raise ValueError("give either dark (a file) or offset (a level), not both")
        if self.dark is None and self.offset is None:
            raise ValueError(
                'give the dark frames as dark = "file.tif", or a level as offset = "64 DN"'
            )
        return self


class OpticsSettings(Settings):
    """What a pixel of camera 1 is in the object plane."""

    pixel_pitch: Length = Field(description="size of a pixel of camera 1 in the object plane [m]")
    x_axis: Literal["sliding", "axial"] = Field(
        "sliding", description="direction of the joint along image x"
    )


class EncoderSettings(Settings):
    """The encoder and its log."""

    file: FileName = Field(description="the log, one row per trigger")
    mounted_on: Literal["rocker", "crank"] = "rocker"
    zero: Angle | None = Field(
        None, description="angle of the link the encoder sits on at reading 0 [rad]"
    )
    triggers_per_cycle: int | None = Field(None, ge=2, description="for folding several cycles")


class CrankRockerSettings(Settings):
    """The four links [m] and the speed of the crank [rad/s]."""

    kind: Literal["crank-rocker"]
    crank: Length
    coupler: Length
    rocker: Length
    ground: Length
    crank_speed: Speed


class SliderCrankSettings(Settings):
    """Crank and connecting rod [m] and the speed of the crank [rad/s]."""

    kind: Literal["slider-crank"]
    crank: Length
    coupler: Length
    crank_speed: Speed


class MaterialSettings(Settings):
    """One side of the joint."""

    youngs_modulus: Pressure = Field(description="[Pa]")
    poissons_ratio: float = Field(gt=-1, le=0.5)
    roughness: Length | None = Field(None, description="rms roughness [m]")


class JointSettings(Settings):
    """The pin and the bushing it turns in."""

    pin_radius: Length = Field(description="[m]")
    bushing_radius: Length = Field(description="[m]")
    length: Length = Field(description="loaded length along the axis [m]")
    load: Force | None = Field(None, description="used where the log has no load_N [N]")
    pin: MaterialSettings
    bushing: MaterialSettings

    @model_validator(mode="after")
    def _pin_fits(self) -> Self:
        if self.pin_radius >= self.bushing_radius:
            raise ValueError(
                f"pin_radius must be smaller than bushing_radius for the pin to turn; got {self.pin_radius * 1e3:g} mm "
                f"in {self.bushing_radius * 1e3:g} mm"
            )
        return self


class VogelSettings(Settings):
    """Vogel's law, viscosity = a exp(b/(T - c))."""

    a: Viscosity = Field(description="[Pa s]")
    b: TemperatureDifference = Field(description="[K]")
    c: Temperature = Field(description="[degC]")


class OilSettings(Settings):
    """The oil between pin and bushing."""

    name: Text = ""
    viscosity: Viscosity | None = Field(None, description="dynamic viscosity [Pa s]")
    vogel: VogelSettings | None = Field(
        None, description="viscosity by the logged temperature instead"
    )
    pressure_viscosity: PressureViscosity = Field(description="Barus coefficient [1/Pa]")

    @model_validator(mode="after")
    def _one_viscosity(self) -> Self:
        if (self.viscosity is None) == (self.vogel is None):
            raise ValueError('give either viscosity = "0.12 Pa s" or a vogel law { a, b, c }')
        return self


class RegistrationOptions(Settings):
    """How camera 2 is laid over camera 1."""

    window: int = Field(32, ge=16, le=256, description="interrogation window [px]")
    step: int = Field(8, ge=4, le=128, description="distance of window centres [px]")
    model: Literal["auto", "surface", "local"] = Field(
        "auto", description="smooth surface or window by window"
    )
    orientation: Literal[
        "normal", "mirrored_x", "mirrored_y", "rotated_90", "rotated_180", "rotated_270"
    ] = Field("normal", description="how camera 2 is mounted against camera 1")
    reuse: bool = Field(
        False,
        description="use the camera map stored with the calibration, once it is checked on this run's frames",
    )
    frames: int | None = Field(
        None,
        ge=1,
        description="frames used together for the fixed part of the map; default: 12 small or 4 large ones",
    )


class RegionOfInterest(Settings):
    """Where film statistics are taken [mm], from the centre of the first pixel."""

    x: Interval
    y: Interval

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        for name, (low, high) in (("x", self.x), ("y", self.y)):
            if not low < high:
                raise ValueError(
                    f"{name} must be [low, high] in mm with low < high; got [{low:g}, {high:g}]"
                )
        return self


class ThicknessOptions(Settings):
    """How film is read off the ratio and summed up."""

    roi: RegionOfInterest | None = Field(
        None, description="region of the film statistics; default: all of the image"
    )
    least_signal: Electrons = Field(
        100.0, description="darker pixels are flagged dim [electron]", validate_default=False
    )
    no_film_below: float = Field(
        0.25,
        gt=0,
        lt=1,
        description="fluorescence below this share of its surroundings counts as a bubble",
    )
    smoothing: int | None = Field(
        None,
        ge=2,
        le=50,
        description="resolution in pixels of the smoothed ratio; default: not smoothed",
    )


class RunName(Settings):
    """What the run is called."""

    name: Text


class RunSettings(Settings):
    """run.toml."""

    calibration: FileName | None = None
    run: RunName
    camera1: CameraSettings
    camera2: CameraSettings
    optics: OpticsSettings
    encoder: EncoderSettings
    mechanism: Annotated[CrankRockerSettings | SliderCrankSettings, Field(discriminator="kind")]
    joint: JointSettings
    oil: OilSettings
    registration: RegistrationOptions = RegistrationOptions()
    thickness: ThicknessOptions = ThicknessOptions()

    @property
    def name(self) -> str:
        """What the run is called."""
        return self.run.name


class FixtureProfile(Settings):
    """The calibration fixture and its profile from the coordinate measuring machine."""

    name: Text
    profile: FileName = Field(
        description="x_mm,thickness_um[,uncertainty_um] or x_mm,y_mm,thickness_um[,uncertainty_um]"
    )
    origin: tuple[float, float] = Field(
        (0.0, 0.0), description="pixel (x, y) of camera 1 at profile x = 0 (y = 0)"
    )
    direction: Angle = Field(
        0.0, description="turn from image x to profile x [rad]", validate_default=False
    )
    align: bool = Field(False, description="refine origin and scale against the image")


class FixtureSettings(Settings):
    """fixture.toml."""

    fixture: FixtureProfile
    camera1: CameraSettings
    camera2: CameraSettings
    optics: OpticsSettings
    registration: RegistrationOptions = RegistrationOptions()
    thickness: ThicknessOptions = ThicknessOptions()

    @property
    def name(self) -> str:
        """What the fixture is called."""
        return self.fixture.name
