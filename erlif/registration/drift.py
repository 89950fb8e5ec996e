"""The translation of one frame against the fixed map: fast, for every frame of a run."""

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from erlif.core.errors import RegistrationError
from erlif.registration.camera_map import CameraMap
from erlif.registration.matching import BX, BY, GXX, GXY, GYY, SUMS, cell_sums, correlation, move_sums, solve_shift
from erlif.registration.pairs import Pair, laid_over, make_pair, textures

Array = NDArray[Any]

STEP: Final = 16
LEAST_QUALITY: Final = 6.0
"""Least correlation of the textures over its own standard error for a drift to be believed."""


@dataclass(frozen=True)
class Drift:
    """Translation of camera 2 in one frame, to be added to the fixed map."""

    dx: float
    """[px]"""
    dy: float
    """[px]"""
    std_dx: float
    """Standard deviation of dx. [px]"""
    std_dy: float
    """Standard deviation of dy. [px]"""
    quality: float
    """Correlation coefficient of the two textures after alignment. [1]"""


def estimate_drift(
    camera_map: CameraMap,
    reference: Array,
    moving: Array,
    *,
    weight_reference: Array | None = None,
    weight_moving: Array | None = None,
    threads: int = 1,
) -> Drift:
    """Measure by how much camera 2 has moved in this frame against a map made before.

    Parameters
    ----------
    camera_map : CameraMap
        The fixed map, whose orientation is applied to ``moving``.
    reference, moving : array, (y, x)
        Camera 1 and camera 2, counts above the dark level.
    weight_reference, weight_moving : array, (y, x), optional
        0 for pixels that must not count.
    threads : int
        Threads to use.

    Raises
    ------
    RegistrationError
        If the frame does not fit the map: another size, or no common texture where the map says it should be.
    """
    pair = make_pair(reference, moving, weight_reference, weight_moving, camera_map.settings)
    if pair.reference.shape != camera_map.shape:
        raise RegistrationError(
            f"The camera map was made for frames of {camera_map.shape}, this frame has {pair.reference.shape}; "
            "register the cameras again for this region of interest."
        )
    return follow_drift(camera_map.displacement_x, camera_map.displacement_y, pair, threads=threads)


def follow_drift(displacement_x: Array, displacement_y: Array, pair: Pair, *, threads: int = 1) -> Drift:
    """The same for a checked pair and a dense displacement (NaN where it is not known). [px]

    Binned images bring the drift within a fraction of a pixel, one step at full resolution does the rest.
    """
    shift = np.zeros(2)
    sums = np.zeros((1, 1, SUMS))
    for binning, passes in ((4, 4), (1, 1)) if min(pair.reference.shape) >= 256 else ((2, 4), (1, 2)):
        views = textures(pair, binning, threads)
        spline = views.spline(threads)
        dx, dy = _thinned(displacement_x, binning), _thinned(displacement_y, binning)
        for _ in range(passes):
            here = (float(shift[0]) / binning, float(shift[1]) / binning)
            sums = cell_sums(views.a, views.weight, laid_over(spline, dx, dy, here, threads), STEP, threads=threads)
            shift = shift + binning * np.array(solve_shift(sums))
    std_dx, std_dy = _spread(move_sums(sums, *solve_shift(sums)))
    return Drift(float(shift[0]), float(shift[1]), std_dx, std_dy, correlation(sums))


def _thinned(field: Array, binning: int) -> Array:
    """The displacement at the centres of the binned pixels, in binned pixels."""
    if binning == 1:
        return field
    h, w = field.shape[0] // binning, field.shape[1] // binning
    low, high = binning // 2 - 1, binning // 2
    parts = [field[j::binning, i::binning][:h, :w] for j in (low, high) for i in (low, high)]
    return np.asarray(sum(parts) * np.float32(0.25 / binning), np.float32)


def _spread(sums: Array) -> tuple[float, float]:
    """Standard deviations of the shift from the scatter of the cell scores."""
    gxx, gxy, gyy = (float(sums[..., k].sum()) for k in (GXX, GXY, GYY))
    matrix = np.array([[gxx, gxy], [gxy, gyy]])
    if not np.linalg.det(matrix) > 0:
        return float("nan"), float("nan")
    scores = np.stack([sums[..., BX].ravel(), sums[..., BY].ravel()])
    inverse = np.linalg.inv(matrix)
    covariance = inverse @ (scores @ scores.T) @ inverse
    return float(np.sqrt(covariance[0, 0])), float(np.sqrt(covariance[1, 1]))
