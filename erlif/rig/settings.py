"""Settings of the virtual rig: every quantity that can be chosen, with unit and default."""

import math
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any, TypeVar

from erlif.core.errors import ModelError
from erlif.core.terms import keys_in

# How a pin without a spring is held at right angles to the load.
SIDEWAYS = ("free", "guided")
# Angle through which the rocker of the thesis turns; the default one differs little. [degree]
SWING = 24.0
# Settings of any number of values.
_LISTS = ("film_table", "flat_levels", "lobes", "profile")

_Value = TypeVar("_Value")


def _limited(default: _Value, low: float, high: float) -> _Value:
    """Smallest and largest value of a setting, of each number of a pair.

    Beyond them random numbers, memory or the search for object points fail.
    """
    return field(default=default, metadata={"limits": (low, high)})


def _one_of(*words: str) -> str:
    """A setting that is one of several words; the first one is the default."""
    return field(default=words[0], metadata={"words": words})


@dataclass(frozen=True)
class DyeSpectra:
    """Spectra of two dyes in the oil, in place of the invented ones.

    Attributes
    ----------
    laser : float
        Wavelength of the laser. [nm]
    bands : tuple[float, float]
        Centres of the filters of cameras 1 and 2. [nm]
    bandwidth : tuple[float, float]
        Full widths of these filters at half of their transmission. [nm]
    wavelength : tuple[float, ...]
        Rising, over laser and filters; values between are linear. [nm]
    attenuation : tuple[tuple[float, ...], tuple[float, ...]]
        Napierian attenuation of the oil by dye 1 and dye 2. [1/um]
    emission : tuple[tuple[float, ...], tuple[float, ...]]
        Light per depth and wavelength by unit laser light, of dye 1 and dye 2. [arbitrary unit]
    """

    laser: float
    bands: tuple[float, float]
    bandwidth: tuple[float, float]
    wavelength: tuple[float, ...]
    attenuation: tuple[tuple[float, ...], tuple[float, ...]]
    emission: tuple[tuple[float, ...], tuple[float, ...]]


@dataclass(frozen=True)
class RigSettings:
    """Settings of the virtual rig; the defaults follow the pin-joint rig of the thesis.

    Lengths in the picture are pixels of camera 1, so that the texture suits the sensor whatever
    the magnification.

    Attributes
    ----------
    width : int
        Columns of both cameras. [pixel]
    height : int
        Rows of both cameras. [pixel]
    field_width : float
        Width of the field of camera 1 in the object plane; the pixel pitch follows from it.
        [mm]
    mechanism : str
        "crank-rocker", "slider-crank" (the film of its crank pin), "rotation" (a disc),
        "sinusoidal" (a slider) or "static".
    pictures : int
        Frame pairs of one cycle; of a crank-rocker `spacing` determines them.
    track_radius : float
        Radius of the track on the disc. [mm]
    disc_speed : float
        Speed of the disc. [rpm]
    stroke : float
        Travel of the slider from end to end. [mm]
    frequency : float
        Cycles of the slider in a second. [Hz]
    crank : float
        Length of the crank. [cm]
    coupler : float
        Length of the coupler, or of the rod of a slider-crank. [cm]
    rocker : float
        Length of the rocker. [cm]
    ground : float
        Distance of the fixed pivots. [cm]
    crank_speed : float
        Speed of the crank. [rpm]
    spacing : float
        Rocker rotation from one encoder trigger to the next. [degree]
    cycles : int
        Turns of the crank that are photographed.
    write_zero : bool
        Write the link angle at encoder reading 0 into run.toml.
    encoder : str
        Link that carries the encoder: rocker, coupler or crank. The rod of a slider-crank is both
        rocker and coupler.
    reading : str
        What it shows: degrees; wrapped, degrees that start again at 0 within the stroke; or
        ticks, which do so too.
    pulses_per_cycle : float
        Frames in one turn at even crank angles, in place of the spacing; they need not repeat
        from turn to turn. 0: the spacing holds.
    log : str
        One row for each of the frames, or continuous.
    pin_radius : float
        Radius of the pin. [mm]
    bushing_radius : float
        Radius of the bushing. [mm]
    length : float
        Length of the joint along its axis. [mm]
    lobes : tuple[float, ...] | None
        Places along y of lobes in the bore, from the middle of the joint. [mm]
    lobe : tuple[float, float]
        Radius of a lobe along y [mm], and its height above the bore [um].
    edge : tuple[float, float]
        Length at either end of the joint over which the bore recedes as a parabola [mm], and how
        far it recedes at the end [um]; 0 for a sharp edge.
    profile : tuple[float, ...] | None
        Depth of the bore beyond its radius at equal distances from one end of the joint to the
        other, in place of lobes and edges; run.toml names it as a measured profile. [um]
    liner : tuple[float, float, float]
        Elastic layer in the bushing of the film "reynolds": thickness [mm], 0 for none, Young's
        modulus [GPa] and Poisson's ratio.
    roughness : float
        Rms roughness of pin and of bushing, without lay. [um]
    rough : bool
        Whether it hinders the flow of the film "reynolds", and is in the picture: finer than a
        pixel, which shows the mean light. Otherwise run.toml alone has it.
    axial_centre : float
        Position of the middle of the joint along y, from the middle of the field. [mm]
    load : float
        Mean load, 50 lbf. [N]
    load_swing : float
        Relative amplitude with which the load follows the crank.
    viscosity : float
        Viscosity of the oil. [Pa s]
    stated_viscosity : float
        Viscosity that run.toml states, where it is not the true one; 0: the true one. [Pa s]
    film : str
        "law", a power of speed over load, or "reynolds", the film that the load and the motion of
        the linkage produce; it changes from cycle to cycle.
    elapsed : float
        Turns of the crank from loading to the start of the first cycle, of the film "reynolds";
        the pin is centred at first. After 24 turns the film is about 6 um.
    sideways : str | float
        How the pin of the film "reynolds" is held at right angles to the load: "free", "guided"
        (it does not move), or the stiffness of a spring. [N/m]
    cavitation_pressure : float
        Pressure over the ambient one at which the film "reynolds" ruptures. [kPa]
    write_mount : bool
        Write into run.toml how the pin is held, the cavitation pressure and the load line.
    contact : str
        "pin" in its bushing, "ball" on a disc, or "plane": what the gap of the film law is.
    ball_radius : float
        Radius of the ball, whose contact is in the middle of the rows and at `thin_line`. [mm]
    plateau : tuple[float, float]
        Radius over which the load flattens the ball, 0: not [mm]; its central film over the
        minimum, which lies in the constriction at its sides. [1]
    film_reference : float
        Minimum film thickness at the highest rocker speed and the mean load. [um]
    exponent : float
        Exponent of speed over load in the film law.
    film_floor : float
        Minimum film thickness that squeeze maintains where the rocker stands still. [um]
    film_table : tuple[float, ...] | None
        Minimum film thickness at each trigger of one cycle, in place of the law. [um]
    thin_line : float
        Position of the thinnest film along x, from the middle of the field; of the load line for
        the film "reynolds". [mm]
    tilt : float
        Rise of the film over the height of the field; 0 for the film "reynolds", whose pin and
        bushing are parallel. A ball has none. [um]
    marks : float
        Standard deviation of the turning marks; scratches are four times as deep. [um]
    bubbles : int
        Largest number of bubbles in a frame of 320 x 256 pixels; smaller pictures hold fewer.
    light : float
        Exposure: 1 keeps the brightest speckle near 3000 DN.
    dyes : DyeSpectra | None
        Dyes, laser and filters in place of the invented dyes at 532, 580 and 610 nm.
    beam_corner : float
        Brightness of the laser beam at the corners of the field, relative to its axis.
    iris : float
        Radius of the iris that cuts the laser beam, over half the diagonal of the field; 0: none.
    glare : float
        Light that each lens scatters evenly over its picture, of the mean light of the frame.
    pulse_jitter : float
        Relative standard deviation of the pulse energy.
    speckle_fixed : float
        Contrast in the object plane of the speckle that is the same in every pulse.
    speckle_new : float
        Contrast in the object plane of the speckle that is new with every pulse.
    speckle_size : float
        Standard deviation of one grain; the field is correlated over twice this (1/e). [pixel]
    blur : tuple[float, float]
        Standard deviation of the point spread, lens and pixel together. [pixel]
    thick_film_signal : tuple[float, float]
        Photo-electrons of a very thick film on the beam axis. [electron]
    vignetting : tuple[float, float]
        Transmission of the lens at the corners relative to the centre.
    gain : float
        Electrons of one count. [electron/DN]
    read_noise : float
        Standard deviation of the read noise. [electron]
    full_well : float | None
        Largest signal of a pixel, where the converter does not limit it. [electron]
    offset : float
        Mean dark level. [DN]
    column_pattern : float
        Standard deviation of the dark level from column to column. [DN]
    response_spread : float
        Relative standard deviation of the pixel response.
    hot_fraction : float
        Share of the pixels with 500 to 3000 electrons of dark signal.
    dead_pixels : int
        Pixels of each camera without response to light.
    dust : int
        Dust specks on each sensor window.
    background : float
        Light of the dry joint under the laser, even over the field, over the median light of the
        run in each camera.
    background_beam : float
        The same with the shape of the laser beam.
    background_second : float
        Both in camera 2, over what they are in camera 1.
    background_pages : int
        Pages of the dry joint written for each camera; 0 writes none.
    background_energy : float
        Mean pulse energy of these pages over that of the run.
    bleaching : tuple[float, float]
        Share of dye 1 and dye 2 that each pulse of the run destroys.
    batch : tuple[float, float]
        Concentrations of dye 1 and dye 2 in the run over those in the fixture.
    wall : tuple[float, float]
        Reflectance of the wall behind the film of the fixture and of the joint.
    wall_texture : tuple[float, float]
        Standard deviation of the reflectance of the joint's wall over the picture, relative to its
        mean, and the length over which it is correlated (1/e) [mm].
    warming : float
        Rise of the oil's temperature from the first frame of the run to the last. [K]
    glow_per_kelvin : tuple[float, float]
        Relative change of the light of dye 1 and dye 2. [1/K]
    brightness : tuple[float, float]
        Light of camera 1 and 2 in the run over that at the calibration: filters, exposure, gain.
    shading : tuple[float, ...]
        Change of the response of camera 2 in the run, as by a window that was cleaned: its
        coefficients of x, y, x^2, x y and y^2, from -1 to 1 over the picture.
    gain_step : tuple[float, float]
        Frame from which on camera 2 is brighter, and by which factor.
    blur_step : tuple[float, float]
        Frame from which on camera 2 is less sharp, and the standard deviation of the point spread
        that is added. [pixel]
    bump : tuple[float, float, float]
        Frame from which on camera 2 is displaced, and by how much along x and y. [pixel]
    lag : tuple[float, float]
        Share of its last light that each camera adds to a frame of the run.
    compression : tuple[float, float]
        Share of the light that each camera loses at full scale in the run.
    dark_drift : tuple[float, float]
        Dark level of each camera in the run over that of its dark pages. [DN]
    dark_step : tuple[float, float]
        Frame from which on the dark level of camera 2 is higher, and by how much. [DN]
    write_systematics : bool
        Write into run.toml and fixture.toml which of these the rig does not have.
    reference : float
        Film in a patch beside the region of interest, the same in all frames; 0 for none. [um]
    shift : tuple[float, float]
        Displacement (x, y) at the middle of the picture. [pixel]
    scale : tuple[float, float]
        Magnification (x, y) of camera 2 over camera 1.
    rotation : float
        Rotation of camera 2 about the middle of the picture. [degree]
    distortion : float
        Quadratic distortion near the corners. [pixel]
    vibration : float
        Standard deviation per axis of the extra shift of camera 2 in each frame. [pixel]
    fixture_frames : int
        Frame pairs of the wedge.
    fixture_after : bool
        Photograph the wedge once more after the run, with its last dyes, oil and gain.
    wedge : tuple[float, float]
        Film at the first and the last column. [um]
    wedge_form : float
        Amplitude of the smooth departure of the wedge from a plane. [um]
    cmm_noise : float
        Standard deviation of one reading of the coordinate-measuring machine. [um]
    fixture_offset : tuple[float, float]
        Shift (x, y) of camera 2 between the fixture's session and the run. [pixel]
    dark_pages : int
        Pages of the dark file.
    flat_pages : int
        Pages of the flat file at each level of the lamp.
    flat_levels : tuple[float, ...]
        Brightest flat signal at each level of the lamp, of full scale.
    """

    # picture
    width: int = _limited(320, 32, 16384)
    height: int = _limited(256, 32, 16384)
    field_width: float = _limited(19.2, 0.01, 1000)

    # motion without a linkage
    mechanism: str = _one_of("crank-rocker", "slider-crank", "rotation", "sinusoidal", "static")
    pictures: int = _limited(24, 1, 1_000_000)  # a week of simulation at 320 x 256
    track_radius: float = _limited(20.0, 1e-3, 1e6)
    disc_speed: float = _limited(60.0, 1e-6, 1e6)
    stroke: float = _limited(10.0, 1e-6, 1e6)
    frequency: float = _limited(5.0, 1e-9, 1e6)

    # linkage and encoder
    crank: float = 5.5
    coupler: float = 44.0
    rocker: float = 26.0
    ground: float = 51.0
    crank_speed: float = _limited(114.0, 0.001, 1e5)
    spacing: float = _limited(0.96, 1e-9, 10)
    cycles: int = _limited(1, 1, math.inf)
    write_zero: bool = True
    encoder: str = _one_of("rocker", "coupler", "crank")
    reading: str = _one_of("degrees", "wrapped", "ticks")
    pulses_per_cycle: float = 0.0
    log: str = _one_of("frames", "continuous")

    # joint
    pin_radius: float = 33.36
    bushing_radius: float = 33.59
    length: float = _limited(237.0, 1e-3, 1e6)
    lobes: tuple[float, ...] | None = None
    lobe: tuple[float, float] = _limited((200.0, 20.0), 1e-3, 1e6)
    edge: tuple[float, float] = _limited((0.0, 0.0), 0, 1e4)
    profile: tuple[float, ...] | None = None
    liner: tuple[float, float, float] = _limited((0.0, 1.4, 0.4), 0, 1e4)
    roughness: float = _limited(0.2, 0, 100)
    rough: bool = False
    axial_centre: float = 0.0
    load: float = _limited(222.411, 1e-6, 1e9)
    load_swing: float = _limited(0.01, 0, 0.99)
    viscosity: float = _limited(0.12, 1e-6, 1e6)
    stated_viscosity: float = _limited(0.0, 0, 1e6)

    # film
    film: str = _one_of("law", "reynolds")
    elapsed: float = _limited(24.0, 0, 1e4)
    sideways: str | float = "free"
    cavitation_pressure: float = _limited(-100.0, -101.325, 0)
    write_mount: bool = True
    contact: str = _one_of("pin", "ball", "plane")
    ball_radius: float = _limited(100.0, 1e-3, 1e9)
    plateau: tuple[float, float] = _limited((0.0, 1.0), 0, 1e6)
    film_reference: float = _limited(6.0, 1e-3, 1000)
    exponent: float = _limited(0.62, -10, 10)
    film_floor: float = _limited(0.3, 1e-3, 1000)
    film_table: tuple[float, ...] | None = None
    thin_line: float = 0.8
    tilt: float = _limited(0.2, -1000, 1000)
    marks: float = _limited(0.07, 0, 10)
    bubbles: int = _limited(6, 0, 10_000)

    # light
    light: float = _limited(1.0, 1e-6, 1000)
    dyes: DyeSpectra | None = None
    beam_corner: float = 0.5
    iris: float = _limited(0.0, 0, 10)
    glare: float = _limited(0.0, 0, 1)
    pulse_jitter: float = _limited(0.03, 0, 0.3)
    speckle_fixed: float = _limited(0.08, 0, 1)
    speckle_new: float = _limited(0.08, 0, 1)
    speckle_size: float = _limited(0.72, 0.1, 100)

    # cameras, first and second
    blur: tuple[float, float] = (0.50, 0.55)
    thick_film_signal: tuple[float, float] = (11000.0, 11500.0)
    vignetting: tuple[float, float] = (0.84, 0.87)
    gain: float = _limited(4.4, 1e-3, 1e6)
    read_noise: float = _limited(9.0, 0, 1e6)
    full_well: float | None = _limited(None, 10, 1e9)
    offset: float = _limited(64.0, 0, 4095)
    column_pattern: float = _limited(2.0, 0, 1000)
    response_spread: float = _limited(0.01, 0, 0.3)
    hot_fraction: float = _limited(5e-4, 0, 1)
    dead_pixels: int = _limited(3, 0, 1_000_000)
    dust: int = _limited(4, 0, 10_000)

    # light that is not film, in the run alone
    background: float = _limited(0.0, 0, 10)
    background_beam: float = _limited(0.0, 0, 10)
    background_second: float = _limited(1.0, 0, 1000)
    background_pages: int = _limited(0, 0, 10_000)
    background_energy: float = _limited(1.0, 0, 100)
    bleaching: tuple[float, float] = _limited((0.0, 0.0), 0, 0.999999999)
    reference: float = _limited(0.0, 0, 1000)

    # what differs between fixture and run, or changes during it
    batch: tuple[float, float] = _limited((1.0, 1.0), 1e-3, 1000)
    wall: tuple[float, float] = _limited((0.0, 0.0), 0, 1)
    wall_texture: tuple[float, float] = _limited((0.0, 1.0), 0, 1000)
    warming: float = _limited(0.0, -100, 100)
    glow_per_kelvin: tuple[float, float] = _limited((-0.002, -0.001), -0.05, 0.05)
    brightness: tuple[float, float] = _limited((1.0, 1.0), 0.01, 100)
    shading: tuple[float, float, float, float, float] = (0.0, 0.0, 0.0, 0.0, 0.0)
    gain_step: tuple[float, float] = _limited((0.0, 1.0), 0, 1_000_000)
    blur_step: tuple[float, float] = _limited((0.0, 0.0), 0, 1_000_000)
    bump: tuple[float, float, float] = _limited((0.0, 0.0, 0.0), -1_000_000, 1_000_000)
    lag: tuple[float, float] = _limited((0.0, 0.0), 0, 0.9)
    compression: tuple[float, float] = _limited((0.0, 0.0), -0.9, 0.9)
    dark_drift: tuple[float, float] = _limited((0.0, 0.0), -1000, 1000)
    dark_step: tuple[float, float] = _limited((0.0, 0.0), -1_000, 1_000_000)
    write_systematics: bool = True

    # from camera 1 to camera 2
    shift: tuple[float, float] = (4.0, -3.0)
    scale: tuple[float, float] = _limited((1.004, 0.997), 0.8, 1.2)
    rotation: float = _limited(0.4, -10, 10)
    distortion: float = _limited(0.5, -10, 10)
    vibration: float = _limited(0.3, 0, 20)

    # calibration fixture
    fixture_frames: int = _limited(12, 1, 100_000)
    fixture_after: bool = False
    wedge: tuple[float, float] = (0.1, 18.0)
    wedge_form: float = _limited(0.1, 0, 100)
    cmm_noise: float = _limited(0.15, 0, 100)
    fixture_offset: tuple[float, float] = (0.6, -0.4)

    # reference pages
    dark_pages: int = _limited(8, 1, 10_000)
    flat_pages: int = _limited(4, 1, 10_000)
    flat_levels: tuple[float, ...] = (0.25, 0.5, 0.8)

    def excluded(self, file: str) -> dict[str, str]:
        """Keys of [systematics] in a settings file that the rig does not have, with zero."""
        if not self.write_systematics:
            return {}
        dark = (*self.dark_drift, self.dark_step[1])
        found = {
            "ratio": self.brightness != (1.0, 1.0) or self.gain_step[1] != 1,
            "background": any((self.background, self.background_beam, self.glare, *dark)),
            "energy": not self.background_pages or self.background_energy != 1,
            "field": any(self.shading),
            "bleaching": any(self.bleaching),
            "batch": self.batch != (1, 1),
            "temperature": self.warming != 0,
            "wall": self.wall[0] != self.wall[1],
            "linearity": any(self.compression),
            "lag": any(self.lag),
            "course": True,  # the change between two fixtures may depart from a straight line
        }
        return {key: f"0 {one.unit}" for key, one in keys_in(file).items() if not found.get(key)}

    def __post_init__(self) -> None:
        self._check_each()
        self._check_run()
        self._check_joint()

    def _check_each(self) -> None:
        """Refuse numbers that are not finite or that no rig has, and unknown words."""
        for name, value in vars(self).items():
            low, high = LIMITS.get(name, (-math.inf, math.inf))
            values = value if isinstance(value, tuple) else (value,)
            numbers = [one for one in values if isinstance(one, int | float)]
            text = isinstance(value, str) and not isinstance(getattr(RigSettings, name), str)
            if text or not all(math.isfinite(one) and low <= one <= high for one in numbers):
                among = f" from {low:g} to {high:g}" if name in LIMITS else ""
                raise ModelError(
                    f"Expected {name} of the virtual rig as a number{among}; got {value}. Choose "
                    "another value."
                )
        for name, words in CHOICES.items():
            if (got := getattr(self, name)) not in words:
                raise ModelError(
                    f"Expected {name} of the virtual rig as one of {', '.join(words)}; got "
                    f"{got!r}. Choose one of them."
                )

    def _check_run(self) -> None:
        """Refuse a run that is too long, references without a level, and a log without linkage."""
        logger = (self.log, self.reading, self.encoder)
        if not self.linked and logger != ("frames", "degrees", "rocker"):
            raise ModelError(
                "Expected log, reading and encoder of the virtual rig with a linkage alone; the "
                f"mechanism is {self.mechanism!r}. Leave them out."
            )
        spaced = self.mechanism == "crank-rocker"
        if self.pulses_per_cycle and not spaced:
            raise ModelError(
                "Expected pulses_per_cycle of the virtual rig with a crank-rocker alone; the "
                f"mechanism is {self.mechanism!r}. Write pictures in its place."
            )
        in_turn = self.pulses_per_cycle or 2 * SWING / self.spacing
        in_turn = in_turn if spaced else self.pictures
        most = LIMITS["pictures"][1]
        if in_turn * self.cycles > most:
            raise ModelError(
                f"Expected a run of at most {most} frame pairs; a spacing of {self.spacing:g} "
                f"degrees and {self.cycles} cycles have more. Choose a larger spacing or fewer "
                "cycles."
            )
        if not self.flat_levels:
            raise ModelError("The virtual rig needs at least one flat level. Choose 1 or more.")

    def _check_joint(self) -> None:
        """Refuse a linkage that cannot turn, bodies that do not fit, and a film without theory."""
        # Grashof: the crank turns if it is the shortest link and the frame is long enough
        turns = self.crank < self.coupler
        if self.mechanism != "slider-crank":
            turns = turns and self.crank < self.rocker
            turns = turns and self.crank + self.ground < self.coupler + self.rocker
        if not turns:
            raise ModelError(
                "The crank of the virtual rig cannot turn (Grashof): make it the shortest of four "
                "links, or shorter than the rod of a slider-crank."
            )
        if not 0 < self.pin_radius < self.bushing_radius:
            raise ModelError(
                "The pin radius must be smaller than the bushing radius. Correct one of them."
            )
        if not 0 <= self.wedge[0] < self.wedge[1]:
            raise ModelError(
                f"The wedge must rise from a film of 0 um or more, got {self.wedge}. Choose other "
                "ends."
            )
        held = self.sideways
        if held not in SIDEWAYS and (isinstance(held, str) or held <= 0):
            raise ModelError(
                f"Expected sideways of the virtual rig as {', '.join(SIDEWAYS)} or a stiffness "
                f"above 0 in N/m; got {held!r}. Choose one of them."
            )

        # the film of theory is that of a journal bearing whose pin and bushing are parallel
        if self.film == "reynolds" and (
            self.mechanism != "crank-rocker"
            or self.film_table is not None
            or self.tilt != 0
            or self.contact != "pin"
        ):
            raise ModelError(
                "Expected the film reynolds, that of a journal bearing, with the mechanism "
                "crank-rocker, without film_table, with the contact pin and a tilt of 0; got "
                f"{self.mechanism!r} and a tilt of {self.tilt:g} um. Choose another film, or leave "
                "them out."
            )
        thickness, modulus, poisson = self.liner
        if (self.rough or thickness) and self.film != "reynolds":
            raise ModelError(
                "Expected liner and rough of the virtual rig with the film reynolds, that of a "
                f"pressure; got {self.film!r}. Choose it, or leave them out."
            )
        if thickness and not (modulus > 0 and poisson < 0.5):
            raise ModelError(
                "Expected a liner of the virtual rig with a modulus above 0 and Poisson's ratio "
                f"below 0.5; got {modulus:g} GPa and {poisson:g}. Correct them."
            )
        if self.profile is not None and (self.lobes or self.edge[0] or len(self.profile) < 2):
            raise ModelError(
                "Expected a profile of the virtual rig with two or more depths, without lobes and "
                "edges, which it has already. Leave one of them out."
            )

    @property
    def linked(self) -> bool:
        """Whether a linkage with a crank moves the joint."""
        return self.mechanism in ("crank-rocker", "slider-crank")

    @property
    def pitch(self) -> float:
        """Pixel pitch of camera 1 in the object plane. [mm]"""
        return self.field_width / self.width

    @property
    def journal_radius(self) -> float:
        """Geometric mean of both radii. [mm]"""
        return math.sqrt(self.pin_radius * self.bushing_radius)

    @property
    def clearance(self) -> float:
        """Difference of the radii. [um]"""
        return 1e3 * (self.bushing_radius - self.pin_radius)

    @property
    def shaped(self) -> bool:
        """Whether the bore is not straight along its axis."""
        return bool(self.lobes) or self.edge[0] > 0 or self.profile is not None

    @property
    def region(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """Region of interest of the run, (x, x) and (y, y), clear of the edges. [mm]"""
        # 4 to 15 mm of 19.2 mm, and 2 to 13 mm of 15.36 mm, in the reference picture
        field_height = self.height * self.pitch
        x = tuple(round(self.field_width * share, 2) for share in (4 / 19.2, 15 / 19.2))
        y = tuple(round(field_height * share, 2) for share in (2 / 15.36, 13 / 15.36))
        return (x[0], x[1]), (y[0], y[1])

    @property
    def patch(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """Patch of the reference film, (x, x) and (y, y), left of the region of interest. [mm]"""
        field_height = self.height * self.pitch
        left, right = 0.06 * self.field_width, 0.18 * self.field_width
        return (left, right), (0.35 * field_height, 0.65 * field_height)

    @property
    def centre(self) -> tuple[float, float]:
        """Middle (x, y) of the picture. [pixel]"""
        return (self.width - 1) / 2, (self.height - 1) / 2

    @property
    def half_diagonal(self) -> float:
        """Distance from the middle of the picture to a corner. [pixel]"""
        return math.hypot(*self.centre)


# Smallest and largest value of the settings that are limited, in their units.
LIMITS: Mapping[str, tuple[float, float]] = {
    one.name: one.metadata["limits"] for one in fields(RigSettings) if "limits" in one.metadata
}
# Settings that are one of several words.
CHOICES: Mapping[str, Sequence[str]] = {
    one.name: one.metadata["words"] for one in fields(RigSettings) if "words" in one.metadata
}


def read_rig_settings(path: Path) -> dict[str, Any]:
    """Read settings of the rig from a TOML file.

    Parameters
    ----------
    path : Path
        Keys are fields of `RigSettings`; lists stand for its tuples.

    Returns
    -------
    dict
        Values by field.

    Raises
    ------
    ModelError
        If the file cannot be read as TOML, or has a key that the rig does not know.
    """
    try:
        table = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise ModelError(
            f"Expected settings of the virtual rig as TOML in {path}; {error}. Correct the file."
        ) from error

    known = {one.name: one.default for one in fields(RigSettings)}
    settings: dict[str, Any] = {}
    for name, value in table.items():
        default = known.get(name)
        size = len(default) if isinstance(default, tuple) else 0
        stated = len(value) if isinstance(value, list) else 0
        if name not in known or (stated != size and name not in _LISTS):
            raise ModelError(
                "Expected settings of the virtual rig, with as many numbers as docs/simulator.md "
                f"shows; {path} has {name} = {value}. Correct it."
            )
        settings[name] = tuple(value) if stated else value
    return settings
