"""The translation of one frame against the fixed map: fast, for every frame of a run."""

from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from scipy import fft

from erlif.core.arrays import AnyArray
from erlif.core.errors import RegistrationError
from erlif.registration import local
from erlif.registration.camera_map import CameraMap
from erlif.registration.matching import (
    AB,
    BX,
    BY,
    GXX,
    GXY,
    GYY,
    SUMS,
    WEIGHT,
    cell_sums,
    correlation,
    move_sums,
    solve_shift,
    without_noise,
)
from erlif.registration.pairs import Pair, Pairs, laid_over, make_pair, open_frames, textures
from erlif.registration.settings import RegistrationSettings
from erlif.registration.surface import cell_weights

STEP: Final = 16
FARTHEST: Final = 8
"""Largest drift looked for, in pixels binned by 2 or, for frames of 400 px and more, by 4."""
CHANCE: Final = 6.0
"""The mean or median product of the textures must be this many of its standard errors for a drift to be believed."""


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
    reference: AnyArray,
    moving: AnyArray,
    *,
    weight_reference: AnyArray | None = None,
    weight_moving: AnyArray | None = None,
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
    found = follow_drift(
        camera_map.displacement_x, camera_map.displacement_y, pair, threads=threads
    )
    if np.isnan(found.dx):
        raise RegistrationError(
            f"This frame does not fit the camera map: laid over each other, the images of the two cameras have a "
            f"correlation coefficient of {found.quality:.3f}, no more than chance gives. Leave the frame out if the "
            "pulse misfired, or register the cameras again if they have been moved."
        )
    return found


def check_map(
    camera_map: CameraMap,
    pairs: Pairs,
    *,
    tolerance: float = 0.1,
    settings: RegistrationSettings | None = None,
) -> AnyArray:
    """Check on a few frames of a run that a map made before still fits it.

    Parameters
    ----------
    camera_map : CameraMap
        A stored map.
    pairs : sequence, or callable that gives a fresh iterable
        Frames of the run, as for `register_frames`; at most eight of them, evenly spaced, are used.
    tolerance : float
        Local displacement beyond the drift that is let pass. [px]
    settings : RegistrationSettings, optional
        Those of the map if missing.

    Returns
    -------
    array, (frame, 2)
        Drift ``(dx, dy)`` of the frames used. [px]

    Raises
    ------
    RegistrationError
        If a frame does not fit at all, or if more than a tenth of the field clearly needs another displacement.
    """
    settings = camera_map.settings if settings is None else settings
    frames = open_frames(pairs, replace(settings, frames_for_map=min(8, settings.frames_for_map)))
    drift = []
    total = np.zeros((1, 1, SUMS))
    for pair in frames.pick(frames.chosen):
        found = estimate_drift(
            replace(camera_map, settings=replace(settings, orientation="normal")),
            pair.reference,
            pair.moving,
            weight_reference=pair.weight_reference,
            weight_moving=pair.weight_moving,
            threads=settings.threads,
        )
        drift.append((found.dx, found.dy))
        views = textures(pair, 1, settings.threads)
        field = camera_map.displacement_x, camera_map.displacement_y
        b = laid_over(
            views.spline(settings.threads), *field, (found.dx, found.dy), settings.threads
        )
        total = total + cell_sums(views.a, views.weight, b, STEP, threads=settings.threads)
    total = without_noise(total)
    off = local.still_off(total * cell_weights(total)[..., None], STEP, tolerance=tolerance)
    lit = total[..., WEIGHT] > 0
    if off[lit].mean() > 0.1:
        raise RegistrationError(
            f"The stored camera map fits no longer: {off[lit].mean():.0%} of the common field needs a displacement that "
            f"differs by more than {tolerance} px even after the drift. Register the cameras again with this run."
        )
    return np.array(drift)


def follow_drift(
    displacement_x: AnyArray, displacement_y: AnyArray, pair: Pair, *, threads: int = 1
) -> Drift:
    """The same as `estimate_drift` for a checked pair and a dense displacement (NaN where it is not known). [px]

    The cross-correlation of binned images finds it to the binned pixel, Gauss-Newton steps on them to a fraction of a
    pixel, and one or two steps at full resolution, or at half of it for large frames, do the rest. NaN if the textures
    do not correlate beyond chance.
    """
    shift = np.zeros(2)
    sums = np.zeros((1, 1, SUMS))
    last = (
        2 if min(pair.reference.shape) >= 400 else 1
    )  # large frames have texture enough for a shift when binned
    for binning, passes in ((2 * last, 3), (last, last)):
        views = textures(pair, binning, threads)
        spline = views.spline(threads)
        dx, dy = _thinned(displacement_x, binning), _thinned(displacement_y, binning)
        if binning > last:
            shift = binning * _whole_pixels(views.a, laid_over(spline, dx, dy, (0.0, 0.0), threads))
        for _ in range(passes):
            here = (float(shift[0]) / binning, float(shift[1]) / binning)
            sums = cell_sums(
                views.a,
                views.weight,
                laid_over(spline, dx, dy, here, threads),
                STEP,
                threads=threads,
            )
            shift = shift + binning * np.array(solve_shift(without_noise(sums)))
    quality = correlation(sums)
    products = sums[..., AB][sums[..., WEIGHT] > 0]
    if products.size < 16 or not _beyond_chance(products):
        return Drift(np.nan, np.nan, np.nan, np.nan, quality)
    sums = without_noise(sums)
    std_dx, std_dy = _spread(move_sums(sums, *solve_shift(sums)))
    return Drift(float(shift[0]), float(shift[1]), last * std_dx, last * std_dy, quality)


def _beyond_chance(products: AnyArray) -> bool:
    """Whether the textures have something in common: in the mean, or, where the rim of a bubble outshines the rest, in the median."""
    error = np.sqrt(1 / products.size)
    median = float(np.median(products))
    spread = 1.4826 * float(np.median(np.abs(products - median)))
    return bool(
        products.mean() > CHANCE * products.std() * error
        or median > CHANCE * np.sqrt(np.pi / 2) * spread * error > 0
    )


def _whole_pixels(a: AnyArray, b: AnyArray) -> AnyArray:
    """Translation (dx, dy) of ``b`` against ``a`` to the pixel, from their cross-correlation; NaN in ``b`` counts 0."""
    size = (
        fft.next_fast_len(a.shape[0] + FARTHEST, real=True),
        fft.next_fast_len(a.shape[1] + FARTHEST, real=True),
    )
    product = fft.rfft2(np.nan_to_num(b), size) * np.conj(fft.rfft2(a, size))
    value = fft.irfft2(product, size)
    near = np.r_[-FARTHEST : FARTHEST + 1]
    j, i = np.unravel_index(int(np.argmax(value[np.ix_(near, near)])), (near.size, near.size))
    return np.array([near[i], near[j]], float)


def _thinned(field: AnyArray, binning: int) -> AnyArray:
    """The displacement at the centres of the binned pixels, in binned pixels."""
    if binning == 1:
        return field
    h, w = field.shape[0] // binning, field.shape[1] // binning
    low, high = binning // 2 - 1, binning // 2
    parts = [field[j::binning, i::binning][:h, :w] for j in (low, high) for i in (low, high)]
    return np.asarray(sum(parts) * np.float32(0.25 / binning), np.float32)


def _spread(sums: AnyArray) -> tuple[float, float]:
    """Standard deviations of the shift from the scatter of the cell scores."""
    gxx, gxy, gyy = (float(sums[..., k].sum()) for k in (GXX, GXY, GYY))
    matrix = np.array([[gxx, gxy], [gxy, gyy]])
    if not np.linalg.det(matrix) > 0:
        return float("nan"), float("nan")
    scores = np.stack([sums[..., BX].ravel(), sums[..., BY].ravel()])
    inverse = np.linalg.inv(matrix)
    covariance = inverse @ (scores @ scores.T) @ inverse
    return float(np.sqrt(covariance[0, 0])), float(np.sqrt(covariance[1, 1]))
