"""Settings of the virtual rig: every quantity that can be chosen, with unit and default."""

import math
from dataclasses import dataclass

from erlif.core.errors import ModelError

SMALLEST_PICTURE = 32
"""Fewest rows and columns. [pixel]"""
LARGEST_SPACING = 10.0
"""Largest trigger spacing; the rocker turns by 24 degrees. [degree]"""
LARGEST_SCALE = 0.2
"""Largest difference of the magnification of the cameras. [1]"""
LARGEST_ROTATION = 10.0
"""Largest rotation of camera 2. [degree]"""
LARGEST_DISTORTION = 10.0
"""Largest distortion of camera 2. [pixel]"""


@dataclass(frozen=True)
class RigSettings:
    """Settings of the virtual rig; the defaults follow the pin-joint rig of the thesis.

    Lengths in the picture are pixels of camera 1, so that the texture suits the sensor whatever
    the magnification.
    """

    # picture
    width: int = 320
    """Columns of both cameras. [pixel]"""
    height: int = 256
    """Rows of both cameras. [pixel]"""
    field_width: float = 19.2
    """Width of the field of camera 1 in the object plane; the pixel pitch follows from it. [mm]"""

    # linkage and encoder
    crank: float = 5.5
    """Length of the crank. [cm]"""
    coupler: float = 44.0
    """Length of the coupler. [cm]"""
    rocker: float = 26.0
    """Length of the rocker. [cm]"""
    ground: float = 51.0
    """Distance of the fixed pivots. [cm]"""
    crank_speed: float = 114.0
    """Speed of the crank. [rpm]"""
    spacing: float = 0.96
    """Rocker rotation from one encoder trigger to the next. [degree]"""
    cycles: int = 1
    """Turns of the crank that are photographed."""
    write_zero: bool = True
    """Write the rocker angle at encoder reading 0 into run.toml."""

    # joint
    pin_radius: float = 33.36
    """Radius of the pin. [mm]"""
    bushing_radius: float = 33.59
    """Radius of the bushing. [mm]"""
    load: float = 222.411
    """Mean load, 50 lbf. [N]"""
    load_swing: float = 0.01
    """Relative amplitude with which the load follows the crank."""

    # film
    film_reference: float = 6.0
    """Minimum film thickness at the highest rocker speed and the mean load. [um]"""
    exponent: float = 0.62
    """Exponent of speed over load in the film law."""
    film_floor: float = 0.3
    """Minimum film thickness that squeeze maintains where the rocker stands still. [um]"""
    film_table: tuple[float, ...] | None = None
    """Minimum film thickness at each trigger of one cycle, in place of the law. [um]"""
    thin_line: float = 0.8
    """Position of the thinnest film along x, from the middle of the field. [mm]"""
    tilt: float = 0.2
    """Rise of the film over the height of the field. [um]"""
    marks: float = 0.07
    """Standard deviation of the turning marks; scratches are four times as deep. [um]"""
    bubbles: int = 6
    """Largest number of bubbles in a frame of 320 x 256 pixels; smaller pictures hold fewer."""

    # light
    light: float = 1.0
    """Exposure: 1 keeps the brightest speckle near 3000 DN."""
    beam_corner: float = 0.5
    """Brightness of the laser beam at the corners of the field, relative to its axis."""
    pulse_jitter: float = 0.03
    """Relative standard deviation of the pulse energy."""
    speckle_fixed: float = 0.08
    """Contrast in the object plane of the speckle that is the same in every pulse."""
    speckle_new: float = 0.08
    """Contrast in the object plane of the speckle that is new with every pulse."""
    speckle_size: float = 0.72
    """Standard deviation of one grain; the field is correlated over twice this (1/e). [pixel]"""

    # cameras, first and second
    blur: tuple[float, float] = (0.50, 0.55)
    """Standard deviation of the point spread, lens and pixel together. [pixel]"""
    thick_film_signal: tuple[float, float] = (11000.0, 11500.0)
    """Photo-electrons of a very thick film on the beam axis. [electron]"""
    vignetting: tuple[float, float] = (0.84, 0.87)
    """Transmission of the lens at the corners relative to the centre."""
    gain: float = 4.4
    """Electrons of one count. [electron/DN]"""
    read_noise: float = 9.0
    """Standard deviation of the read noise. [electron]"""
    offset: float = 64.0
    """Mean dark level. [DN]"""
    column_pattern: float = 2.0
    """Standard deviation of the dark level from column to column. [DN]"""
    response_spread: float = 0.01
    """Relative standard deviation of the pixel response."""
    hot_fraction: float = 5e-4
    """Share of the pixels with 500 to 3000 electrons of dark signal."""
    dead_pixels: int = 3
    """Pixels of each camera without response to light."""
    dust: int = 4
    """Dust specks on each sensor window."""

    # from camera 1 to camera 2
    shift: tuple[float, float] = (4.0, -3.0)
    """Displacement (x, y) at the middle of the picture. [pixel]"""
    scale: tuple[float, float] = (1.004, 0.997)
    """Magnification (x, y) of camera 2 over camera 1."""
    rotation: float = 0.4
    """Rotation of camera 2 about the middle of the picture. [degree]"""
    distortion: float = 0.5
    """Quadratic distortion near the corners. [pixel]"""
    vibration: float = 0.3
    """Standard deviation per axis of the extra shift of camera 2 in each frame. [pixel]"""

    # calibration fixture
    fixture_frames: int = 12
    """Frame pairs of the wedge."""
    wedge: tuple[float, float] = (0.1, 18.0)
    """Film at the first and the last column. [um]"""
    wedge_form: float = 0.1
    """Amplitude of the smooth departure of the wedge from a plane. [um]"""
    cmm_noise: float = 0.15
    """Standard deviation of one reading of the coordinate-measuring machine. [um]"""
    fixture_offset: tuple[float, float] = (0.6, -0.4)
    """Shift (x, y) of camera 2 between the fixture's session and the run. [pixel]"""

    # reference pages
    dark_pages: int = 8
    """Pages of the dark file."""
    flat_pages: int = 4
    """Pages of the flat file at each level of the lamp."""
    flat_levels: tuple[float, ...] = (0.25, 0.5, 0.8)
    """Brightest flat signal at each level of the lamp, of full scale."""

    def __post_init__(self) -> None:
        self._check_picture()
        self._check_motion()
        self._check_optics()

    def _check_picture(self) -> None:
        """Refuse a picture or a session that is too small."""
        if min(self.width, self.height) < SMALLEST_PICTURE:
            raise ModelError(
                f"The virtual cameras need at least {SMALLEST_PICTURE} x {SMALLEST_PICTURE} "
                f"pixels, got {self.width} x {self.height}."
            )
        pages = (self.fixture_frames, self.dark_pages, self.flat_pages, len(self.flat_levels))
        if min(self.cycles, *pages) < 1:
            raise ModelError(
                "The virtual rig needs at least one cycle, fixture frame, dark page, flat page "
                "and level."
            )

    def _check_motion(self) -> None:
        """Refuse a linkage that cannot turn and a joint that does not fit."""
        if not 0 < self.spacing <= LARGEST_SPACING:
            raise ModelError(
                f"The trigger spacing must lie above 0 and at most at {LARGEST_SPACING:g} degrees, "
                f"got {self.spacing:g}."
            )
        # Grashof: the crank turns if it is the shortest link and the frame is long enough
        if self.crank + self.ground >= self.coupler + self.rocker or self.crank >= min(
            self.coupler, self.rocker
        ):
            raise ModelError(
                "The crank of the virtual rig cannot turn (Grashof): make it the shortest of four "
                "links."
            )
        if not 0 < self.pin_radius < self.bushing_radius:
            raise ModelError("The pin radius must be smaller than the bushing radius.")

    def _check_optics(self) -> None:
        """Refuse light, film and displacement outside the range of the simulation."""
        if self.light <= 0 or self.gain <= 0 or self.film_floor <= 0 or self.film_reference <= 0:
            raise ModelError(
                "light, gain, film_reference and film_floor of the virtual rig must be above zero."
            )
        # beyond these the search for the object points of camera 2 may not converge
        if (
            max(abs(scale - 1) for scale in self.scale) > LARGEST_SCALE
            or abs(self.rotation) > LARGEST_ROTATION
            or abs(self.distortion) > LARGEST_DISTORTION
        ):
            raise ModelError(
                f"Camera 2 may differ by at most {LARGEST_SCALE:g} in scale, "
                f"{LARGEST_ROTATION:g} degrees in rotation and {LARGEST_DISTORTION:g} px in "
                "distortion."
            )
        if not 0 <= self.wedge[0] < self.wedge[1]:
            raise ModelError(f"The wedge must rise from a film of 0 um or more, got {self.wedge}.")

    @property
    def pitch(self) -> float:
        """Pixel pitch of camera 1 in the object plane. [mm]"""
        return self.field_width / self.width

    @property
    def relative_radius(self) -> float:
        """R = R1 R2 / (R1 - R2) of a pin in a bushing. [mm]"""
        return self.bushing_radius * self.pin_radius / (self.bushing_radius - self.pin_radius)

    @property
    def region(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """Region of interest of the run, (x, x) and (y, y), clear of the edges. [mm]"""
        # 4 to 15 mm of 19.2 mm, and 2 to 13 mm of 15.36 mm, in the reference picture
        field_height = self.height * self.pitch
        x = tuple(round(self.field_width * share, 2) for share in (4 / 19.2, 15 / 19.2))
        y = tuple(round(field_height * share, 2) for share in (2 / 15.36, 13 / 15.36))
        return (x[0], x[1]), (y[0], y[1])

    @property
    def centre(self) -> tuple[float, float]:
        """Middle (x, y) of the picture. [pixel]"""
        return (self.width - 1) / 2, (self.height - 1) / 2

    @property
    def half_diagonal(self) -> float:
        """Distance from the middle of the picture to a corner. [pixel]"""
        return math.hypot(*self.centre)
