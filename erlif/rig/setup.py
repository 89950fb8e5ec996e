"""The virtual set-up: cameras, dyes and speckle of one laboratory, and one photograph of a film.

Its light is beam and laser speckle, as functions of continuous coordinates.

No rendered picture is resampled: the light at any object point of a camera is exact.
"""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace

import numpy as np

from erlif.core.arrays import Array, Counts
from erlif.core.speed.kernels import njit
from erlif.rig.camera import Camera, build_camera, displacement, expose, seen_from_camera_2
from erlif.rig.dyes import DyedOil, Signals, signals_of
from erlif.rig.film import BARE_FILM, Bubbles, Field
from erlif.rig.settings import RigSettings

# Purposes with random numbers of their own. A new one is appended, so that the old ones keep
# theirs.
STREAMS = (
    "camera 1",
    "camera 2",
    "marks",
    "grains",
    "run",
    "fixture",
    "run frame",
    "fixture frame",
    "run pages",
    "fixture pages",
    "run background",
    "wall",
)

_LARGEST_SHAKE = 6  # standard deviations of the vibration that the lattice of grains allows for
_GRAIN_MARGIN = 8  # pixel: reach of the grains beyond the farthest object point


def random_stream(seed: int, name: str, number: int = 0) -> np.random.Generator:
    """Random numbers of one purpose and frame, independent of what was drawn before."""
    return np.random.default_rng(
        np.random.SeedSequence(seed, spawn_key=(STREAMS.index(name), number))
    )


_BEAM_AXIS = (0.04, -0.03)  # of width and height: offset of the beam from the middle
_REACH = 4.5  # standard deviations; beyond them a grain adds less than 1e-4 of its brightness
_WAVES = 128  # of which the texture of a wall is the sum
_TABLE = 4096  # steps of the squared distance in a table of the Gaussian, good to 1e-6


def beam(x: Array, y: Array, rig: RigSettings) -> Array:
    """Gaussian beam: 1 on its axis beside the middle, `beam_corner` half a diagonal away.

    An iris about the middle of the field cuts it.
    """
    from_axis_x = x - rig.centre[0] - _BEAM_AXIS[0] * rig.width
    from_axis_y = y - rig.centre[1] - _BEAM_AXIS[1] * rig.height
    light = rig.beam_corner ** ((from_axis_x**2 + from_axis_y**2) / rig.half_diagonal**2)
    if rig.iris == 0:
        return np.asarray(light)
    distance = np.hypot(x - rig.centre[0], y - rig.centre[1])
    return np.where(distance < rig.iris * rig.half_diagonal, light, 0.0)


@dataclass(frozen=True)
class Grains:
    """Positions and brightness of the speckle grains in one pulse.

    One grain lies at random in each cell of a unit lattice, so the field has no preferred
    position or direction.

    Attributes
    ----------
    x : Array
        Column of each grain, (row, column) of the lattice. [pixel]
    y : Array
        Row of each grain, (row, column) of the lattice. [pixel]
    brightness : Array
        Brightness of each grain about zero, (row, column) of the lattice. [1]
    margin : int
        Cells of the lattice beyond the picture. [pixel]
    """

    x: Array
    y: Array
    brightness: Array
    margin: int


def draw_grains(rig: RigSettings, margin: int, rng: np.random.Generator) -> Grains:
    """Draw the grains of the speckle that all pulses share; brightness has variance 1."""
    shape = (rig.height + 2 * margin, rig.width + 2 * margin)
    rows, columns = np.indices(shape) - margin
    x = columns + rng.uniform(-0.5, 0.5, shape)
    y = rows + rng.uniform(-0.5, 0.5, shape)
    return Grains(x, y, rng.standard_normal(shape), margin)


def mix_grains(fixed: Grains, rig: RigSettings, rng: np.random.Generator) -> Grains:
    """Return the grains of one pulse: shared and new brightness, each with its contrast."""
    new = rng.standard_normal(fixed.brightness.shape)
    brightness = rig.speckle_fixed * fixed.brightness + rig.speckle_new * new
    return Grains(fixed.x, fixed.y, brightness, fixed.margin)


def speckle(x: Array, y: Array, grains: Grains, *, size: float, blur: float) -> Array:
    """Relative brightness of the laser light at object points, seen with a Gaussian point spread.

    It is a sum of Gaussian grains of standard deviation `size`. In a camera of point spread `blur`
    each is wider and lower, exactly ``size^2/s^2 exp(-r^2/(2 s^2))`` with
    ``s^2 = size^2 + blur^2``. The division by ``sqrt(pi) size`` makes the contrast in the object
    plane that of the grains' brightness.
    """
    seen = np.hypot(size, blur)
    scale = size**2 / seen**2 / (np.sqrt(np.pi) * size)
    return np.asarray(
        1 + scale * _sum_grains(x, y, grains.x, grains.y, grains.brightness, grains.margin, seen)
    )


@njit(cache=True, nogil=True)
def _sum_grains(
    x: Array, y: Array, grain_x: Array, grain_y: Array, bright: Array, margin: int, seen: float
) -> Array:
    """Sum of the grains at each point, those within reach only."""
    reach = _REACH * seen
    per_square = _TABLE / reach**2
    table = np.exp(-np.arange(_TABLE + 1) / (2 * seen**2 * per_square))

    total = np.empty(x.shape)
    for j in range(x.shape[0]):
        for i in range(x.shape[1]):
            px, py = x[j, i], y[j, i]
            top = max(0, int(np.ceil(py - reach - 0.5)) + margin)
            bottom = min(bright.shape[0] - 1, int(np.floor(py + reach + 0.5)) + margin)
            left = max(0, int(np.ceil(px - reach - 0.5)) + margin)
            right = min(bright.shape[1] - 1, int(np.floor(px + reach + 0.5)) + margin)

            light = 0.0
            for row in range(top, bottom + 1):
                for column in range(left, right + 1):
                    off_x, off_y = px - grain_x[row, column], py - grain_y[row, column]
                    place = per_square * (off_x * off_x + off_y * off_y)
                    if place < _TABLE:
                        k = int(place)
                        light += bright[row, column] * (
                            table[k] + (place - k) * (table[k + 1] - table[k])
                        )
            total[j, i] = light
    return total


@dataclass(frozen=True)
class Texture:
    """A wall whose reflectance varies over the picture.

    Attributes
    ----------
    waves : Array
        Cosines of which it is the sum: wave vector along x and y [1/pixel], phase [rad], (wave, 3).
    share : float
        Standard deviation of the reflectance, relative to its mean. [1]
    signals : tuple[Signals, ...]
        As those of a set-up, before a black wall, the mean one, and one of twice its reflectance;
        empty before the even wall of the fixture.
    """

    waves: Array
    share: float
    signals: tuple[Signals, ...] = ()

    def light(self, number: int, film: Array, x: Array, y: Array) -> Array:
        """Light of a film in camera `number`, relative to a very thick film.

        It is a parabola of the reflectance.
        """
        total = sum(np.cos(along * x + down * y + phase) for along, down, phase in self.waves)
        over_mean = np.maximum(1 + self.share * np.sqrt(2 / _WAVES) * total, 0.0)
        black, mean, twice = (each[number - 1](film) for each in self.signals)
        bend = (black + twice) / 2 - mean
        return np.asarray(black + over_mean * (mean - black + bend * (over_mean - 1)))


def draw_texture(rig: RigSettings, rng: np.random.Generator) -> Texture | None:
    """Draw the wall of the joint; None where it is even."""
    share, size = rig.wall_texture
    std = np.sqrt(2) * rig.field_width / rig.width / size
    vectors, phases = rng.normal(0, std, (_WAVES, 2)), rng.uniform(0, 2 * np.pi, (_WAVES, 1))
    return Texture(np.hstack([vectors, phases]), share) if share else None


@dataclass(frozen=True)
class Setup:
    """Properties of the rig that are the same in all frames.

    Attributes
    ----------
    rig : RigSettings
        Settings of the rig.
    cameras : tuple[Camera, Camera]
        Sensors of camera 1 and 2.
    signals : Signals
        Light of a film [um] behind the filter of each camera, relative to a very thick film.
    grains : Grains
        Speckle that all pulses share.
    x : Array
        Columns of the pixel centres, (y, x). [pixel]
    y : Array
        Rows of the pixel centres, (y, x). [pixel]
    typical : tuple[float, float]
        Light of each camera that its background is a share of. [electron]
    texture : Texture | None
        Wall of the joint in place of an even one.
    roughness : float
        Of both walls together, rms, finer than a pixel. [um]
    """

    rig: RigSettings
    cameras: tuple[Camera, Camera]
    signals: Signals
    grains: Grains
    x: Array
    y: Array
    typical: tuple[float, float] = (0.0, 0.0)
    texture: Texture | None = None
    roughness: float = 0.0

    def background(self, number: int, x: Array, y: Array) -> Array | float:
        """Electrons in camera `number` that do not come from the film, at object points (x, y).

        Transmission of the lens and pulse energy are not included.
        """
        rig, typical = self.rig, self.typical[number - 1]
        if number == 2:
            typical *= rig.background_second
        even = rig.background * typical
        if rig.background_beam == 0:
            return even
        return np.asarray(even + rig.background_beam * typical * beam(x, y, rig))

    def light(self, number: int, film: Array, x: Array, y: Array) -> Array:
        """Electrons in camera `number` from the film at object points (x, y).

        Transmission of the lens, speckle and pulse energy are not included. Over rough walls it is
        the mean of normal heights, by three points of Gauss and Hermite.
        """
        if self.roughness:
            smooth, off = replace(self, roughness=0.0), np.sqrt(3) * self.roughness
            three = ((film + off, 1 / 6), (film, 2 / 3), (np.maximum(film - off, BARE_FILM), 1 / 6))
            return np.asarray(sum(share * smooth.light(number, at, x, y) for at, share in three))
        scale = self.rig.light * self.rig.thick_film_signal[number - 1]
        if self.texture is not None and self.texture.signals:
            of_film = self.texture.light(number, film, x, y)
        else:
            of_film = self.signals[number - 1](film)
        return np.asarray(scale * beam(x, y, self.rig) * of_film)


def build_setup(seed: int, rig: RigSettings) -> Setup:
    """Draw the cameras and the fixed speckle of one laboratory."""
    y, x = np.indices((rig.height, rig.width), dtype=np.float64)
    farthest = (
        np.abs(np.stack(displacement(x, y, rig))).max()
        + np.abs(rig.fixture_offset).max()
        + _LARGEST_SHAKE * rig.vibration
    )
    margin = int(np.ceil(farthest)) + _GRAIN_MARGIN
    return Setup(
        rig=rig,
        cameras=(
            build_camera(1, rig, random_stream(seed, "camera 1")),
            build_camera(2, rig, random_stream(seed, "camera 2")),
        ),
        signals=signals_of(rig.dyes, DyedOil(reflectance=rig.wall[0])),
        grains=draw_grains(rig, margin, random_stream(seed, "grains")),
        x=x,
        y=y,
        texture=draw_texture(rig, random_stream(seed, "wall")),
    )


@dataclass(frozen=True)
class Shot:
    """The state of the rig at one laser pulse.

    Attributes
    ----------
    film : Field
        Film thickness at object points. [um]
    bubbles : Bubbles
        Bubbles in the film.
    grains : Grains
        Speckle of the pulse.
    energy : float
        Relative pulse energy. [1]
    drift : tuple[float, float]
        Extra shift (x, y) of camera 2. [pixel]
    """

    film: Field
    bubbles: Bubbles
    grains: Grains
    energy: float
    drift: tuple[float, float]


def photograph(
    setup: Setup, shot: Shot, rng: np.random.Generator, *, last: list[Array | None] | None = None
) -> tuple[Counts, Counts]:
    """Return the frames of camera 1 and 2: one pulse and object, two filters and viewpoints.

    Speckle passes the point spread of each camera. The film is smooth on that scale and is not
    blurred. `last` holds the light of the frame before for cameras that lag, and receives that of
    this one. [electron]
    """
    rig = setup.rig

    def expose_camera(number: int, rng: np.random.Generator) -> Counts:
        x, y = setup.x, setup.y
        if number == 2:
            x, y = seen_from_camera_2(x, y, shot.drift, rig)
        film = shot.bubbles.empty(shot.film(x, y), x, y)
        pattern = speckle(x, y, shot.grains, size=rig.speckle_size, blur=rig.blur[number - 1])
        of_film = np.maximum(pattern, 0) * setup.light(number, film, x, y)
        light = shot.energy * of_film + shot.energy * setup.background(number, x, y)
        light = light + rig.glare * light.mean() if rig.glare else light
        if last is not None:
            before, last[number - 1] = last[number - 1], light
            light = light if before is None else light + rig.lag[number - 1] * before
        return expose(light, setup.cameras[number - 1], rng)

    # each camera has random numbers of its own, so the order of the threads does not matter
    with ThreadPoolExecutor(2) as pool:
        first, second = pool.map(expose_camera, (1, 2), rng.spawn(2))
    return first, second
