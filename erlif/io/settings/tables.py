"""The tables of run.toml and fixture.toml as frozen, checked settings.

A quantity is written as text with a unit and kept as a float in the unit of its type (`Form.unit`):
SI, but nm for a band, electrons and DN for a camera, degC for Vogel's temperature. Its text is kept
with it (`Quantity`), so that settings are stored as the user wrote them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Literal, Self

from annotated_types import Ge, Gt, Le
from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    PlainSerializer,
    WithJsonSchema,
    WrapValidator,
    field_validator,
    model_validator,
)

from erlif.core.units import Quantity, parse_quantity


@dataclass(frozen=True)
class Form:
    """How a value is written in a settings file; part of the type of a field.

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


QUANTITY_PATTERN = (
    r"^\s*[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]{1,3})?"  # the number
    r"\s*(1\s*/\s*)?[^0-9\s.,?].*$"  # the unit, as in "mm" or "1/GPa"
)
"""A number and a unit, for the JSON schema; `erlif.core.units.parse_quantity` checks the unit."""


def _write_quantity(value: float, unit: str) -> str:
    """A quantity as the user wrote it, or the shortest decimal number in its unit."""
    return (
        value.text if isinstance(value, Quantity) else f"{value!r}".removesuffix(".0") + f" {unit}"
    )


def quantity(name: str, example: str, unit: str, *bounds: Gt | Ge | Le) -> Any:
    """Annotations of a field that is written with its unit and kept as a float in `unit`."""
    schema = {"type": "string", "pattern": QUANTITY_PATTERN, "examples": [example]}
    # Bounds are checked on the converted float. The schema is last: it replaces what pydantic would
    # derive from the float, since the file holds text.
    return (
        BeforeValidator(lambda text: parse_quantity(text, unit)),
        *bounds,
        WrapValidator(lambda text, check: Quantity(check(text), " ".join(text.split()))),
        PlainSerializer(lambda value: _write_quantity(value, unit), return_type=str),
        WithJsonSchema(schema),
        Form(name, example, unit),
    )


Length = Annotated[float, *quantity("length", "5.5 cm", "m", Gt(0))]
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
Counts = Annotated[float, *quantity("counts", "64 DN", "DN", Ge(0))]
Gain = Annotated[float, *quantity("gain", "4.4 electron/DN", "electron/DN", Gt(0))]
Electrons = Annotated[float, *quantity("electrons", "9 electron", "electron", Gt(0))]
Temperature = Annotated[float, *quantity("temperature", "-115 degC", "degC")]
TemperatureDifference = Annotated[
    float, *quantity("temperature difference", "1100 K", "delta_degC", Gt(0))
]


def _quantity_or(
    words: tuple[str, ...], name: str, example: str, unit: str, *, positive: bool = False
) -> Any:
    """Annotations of a field that holds one of a few words or a quantity."""
    listed = ", ".join(f'"{word}"' for word in words)

    def read(text: Any, check: Any) -> Any:
        if isinstance(text, str) and not any(sign.isdigit() for sign in text):
            if text in words:
                return text
            raise ValueError(f"expected {listed} or a {name} such as {example!r}; got {text!r}")
        value = parse_quantity(text, unit)
        if positive and value <= 0:
            raise ValueError(f"expected {listed} or a {name} above 0; got {text!r}")
        return Quantity(check(value), " ".join(text.split()))

    pattern = f"^({'|'.join(words)})$|{QUANTITY_PATTERN}"
    return (
        WrapValidator(read),
        PlainSerializer(
            lambda value: value if isinstance(value, str) else _write_quantity(value, unit),
            return_type=str,
        ),
        WithJsonSchema({"type": "string", "pattern": pattern, "examples": [example]}),
        Form(f"{name}, or {listed}", example, unit),
    )


Start = Annotated[float | Literal["fit"], *_quantity_or(("fit",), "time", "0.25 s", "s")]
StartFilm = Annotated[
    float | Literal["fit"], *_quantity_or(("fit",), "length", "20 um", "m", positive=True)
]
Sideways = Annotated[
    float | Literal["free", "guided"],
    *_quantity_or(("free", "guided"), "stiffness", "12 N/mm", "N/m", positive=True),
]
Place = Annotated[float, *quantity("position", "9.6 mm", "m")]
CavitationPressure = Annotated[
    float, *quantity("pressure below ambient", "-100 kPa", "Pa", Ge(-101325), Le(0))
]

PITCHES = (50e-9, 5e-3)
"""Pixels in the object plane: from those of a microscope to an image of metres. [m]"""

BANDS = (200.0, 2000.0)
"""Wavelengths that cameras and filters cover. [nm]"""

Interval = Annotated[tuple[float, float], Form("interval [low, high] in mm", [4, 15])]

NO_CONTROL_CHARACTERS = r"^[^\x00-\x1f\x7f]*$"

Text = Annotated[str, Field(pattern=NO_CONTROL_CHARACTERS), Form("text", "straight bushing 1")]
FileName = Annotated[
    str,
    Field(min_length=1, pattern=NO_CONTROL_CHARACTERS),
    Form("file name or pattern", "camera1/*.tif"),
]

ColumnName = Annotated[
    str, Field(min_length=1, pattern=NO_CONTROL_CHARACTERS), Form("column", "Encoder [deg]")
]


class Settings(BaseModel):
    """A table of a settings file: frozen, and closed to keys it does not know."""

    # a misspelt key must not pass unnoticed, and NaN must not reach the physics
    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


FilePart = Literal[
    "left",
    "right",
    "top",
    "bottom",
    "odd",
    "even",
    "channel 1",
    "channel 2",
    "channel 3",
    "channel 4",
]
"""Parts of a file that may belong to one of two cameras."""


class CameraSettings(Settings):
    """One camera: its files, its filter and its noise."""

    files: FileName = Field(
        description="Frames of this camera, in natural order (frame_2 before frame_10): a pattern, "
        "or one multi-page file. The name is relative to this file."
    )
    band: Wavelength = Field(
        description="Centre wavelength of the filter of this camera. Camera 1 has the shorter one, "
        "whose light dye 2 reabsorbs."
    )

    @field_validator("band")
    @classmethod
    def _is_light(cls, band: float) -> float:
        """A band in um in place of nm is no light that a camera records."""
        low, high = BANDS
        if not low <= band <= high:
            raise ValueError(f"expected {low:g} to {high:g} nm; got {band:g} nm")
        return band

    bit_depth: int = Field(
        12,
        ge=8,
        le=16,
        description="Bits of a count: full scale is 2^bit_depth - 1. The data sheet of the camera "
        "states it.",
    )
    alignment: Literal["right", "left"] = Field(
        "right",
        description="Bits of a 16-bit word that hold the count: the low ones (right) or the high "
        "ones (left), as in counts that are multiples of 16 at 12 bits.",
    )
    part: FilePart | None = Field(
        None,
        description="Part of the files that belongs to this camera where one file holds both: half "
        "of the sensor, odd or even pages (the first page is odd), a channel of an OME or ImageJ "
        "file, or a frame of each LaVision image. Darks and flats have the same part. Default: the "
        "whole file.",
    )
    dataset: Text | None = Field(
        None,
        description="Path of the frames in an HDF5 or netCDF file. Default: its only dataset of "
        "three dimensions.",
        examples=["/camera1/counts"],
    )
    dark_dataset: Text | None = Field(
        None,
        description="Path of the dark frames in an HDF5 or netCDF file. Default: that of the "
        "frames.",
        examples=["/camera1/dark"],
    )
    flat_dataset: Text | None = Field(
        None,
        description="Path of the flat frames in an HDF5 or netCDF file. Default: that of the "
        "frames.",
        examples=["/camera1/flat"],
    )
    background_dataset: Text | None = Field(
        None,
        description="Path of the frames of the dry joint in an HDF5 or netCDF file. Default: that "
        "of the frames.",
        examples=["/camera1/background"],
    )
    dark: FileName | None = Field(
        None,
        description="Dark frames: lens capped, exposure time and camera gain as in the run. Either "
        "dark or offset is required.",
        examples=["camera1_dark.tif"],
    )
    offset: Counts | None = Field(
        None, description="Dark level of the camera where no dark frames were taken."
    )
    flat: FileName | None = Field(
        None,
        description="Flat frames of an evenly lit target, several at each of one or more light "
        "levels. Default: all pixels are taken as equally sensitive.",
        examples=["camera1_flat.tif"],
    )
    background: FileName | None = Field(
        None,
        description="Frames of the dry or dye-free joint under the laser, at the mean pulse energy "
        "of the run. Their light above the dark, scaled by the pulse energy where the log has it, "
        "is subtracted.",
        examples=["camera1_background.tif"],
    )
    gain: Gain | None = Field(
        None,
        description="Photo-electrons per count. Default: measured from the flats by photon "
        "transfer (EMVA 1288), without flats from the frames.",
    )
    read_noise: Electrons | None = Field(
        None,
        description="Rms read noise of a pixel. Default: measured from the darks, "
        "without darks from the frames.",
    )

    @property
    def full_scale(self) -> int:
        """The largest count the camera can give [DN]."""
        return (1 << self.bit_depth) - 1

    @model_validator(mode="after")
    def _references_differ_from_frames(self) -> Self:
        # one HDF5 file may hold all; the same dataset for two purposes is a slip
        for key, file, dataset in (
            ("dark", self.dark, self.dark_dataset),
            ("flat", self.flat, self.flat_dataset),
            ("background", self.background, self.background_dataset),
        ):
            if file == self.files and (dataset or self.dataset) == self.dataset:
                raise ValueError(
                    f"{key} and files name the same frames; correct {key}, or give {key}_dataset "
                    "where one HDF5 file holds both"
                )
        return self

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
    """Scale and direction of the image of camera 1 in the object plane."""

    pixel_pitch: Length = Field(
        description="Size of a pixel of camera 1 in the object plane. Photograph a scale there and "
        "divide a length by the number of pixels it covers.",
        examples=["60 um"],
    )

    @field_validator("pixel_pitch")
    @classmethod
    def _is_of_a_camera(cls, pitch: float) -> float:
        """A pitch in mm in place of um makes an image of metres."""
        low, high = PITCHES
        if not low <= pitch <= high:
            raise ValueError(
                f"expected a pixel of {low * 1e9:g} nm to {high * 1e3:g} mm in the object plane; "
                f"got {pitch * 1e6:g} um"
            )
        return pitch

    x_axis: Literal["sliding", "axial"] = Field(
        "sliding",
        description="Direction of the joint along image x: the sliding (circumferential) or the "
        "axial direction.",
    )


class ColumnUnits(Settings):
    """Units of columns whose header has none; they take precedence over the header."""

    angle: Literal["deg", "rad", "mrad", "turn", "tick"] | None = Field(
        None, description="Unit of the angle; tick needs ticks_per_turn.", examples=["rad"]
    )
    time: Literal["s", "ms", "us", "ns", "min", "h"] | None = Field(
        None, description="Unit of the time.", examples=["ms"]
    )
    load: Literal["N", "kN", "mN", "lbf", "kgf"] | None = Field(
        None, description="Unit of the load.", examples=["lbf"]
    )
    temperature: Literal["degC", "K", "degF"] | None = Field(
        None, description="Unit of the temperature.", examples=["degF"]
    )
    speed: Literal["m/s", "mm/s", "rad/s", "rpm", "deg/s", "rev/s"] | None = Field(
        None, description="Unit of the speed.", examples=["mm/s"]
    )
    pulse_energy: Literal["mJ", "J", "uJ", "V", "1"] | None = Field(
        None, description="Unit of the pulse energy.", examples=["mJ"]
    )


class EncoderSettings(Settings):
    """The encoder and its log."""

    file: FileName | None = Field(
        None,
        description="Encoder log: one row for each frame pair, or a column of times. Default: "
        "there is none, as for a static film.",
        examples=["encoder.csv"],
    )
    mounted_on: Literal["rocker", "crank", "coupler"] = Field(
        "rocker",
        description="Link whose angle against the ground link the encoder measures.",
    )
    zero: Angle | None = Field(
        None,
        description="Angle of that link, counted from the ground link, at encoder reading 0; of a "
        "disc, its angle; of a sinusoidal slider, the angle of its drive, 0 at mid-stroke. "
        "Default: the extremes of the log are matched to the dead points of the linkage; 0 for "
        "disc and slider.",
    )
    triggers_per_cycle: int | None = Field(
        None,
        ge=1,
        description="Triggers in one cycle, for folding several cycles; 1 averages all frames of a "
        "static film. Default: from the angles of the log for a linkage, if its triggers repeat "
        "from cycle to cycle; else each frame is a trigger.",
        examples=[50],
    )
    bins: int | None = Field(
        None,
        ge=2,
        description="Parts of a cycle, by the angle of the crank, over which frames are averaged. "
        "No part holds frames of both strokes. Default: none.",
        examples=[50],
    )
    direction: Literal["rising", "falling"] | None = Field(
        None,
        description="Whether the reading rises or falls while the angle of the link rises. "
        "Default: as the log shows; rising where it does not show it.",
    )

    # columns of the log
    angle: ColumnName | None = Field(
        None,
        description="Column with the reading of the encoder. Default: angle_deg, else a column "
        "called angle or encoder.",
    )
    frame: ColumnName | None = Field(
        None,
        description="Column with the number of the frame. Default: frame; without one, a log with "
        "as many rows as frames has one row for each.",
        examples=["Image No"],
    )
    time: ColumnName | None = Field(
        None,
        description="Column with the time. Default: time_s, else a column called time or t.",
        examples=["Time [ms]"],
    )
    load: ColumnName | None = Field(
        None,
        description="Column with the load on the joint. Default: load_N, else a column called load "
        "or force.",
        examples=["Force [lbf]"],
    )
    temperature: ColumnName | None = Field(
        None,
        description="Column with the temperature of the oil. Default: temperature_C, else a column "
        "called temperature.",
        examples=["T oil [°C]"],
    )
    speed: ColumnName | None = Field(
        None,
        description="Column with the sliding speed or the speed of rotation. Default: speed_m_s.",
        examples=["Speed [mm/s]"],
    )
    pulse_energy: ColumnName | None = Field(
        None,
        description="Column with the energy of the laser pulse. Default: none.",
        examples=["Laser [mJ]"],
    )
    units: ColumnUnits = Field(
        ColumnUnits(),
        description="Units of columns that have none in their header.",
        examples=[{"angle": "rad", "load": "lbf"}],
    )
    ticks_per_turn: float | None = Field(
        None,
        gt=0,
        description="Ticks that the encoder counts in a turn. Required where the unit of the angle "
        "is tick.",
        examples=[3600],
    )

    # frames in a continuous log
    pulse: ColumnName | None = Field(
        None,
        description="Column of a continuous log with the trigger of the cameras: a voltage that "
        "rises at each frame, or a count of the frames. Default: none.",
        examples=["Trigger [V]"],
    )
    frame_rate: Frequency | None = Field(
        None,
        description="Rate of the frames in a continuous log. Default: times in the headers of the "
        "camera files.",
        examples=["500 Hz"],
    )
    start: Start | None = Field(
        None,
        description='Time of the first frame on the clock of a continuous log. "fit" finds it from '
        "the light of the frames over the cycle. Default: none.",
    )

    @model_validator(mode="after")
    def _one_grouping(self) -> Self:
        if self.bins is not None and self.triggers_per_cycle is not None:
            raise ValueError("give either bins or triggers_per_cycle")
        return self

    @model_validator(mode="after")
    def _one_source_of_times(self) -> Self:
        if self.pulse is not None and (self.frame_rate is not None or self.start is not None):
            raise ValueError(
                "give the times of the frames either as pulse (a column) or as frame_rate and start"
            )
        if self.frame_rate is not None and self.start is None:
            raise ValueError(
                'frame_rate needs the time of the first frame: add start = "0.25 s", or start = '
                '"fit"'
            )
        return self


class CrankRockerSettings(Settings):
    """The four links and the speed of the crank."""

    kind: Literal["crank-rocker"] = Field(description="Kind of linkage.")
    crank: Length = Field(description="Length of the crank, from pivot to pivot.")
    coupler: Length = Field(
        description="Length of the coupler between crank and rocker, from pivot to pivot.",
        examples=["44 cm"],
    )
    rocker: Length = Field(
        description="Length of the rocker, from pivot to pivot.", examples=["26 cm"]
    )
    ground: Length = Field(
        description="Distance of the fixed pivots of crank and rocker.", examples=["51 cm"]
    )
    crank_speed: Speed = Field(description="Speed of rotation of the crank.")


class SliderCrankSettings(Settings):
    """Crank, connecting rod and the speed of the crank."""

    kind: Literal["slider-crank"] = Field(description="Kind of linkage.")
    crank: Length = Field(description="Length of the crank, from pivot to pivot.")
    coupler: Length = Field(
        description="Length of the connecting rod, from pivot to pivot.", examples=["44 cm"]
    )
    crank_speed: Speed = Field(description="Speed of rotation of the crank.")


class RotationSettings(Settings):
    """A disc, ring or shaft that turns past the contact, as in a pin-on-disc tribometer."""

    kind: Literal["rotation"] = Field(description="Kind of motion.")
    radius: Length = Field(
        description="Radius of the track: distance of the contact from the axis of rotation.",
        examples=["20 mm"],
    )
    speed: Speed | None = Field(
        None,
        description="Speed of rotation. Default: from the angle and the time of the log.",
        examples=["60 rpm"],
    )
    load: Force | None = Field(
        None,
        description="Load on the contact, where the encoder log has no column load_N. Default: the "
        "film has no load.",
        examples=["20 N"],
    )


class SinusoidalSettings(Settings):
    """A slider that moves to and fro in a straight line, as a sine of the time."""

    kind: Literal["sinusoidal"] = Field(description="Kind of motion.")
    stroke: Length = Field(
        description="Travel from end to end, twice the amplitude.", examples=["10 mm"]
    )
    frequency: Frequency = Field(description="Cycles to and fro in a unit of time.")
    load: Force | None = Field(
        None,
        description="Load on the contact, where the encoder log has no column load_N. Default: the "
        "film has no load.",
        examples=["20 N"],
    )


class MaterialSettings(Settings):
    """One side of the joint."""

    youngs_modulus: Pressure = Field(description="Young's modulus.")
    poissons_ratio: float = Field(gt=-1, le=0.5, description="Poisson's ratio.", examples=[0.37])
    roughness: Length | None = Field(
        None,
        description="Rms roughness of the surface. Default: no film parameter Lambda is computed.",
        examples=["0.2 um"],
    )


class JointSettings(Settings):
    """The pin and the bushing it turns in."""

    pin_radius: Length = Field(description="Radius of the pin.", examples=["33.36 mm"])
    bushing_radius: Length = Field(
        description="Inner radius of the bushing, larger than pin_radius.", examples=["33.59 mm"]
    )
    clearance_std: Length | None = Field(
        None,
        description="Standard deviation of the radial clearance, bushing_radius less pin_radius. "
        "It enters the error of the pressure. Default: the clearance is exact.",
        examples=["1 um"],
    )
    length: Length = Field(
        description="Loaded length of the joint along its axis.", examples=["237 mm"]
    )
    load: Force | None = Field(
        None,
        description="Load on the joint. Used where the encoder log has no column load_N, and "
        "required there.",
    )
    pin: MaterialSettings
    bushing: MaterialSettings

    @model_validator(mode="after")
    def _pin_fits(self) -> Self:
        if self.pin_radius >= self.bushing_radius:
            raise ValueError(
                "pin_radius must be smaller than bushing_radius for the pin to turn; got "
                f"{self.pin_radius * 1e3:g} mm in {self.bushing_radius * 1e3:g} mm"
            )
        return self


class VogelSettings(Settings):
    """Vogel's law, viscosity = a exp(b/(T - c))."""

    a: Viscosity = Field(
        description="Viscosity in the limit of high temperature.", examples=["0.05 mPa s"]
    )
    b: TemperatureDifference = Field(description="Slope of ln(viscosity) over 1/(T - c).")
    c: Temperature = Field(description="Temperature of the pole, below every temperature logged.")


class OilSettings(Settings):
    """The oil between pin and bushing."""

    name: Text = Field(
        "", description="Name of the oil in figures and reports.", examples=["80W-90"]
    )
    viscosity: Viscosity | None = Field(
        None,
        description="Dynamic viscosity at the temperature of the run. Either viscosity or vogel is "
        "required.",
    )
    vogel: VogelSettings | None = Field(
        None,
        description="Viscosity from the logged temperature by Vogel's law, a exp(b/(T - c)), in "
        "place of one value.",
        examples=[{"a": "0.05 mPa s", "b": "1100 K", "c": "-115 degC"}],
    )
    viscosity_std: Viscosity | None = Field(
        None,
        description="Standard deviation of the viscosity, with a vogel law at the mean temperature "
        "of the run. It enters the error of the pressure. Default: the viscosity is exact.",
        examples=["0.004 Pa s"],
    )
    pressure_viscosity: PressureViscosity = Field(
        description="Pressure-viscosity coefficient of Barus."
    )

    @model_validator(mode="after")
    def _one_viscosity(self) -> Self:
        if (self.viscosity is None) == (self.vogel is None):
            raise ValueError('give either viscosity = "0.12 Pa s" or a vogel law { a, b, c }')
        return self


class RegistrationOptions(Settings):
    """Registration of camera 2 to camera 1."""

    window: int = Field(32, ge=16, le=256, description="Side of the interrogation window. [px]")
    step: int = Field(8, ge=4, le=128, description="Distance between window centres. [px]")
    model: Literal["auto", "surface", "local"] = Field(
        "auto",
        description="Form of the camera map: one smooth surface, one displacement for each "
        "window, or the surface unless the distortion is finer.",
    )
    orientation: Literal[
        "normal", "mirrored_x", "mirrored_y", "rotated_90", "rotated_180", "rotated_270"
    ] = Field(
        "normal",
        description="Turn or mirror image that lays the image of camera 2 over that of camera 1; "
        "rotated_90 turns it counter-clockwise on the screen.",
    )
    reuse: bool = Field(
        False,
        description="Use the camera map stored with the calibration, after a check on the frames "
        "of this run.",
    )
    frames: int | None = Field(
        None,
        ge=1,
        description="Number of frame pairs for the fixed part of the camera map. Default: 12 small "
        "or 4 large ones.",
        examples=[12],
    )


class RegionOfInterest(Settings):
    """Region of the film statistics, from the centre of the first pixel. [mm]"""

    x: Interval = Field(description="Interval along image x. [mm]")
    y: Interval = Field(
        description="Interval along image y, which points down. [mm]", examples=[[2, 13]]
    )

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        for name, (low, high) in (("x", self.x), ("y", self.y)):
            if not low < high:
                raise ValueError(
                    f"{name} must be [low, high] in mm with low < high; got [{low:g}, {high:g}]"
                )
        return self


class ThicknessOptions(Settings):
    """Thickness maps and the statistics of a trigger."""

    roi: RegionOfInterest | None = Field(
        None,
        description="Region in mm in which film_mean and film_min are taken. Default: the whole "
        "image.",
        examples=[{"x": [4, 15], "y": [2, 13]}],
    )
    least_signal: Electrons = Field(
        100.0,  # 10 % of shot noise in one pixel
        description="Signal below which a pixel is flagged dim.",
        validate_default=False,
        examples=["100 electron"],
    )
    no_film_below: float = Field(
        0.25,
        gt=0,
        lt=1,
        description="A pixel whose fluorescence is below this share of its surroundings is "
        "flagged no_film (a bubble).",
    )
    smoothing: int | None = Field(
        None,
        ge=2,
        le=50,
        description="Resolution of the smoothed ratio behind the maps, full width at half maximum "
        "[px]. Default: no smoothing.",
        examples=[4],
    )


class LightOptions(Settings):
    """Light that is not film."""

    background: Literal["report", "correct"] = Field(
        "report",
        description="Light of joint and filters that light and films of the run show, beyond the "
        "frames of the dry joint: reported with its uncertainty, or subtracted from the frames. It "
        "is taken as even over the image.",
    )
    bleaching: Literal["report", "correct"] = Field(
        "report",
        description="Change of the ratio with every pulse at equal film, on the reference patch or "
        "at equal triggers of several cycles: reported, or taken out of the ratio.",
    )


class ReferenceSettings(Settings):
    """A patch of known film that both cameras see in every frame."""

    region: RegionOfInterest | None = Field(
        None,
        description="Region of the patch in mm.",
        examples=[{"x": [1.2, 3.4], "y": [6, 9]}],
    )
    thickness: Length | None = Field(
        None,
        description="Film of the patch. Default: there is no patch.",
        examples=["5.2 um"],
    )
    uncertainty: Length | None = Field(
        None,
        description="Standard deviation of that film. Default: it is exact.",
        examples=["0.02 um"],
    )

    @model_validator(mode="after")
    def _whole(self) -> Self:
        if (self.region is None) != (self.thickness is None):
            raise ValueError("give region and thickness of the reference patch together")
        return self


class PredictionOptions(Settings):
    """The film that theory predicts for an oscillating joint."""

    sideways: Sideways = Field(
        "free",
        description="How the pin is held at right angles to the load: free, guided (it does not "
        "move), or by a spring of this stiffness.",
    )
    cavitation_pressure: CavitationPressure = Field(
        -1e5,
        description="Pressure at which the oil film ruptures, relative to ambient; 0 Pa where air "
        "enters the cavities.",
        validate_default=False,
    )
    start_film: StartFilm = Field(
        "fit",
        description='Minimum film thickness at the first frame; "fit" is the one whose film is '
        "nearest to the measured minima.",
    )
    load_line: Place | None = Field(
        None,
        description="Place of the load line along the sliding direction, from the centre of the "
        "first pixel: there the pin would touch the bushing at rest. Default: the middle of the "
        "image for the position, and for the prediction the place about which the pin swings.",
    )
    load_line_std: Length | None = Field(
        None,
        description="Standard deviation of the load line. It enters the error of the forces of the "
        "pressure. Default: the load line is exact.",
        examples=["0.2 mm"],
    )
    direction: Literal["along", "against"] = Field(
        "along",
        description="Whether the bushing moves along the sliding direction of the image or against "
        "it while the angle of the rocker rises.",
    )
    long: bool = Field(
        False,
        description="Leave out the flow along the axis: an infinitely long joint.",
    )


class RunName(Settings):
    """Name of the run."""

    name: Text = Field(description="Name of the run in figures and reports.")


# "kind" selects the form of the table, so that a fault is reported for that form alone
MechanismSettings = Annotated[
    CrankRockerSettings | SliderCrankSettings | RotationSettings | SinusoidalSettings,
    Field(discriminator="kind"),
]
"""Forms of [mechanism]."""


class RunSettings(Settings):
    """run.toml."""

    calibration: FileName | None = Field(
        None,
        description="calibration.nc of a fixture photographed with the same cameras and filters; "
        "made on the way if only its fixture.toml exists. The option --calibration takes "
        "precedence.",
        examples=["../fixture/calibration.nc"],
    )
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
    reference: ReferenceSettings = ReferenceSettings()
    prediction: PredictionOptions = PredictionOptions()

    @property
    def name(self) -> str:
        """Name of the run."""
        return self.run.name

    @property
    def linkage(self) -> CrankRockerSettings | SliderCrankSettings | None:
        """The mechanism where it is a linkage, whose position follows from the encoder alone."""
        if isinstance(self.mechanism, CrankRockerSettings | SliderCrankSettings):
            return self.mechanism
        return None

    @model_validator(mode="after")
    def _linkage_has_an_encoder(self) -> Self:
        if self.linkage is not None and (self.encoder is None or self.encoder.file is None):
            raise ValueError(
                f'[mechanism] of kind "{self.linkage.kind}" needs the log of its encoder: add '
                'file = "encoder.csv" to [encoder], or leave [mechanism] out; the film then has no '
                "speed"
            )
        return self

    @model_validator(mode="after")
    def _bins_have_a_cycle(self) -> Self:
        if self.mechanism is None and self.encoder is not None and self.encoder.bins is not None:
            raise ValueError(
                "bins in [encoder] are parts of the cycle of a mechanism: add [mechanism], or "
                "remove bins"
            )
        return self

    @model_validator(mode="after")
    def _one_load(self) -> Self:
        here = getattr(self.mechanism, "load", None)
        if here is not None and self.joint is not None and self.joint.load is not None:
            raise ValueError("give the load once, in [mechanism] or in [joint]")
        return self

    @property
    def load(self) -> float | None:
        """Load of the settings, for a log without one; None where neither table gives it. [N]"""
        of_mechanism: float | None = getattr(self.mechanism, "load", None)
        return self.joint.load if self.joint and self.joint.load else of_mechanism


class FixtureProfile(Settings):
    """The calibration fixture and its profile from the coordinate measuring machine."""

    name: Text = Field(description="Name of the fixture.", examples=["wedge"])
    profile: FileName = Field(
        description="Profile: CSV with the columns x_mm, thickness_um and, if known, y_mm and "
        "uncertainty_um.",
        examples=["profile.csv"],
    )
    origin: tuple[float, float] = Field(
        (0.0, 0.0),
        description="Pixel (x, y) of camera 1 at profile x = 0 (and y = 0).",
    )
    direction: Angle = Field(
        0.0, description="Turn from image x to profile x.", validate_default=False
    )
    align: bool = Field(False, description="Refine origin and scale against the image.")


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
        """Name of the fixture."""
        return self.fixture.name
