"""The virtual set-up: cameras, dyes and speckle of one laboratory, and one photograph of a film."""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np

from erlif.core.arrays import Array, Counts
from erlif.rig.camera import Camera, build_camera, displacement, expose, seen_from_camera_2
from erlif.rig.dyes import DyedOil, signals_of
from erlif.rig.film import Bubbles, Field
from erlif.rig.scene import Grains, beam, draw_grains, speckle
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
)

_LARGEST_SHAKE = 6  # standard deviations of the vibration that the lattice of grains allows for
_GRAIN_MARGIN = 8  # pixel: reach of the grains beyond the farthest object point


def random_stream(seed: int, name: str, number: int = 0) -> np.random.Generator:
    """Random numbers of one purpose and frame, independent of what was drawn before."""
    return np.random.default_rng(
        np.random.SeedSequence(seed, spawn_key=(STREAMS.index(name), number))
    )


@dataclass(frozen=True)
class Setup:
    """Everything that stays the same from frame to frame.

    Attributes
    ----------
    rig : RigSettings
        Settings of the rig.
    cameras : tuple[Camera, Camera]
        Sensors of camera 1 and 2.
    signals : tuple[Callable[[Array], Array], Callable[[Array], Array]]
        Light of a film [um] behind the filter of each camera, relative to a very thick film.
    grains : Grains
        Speckle that all pulses share.
    x : Array
        Columns of the pixel centres, (y, x). [pixel]
    y : Array
        Rows of the pixel centres, (y, x). [pixel]
    typical : tuple[float, float]
        Light of each camera that its background is a share of. [electron]
    """

    rig: RigSettings
    cameras: tuple[Camera, Camera]
    signals: tuple[Callable[[Array], Array], Callable[[Array], Array]]
    grains: Grains
    x: Array
    y: Array
    typical: tuple[float, float] = (0.0, 0.0)

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

        Transmission of the lens, speckle and pulse energy are not included.
        """
        scale = self.rig.light * self.rig.thick_film_signal[number - 1]
        return np.asarray(scale * beam(x, y, self.rig) * self.signals[number - 1](film))


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
