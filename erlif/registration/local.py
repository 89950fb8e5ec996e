"""A displacement for each window: for distortion that is finer than any surface resolves.

Each pass aligns camera 2 with the field so far and solves the Gauss-Newton equations in a Gaussian
window about each node (Scarano 2002). Vectors that do not fit their neighbours are replaced
(Westerweel and Scarano 2005).
"""

from typing import Final, NamedTuple

import numpy as np
from scipy import ndimage

from erlif.core.arrays import Array, Image, Mask
from erlif.registration.matching import SCORES, SYSTEM, system_of

# Longest correction of one pass. [px]
LARGEST_STEP: Final = 1.5
# Variance of the score of a cell over its normal matrix times the residual variance: neighbouring
# pixels share noise and texture. 2 to 5 on the scenes of the benchmark.
SCORE_NOISE: Final = 4.0
# The Gaussian windows end at this many standard deviations.
TRUNCATE: Final = 3.5
# Ridge of a window in parts of the median information, for windows of texture in one direction.
WINDOW_RIDGE: Final = 1e-3
# A window has too little texture if its information is below this many ridges: a fiftieth of the
# median.
FAINT: Final = 20.0
# Departure from the neighbours' median that makes a vector an outlier, in their median scatter.
OUTLIER: Final = 3.0
# Added to the scatter of the neighbours, the noise of correlation. [px]
MEDIAN_FLOOR: Final = 0.1
# No variance is taken to be below this part of the median variance.
STD_FLOOR: Final = 1e-3
# Side of the surroundings in which a remaining displacement is judged. [px]
JUDGED_WINDOW: Final = 64
# Standard deviations that a remaining displacement must have to be taken as one.
CLEAR: Final = 5.0


def window_sigma(window: int, step: int) -> float:
    """Standard deviation of the Gaussian window with the noise of a square one. [cells]

    A Gaussian of standard deviation s averages over the area 4 pi s^2, a square over its side^2;
    ``window`` and ``step``, the side of a cell, are in px.
    """
    return window / (2 * float(np.sqrt(np.pi))) / step


def window_sums(cells: Array, sigma: float) -> Array:
    """Gaussian-weighted sums about each cell; nothing beyond the edges."""
    return np.asarray(
        ndimage.gaussian_filter(cells, (sigma, sigma, 0), mode="constant", truncate=TRUNCATE)
    )


class Windows(NamedTuple):
    """Solution of the Gauss-Newton equations in a window about each cell.

    Attributes
    ----------
    vector : Array
        (component, row, column): remaining displacement; component 0 is x. [px]
    inverse : Array
        (row, column, 2, 2): inverse of the normal matrix. [px^2]
    sound : Mask
        (row, column): True where the window has texture enough.
    """

    vector: Array
    inverse: Array
    sound: Mask


def solve_windows(sums: Array, sigma: float) -> Windows:
    """Solve for the displacement that each Gaussian window still needs.

    Parameters
    ----------
    sums : array, (row, column, 11)
        Cell sums, see `erlif.registration.matching.SUMS`.
    sigma : float
        Standard deviation of the window. [cells]

    Returns
    -------
    Windows
        Displacement, inverse normal matrix and validity of each window.
    """
    gxx, gxy, gyy, bx, by = system_of(window_sums(sums[..., SYSTEM], sigma))
    trace = gxx + gyy
    ridge = WINDOW_RIDGE * float(np.median(trace[trace > 0])) if (trace > 0).any() else 1.0

    gxx, gyy = gxx + ridge, gyy + ridge
    det = gxx * gyy - gxy**2
    adjugate = np.stack([np.stack([gyy, -gxy], -1), np.stack([-gxy, gxx], -1)], -2)
    inverse = adjugate / det[..., None, None]
    vector = np.stack([inverse[..., k, 0] * bx + inverse[..., k, 1] * by for k in range(2)])
    return Windows(vector, inverse, trace > FAINT * ridge)


def replace_outliers(field: Array, sound: Mask) -> Array:
    """Replace vectors that fail the normalised median test by the median of their neighbours.

    Parameters
    ----------
    field : array, (component, row, column)
        Displacements. [px]
    sound : array, (row, column), bool
        False for vectors to replace in any case, which count for no neighbour either.

    Returns
    -------
    array, (component, row, column)
        The field with its outliers replaced. [px]
    """
    # adjacent windows share most of their pixels, so the neighbours are two nodes away
    rows, cols = sound.shape
    marked = np.where(sound, field, np.nan)
    padded = np.pad(marked, ((0, 0), (2, 2), (2, 2)), constant_values=np.nan)
    offsets = [(j, i) for j in (0, 2, 4) for i in (0, 2, 4) if (j, i) != (2, 2)]
    around = np.stack([padded[:, j : j + rows, i : i + cols] for j, i in offsets])

    # where no neighbour is sound, the displacement is taken as 0
    some = np.isfinite(around).any(0)
    around[:, ~some] = 0
    middle = np.nanmedian(around, axis=0)
    scatter = np.nanmedian(np.abs(around - middle), axis=0)
    departure = np.abs(field - middle) / (scatter + MEDIAN_FLOOR)
    bad = (np.hypot(departure[0], departure[1]) > OUTLIER) | ~sound
    return np.where(bad, middle, field)


def smooth(field: Array) -> Array:
    """Smooth by 1-2-1 along both axes, edges repeated."""
    p = np.pad(field, ((0, 0), (1, 1), (1, 1)), mode="edge")
    p = p[:, :-2] + 2 * p[:, 1:-1] + p[:, 2:]
    return np.asarray((p[:, :, :-2] + 2 * p[:, :, 1:-1] + p[:, :, 2:]) / 16)


def to_pixels(
    nodes: Array, positions_y: Array, positions_x: Array, shape: tuple[int, int]
) -> Image:
    """Interpolate from equidistant nodes to all pixels by Catmull-Rom splines.

    Parameters
    ----------
    nodes : array, (row, column)
        Values at the nodes.
    positions_y, positions_x : array, (row,) and (column,)
        Places of the nodes. [px]
    shape : (int, int)
        Rows and columns of the frame.

    Returns
    -------
    array, (y, x), float32
        Constant beyond the outer nodes.
    """
    down = _catmull_rom(positions_y, shape[0])
    across = _catmull_rom(positions_x, shape[1])
    return np.asarray(down @ nodes.astype(np.float32) @ np.ascontiguousarray(across.T))


def _catmull_rom(positions: Array, size: int) -> Image:
    """Weights (pixel, node) of the nodes along one axis."""
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

    # nodes beyond the edge repeat the outer one, whose weights add up
    matrix = np.zeros((size, n), np.float32)
    for k, weight in enumerate(weights):
        node = np.clip(i + k - 1, 0, n - 1)
        np.add.at(matrix, (np.arange(size), node), weight.astype(np.float32))
    return matrix


def response(sigma: float, passes: int) -> tuple[float, float]:
    """Compute how much noise iterated deformation lets through, frequency by frequency.

    Each pass adds to the field what its window W(k) sees of the rest, so it undoes the low-pass of
    the window: a field that holds the part T of the truth holds T + W (1 - T) after the pass. Then
    comes the smoothing between the passes.

    Parameters
    ----------
    sigma : float
        Standard deviation of the window. [cells]
    passes : int
        Number of passes.

    Returns
    -------
    gain : float
        Variance of a vector over that of a single pass. [1]
    kept : float
        Part of the variance of the scores, in sums over 3 by 3 cells, that the field leaves. [1]
    """
    k = 2 * np.pi * np.fft.fftfreq(64)  # 64 cells are wide enough for all windows in use
    ky, kx = k[:, None], k[None, :]
    window = np.exp(-0.5 * sigma**2 * (kx**2 + ky**2))
    binomial = (0.5 + 0.5 * np.cos(kx)) * (0.5 + 0.5 * np.cos(ky))

    held = np.zeros_like(window)
    for number in range(passes):
        held = held + window * (1 - held)
        if number < passes - 1:
            held = held * binomial

    # the scatter is taken from sums over 3 by 3 cells; the field follows these more closely
    three = ((1 + 2 * np.cos(kx)) * (1 + 2 * np.cos(ky))) ** 2
    kept = ((1 - held) ** 2 * three).mean() / three.mean()
    return float((held**2).mean() / (window**2).mean()), float(kept)


def window_std(sums: Array, sigma: float, passes: int) -> Array:
    """Return the standard deviation of the local field, from the scatter of the cell scores.

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
        Of one component, the rms of the two; infinite where the texture is too faint. [px]
    """
    _, inverse, sound = solve_windows(sums, sigma)
    scores = sums[..., SCORES]

    # neighbouring cells share texture: the products of sums over 3 by 3 cells hold their
    # covariances too
    near = ndimage.uniform_filter(scores, (3, 3, 1), mode="constant") * 3
    product = near[..., :, None] * near[..., None, :]
    rows, cols = sound.shape

    # the square of the Gaussian window is a Gaussian of 1/sqrt(2) its width, whose sum is
    # 1/(4 pi sigma^2)
    spread = window_sums(product.reshape(rows, cols, 4), sigma / float(np.sqrt(2))) / (
        4 * np.pi * sigma**2
    )
    covariance = inverse @ spread.reshape(rows, cols, 2, 2) @ inverse

    gain, kept = response(sigma, passes)
    variance = 0.5 * np.trace(covariance, axis1=-2, axis2=-1) * gain / kept
    floor = np.median(variance[sound]) * STD_FLOOR if sound.any() else 0.0
    return np.where(sound, np.sqrt(np.maximum(variance, floor)), np.inf)


def still_off(sums: Array, step: int, *, tolerance: float) -> Mask:
    """Find the cells whose surroundings of some 64 px clearly need another displacement.

    Parameters
    ----------
    sums : array, (row, column, 11)
        Cell sums at the displacement to judge, each over its residual variance.
    step : int
        Side of a cell. [px]
    tolerance : float
        A displacement up to this is accepted, however clear it is. [px]

    Returns
    -------
    array, (row, column), bool
        True where the displacement is off.
    """
    sigma = window_sigma(JUDGED_WINDOW, step)
    rest, inverse, sound = solve_windows(sums, sigma)
    length = np.hypot(rest[0], rest[1])

    # from the residual variance: a displacement that is off also widens the scatter of the scores
    variance = SCORE_NOISE * 0.5 * np.trace(inverse, axis1=-2, axis2=-1) / (4 * np.pi * sigma**2)
    return np.asarray(sound & (length > tolerance) & (length > CLEAR * np.sqrt(variance)))
