"""The light on the object: beam and laser speckle, as functions of continuous coordinates.

No rendered picture is resampled: the light at any object point of a camera is exact.
"""

from dataclasses import dataclass

import numpy as np
from numba import njit

from erlif.core.arrays import Array
from erlif.rig.settings import RigSettings

_BEAM_AXIS = (0.04, -0.03)  # of width and height: offset of the beam from the middle
_REACH = 4.5  # standard deviations; beyond them a grain adds less than 1e-4 of its brightness
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
