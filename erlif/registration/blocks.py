"""Blocks of one image matched to another, and the affine map that most of them agree with.

Each block of camera 1 is compared with camera 2 at every integer offset within a few pixels; a
parabola through the highest correlation and its neighbours gives the fraction. Blocks without
texture give wrong vectors, so the affine map comes from random triples of blocks and the number of
others that agree (random sample consensus: Fischler and Bolles, 1981).
"""

from typing import Final, NamedTuple

import cv2
import numpy as np

from erlif.core.arrays import AnyArray, Array, Image

# Side of a block. [px]
BLOCK: Final = 32

# Distance of the blocks. [px]
STRIDE: Final = 16

# A block needs this part of its area in camera 2 at an offset. [1]
SEEN: Final = 0.3

# Stands for the correlation at offsets without enough overlap; below every coefficient.
UNSEEN: Final = -2.0

# Correlations above this are coefficients, not `UNSEEN`.
KNOWN: Final = -1.5

# A block counts if this part of its offsets has a correlation. [1]
OFFSETS_NEEDED: Final = 0.6

# Smallest scatter of the correlation of a block, to divide by. [1]
LEAST_CHANCE: Final = 1e-6

# Median of the magnitude of a normal variable over its standard deviation.
NORMAL_MEDIAN: Final = 0.6745

# Blocks that must agree: three always do.
FEWEST: Final = 4

# Triples of blocks that are drawn: with half of the blocks wrong, one in eight is right.
TRIPLES: Final = 300

# Smallest strength of a block in the draw. [1]
LEAST_WEIGHT: Final = 0.1

# Twice the area of the smallest triple; smaller ones have noisy slopes. [px^2]
LEAST_TRIANGLE: Final = 400.0

# Largest distance of a vector from a map with which it agrees. [px]
AGREED: Final = 1.0

# Largest slope of a map; a rotation by 5 degrees has 0.09, a scale of 5 % has 0.05. [1]
STEEPEST: Final = 0.12

# Least-squares fits to the blocks that agree, each of which may change their number.
REFITS: Final = 3


class Blocks(NamedTuple):
    """Blocks that overlap enough.

    Attributes
    ----------
    centres : Array
        (block, 2): x and y. [px]
    vectors : Array
        (block, 2): offset (x, y) of camera 2. [px]
    strength : Array
        (block,): height of the correlation peak over its scatter by chance. [1]
    """

    centres: Array
    vectors: Array
    strength: Array


class Agreement(NamedTuple):
    """An affine field of vectors, ``matrix @ x + offset``, and how many blocks share it.

    Attributes
    ----------
    matrix : Array
        (2, 2). [1]
    offset : Array
        (2,). [px]
    part : float
        Part of the blocks within a pixel of it; 0 if there is none. [1]
    """

    matrix: Array
    offset: Array
    part: float


NONE_AGREE: Final = Agreement(np.zeros((2, 2)), np.zeros(2), 0.0)


def integral(values: Image) -> Array:
    """Sums over every rectangle from the origin; one row and one column more than the image."""
    return np.asarray(cv2.integral(values, sdepth=cv2.CV_64F))


def _block_ends(blocks: int, size: int, offsets: AnyArray) -> tuple[AnyArray, AnyArray]:
    """First pixel (block, offset) of blocks along an axis of this size, and the one after the last.

    The blocks are moved by the offsets and cut at the image.
    """
    start = np.arange(blocks) * STRIDE
    stop = np.minimum(start + BLOCK, size)
    first, last = (np.clip(end[:, None] + offsets, 0, size) for end in (start, stop))
    return first, last


def _sum_blocks(sums: Array, y: tuple[AnyArray, AnyArray], x: tuple[AnyArray, AnyArray]) -> Array:
    """Sums (row, column, offset y, offset x) over the blocks, from an integral image."""
    top, bottom = (end[:, None, :, None] for end in y)
    left, right = (end[:, None] for end in x)
    rows: Array = sums[bottom, right] - sums[top, right]
    return rows - sums[bottom, left] + sums[top, left]


def _correlate_blocks(a: Image, b: Image, weight: Image, reach: int) -> Image:
    """Normalised correlation of each block of ``a`` with ``b`` at the offsets within ``reach``.

    (row, column, offset y, offset x), `UNSEEN` where less than `SEEN` of the block is seen.
    """
    h, w = a.shape
    rows, cols = max((h - BLOCK) // STRIDE + 1, 1), max((w - BLOCK) // STRIDE + 1, 1)
    offsets = np.arange(-reach, reach + 1)

    # the energies of each block, and of its counterpart as far as it lies inside the image
    still = np.zeros(1, int)
    own = _block_ends(rows, h, still), _block_ends(cols, w, still)
    energy = _sum_blocks(integral(a * a), *own)
    y, x = _block_ends(rows, h, offsets), _block_ends(cols, w, offsets)
    area = _sum_blocks(integral(weight * weight), y, x)
    other = _sum_blocks(integral(b * b), y, x)

    # sums over blocks that overlap are a matrix product along each axis
    down, across = (
        ((start <= np.arange(size)) & (np.arange(size) < stop)).astype(np.float32)
        for (start, stop), size in zip(own, a.shape, strict=True)
    )
    padded = np.pad(b, reach)
    total = np.empty((rows, cols, len(offsets), len(offsets)), np.float32)
    for j, i in np.ndindex(total.shape[2:]):
        total[:, :, j, i] = down @ ((a * padded[j : j + h, i : i + w]) @ across.T)

    known = (area >= SEEN * BLOCK * BLOCK) & (energy > 0) & (other > 0)
    scores = np.full(total.shape, UNSEEN, np.float32)
    scores[known] = total[known] / np.sqrt((energy * other)[known])
    return scores


def match_blocks(a: Image, b: Image, weight: Image, reach: int) -> Blocks:
    """Match the blocks of camera 1 to camera 2.

    Parameters
    ----------
    a, b : array, (y, x), float32
        Textures of camera 1 and camera 2, 0 where unknown. [1]
    weight : array, (y, x), float32
        0 where ``b`` is unknown, otherwise 1.
    reach : int
        Largest offset along each axis. [px]

    Returns
    -------
    Blocks
        Those for which most offsets have enough overlap.
    """
    h, w = a.shape
    scores = _correlate_blocks(a, b, weight, reach)
    rows, cols, n, _ = scores.shape

    # the highest correlation of each block, and the scatter of the others by chance
    flat = scores.reshape(rows, cols, n * n)
    usable = (flat > KNOWN).mean(-1) > OFFSETS_NEEDED
    best = np.argmax(flat, axis=-1)
    j, i = np.divmod(best, n)
    height = np.take_along_axis(flat, best[..., None], -1)[..., 0]
    valid = np.where(flat > KNOWN, flat, np.nan)[usable]
    chance = np.sqrt(np.nanmedian(valid**2, axis=-1)) / NORMAL_MEDIAN

    vectors = np.stack([i - reach, j - reach], axis=-1) + _fractions(scores, j, i)
    y, x = np.meshgrid(np.arange(rows), np.arange(cols), indexing="ij")
    half = (min(BLOCK, w, h) - 1) / 2
    centres = np.stack([x * STRIDE + half, y * STRIDE + half], axis=-1).astype(float)
    strength = height[usable] / np.maximum(chance, LEAST_CHANCE)
    return Blocks(centres[usable], vectors[usable], strength)


def _fractions(scores: AnyArray, j: AnyArray, i: AnyArray) -> Array:
    """Fraction (row, column, 2), x first, of the peak of each block by a parabola. [px]

    0 for a peak on the rim of the search, whose neighbours are not all known.
    """
    rows, cols, n, _ = scores.shape
    y, x = np.meshgrid(np.arange(rows), np.arange(cols), indexing="ij")
    inner = (i > 0) & (i < n - 1) & (j > 0) & (j < n - 1)
    jj, ii = np.clip(j, 1, n - 2), np.clip(i, 1, n - 2)

    fractions = np.zeros((rows, cols, 2))
    for axis, (down, right) in enumerate(((0, 1), (1, 0))):
        low = scores[y, x, jj - down, ii - right]
        high = scores[y, x, jj + down, ii + right]
        middle = scores[y, x, jj, ii]
        bend = 2 * middle - low - high
        ok = inner & (bend > 0) & (low > KNOWN) & (high > KNOWN)
        vertex = (high - low) / (2 * np.where(bend > 0, bend, 1))
        fractions[..., axis] = np.where(ok, np.clip(vertex, -0.5, 0.5), 0)
    return fractions


def agree(centres: Array, vectors: Array, strength: Array) -> Agreement:
    """Find the affine field that most blocks agree with.

    Triples of blocks are drawn, strong ones more often, from a generator of fixed seed. Then least
    squares over the blocks that agree with the best triple, repeated as their number changes.

    Parameters
    ----------
    centres, vectors, strength : array
        As in `Blocks`; the centres from any origin.

    Returns
    -------
    Agreement
        About the origin of the centres.
    """
    n = len(centres)
    if n < FEWEST:
        return NONE_AGREE

    # triples that span a triangle
    terms = np.concatenate([centres, np.ones((n, 1))], axis=1)
    rng = np.random.default_rng(0)
    chance = np.maximum(strength, LEAST_WEIGHT) ** 2
    chance /= chance.sum()
    pick = rng.choice(n, (TRIPLES, 3), p=chance)
    triangle = terms[pick]
    area = np.linalg.det(triangle)
    pick, triangle = pick[np.abs(area) > LEAST_TRIANGLE], triangle[np.abs(area) > LEAST_TRIANGLE]
    if not len(pick):
        return NONE_AGREE

    # the field of the triple with which most blocks agree
    fields = np.linalg.solve(triangle, vectors[pick])
    near = np.hypot(*np.moveaxis(terms @ fields - vectors, -1, 0)) < AGREED
    near[np.abs(fields[:, :2]).max((1, 2)) > STEEPEST] = False
    best = near[np.argmax(near.sum(1))]
    if best.sum() < FEWEST:
        return NONE_AGREE

    for _ in range(REFITS):
        field = np.linalg.lstsq(terms[best], vectors[best], rcond=None)[0]
        best = np.hypot(*(terms @ field - vectors).T) < AGREED
        if best.sum() < FEWEST:
            return NONE_AGREE
    return Agreement(field[:2].T, field[2], float(best.mean()))
