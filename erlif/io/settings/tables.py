"""The tables of run.toml and fixture.toml as frozen, checked settings.

A quantity is written as text with a unit and kept as a float in the unit of its type (`Form.unit`):
SI, but nm for a band, electrons and DN for a camera, degC for Vogel's temperature. Its text is kept
with it (`Quantity`), so that settings are stored as the user wrote them.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
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
CurvatureRadius = Annotated[
    float, *quantity("radius, negative where the body is hollow", "9.5 mm", "m")
]
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
Places = Annotated[tuple[Place, ...], Form("list of positions", ["-50 mm", "50 mm"])]
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
    """Frames of this camera, in natural order (frame_2 before frame_10): a pattern, or one
    multi-page file, relative to this file."""
    band: Band
    """Centre wavelength of the filter of this camera. Camera 1 has the shorter one, whose light dye
    2 reabsorbs."""
    bit_depth: int = Field(12, strict=True, ge=8, le=16)
    """Bits of a count: full scale is 2^bit_depth - 1. The data sheet of the camera states it."""
    alignment: Literal["right", "left"] = "right"
    """Bits of a 16-bit word that hold the count: low (right) or high (left), as in multiples of 16
    at 12 bits."""
    part: FilePart | None = None
    """Part of the files that belongs to this camera where one file holds both, also of darks and
    flats: half of the sensor, odd or even pages (the first is odd), a channel of an OME or ImageJ
    file, a frame of a LaVision image. Default: the whole file."""
    dataset: Text | None = Field(None, examples=["/camera1/counts"])
    """Path of the frames in an HDF5 or netCDF file. Default: its only dataset of three
    dimensions."""
    dark_dataset: Text | None = Field(None, examples=["/camera1/dark"])
    """Path of the dark frames in an HDF5 or netCDF file. Default: that of the frames."""
    flat_dataset: Text | None = Field(None, examples=["/camera1/flat"])
    """Path of the flat frames in an HDF5 or netCDF file. Default: that of the frames."""
    background_dataset: Text | None = Field(None, examples=["/camera1/background"])
    """Path of the frames of the dry joint in an HDF5 or netCDF file. Default: that of the
    frames."""
    dark: FileName | None = Field(None, examples=["camera1_dark.tif"])
    """Dark frames: lens capped, exposure time and camera gain as in the run. Either dark or offset
    is required."""
    offset: Counts | None = None
    """Dark level of the camera where no dark frames were taken."""
    flat: FileName | None = Field(None, examples=["camera1_flat.tif"])
    """Flat frames of an evenly lit target, several at each light level. Default: all pixels are
    equally sensitive."""
    background: FileName | None = Field(None, examples=["camera1_background.tif"])
    """Frames of the dry or dye-free joint under the laser, at the mean pulse energy of the run.
    Their light is subtracted, scaled by the pulse energy where the log has it."""
    gain: Gain | None = None
    """Photo-electrons per count. Default: measured from the flats by photon transfer (EMVA 1288),
    without flats from the frames."""
    read_noise: Electrons | None = None
    """Rms read noise of a pixel. Default: measured from the darks, without darks from the
    frames."""

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
    """Size of a pixel of camera 1 in the object plane. Photograph a scale there and divide a length
    by the number of pixels it covers."""
    x_axis: Literal["sliding", "axial"] = "sliding"
    """Direction of the joint along image x: the sliding (circumferential) or the axial
    direction."""
    wall: Reflectance | None = None
    """Share of laser and fluorescence that the wall behind the film returns; [systematics] wall is
    its error. Default: as the fit of the fixture finds it, and that of the fixture for the
    joint."""

    axial_centre: Place | None = None
    """Place of the middle of the joint along the axial direction, from the centre of the first
    pixel. The bore of the joint and its ends are placed from it. Default: the middle of the
    image."""

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

    angle: AngleUnit | None = Field(None, examples=["rad"])
    """Unit of the angle; tick needs ticks_per_turn."""
    time: TimeUnit | None = Field(None, examples=["ms"])
    """Unit of the time."""
    load: ForceUnit | None = Field(None, examples=["lbf"])
    """Unit of the load."""
    temperature: TemperatureUnit | None = Field(None, examples=["degF"])
    """Unit of the temperature."""
    speed: SpeedUnit | None = Field(None, examples=["mm/s"])
    """Unit of the speed."""
    torque: TorqueUnit | None = Field(None, examples=["N mm"])
    """Unit of the torque."""
    pulse_energy: PulseEnergyUnit | None = Field(None, examples=["mJ"])
    """Unit of the pulse energy."""


class EncoderSettings(Settings):
    """The encoder and its log."""

    file: FileName | None = Field(None, examples=["encoder.csv"])
    """Encoder log: one row for each frame pair, or a column of times. Default: there is none, as
    for a static film."""
    mounted_on: Literal["rocker", "crank", "coupler"] = "rocker"
    """Link whose angle against the ground link the encoder measures."""
    zero: Angle | None = None
    """Angle of that link, counted from the ground link, at encoder reading 0; of a disc, its angle;
    of a sinusoidal slider, the angle of its drive, 0 at mid-stroke. Default: the extremes of the
    log are matched to the dead points of the linkage; 0 for disc and slider."""
    triggers_per_cycle: int | None = Field(None, strict=True, ge=1, examples=[50])
    """Triggers in one cycle, for folding several cycles; 1 averages all frames of a static film.
    Default: from the log of a linkage whose triggers repeat; else each frame is a trigger."""
    bins: int | None = Field(None, strict=True, ge=2, examples=[50])
    """Parts of a cycle, by the angle of the crank, over which frames are averaged. No part holds
    frames of both strokes. Default: none."""
    direction: Literal["rising", "falling"] | None = None
    """Whether the reading rises or falls while the angle of the link rises. Default: as the log
    shows; rising where it does not show it."""

    # columns of the log
    angle: ColumnName | None = None
    """Column with the reading of the encoder. Default: angle_deg, else a column called angle or
    encoder."""
    frame: ColumnName | None = Field(None, examples=["Image No"])
    """Column with the number of the frame. Default: frame, else one row for each frame."""
    time: ColumnName | None = Field(None, examples=["Time [ms]"])
    """Column with the time. Default: time_s, else a column called time or t."""
    load: ColumnName | None = Field(None, examples=["Force [lbf]"])
    """Column with the load on the joint. Default: load_N, else a column called load or force."""
    temperature: ColumnName | None = Field(None, examples=["T oil [°C]"])
    """Column with the temperature of the oil. Default: temperature_C, else a column called
    temperature."""
    speed: ColumnName | None = Field(None, examples=["Speed [mm/s]"])
    """Column with the sliding speed or the speed of rotation. Default: speed_m_s."""
    torque: ColumnName | None = Field(None, examples=["Torque [N m]"])
    """Column with the torque that turns the joint. Default: torque_Nm."""
    pulse_energy: ColumnName | None = Field(None, examples=["Laser [mJ]"])
    """Column with the energy of the laser pulse. Default: none."""
    units: ColumnUnits = Field(ColumnUnits(), examples=[{"angle": "rad", "load": "lbf"}])
    """Units of columns that have none in their header."""
    ticks_per_turn: float | None = Field(None, strict=True, gt=0, examples=[3600])
    """Ticks that the encoder counts in a turn. Required where the unit of the angle is tick."""

    # frames in a continuous log
    pulse: ColumnName | None = Field(None, examples=["Trigger [V]"])
    """Column of a continuous log with the trigger of the cameras: a voltage that rises at each
    frame, or a count of the frames. Default: none."""
    frame_rate: Frequency | None = Field(None, examples=["500 Hz"])
    """Rate of the frames in a continuous log. Default: times in the headers of the camera files."""
    start: Start | None = None
    """Time of the first frame on the clock of a continuous log. "fit" finds it from the light of
    the frames over the cycle. Default: none."""

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
    """Kind of linkage."""
    crank: Length
    """Length of the crank, from pivot to pivot."""
    coupler: Length = Field(examples=["44 cm"])
    """Length of the coupler between crank and rocker, from pivot to pivot."""
    rocker: Length = Field(examples=["26 cm"])
    """Length of the rocker, from pivot to pivot."""
    ground: Length = Field(examples=["51 cm"])
    """Distance of the fixed pivots of crank and rocker."""
    crank_speed: Speed
    """Speed of rotation of the crank."""


class SliderCrankSettings(Settings):
    """Crank, connecting rod and the speed of the crank."""

    kind: Literal["slider-crank"]
    """Kind of linkage."""
    crank: Length
    """Length of the crank, from pivot to pivot."""
    coupler: Length = Field(examples=["44 cm"])
    """Length of the connecting rod, from pivot to pivot."""
    crank_speed: Speed
    """Speed of rotation of the crank."""


class RotationSettings(Settings):
    """A disc, ring or shaft that turns past the contact, as in a pin-on-disc tribometer."""

    kind: Literal["rotation"]
    """Kind of motion."""
    radius: Length = Field(examples=["20 mm"])
    """Radius of the track: distance of the contact from the axis of rotation."""
    speed: Speed | None = Field(None, examples=["60 rpm"])
    """Speed of rotation. Default: from the angle and the time of the log."""
    load: Force | None = Field(None, examples=["20 N"])
    """Load on the contact, where the encoder log has no column load_N. Default: the film has no
    load."""


class SinusoidalSettings(Settings):
    """A slider that moves to and fro in a straight line, as a sine of the time."""

    kind: Literal["sinusoidal"]
    """Kind of motion."""
    stroke: Length = Field(examples=["10 mm"])
    """Travel from end to end, twice the amplitude."""
    frequency: Frequency
    """Cycles to and fro in a unit of time."""
    load: Force | None = Field(None, examples=["20 N"])
    """Load on the contact, where the encoder log has no column load_N. Default: the film has no
    load."""


class MaterialSettings(Settings):
    """One side of the joint."""

    youngs_modulus: Pressure
    """Young's modulus."""
    poissons_ratio: float = Field(strict=True, gt=-1, le=0.5, examples=[0.37])
    """Poisson's ratio."""
    roughness: Length | None = Field(None, examples=["0.2 um"])
    """Rms roughness of the surface. Default: no film parameter Lambda is computed."""


class BoreSettings(Settings):
    """The bore along its axis, where it is not straight: lobes, edges or a measured profile."""

    lobes: Places = ()
    """Places along the axis of lobes that reach into the bore, from the middle of the joint. Beside
    them the bore has bushing_radius."""
    lobe_radius: Length | None = Field(None, examples=["200 mm"])
    """Radius of the lobes along the axis."""
    lobe_height: Length | None = Field(None, examples=["20 um"])
    """Height of the lobes above the bore."""
    edge_length: Length | None = Field(None, examples=["5 mm"])
    """Length over which the bore is relieved at either end, as a parabola that begins level: an
    edge of the radius edge_length^2 / (2 edge_depth)."""
    edge_depth: Length | None = Field(None, examples=["20 um"])
    """Depth of the relief at the ends."""

    def faults(self) -> Iterator[str]:
        if bool(self.lobes) != bool(self.lobe_radius) or bool(self.lobes) != bool(self.lobe_height):
            yield "give lobes, lobe_radius and lobe_height together, or none of them"
        if bool(self.edge_length) != bool(self.edge_depth):
            yield "give edge_length and edge_depth together, or neither"

    @property
    def lobe_reach(self) -> float:
        """Distance from the crest of a lobe to its foot. [m]"""
        return math.sqrt(2 * (self.lobe_radius or 0.0) * (self.lobe_height or 0.0))


class LinerSettings(Settings):
    """A thin elastic layer in the bushing, bonded to a rigid one: a Winkler foundation."""

    thickness: Length = Field(examples=["1 mm"])
    """Thickness of the layer."""
    youngs_modulus: Pressure = Field(examples=["1.4 GPa"])
    """Young's modulus of the layer."""
    poissons_ratio: float = Field(strict=True, gt=-1, lt=0.5, examples=[0.4])
    """Poisson's ratio of the layer; a layer of 0.5 that cannot spread does not yield."""


class JointSettings(Settings):
    """The pin and the bushing it turns in."""

    pin_radius: Length = Field(examples=["33.36 mm"])
    """Radius of the pin."""
    bushing_radius: Length = Field(examples=["33.59 mm"])
    """Inner radius of the bushing, larger than pin_radius."""
    clearance_std: Length | None = Field(None, examples=["1 um"])
    """Standard deviation of the radial clearance, for the pressure and `predict --fit`. Default:
    exact for the pressure; known to the last digits of both radii for the fit."""
    length: Length = Field(examples=["237 mm"])
    """Loaded length of the joint along its axis."""
    load: Force | None = None
    """Load on the joint. Used where the encoder log has no column load_N, and required there."""
    pin: MaterialSettings
    bushing: MaterialSettings
    bore: BoreSettings | None = Field(
        None,
        examples=[{"lobes": ["-50 mm", "50 mm"], "lobe_radius": "200 mm", "lobe_height": "20 um"}],
    )
    """The bore along its axis where it is not straight. Position, minimum and prediction of the
    film take its shape. Default: straight."""
    liner: LinerSettings | None = Field(
        None,
        examples=[{"thickness": "1 mm", "youngs_modulus": "1.4 GPa", "poissons_ratio": 0.4}],
    )
    """A thin elastic layer on the bushing, which the pressure of the prediction deflects. Default:
    none; the prediction takes the surfaces as rigid."""

    def faults(self) -> Iterator[str]:
        if self.pin_radius >= self.bushing_radius:
            yield (
                "pin_radius must be smaller than bushing_radius for the pin to turn; got "
                f"{self.pin_radius * 1e3:g} mm in {self.bushing_radius * 1e3:g} mm"
            )
        if self.bore is not None:
            yield from self._faults_of_bore(self.bore)

    def _faults_of_bore(self, bore: BoreSettings) -> Iterator[str]:
        """Lobes and edges that have no place in the joint."""
        half, clearance = self.length / 2, self.bushing_radius - self.pin_radius
        reach, height, edge = bore.lobe_reach, bore.lobe_height or 0.0, bore.edge_length or 0.0
        feet = [-half, *(at + side for at in sorted(bore.lobes) for side in (-reach, reach)), half]
        if any(after < before for before, after in pairwise(feet)):
            yield (
                f"lobes of bore must neither overlap nor end beyond {half * 1e3:g} mm from the "
                f"middle of the joint; each reaches {reach * 1e3:.3g} mm to either side, by its "
                "radius and height. Correct lobes, lobe_height or length"
            )
        if height >= clearance:
            yield (
                f"lobe_height of bore must be below the radial clearance, {clearance * 1e6:g} um, "
                f"for the pin to fit; got {height * 1e6:g} um"
            )
        if edge > half:
            yield (
                f"edge_length of bore must be at most half of the length, {half * 1e3:g} mm; got "
                f"{edge * 1e3:g} mm"
            )


class BodySettings(MaterialSettings):
    """A body of the contact: its curvature, its material and its surface."""

    radius: CurvatureRadius | None = Field(None, examples=["9.525 mm"])
    """Radius of a ball. Default: the body is flat."""
    radius_along: CurvatureRadius | None = Field(None, examples=["9.525 mm"])
    """Radius along the sliding direction, negative in a bore. Default: radius."""
    radius_across: CurvatureRadius | None = Field(None, examples=["50 mm"])
    """Radius across the sliding direction, negative in a groove. Default: radius."""

    def faults(self) -> Iterator[str]:
        if 0 in (self.radius, self.radius_along, self.radius_across):
            yield "a radius must not be zero; leave it out where the body is flat"

    def curvature(self, own: float | None) -> float:
        """Curvature in one direction, of its `own` radius or that of the ball. [1/m]"""
        radius = own or self.radius
        return 0.0 if radius is None else 1 / radius


class ContactSettings(Settings):
    """Ball, barrel or roller on a disc, ring or plane, in place of [joint]."""

    length: Length | None = Field(None, examples=["10 mm"])
    """Length of a line contact across the sliding direction, as of a roller. Default: the bodies
    touch in a point."""
    load: Force | None = Field(None, examples=["20 N"])
    """Load on the contact, where neither the encoder log nor [mechanism] has one."""
    slide_to_roll: float = Field(2.0, strict=True, ge=0)
    """Slide-to-roll ratio: difference of the two surface speeds over their mean. The speed of
    [mechanism], or of the log, is that of the faster surface: the mean is that speed over
    1 + slide_to_roll/2. 2 is pure sliding, 0 pure rolling."""
    body: BodySettings
    counterbody: BodySettings

    @property
    def radii(self) -> tuple[float, float]:
        """Reduced radii along and across the sliding direction, infinite where flat. [m]"""
        one, other = self.body, self.counterbody
        along = one.curvature(one.radius_along) + other.curvature(other.radius_along)
        across = one.curvature(one.radius_across) + other.curvature(other.radius_across)
        return 1 / along if along else math.inf, 1 / across if across else math.inf

    def faults(self) -> Iterator[str]:
        along, across = self.radii
        if not 0 < along < math.inf or across < 0:
            yield (
                "the bodies must touch in a point or a line: make the sum of their curvatures, "
                "1/radius and negative where hollow, positive along the sliding direction and not "
                "negative across it"
            )
        if (self.length is None) == math.isinf(across):
            yield (
                "give radius or radius_across of a body, for a contact in a point, or length, for "
                "bodies that are straight across the sliding direction"
            )


class VogelSettings(Settings):
    """Vogel's law, viscosity = a exp(b/(T - c))."""

    a: Viscosity = Field(examples=["0.05 mPa s"])
    """Viscosity in the limit of high temperature."""
    b: TemperatureDifference
    """Slope of ln(viscosity) over 1/(T - c)."""
    c: Temperature
    """Temperature of the pole, below every temperature logged."""


class OilSettings(Settings):
    """The oil between pin and bushing."""

    name: Text = Field("", examples=["80W-90"])
    """Name of the oil in figures and reports."""
    viscosity: Viscosity | None = None
    """Dynamic viscosity at the temperature of the run. Either viscosity or vogel is required."""
    vogel: VogelSettings | None = Field(
        None, examples=[{"a": "0.05 mPa s", "b": "1100 K", "c": "-115 degC"}]
    )
    """Viscosity from the logged temperature by Vogel's law, a exp(b/(T - c)), in place of one
    value."""
    viscosity_std: Viscosity | None = Field(None, examples=["0.004 Pa s"])
    """Standard deviation of the viscosity, with a vogel law at the mean temperature of the run, for
    the pressure and `predict --fit`. Default: the viscosity is exact."""
    drift_std: Share | None = Field(None, examples=["5 %"])
    """Standard deviation of the change of the viscosity from the first frame to the last, beside
    that of the logged temperature, for `predict --fit`. Default: of a vogel law, what reading_std
    of [temperature] makes; else no change."""
    pressure_viscosity: PressureViscosity
    """Pressure-viscosity coefficient of Barus."""

    def faults(self) -> Iterator[str]:
        if (self.viscosity is None) == (self.vogel is None):
            yield 'give either viscosity = "0.12 Pa s" or a vogel law { a, b, c }'


class RegistrationOptions(Settings):
    """Registration of camera 2 to camera 1."""

    window: int = Field(32, strict=True, ge=16, le=256)
    """Side of the interrogation window. [px]"""
    step: int = Field(8, strict=True, ge=4, le=128)
    """Distance between window centres. [px]"""
    model: Literal["auto", "surface", "local"] = "auto"
    """Form of the camera map: one smooth surface, one displacement for each window, or the surface
    unless the distortion is finer."""
    orientation: Literal[
        "normal", "mirrored_x", "mirrored_y", "rotated_90", "rotated_180", "rotated_270"
    ] = "normal"
    """Turn or mirror image that lays camera 2 over camera 1; rotated_90 turns it
    counter-clockwise."""
    reuse: bool = False
    """Use the camera map stored with the calibration, after a check on the frames of this run."""
    frames: int | None = Field(None, strict=True, ge=1, examples=[12])
    """Number of frame pairs for the fixed part of the camera map. Default: 12 small or 4 large
    ones."""


class RegionOfInterest(Settings):
    """Region of the film statistics, from the centre of the first pixel. [mm]"""

    x: Interval
    """Interval along image x. [mm]"""
    y: Interval = Field(examples=[[2, 13]])
    """Interval along image y, which points down. [mm]"""

    def faults(self) -> Iterator[str]:
        for name, (low, high) in (("x", self.x), ("y", self.y)):
            if not low < high:
                yield (f"{name} must be [low, high] in mm with low < high; got [{low:g}, {high:g}]")


class ThicknessOptions(Settings):
    """Thickness maps and the statistics of a trigger."""

    roi: RegionOfInterest | None = Field(None, examples=[{"x": [4, 15], "y": [2, 13]}])
    """Region in mm in which film_mean and film_min are taken. Default: the whole image."""
    least_signal: Electrons = Field(100.0, examples=["100 electron"])
    """Signal below which a pixel is flagged dim."""
    no_film_below: float = Field(0.25, strict=True, gt=0, lt=1)
    """A pixel whose fluorescence is below this share of its surroundings is flagged no_film (a
    bubble)."""
    smoothing: int | None = Field(None, strict=True, ge=2, le=50, examples=[4])
    """Resolution of the smoothed ratio behind the maps, full width at half maximum [px]. Default:
    no smoothing."""


class LightOptions(Settings):
    """Light that is not film, and what light and films show of other errors."""

    background: Literal["report", "correct"] = "report"
    """Even light of joint and filters that the run shows, beyond the frames of the dry joint:
    reported, or subtracted from the frames."""
    bleaching: Literal["report", "correct"] = "report"
    """Change of the ratio with every pulse, on the reference patch or over several cycles:
    reported, or taken out of the ratio."""
    ratio: Literal["report", "correct"] = "report"
    """Scale of the ratio on the patch of [reference], and its change over the frames: reported, or
    taken out of all frames."""
    errors: Literal["report", "correct"] = "report"
    """Errors of [systematics] that the gap of the joint shows: reported, or taken out of the curve
    of the calibration."""

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
    """Relative change of the light in the band of camera 1 with the temperature of the oil.
    Default: the ratio is not corrected."""
    camera2: TemperatureCoefficient | None = Field(None, examples=["-0.1 %/K"])
    """The same in the band of camera 2."""
    std: TemperatureCoefficientStd | None = None
    """Standard deviation of the difference of both."""
    reading_std: TemperatureStd = 1.0
    """Standard deviation of the temperature between fixture and run, and again from the first frame
    of the run to the last."""

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

    region: RegionOfInterest | None = Field(None, examples=[{"x": [1.2, 3.4], "y": [6, 9]}])
    """Region of the patch in mm."""
    thickness: Length | None = Field(None, examples=["5.2 um"])
    """Film of the patch. Default: there is no patch."""
    uncertainty: Length | None = Field(None, examples=["0.02 um"])
    """Standard deviation of that film. Default: it is exact."""

    def faults(self) -> Iterator[str]:
        if (self.region is None) != (self.thickness is None):
            yield "give region and thickness of the reference patch together"


class PredictionOptions(Settings):
    """The film that theory predicts for an oscillating joint."""

    sideways: Sideways = "free"
    """How the pin is held at right angles to the load: free, guided (it does not move), or by a
    spring of this stiffness."""
    cavitation_pressure: CavitationPressure = -1e5
    """Pressure at which the oil film ruptures, relative to ambient; 0 Pa where air enters the
    cavities."""
    cavitation_pressure_std: Pressure | None = Field(None, examples=["20 kPa"])
    """Standard deviation of that pressure, within which `predict --fit` finds the one of a held
    pin. Default: it is exact."""
    start_film: StartFilm = "fit"
    """Minimum film thickness at the first frame; "fit" is the one whose film is nearest to the
    measured minima."""
    load_line: Place | None = None
    """Place along the sliding direction, from the centre of the first pixel, where the pin would
    touch the bushing at rest. Default, for position and prediction alike: the line that is fitted
    to the orbit of a free pin; where the orbit does not determine it, and for a pin that is held,
    the middle of the swing; without a crank-rocker the middle of the image. The attribute load_line
    of pin_displacement states it, and its standard deviation is in that of the sideways
    displacement."""
    load_line_std: Length | None = Field(None, examples=["0.2 mm"])
    """Standard deviation of the load line, for the sideways displacement, the pressure and `predict
    --fit`. Default: that of a fitted line; of a given one none, and 0.5 mm for the fit."""
    load_std: Share = 1.0
    """Standard deviation of the load over the load, the same at all triggers, for `predict
    --fit`."""
    direction: Literal["along", "against"] = "along"
    """Motion of the bushing in the image while the angle of the rocker rises."""
    long: bool = False
    """Leave out the flow along the axis: an infinitely long joint."""
    rough: bool | None = Field(None, examples=[True])
    """Let the roughness of pin and bushing hinder the flow between them, by the flow factors of
    Patir and Cheng. Default: false. It counts for films below five times the combined roughness."""


class RunName(Settings):
    """Name of the run."""

    name: Text
    """Name of the run in figures and reports."""


# "kind" selects the form of the table, so that a fault is reported for that form alone
# Forms of [mechanism].
MechanismSettings = Annotated[
    CrankRockerSettings | SliderCrankSettings | RotationSettings | SinusoidalSettings,
    Field(discriminator="kind"),
]


class RunSettings(Settings):
    """run.toml."""

    calibration: CalibrationNames | None = Field(None, examples=["../fixture/calibration.nc"])
    """calibration.nc of a fixture photographed with the same cameras and filters; made on the way
    if only its fixture.toml exists. Two names: the fixture before and after the run. The option
    --calibration takes precedence."""
    run: RunName
    camera1: CameraSettings
    camera2: CameraSettings
    optics: OpticsSettings
    encoder: EncoderSettings | None = None
    mechanism: MechanismSettings | None = None
    joint: JointSettings | None = None
    contact: ContactSettings | None = None
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

        if self.joint is not None and self.contact is not None:
            yield (
                "give [joint], for a pin in a bushing, or [contact], for a ball, barrel or roller "
                "on a disc, ring or plane, not both"
            )

        if self.prediction.long and self.joint is not None and self.joint.bore is not None:
            yield (
                "long = true in [prediction] is a joint without ends, and bore in [joint] is a "
                "shape along its axis: remove one of them"
            )

        sides = [] if self.joint is None else [self.joint.pin, self.joint.bushing]
        if self.prediction.rough and not any(one.roughness for one in sides):
            yield "rough = true in [prediction] needs roughness of pin or bushing in [joint]"

        if len(self._loads) > 1:
            yield f"give the load once, in {' or in '.join(self._loads)}"

    @property
    def _loads(self) -> dict[str, float]:
        tables = {"mechanism": self.mechanism, "joint": self.joint, "contact": self.contact}
        loads = {f"[{name}]": getattr(table, "load", None) for name, table in tables.items()}
        return {name: load for name, load in loads.items() if load is not None}

    @property
    def load(self) -> float | None:
        """Load of the settings, for a log without one; None where no table gives it. [N]"""
        return next(iter(self._loads.values()), None)

    @property
    def surfaces(self) -> tuple[MaterialSettings, ...]:
        """The two sides of [joint] or of [contact]; empty without either."""
        if self.joint is not None:
            return self.joint.pin, self.joint.bushing
        return () if self.contact is None else (self.contact.body, self.contact.counterbody)


class FixtureProfile(Settings):
    """The calibration fixture and its profile from the coordinate measuring machine."""

    name: Text = Field(examples=["wedge"])
    """Name of the fixture."""
    profile: FileName = Field(examples=["profile.csv"])
    """Profile: CSV with the columns x_mm, thickness_um and, if known, y_mm and uncertainty_um."""
    origin: tuple[StrictFloat, StrictFloat] = (0.0, 0.0)
    """Pixel (x, y) of camera 1 at profile x = 0 (and y = 0)."""
    direction: Angle = 0.0
    """Turn from image x to profile x."""
    align: bool = False
    """Refine origin and scale against the image."""
    temperature: Temperature | None = Field(None, examples=["23 degC"])
    """Temperature of the oil while the fixture was photographed, to which [temperature] of run.toml
    refers. Default: it is not known."""


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
