"""A displacement for each window: for distortion that is finer than any surface resolves.

Each pass lays camera 2 over camera 1 with the field so far and solves the Gauss-Newton equations in a Gaussian window
about each node (F. Scarano, Meas. Sci. Technol. 13 (2002) R1). Vectors
that do not fit their neighbours are replaced (J. Westerweel, F. Scarano, Exp. Fluids 39 (2005) 1096).
"""

from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy import ndimage

from erlif.core.arrays import AnyArray
from erlif.registration.matching import BX, BY, GXX, GXY, GYY

LARGEST_STEP: Final = 1.5
"""Longest correction of one pass. [px]"""
SCORE_NOISE: Final = 4.0
"""Variance of the score of a cell over its normal matrix times the residual variance: neighbouring pixels share noise
and texture. 2 to 5 on the scenes of the benchmark."""


def window_sigma(window: int, step: int) -> float:
    """Standard deviation, in cells, of the Gaussian window with the noise of a square one of side ``window``."""
    return window / (2 * float(np.sqrt(np.pi))) / step


def window_sums(cells: AnyArray, sigma: float) -> AnyArray:
    """Gaussian-weighted sums about each cell; nothing beyond the edges."""
    return np.asarray(
        ndimage.gaussian_filter(cells, (sigma, sigma, 0), mode="constant", truncate=3.5)
    )


def solve_windows(sums: AnyArray, sigma: float) -> tuple[AnyArray, AnyArray, AnyArray]:
    """Displacement (2, row, column) [px], inverse normal matrix (row, column, 2, 2), and where there is any."""
    total = window_sums(sums[..., : BY + 1], sigma)
    gxx, gxy, gyy, bx, by = (total[..., k] for k in (GXX, GXY, GYY, BX, BY))
    trace = gxx + gyy
    ridge = 1e-3 * float(np.median(trace[trace > 0])) if (trace > 0).any() else 1.0
    gxx, gyy = gxx + ridge, gyy + ridge
    det = gxx * gyy - gxy**2
    inverse = (
        np.stack([np.stack([gyy, -gxy], -1), np.stack([-gxy, gxx], -1)], -2) / det[..., None, None]
    )
    vector = np.stack([inverse[..., k, 0] * bx + inverse[..., k, 1] * by for k in range(2)])
    return vector, inverse, trace > 20 * ridge


def replace_outliers(field: AnyArray, sound: AnyArray) -> AnyArray:
    """Replace vectors that fail the normalised median test by the median of their neighbours.

    Neighbours two nodes away are compared: adjacent windows share most of their pixels.
    """
    rows, cols = sound.shape
    marked = np.where(sound, field, np.nan)
    padded = np.pad(marked, ((0, 0), (2, 2), (2, 2)), constant_values=np.nan)
    offsets = [(j, i) for j in (0, 2, 4) for i in (0, 2, 4) if (j, i) != (2, 2)]
    around = np.stack([padded[:, j : j + rows, i : i + cols] for j, i in offsets])
    some = np.isfinite(around).any(0)
    around[:, ~some] = 0
    middle = np.nanmedian(around, axis=0)
    scatter = np.nanmedian(np.abs(around - middle), axis=0)
    departure = np.abs(field - middle) / (scatter + 0.1)
    bad = (np.hypot(departure[0], departure[1]) > 3) | ~sound
    return np.where(bad, middle, field)


def smooth(field: AnyArray) -> AnyArray:
    """1-2-1 along both axes, edges repeated."""
    p = np.pad(field, ((0, 0), (1, 1), (1, 1)), mode="edge")
    p = p[:, :-2] + 2 * p[:, 1:-1] + p[:, 2:]
    return np.asarray((p[:, :, :-2] + 2 * p[:, :, 1:-1] + p[:, :, 2:]) / 16)


def to_pixels(
    nodes: AnyArray, positions_y: AnyArray, positions_x: AnyArray, shape: tuple[int, int]
) -> AnyArray:
    """Catmull-Rom interpolation from equidistant nodes (row, column) to all pixels; constant beyond them; float32."""

    def matrix(positions: AnyArray, size: int) -> AnyArray:
        n = len(positions)
        t = (np.arange(size) - positions[0]) / (positions[1] - positions[0])
        t = np.clip(t, 0, n - 1)
        i = np.minimum(t.astype(int), n - 2)
        u = t - i
        weights = (
            (-u + 2 * u**2 - u**3) / 2,
            (2 - 5 * u**2 + 3 * u**3) / 2,
            (u + 4 * u**2 - 3 * u**3) / 2,
            (-(u**2) + u**3) / 2,
        )
        m = np.zeros((size, n), np.float32)
        for k, weight in enumerate(weights):
            np.add.at(m, (np.arange(size), np.clip(i + k - 1, 0, n - 1)), weight.astype(np.float32))
        return m

    down, across = matrix(positions_y, shape[0]), matrix(positions_x, shape[1])
    return np.asarray(down @ nodes.astype(np.float32) @ np.ascontiguousarray(across.T))


@dataclass(frozen=True)
class Response:
    """What the passes together do to noise that is independent from cell to cell."""

    gain: float
    """Variance of a vector over that of a single pass."""
    kept: float
    """Part of the variance of the scores that is left when the field has taken what it can."""


def response(sigma: float, passes: int) -> Response:
    """Iterated deformation undoes the low-pass of the window and so lets more noise in: after a pass with window
    W(k) the field holds T + W (1 - T) of what is there, T before it; then the smoothing between passes."""
    k = 2 * np.pi * np.fft.fftfreq(64)
    ky, kx = k[:, None], k[None, :]
    window = np.exp(-0.5 * sigma**2 * (kx**2 + ky**2))
    binomial = (0.5 + 0.5 * np.cos(kx)) * (0.5 + 0.5 * np.cos(ky))
    held = np.zeros_like(window)
    for number in range(passes):
        held = held + window * (1 - held)
        if number < passes - 1:
            held = held * binomial
    # the scatter is taken from sums over 3 by 3 cells, of which the field has taken more than of single cells
    three = ((1 + 2 * np.cos(kx)) * (1 + 2 * np.cos(ky))) ** 2
    kept = ((1 - held) ** 2 * three).mean() / three.mean()
    return Response(float((held**2).mean() / (window**2).mean()), float(kept))


def window_std(sums: AnyArray, sigma: float, passes: int) -> AnyArray:
    """Standard deviation of one component (rms of the two) at each node, from the scatter of the cell scores.

    Parameters
    ----------
    sums : array, (row, column, 11)
        Cell sums where the field has converged.
    sigma : float
        Standard deviation of the window. [cells]
    passes : int
        Passes that made the field.

    Returns
    -------
    array, (row, column)
        [px]
    """
    _, inverse, sound = solve_windows(sums, sigma)
    scores = sums[..., [BX, BY]]
    # neighbouring cells share texture: the products of sums over 3 by 3 cells hold their covariances too
    near = ndimage.uniform_filter(scores, (3, 3, 1), mode="constant") * 3
    product = near[..., :, None] * near[..., None, :]
    rows, cols = sound.shape
    # the square of the Gaussian window is a Gaussian of 1/sqrt(2) its width and 1/(4 pi sigma^2) its height
    spread = window_sums(product.reshape(rows, cols, 4), sigma / float(np.sqrt(2))) / (
        4 * np.pi * sigma**2
    )
    covariance = inverse @ spread.reshape(rows, cols, 2, 2) @ inverse
    effect = response(sigma, passes)
    variance = 0.5 * np.trace(covariance, axis1=-2, axis2=-1) * effect.gain / effect.kept
    floor = np.median(variance[sound]) * 1e-3 if sound.any() else 0.0
    return np.where(sound, np.sqrt(np.maximum(variance, floor)), np.inf)


def still_off(sums: AnyArray, step: int, *, tolerance: float) -> AnyArray:
    """Cells whose surroundings of some 64 px still ask clearly for another displacement.

    Parameters
    ----------
    sums : array, (row, column, 11)
        Cell sums at the displacement to be judged, each over its residual variance.
    step : int
        Side of a cell. [px]
    tolerance : float
        A displacement shorter than this is let pass, however clear it is. [px]

    Returns
    -------
    array, (row, column), bool
    """
    sigma = window_sigma(64, step)
    ask, inverse, sound = solve_windows(sums, sigma)
    length = np.hypot(ask[0], ask[1])
    # not from the scatter of the scores, which what is missing has drawn to one side: from the residual variance
    variance = SCORE_NOISE * 0.5 * np.trace(inverse, axis1=-2, axis2=-1) / (4 * np.pi * sigma**2)
    return np.asarray(sound & (length > tolerance) & (length > 5 * np.sqrt(variance)))
