"""The tables of run.toml and fixture.toml as frozen, checked settings."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any, Literal

from pydantic import Field, StrictFloat, create_model

from erlif.core.terms import keys_in
from erlif.io.settings.surfaces import ContactSettings, JointSettings, MaterialSettings, OilSettings
from erlif.io.settings.values import (
    Angle,
    AngleUnit,
    Band,
    CalibrationNames,
    CavitationPressure,
    ColumnName,
    Counts,
    Distance,
    Electrons,
    Exclusions,
    FileName,
    Force,
    ForceUnit,
    Frequency,
    Gain,
    Interval,
    Length,
    PixelPitch,
    Place,
    Pressure,
    PulseEnergyUnit,
    Reflectance,
    Settings,
    Share,
    Sideways,
    Speed,
    SpeedUnit,
    Start,
    StartFilm,
    Temperature,
    TemperatureCoefficient,
    TemperatureCoefficientStd,
    TemperatureStd,
    TemperatureUnit,
    Text,
    TimeUnit,
    TorqueUnit,
)

_Channel = Literal["channel 1", "channel 2", "channel 3", "channel 4"]
# Parts of a file that may belong to one of two cameras.
FilePart = Literal["left", "right", "top", "bottom", "odd", "even", _Channel]


class CameraSettings(Settings):
    """One camera: its files, its filter and its noise."""

    files: FileName
    """Frames of this camera in the order of stem and number (run.tif, run_2.tif, run_10.tif): a
    pattern, or one multi-page file, relative to this file."""
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
    array_order: Literal["row", "column"] | None = None
    """Order of the numbers of an image in HDF5: row by row, (frame, y, x), as from Python and
    LabVIEW, or column by column, (frame, x, y), as from MATLAB's h5write, Julia, R and Fortran.
    Default: as the file states it."""
    dark: FileName | None = Field(None, examples=["camera1_dark.tif"])
    """Dark frames: lens capped, exposure time and camera gain as in the run. Either dark or offset
    is required."""
    offset: Counts | None = None
    """Dark level of the camera where no dark frames were taken."""
    flat: FileName | None = Field(None, examples=["camera1_flat.tif"])
    """Flat frames of an evenly lit target, several at each light level. Default: all pixels are
    equally sensitive."""
    serial: Text | None = Field(None, examples=["10234"])
    """Serial number of the camera: runs with other cameras are not of one rig. Default: as the
    frames have it."""
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
    exclude: Exclusions = ()
    """Parts of the image of camera 1 that count nowhere, as a scratch or a bolt: polygons, with
    corners [x, y] in mm from the centre of the first pixel, and images of the size of a frame
    (PNG, TIFF) that are white there. Their pixels are flagged masked."""
    least_signal: Electrons = Field(100.0, examples=["100 electron"])
    """Signal below which a pixel is flagged dim."""
    no_film_below: float = Field(0.25, strict=True, gt=0, lt=1)
    """A pixel whose fluorescence is below this share of its surroundings is flagged no_film (a
    bubble)."""
    smoothing: int | None = Field(None, strict=True, ge=2, le=50, examples=[4])
    """Resolution of the smoothed ratio behind the maps, full width at half maximum [px]. Default:
    no smoothing."""

    @property
    def masks(self) -> list[str]:
        """Names of the mask images."""
        return [one for one in self.exclude if isinstance(one, str)]


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
    taken out of the films, as far as the widths of [systematics] allow."""
    errors: Literal["report", "correct"] | None = None
    """Errors of [systematics] that the gap of the joint shows: reported, or taken out of the curve
    of the calibration. Default: taken out where they lie within their widths."""

    @property
    def corrects(self) -> bool:
        """Whether any effect found in the frames is corrected."""
        return self.corrects_light or "correct" in (self.ratio, self.errors)

    @property
    def corrects_light(self) -> bool:
        """Whether background or bleaching is corrected."""
        return "correct" in (self.background, self.bleaching)

    def faults(self) -> Iterator[str]:
        if self.ratio == "correct" and "correct" in (self.background, self.bleaching):
            yield (
                "the ratio of the patch holds background and bleaching as well: with ratio = "
                '"correct", remove background and bleaching'
            )
        if self.errors == "correct" and self.corrects_light:
            yield (
                "the errors that the gap shows hold background and bleaching as well: with errors "
                '= "correct", remove those'
            )


def with_widths(*files: str, leave_out: str = "") -> type[Settings]:
    """A table with the standard deviations that settings files state, but for one key."""
    types: dict[str, Any] = {"%": Share, "mm": Distance | None}
    fields: dict[str, Any] = {
        key: (types[source.unit], Field(source.width, description=source.__doc__))
        for file in files
        for key, source in keys_in(file).items()
        if key != leave_out
    }
    return create_model("_Widths", __base__=Settings, **fields)


class SystematicsOptions(with_widths("run")):  # type: ignore[misc]
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


class FixtureSystematics(with_widths("fixture")):  # type: ignore[misc]
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
    --fit` and the error of the predicted film."""
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
    """calibration.nc of a fixture photographed with the same cameras and filters; fitted on the way
    if only its fixture.toml exists, and kept in this file if that lies in the run directory. Two
    names: the fixture before and after the run. The option --calibration takes precedence."""
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
    def beside(self) -> list[str]:
        """Names of the log, the profile of the bore and the masks, of those that there are."""
        bore = None if self.joint is None else self.joint.bore
        names = getattr(self.encoder, "file", None), getattr(bore, "profile", None)
        return [name for name in (*names, *self.thickness.masks) if name is not None]

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

    @property
    def beside(self) -> list[str]:
        """Names of the profile and the masks."""
        return [self.fixture.profile, *self.thickness.masks]
