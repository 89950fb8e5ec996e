"""The tables of run.toml and fixture.toml as frozen, checked settings.

A quantity is written as text with a unit and kept as a float in the unit of its type (`Form.unit`):
SI, but nm for a band, electrons and DN for a camera, degC for Vogel's temperature. Its text is kept
with it (`Quantity`), so that settings are stored as the user wrote them.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated, Any, Literal, Self

from annotated_types import Ge, Gt, Le
from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    PlainSerializer,
    StrictFloat,
    WithJsonSchema,
    WrapValidator,
    create_model,
    model_validator,
)

from erlif.core.terms import keys_in
from erlif.core.units import Quantity, parse_quantity


@dataclass(frozen=True)
class Form:
    """Form of a value in a settings file; part of the type of a field.

    Attributes
    ----------
    name : str
        Kind of value, "length" or "file name".
    example : Any
        Value as a user writes it.
    unit : str
        Unit in which a quantity is kept, in pint's spelling; empty for other values.
    """

    name: str
    example: Any
    unit: str = ""


# A number and a unit, for the JSON schema; `erlif.core.units.parse_quantity` checks the unit.
QUANTITY_PATTERN = (
    r"^\s*[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]{1,3})?"  # the number
    r"\s*(1\s*/\s*)?[^0-9\s.,?].*$"  # the unit, as in "mm" or "1/GPa"
)


def _write_quantity(value: float, unit: str) -> str:
    """A quantity as the user wrote it, or the shortest decimal number in its unit."""
    return (
        value.text if isinstance(value, Quantity) else f"{value!r}".removesuffix(".0") + f" {unit}"
    )


def quantity(
    name: str,
    example: str,
    unit: str,
    *bounds: Gt | Ge | Le,
    between: tuple[str, ...] = (),
    words: tuple[str, ...] = (),
    positive: bool = False,
) -> Any:
    """Annotations of a field that is written with its unit and kept as a float in `unit`.

    A value beyond the range `between` is refused with both ends as they are written here. With
    `words` the field may hold one of these in place of a quantity; `positive` then stands for a
    bound, and its refusal names them.
    """
    listed = ", ".join(f'"{word}"' for word in words)
    form = f"{name} from {' to '.join(between)}" if between else name

    def read(text: object) -> float:
        value = parse_quantity(text, unit)
        ends = [parse_quantity(end, unit) for end in between]
        if ends and not ends[0] <= value <= ends[1]:
            raise ValueError(f"expected {' to '.join(between)}; got {text!r}")
        if positive and value <= 0:
            raise ValueError(f"expected {listed} or a {name} above 0; got {text!r}")
        return value

    def keep(text: Any, check: Any) -> Any:
        if words and isinstance(text, str) and not any(sign.isdigit() for sign in text):
            if text in words:
                return text
            raise ValueError(f"expected {listed} or a {name} such as {example!r}; got {text!r}")
        return Quantity(check(text), " ".join(text.split()))

    pattern = f"^({'|'.join(words)})$|{QUANTITY_PATTERN}" if words else QUANTITY_PATTERN
    # Bounds are checked on the converted float. The schema is last: it replaces what pydantic would
    # derive from the float, since the file holds text.
    return (
        BeforeValidator(read),
        *bounds,
        WrapValidator(keep),
        PlainSerializer(
            lambda value: value if isinstance(value, str) else _write_quantity(value, unit),
            return_type=str,
        ),
        WithJsonSchema({"type": "string", "pattern": pattern, "examples": [example]}),
        Form(f"{name}, or {listed}" if words else form, example, unit),
    )


Length = Annotated[float, *quantity("length", "5.5 cm", "m", Gt(0))]
Distance = Annotated[float, *quantity("length, or 0 mm", "0.06 mm", "m", Ge(0))]
Angle = Annotated[float, *quantity("angle", "0 deg", "rad")]
Speed = Annotated[float, *quantity("speed of rotation", "114 rpm", "rad/s", Gt(0))]
Frequency = Annotated[float, *quantity("frequency", "5 Hz", "Hz", Gt(0))]
Force = Annotated[float, *quantity("force", "50 lbf", "N", Gt(0))]
Pressure = Annotated[float, *quantity("pressure", "2.7 GPa", "Pa", Gt(0))]
Viscosity = Annotated[float, *quantity("dynamic viscosity", "0.12 Pa s", "Pa s", Gt(0))]
PressureViscosity = Annotated[
    float, *quantity("pressure-viscosity coefficient", "20 1/GPa", "1/Pa", Ge(0))
]
Wavelength = Annotated[float, *quantity("wavelength", "580 nm", "nm", Gt(0))]
# wavelengths that cameras and filters cover: a band in um in place of nm is no light
Band = Annotated[float, *quantity("wavelength", "580 nm", "nm", between=("200 nm", "2000 nm"))]
# pixels in the object plane, from those of a microscope to an image of metres
PixelPitch = Annotated[float, *quantity("length", "60 um", "m", between=("50 nm", "5 mm"))]
Counts = Annotated[float, *quantity("counts", "64 DN", "DN", Ge(0))]
Gain = Annotated[float, *quantity("gain", "4.4 electron/DN", "electron/DN", Gt(0))]
Electrons = Annotated[float, *quantity("electrons", "9 electron", "electron", Gt(0))]
Temperature = Annotated[float, *quantity("temperature", "-115 degC", "degC")]
TemperatureDifference = Annotated[
    float, *quantity("temperature difference", "1100 K", "delta_degC", Gt(0))
]


# a standard deviation as a share, kept in per cent
Share = Annotated[float, *quantity("share", "1 %", "%", between=("0 %", "50 %"))]
TemperatureCoefficient = Annotated[
    float, *quantity("relative change with temperature", "-0.2 %/K", "%/K")
]
TemperatureCoefficientStd = Annotated[
    float, *quantity("relative change with temperature", "0.02 %/K", "%/K", Ge(0))
]
TemperatureStd = Annotated[float, *quantity("temperature difference", "1 K", "delta_degC", Ge(0))]
Reflectance = Annotated[float, *quantity("share", "30 %", "%", between=("0 %", "100 %"))]
Start = Annotated[float | Literal["fit"], *quantity("time", "0.25 s", "s", words=("fit",))]
StartFilm = Annotated[
    float | Literal["fit"], *quantity("length", "20 um", "m", words=("fit",), positive=True)
]
Sideways = Annotated[
    float | Literal["free", "guided"],
    *quantity("stiffness", "12 N/mm", "N/m", words=("free", "guided"), positive=True),
]
Place = Annotated[float, *quantity("position", "9.6 mm", "m")]
CavitationPressure = Annotated[
    float, *quantity("pressure below ambient", "-100 kPa", "Pa", Ge(-101325), Le(0))
]

Interval = Annotated[tuple[float, float], Form("interval [low, high] in mm", [4, 15])]

NO_CONTROL_CHARACTERS = r"^[^\x00-\x1f\x7f]*$"

Text = Annotated[str, Field(pattern=NO_CONTROL_CHARACTERS), Form("text", "straight bushing 1")]
FileName = Annotated[
    str,
    Field(min_length=1, pattern=NO_CONTROL_CHARACTERS),
    Form("file name or pattern", "camera1/*.tif"),
]

CalibrationNames = Annotated[
    FileName | tuple[FileName, FileName],
    Form("file name, or two of them", "../fixture/calibration.nc"),
]

ColumnName = Annotated[
    str, Field(min_length=1, pattern=NO_CONTROL_CHARACTERS), Form("column", "Encoder [deg]")
]


class Settings(BaseModel):
    """A table of a settings file: frozen, and closed to keys it does not know."""

    # a misspelt key must not pass unnoticed, and NaN must not reach the physics
    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    def faults(self) -> Iterator[str]:
        """Yield contradictions between the keys of the table, each as a complete message."""
        yield from ()

    @model_validator(mode="after")
    def _has_no_fault(self) -> Self:
        fault = next(self.faults(), None)
        if fault is not None:
            raise ValueError(fault)
        return self


_Channel = Literal["channel 1", "channel 2", "channel 3", "channel 4"]
# Parts of a file that may belong to one of two cameras.
FilePart = Literal["left", "right", "top", "bottom", "odd", "even", _Channel]


class CameraSettings(Settings):
    """One camera: its files, its filter and its noise."""

    files: FileName
    band: Band
    bit_depth: int = Field(12, strict=True, ge=8, le=16)
    alignment: Literal["right", "left"] = "right"
    part: FilePart | None = None
    dataset: Text | None = None
    dark_dataset: Text | None = None
    flat_dataset: Text | None = None
    background_dataset: Text | None = None
    dark: FileName | None = None
    offset: Counts | None = None
    flat: FileName | None = None
    background: FileName | None = None
    gain: Gain | None = None
    read_noise: Electrons | None = None

    @property
    def full_scale(self) -> int:
        """The largest count the camera can give [DN]."""
        return (1 << self.bit_depth) - 1

    def faults(self) -> Iterator[str]:
        # one HDF5 file may hold all; the same dataset for two purposes is a slip
        for key, file, dataset in (
            ("dark", self.dark, self.dark_dataset),
            ("flat", self.flat, self.flat_dataset),
            ("background", self.background, self.background_dataset),
        ):
            if file == self.files and (dataset or self.dataset) == self.dataset:
                yield (
                    f"{key} and files name the same frames; correct {key}, or give {key}_dataset "
                    "where one HDF5 file holds both"
                )

        if self.dark is not None and self.offset is not None:
            yield "give either dark (a file) or offset (a level), not both"
        if self.dark is None and self.offset is None:
            yield ('give the dark frames as dark = "file.tif", or a level as offset = "64 DN"')


class OpticsSettings(Settings):
    """Scale and direction of the image of camera 1 in the object plane, and the wall there."""

    pixel_pitch: PixelPitch
    x_axis: Literal["sliding", "axial"] = "sliding"
    wall: Reflectance | None = None

    @property
    def reflectance(self) -> float | None:
        """Share of the light that the wall behind the film returns; None where not stated. [1]"""
        return None if self.wall is None else self.wall / 100


# units of a log; the first of a quantity is that of films
AngleUnit = Literal["deg", "rad", "mrad", "turn", "tick"]
TimeUnit = Literal["s", "ms", "us", "ns", "min", "h"]
ForceUnit = Literal["N", "kN", "mN", "lbf", "kgf"]
TemperatureUnit = Literal["degC", "K", "degF"]
TorqueUnit = Literal["N m", "kN m", "N mm", "lbf ft", "lbf in"]
SpeedUnit = Literal["rad/s", "rpm", "deg/s", "rev/s", "m/s", "mm/s"]
PulseEnergyUnit = Literal["mJ", "J", "uJ", "V", "1"]


class ColumnUnits(Settings):
    """Units of columns whose header has none; they take precedence over the header."""

    angle: AngleUnit | None = None
    time: TimeUnit | None = None
    load: ForceUnit | None = None
    temperature: TemperatureUnit | None = None
    speed: SpeedUnit | None = None
    pulse_energy: PulseEnergyUnit | None = None


class EncoderSettings(Settings):
    """The encoder and its log."""

    file: FileName | None = None
    mounted_on: Literal["rocker", "crank", "coupler"] = "rocker"
    zero: Angle | None = None
    triggers_per_cycle: int | None = Field(None, strict=True, ge=1)
    bins: int | None = Field(None, strict=True, ge=2)
    direction: Literal["rising", "falling"] | None = None

    # columns of the log
    angle: ColumnName | None = None
    frame: ColumnName | None = None
    time: ColumnName | None = None
    load: ColumnName | None = None
    temperature: ColumnName | None = None
    speed: ColumnName | None = None
    pulse_energy: ColumnName | None = None
    units: ColumnUnits = ColumnUnits()
    ticks_per_turn: float | None = Field(None, strict=True, gt=0)

    # frames in a continuous log
    pulse: ColumnName | None = None
    frame_rate: Frequency | None = None
    start: Start | None = None

    def faults(self) -> Iterator[str]:
        if self.bins is not None and self.triggers_per_cycle is not None:
            yield "give either bins or triggers_per_cycle"

        if self.pulse is not None and (self.frame_rate is not None or self.start is not None):
            yield (
                "give the times of the frames either as pulse (a column) or as frame_rate and start"
            )
        if self.frame_rate is not None and self.start is None:
            yield (
                'frame_rate needs the time of the first frame: add start = "0.25 s", or start = '
                '"fit"'
            )


class CrankRockerSettings(Settings):
    """The four links and the speed of the crank."""

    kind: Literal["crank-rocker"]
    crank: Length
    coupler: Length
    rocker: Length
    ground: Length
    crank_speed: Speed


class SliderCrankSettings(Settings):
    """Crank, connecting rod and the speed of the crank."""

    kind: Literal["slider-crank"]
    crank: Length
    coupler: Length
    crank_speed: Speed


class RotationSettings(Settings):
    """A disc, ring or shaft that turns past the contact, as in a pin-on-disc tribometer."""

    kind: Literal["rotation"]
    radius: Length
    speed: Speed | None = None
    load: Force | None = None


class SinusoidalSettings(Settings):
    """A slider that moves to and fro in a straight line, as a sine of the time."""

    kind: Literal["sinusoidal"]
    stroke: Length
    frequency: Frequency
    load: Force | None = None


class MaterialSettings(Settings):
    """One side of the joint."""

    youngs_modulus: Pressure
    poissons_ratio: float = Field(strict=True, gt=-1, le=0.5)
    roughness: Length | None = None


class JointSettings(Settings):
    """The pin and the bushing it turns in."""

    pin_radius: Length
    bushing_radius: Length
    clearance_std: Length | None = None
    length: Length
    load: Force | None = None
    pin: MaterialSettings
    bushing: MaterialSettings

    def faults(self) -> Iterator[str]:
        if self.pin_radius >= self.bushing_radius:
            yield (
                "pin_radius must be smaller than bushing_radius for the pin to turn; got "
                f"{self.pin_radius * 1e3:g} mm in {self.bushing_radius * 1e3:g} mm"
            )


class VogelSettings(Settings):
    """Vogel's law, viscosity = a exp(b/(T - c))."""

    a: Viscosity
    b: TemperatureDifference
    c: Temperature


class OilSettings(Settings):
    """The oil between pin and bushing."""

    name: Text = ""
    viscosity: Viscosity | None = None
    vogel: VogelSettings | None = None
    viscosity_std: Viscosity | None = None
    drift_std: Share | None = None
    pressure_viscosity: PressureViscosity

    def faults(self) -> Iterator[str]:
        if (self.viscosity is None) == (self.vogel is None):
            yield 'give either viscosity = "0.12 Pa s" or a vogel law { a, b, c }'


class RegistrationOptions(Settings):
    """Registration of camera 2 to camera 1."""

    window: int = Field(32, strict=True, ge=16, le=256)
    step: int = Field(8, strict=True, ge=4, le=128)
    model: Literal["auto", "surface", "local"] = "auto"
    orientation: Literal[
        "normal", "mirrored_x", "mirrored_y", "rotated_90", "rotated_180", "rotated_270"
    ] = "normal"
    reuse: bool = False
    frames: int | None = Field(None, strict=True, ge=1)


class RegionOfInterest(Settings):
    """Region of the film statistics, from the centre of the first pixel. [mm]"""

    x: Interval
    y: Interval

    def faults(self) -> Iterator[str]:
        for name, (low, high) in (("x", self.x), ("y", self.y)):
            if not low < high:
                yield (f"{name} must be [low, high] in mm with low < high; got [{low:g}, {high:g}]")


class ThicknessOptions(Settings):
    """Thickness maps and the statistics of a trigger."""

    roi: RegionOfInterest | None = None
    least_signal: Electrons = 100.0
    no_film_below: float = Field(0.25, strict=True, gt=0, lt=1)
    smoothing: int | None = Field(None, strict=True, ge=2, le=50)


class LightOptions(Settings):
    """Light that is not film, and what light and films show of other errors."""

    background: Literal["report", "correct"] = "report"
    bleaching: Literal["report", "correct"] = "report"
    ratio: Literal["report", "correct"] = "report"
    errors: Literal["report", "correct"] = "report"

    @property
    def corrects(self) -> bool:
        """Whether any effect found in the frames is corrected."""
        return self.corrects_light or self.errors == "correct"

    @property
    def corrects_light(self) -> bool:
        """Whether background, bleaching or the ratio of a patch is corrected."""
        return "correct" in (self.background, self.bleaching, self.ratio)

    def faults(self) -> Iterator[str]:
        if self.ratio == "correct" and "correct" in (self.background, self.bleaching):
            yield (
                "the ratio of the patch holds background and bleaching as well: with ratio = "
                '"correct", remove background and bleaching'
            )
        if self.errors == "correct" and self.corrects_light:
            yield (
                "the errors that the gap shows hold background, bleaching and scale of the ratio: "
                'with errors = "correct", remove those'
            )


def _with_widths(file: str) -> type[Settings]:
    """A table with the standard deviations that a settings file states."""
    types: dict[str, Any] = {"%": Share, "mm": Distance | None}
    fields: dict[str, Any] = {
        key: (types[source.unit], Field(source.width, description=source.__doc__))
        for key, source in keys_in(file).items()
    }
    return create_model("_Widths", __base__=Settings, **fields)


class SystematicsOptions(_with_widths("run")):  # type: ignore[misc]
    """Errors of a run that its frames do not show, as standard deviations."""

    @property
    def shares(self) -> dict[str, float]:
        """Standard deviations by name. [1]"""
        return {name: getattr(self, name) / 100 for name in type(self).model_fields}


class TemperatureOptions(Settings):
    """Light of both bands and the temperature of the oil, by which the ratio is corrected."""

    camera1: TemperatureCoefficient | None = None
    camera2: TemperatureCoefficient | None = None
    std: TemperatureCoefficientStd | None = None
    reading_std: TemperatureStd = 1.0

    @property
    def coefficient(self) -> float | None:
        """Change of the logarithm of the ratio; None where none is stated. [1/K]"""
        if self.camera1 is None or self.camera2 is None:
            return None
        return (self.camera2 - self.camera1) / 100

    def faults(self) -> Iterator[str]:
        given = [one is not None for one in (self.camera1, self.camera2, self.std)]
        if any(given) and not all(given):
            yield "give camera1, camera2 and std of the change with temperature together"


class FixtureSystematics(_with_widths("fixture")):  # type: ignore[misc]
    """Errors of a fixture that its frames do not show, as standard deviations."""


class ReferenceSettings(Settings):
    """A patch of known film that both cameras see in every frame."""

    region: RegionOfInterest | None = None
    thickness: Length | None = None
    uncertainty: Length | None = None

    def faults(self) -> Iterator[str]:
        if (self.region is None) != (self.thickness is None):
            yield "give region and thickness of the reference patch together"


class PredictionOptions(Settings):
    """The film that theory predicts for an oscillating joint."""

    sideways: Sideways = "free"
    cavitation_pressure: CavitationPressure = -1e5
    cavitation_pressure_std: Pressure | None = None
    start_film: StartFilm = "fit"
    load_line: Place | None = None
    load_line_std: Length | None = None
    load_std: Share = 1.0
    direction: Literal["along", "against"] = "along"
    long: bool = False


class RunName(Settings):
    """Name of the run."""

    name: Text


# "kind" selects the form of the table, so that a fault is reported for that form alone
# Forms of [mechanism].
MechanismSettings = Annotated[
    CrankRockerSettings | SliderCrankSettings | RotationSettings | SinusoidalSettings,
    Field(discriminator="kind"),
]


class RunSettings(Settings):
    """run.toml."""

    calibration: CalibrationNames | None = None
    run: RunName
    camera1: CameraSettings
    camera2: CameraSettings
    optics: OpticsSettings
    encoder: EncoderSettings | None = None
    mechanism: MechanismSettings | None = None
    joint: JointSettings | None = None
    oil: OilSettings | None = None
    registration: RegistrationOptions = RegistrationOptions()
    thickness: ThicknessOptions = ThicknessOptions()
    light: LightOptions = LightOptions()
    systematics: SystematicsOptions = SystematicsOptions()
    temperature: TemperatureOptions = TemperatureOptions()
    reference: ReferenceSettings = ReferenceSettings()
    prediction: PredictionOptions = PredictionOptions()

    @property
    def name(self) -> str:
        """Name of the run."""
        return self.run.name

    @property
    def calibrations(self) -> tuple[str, ...]:
        """Files of the calibration: none, one, or those of the fixtures before and after a run."""
        named = self.calibration
        return (named,) if isinstance(named, str) else named or ()

    @property
    def linkage(self) -> CrankRockerSettings | SliderCrankSettings | None:
        """The mechanism where it is a linkage, whose position follows from the encoder alone."""
        if isinstance(self.mechanism, CrankRockerSettings | SliderCrankSettings):
            return self.mechanism
        return None

    def faults(self) -> Iterator[str]:
        if self.linkage is not None and (self.encoder is None or self.encoder.file is None):
            yield (
                f'[mechanism] of kind "{self.linkage.kind}" needs the log of its encoder: add '
                'file = "encoder.csv" to [encoder], or leave [mechanism] out; the film then has no '
                "speed"
            )

        if self.mechanism is None and self.encoder is not None and self.encoder.bins is not None:
            yield (
                "bins in [encoder] are parts of the cycle of a mechanism: add [mechanism], or "
                "remove bins"
            )

        if len(self.calibrations) > 1 and self.light.bleaching == "correct":
            yield (
                "the fixture after the run shows the bleaching as well: remove bleaching from "
                "[light], or name one calibration"
            )

        if len(self.calibrations) > 1 and self.temperature.coefficient is not None:
            yield (
                "the fixture after the run shows the temperature as well: remove [temperature], or "
                "name one calibration"
            )

        if self.light.ratio == "correct" and self.reference.region is None:
            yield 'ratio = "correct" in [light] needs a patch of known film: add [reference]'

        here = getattr(self.mechanism, "load", None)
        if here is not None and self.joint is not None and self.joint.load is not None:
            yield "give the load once, in [mechanism] or in [joint]"

    @property
    def load(self) -> float | None:
        """Load of the settings, for a log without one; None where neither table gives it. [N]"""
        of_mechanism: float | None = getattr(self.mechanism, "load", None)
        return self.joint.load if self.joint and self.joint.load else of_mechanism


class FixtureProfile(Settings):
    """The calibration fixture and its profile from the coordinate measuring machine."""

    name: Text
    profile: FileName
    origin: tuple[StrictFloat, StrictFloat] = (0.0, 0.0)
    direction: Angle = 0.0
    align: bool = False
    temperature: Temperature | None = None


class FixtureSettings(Settings):
    """fixture.toml."""

    fixture: FixtureProfile
    camera1: CameraSettings
    camera2: CameraSettings
    optics: OpticsSettings
    registration: RegistrationOptions = RegistrationOptions()
    thickness: ThicknessOptions = ThicknessOptions()
    systematics: FixtureSystematics = FixtureSystematics()

    @property
    def name(self) -> str:
        """Name of the fixture."""
        return self.fixture.name
