"""The translation of one frame against the fixed map: fast, for every frame of a run.

The binned images are correlated to find the whole pixels, and Gauss-Newton steps (Lucas and Kanade
1981) find the fraction. The standard deviation is the sandwich of the scores (Huber 1967).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

import cv2
import numpy as np
from scipy import fft

from erlif.core.arrays import AnyArray, Array, Image, Mask
from erlif.core.errors import RegistrationError
from erlif.registration import local
from erlif.registration.camera_map import CameraMap
from erlif.registration.interpolation import laid_over
from erlif.registration.matching import (
    EDGE,
    SCORES,
    SUMS,
    WEIGHT,
    beyond_chance,
    cell_sums,
    coefficients_of,
    correlation,
    move_sums,
    solve_shift,
    system_of,
    without_noise,
)
from erlif.registration.normalise import MOST, binned
from erlif.registration.pairs import Pair, Pairs, Textures, make_pair, open_series, textures
from erlif.registration.surface import cell_weights
from erlif.registration.whitening import padded_size

# Side of the cells whose sums determine the drift. [px]
STEP: Final = 16
# The same on binned textures, so that small frames have cells enough. [binned px]
ROUGH_STEP: Final = 8
# Largest drift in the search, in pixels binned by 2 or, for large frames, by 4.
FARTHEST: Final = 8
# Frames with both sides above this are binned by 2 in the last steps too: they have texture enough
# for a translation. [px]
LARGE: Final = 400
# Coarse images with both sides above this have texture enough for the search in their sum of
# quarters. [binned px]
LARGEST_UNFOLDED: Final = 200
# Rows of cells from which every other one is enough for the coarse steps.
FEWEST_ROWS: Final = 16
# Gauss-Newton steps on the coarse images; they converge from one coarse pixel to below 0.02.
COARSE_STEPS: Final = 2
# The same for `rough_drift`, whose steps are not corrected.
COARSE_PASSES: Final = 3
# Of so many rows of cells one shows how the scores follow a step: this belongs to the texture.
PART: Final = 4
# Limits of the slope of the scores over that of the equations; 1.3 is usual. [1]
STEP_RATIO: Final = (0.5, 2.0)
# A step below this leaves too little of itself to measure that slope. [px]
LEAST_STEP: Final = 1e-4
# Standard errors by which the mean correlation coefficient of the cells must exceed 0.
CHANCE: Final = 6.0
# Largest number of frames on which a stored map is checked.
FRAMES_CHECKED: Final = 8
# Local displacements up to this, beyond the drift, are accepted in that check. [px]
TOLERANCE: Final = 0.1
# Part of the common field that may need another displacement before a stored map is refused.
OFF_SHARE: Final = 0.1


def whole_pixels(a: Image, b: Image) -> Array:
    """Translation (dx, dy) of ``b`` against ``a`` to the pixel, from their cross-correlation.

    NaN in ``b`` counts as 0, the mean of a texture.
    """
    # zeros beyond the frame, as wide as the search, keep its opposite edges apart
    size = padded_size([side + FARTHEST for side in a.shape])
    product = fft.rfft2(np.nan_to_num(b), size) * np.conj(fft.rfft2(a, size))

    # negative lags stand at the end of the transform, where negative indices find them; after the
    # transform back along y, only the rows of the search are needed
    near = np.r_[-FARTHEST : FARTHEST + 1]
    value = fft.irfft(fft.ifft(product, axis=0)[near], size[1])[:, near]
    j, i = np.unravel_index(int(np.argmax(value)), value.shape)
    return np.array([near[i], near[j]], float)


def fold_quarters(image: Image) -> Image:
    """The sum of the quarters of a large image; a small one as it is.

    A translation is common to the quarters. What they do not have in common is noise to each other:
    it leaves half the significance, with a quarter of the pixels.
    """
    if min(image.shape) <= LARGEST_UNFOLDED:
        return image
    h, w = image.shape[0] // 2, image.shape[1] // 2
    image = np.where(np.isfinite(image), image, np.float32(0))
    return np.asarray(
        image[:h, :w] + image[:h, w : 2 * w] + image[h : 2 * h, :w] + image[h : 2 * h, w : 2 * w]
    )


def binned_field(field: Image, binning: int) -> Image:
    """The displacement at the centres of the binned pixels, in binned pixels.

    ``binning`` is 1, 2 or 4: the centre lies between four pixels, whose mean is taken.
    """
    if binning == 1:
        return field
    h, w = field.shape[0] // binning, field.shape[1] // binning
    low, high = binning // 2 - 1, binning // 2
    parts = [field[j::binning, i::binning][:h, :w] for j in (low, high) for i in (low, high)]
    return np.asarray(sum(parts) * np.float32(0.25 / binning), np.float32)


@dataclass(frozen=True)
class Drift:
    """Translation of camera 2 in one frame, to be added to the fixed map.

    Attributes
    ----------
    dx : float
        Positive towards larger column. [px]
    dy : float
        Positive towards larger row. [px]
    std_dx : float
        Standard deviation of dx. [px]
    std_dy : float
        Standard deviation of dy. [px]
    quality : float
        Correlation coefficient of the two textures after alignment. [1]
    """

    dx: float
    dy: float
    std_dx: float
    std_dy: float
    quality: float


def estimate_drift(
    camera_map: CameraMap,
    reference: AnyArray,
    moving: AnyArray,
    *,
    weight_reference: AnyArray | None = None,
    weight_moving: AnyArray | None = None,
    threads: int = 1,
) -> Drift:
    """Measure how far camera 2 has moved in this frame since the map was made.

    Parameters
    ----------
    camera_map : CameraMap
        The fixed map, whose orientation is applied to ``moving``.
    reference, moving, weight_reference, weight_moving : array, (y, x)
        As for `register`.
    threads : int
        Threads to use.

    Returns
    -------
    Drift
        The translation with its standard deviations.

    Raises
    ------
    RegistrationError
        If the frame has another size than the map, or if the two cameras have no common texture
        when they are aligned by it.

    Examples
    --------
    Camera 2 shows the same random texture three columns to the right.

    >>> from scipy.ndimage import gaussian_filter
    >>> from erlif.registration import CameraMap, MapKind
    >>> flat = np.zeros((96, 128), np.float32)
    >>> level = CameraMap(flat, flat, flat, flat == 0, flat > 0, 1.0, MapKind.SURFACE)
    >>> noise = np.random.default_rng(1).normal(size=(96, 131))
    >>> wall = (1000 + 300 * gaussian_filter(noise, 1.5)).astype(np.float32)
    >>> drift = estimate_drift(level, wall[:, 3:], wall[:, :-3])
    >>> abs(drift.dx - 3) < 0.01, abs(drift.dy) < 0.01
    (True, True)
    """
    pair = make_pair(reference, moving, weight_reference, weight_moving, camera_map.settings)
    return _find_drift(camera_map, pair, threads)


def _find_drift(camera_map: CameraMap, pair: Pair, threads: int) -> Drift:
    """The drift of a pair that is turned already; refused without one."""
    if pair.reference.shape != camera_map.shape:
        raise RegistrationError(
            f"The camera map was made for frames of {camera_map.shape}, this frame has "
            f"{pair.reference.shape}; register the cameras again for this region of interest."
        )

    search = DriftSearch.of(camera_map.displacement_x, camera_map.displacement_y)
    drift = search.find(textures(pair, search.binning, threads), threads=threads)
    if np.isnan(drift.dx):
        raise RegistrationError(
            "This frame does not fit the camera map: after alignment, the images of the two "
            f"cameras have a correlation coefficient of {drift.quality:.3f}, no more than chance "
            "gives. Leave the frame out if the pulse misfired, or register the cameras again if "
            "they have been moved."
        )
    return drift


def check_map(camera_map: CameraMap, pairs: Pairs) -> Array:
    """Check on a few frames of a run that a map made before still fits.

    Parameters
    ----------
    camera_map : CameraMap
        A stored map.
    pairs : sequence
        Frames of the run, as for `register_frames`; at most eight of them, evenly spaced, are used.

    Returns
    -------
    array, (frame, 2)
        Drift ``(dx, dy)`` of the frames used. [px]

    Raises
    ------
    RegistrationError
        If a frame does not fit at all, or if more than a tenth of the field clearly needs another
        displacement.

    Examples
    --------
    The cameras show one noise; camera 2 is a column to the right in the second frame.

    >>> from erlif.registration import CameraMap, MapKind
    >>> wall = 1000 + 100 * np.random.default_rng(1).normal(size=(96, 129)).astype(np.float32)
    >>> one, moved = wall[:, 1:], wall[:, :-1]
    >>> level = CameraMap(0 * one, 0 * one, 0 * one, one > 0, one < 0, 1.0, MapKind.SURFACE)
    >>> drift = check_map(level, [(one, one, None, None), (one, moved, None, None)])
    >>> bool(np.allclose(drift, [[0, 0], [1, 0]], atol=0.01))
    True
    """
    settings = camera_map.settings
    few = replace(settings, frames_for_map=min(FRAMES_CHECKED, settings.frames_for_map))
    frames = open_series(pairs, few)
    field = camera_map.displacement_x, camera_map.displacement_y

    drift = []
    total = np.zeros((1, 1, SUMS))
    for pair in frames.pick(frames.chosen):
        found = _find_drift(camera_map, pair, settings.threads)
        drift.append((found.dx, found.dy))

        views = textures(pair, 1, settings.threads)
        b = laid_over(
            views.spline(settings.threads), *field, (found.dx, found.dy), settings.threads
        )
        total = total + cell_sums(views.a, views.weight, b, STEP, threads=settings.threads)

    # the sums of all frames show a misfit that the noise of one frame hides
    total = without_noise(total)
    off = local.still_off(total * cell_weights(total)[..., None], STEP, tolerance=TOLERANCE)
    lit = total[..., WEIGHT] > 0
    share = off[lit].mean()
    if share > OFF_SHARE:
        raise RegistrationError(
            f"The stored camera map fits no longer: {share:.0%} of the common field needs a "
            f"displacement that differs by more than {TOLERANCE} px even after the drift. Register "
            "the cameras again with this run."
        )
    return np.array(drift)


@dataclass(frozen=True)
class DriftSearch:
    """Finds the drift of frames against one displacement.

    Attributes
    ----------
    binning : int
        Side of the pixels on which the drift is found: 2 for large frames, otherwise 1. [px]
    fine : tuple[Image, Image]
        Displacement (x, y) at these pixels, in their unit; NaN where not known.
    coarse : tuple[Image, Image]
        The same at pixels of twice the side.
    """

    binning: int
    fine: tuple[Image, Image]
    coarse: tuple[Image, Image]

    @classmethod
    def of(cls, displacement_x: Image, displacement_y: Image) -> DriftSearch:
        """Prepare the search for a dense displacement [px], NaN where not known."""
        binning = 2 if min(displacement_x.shape) >= LARGE else 1
        fine, coarse = (
            (binned_field(displacement_x, side), binned_field(displacement_y, side))
            for side in (binning, 2 * binning)
        )
        return cls(binning, fine, coarse)

    def find(self, fine: Textures, *, threads: int = 1) -> Drift:
        """Measure the drift of a frame pair.

        Parameters
        ----------
        fine : Textures
            Of both cameras in the orientation of camera 1, on the pixels of the search.
        threads : int
            Threads to use.

        Returns
        -------
        Drift
            In pixels of the frame; NaN if the textures do not correlate beyond chance.
        """
        # the finer textures are halved: normalising twice would take as long as the search
        coarse = Textures(*_halve(fine.a, fine.weight), *_halve(fine.b, fine.weight_b))
        start = _find_start(coarse, self.coarse, threads)
        return self._finish(fine, 2 * start, threads)

    def _finish(self, views: Textures, shift: Array, threads: int) -> Drift:
        """One more step from a start [binned px], with its standard deviation.

        The five-point derivative falls short of the slope of a fine texture, so a step is too
        long. A second look at a part of the cells shows how far, and the step is corrected.
        """
        spline = views.spline(threads)
        b = laid_over(spline, *self.fine, (shift[0], shift[1]), threads)
        sums = cell_sums(views.a, views.weight, b, STEP, threads=threads)
        quality = correlation(sums)
        if not beyond_chance(coefficients_of(sums), CHANCE):
            return Drift(np.nan, np.nan, np.nan, np.nan, quality)

        # a part of the cells again, after the step; their equations stay those before it
        sums = without_noise(sums)
        step = np.array(solve_shift(sums))
        part = range(min(PART // 2, len(sums) - 1), max(len(sums) - 1, 1), PART)
        b = _parts_laid_over(spline, self.fine, shift + step, part, threads)
        after = sums.copy()
        after[..., SCORES] = cell_sums(views.a, views.weight, b, STEP, only=part)[..., SCORES]
        moved = np.subtract(solve_shift(sums[part]), solve_shift(after[part]))
        ratio = _step_ratio(step, moved)

        # what the step has not moved is left; the scores before it are taken to its end, to first
        # order
        shift = self.binning * (shift + step + (step - moved) / ratio)
        std_dx, std_dy = np.multiply(self.binning / ratio, shift_std(move_sums(sums, *step)))
        return Drift(float(shift[0]), float(shift[1]), float(std_dx), float(std_dy), quality)


def _halve(texture: Image, weight: Image) -> tuple[Image, Image]:
    """Mean texture over squares of 2 px; weight 1 where more than half of the square counts.

    `binned` does the same, and takes a millisecond a pair more for images that may hold NaN.
    """
    size = texture.shape[1] // 2, texture.shape[0] // 2
    texture, weight = (image[: 2 * size[1], : 2 * size[0]] for image in (texture, weight))
    total = cv2.resize(texture, size, interpolation=cv2.INTER_AREA)
    if weight.min() > MOST:
        return np.asarray(total), np.ones_like(total)
    sound = cv2.resize(weight, size, interpolation=cv2.INTER_AREA)

    # the texture is 0 where the weight is
    ok = sound > MOST
    return np.where(ok, total / np.where(ok, sound, 1), np.float32(0)), ok.astype(np.float32)


def _find_start(views: Textures, field: tuple[Image, Image], threads: int) -> Array:
    """Translation by the cross-correlation to the pixel, by Gauss-Newton to a fraction. [px]"""
    spline = views.spline(threads)
    b = laid_over(spline, *field, (0.0, 0.0), threads)
    shift = whole_pixels(*(fold_quarters(image) for image in (views.a, b)))

    # in large images every other row of cells is enough for the start of the fine step
    rows = max(len(views.a) // STEP, 1)
    part = range(0, rows, 1 if rows < FEWEST_ROWS else 2)
    step = np.zeros(2)
    for count in range(COARSE_STEPS):
        if shift.any():
            b = _parts_laid_over(spline, field, shift, part, threads)
        sums = without_noise(cell_sums(views.a, views.weight, b, STEP, only=part)[part])
        before, step = step, np.array(solve_shift(sums))
        shift = shift + (step / _step_ratio(before, before - step) if count else step)
    return np.asarray(shift)


def _parts_laid_over(
    spline: tuple[Image, Mask], field: tuple[Image, Image], shift: Array, part: range, threads: int
) -> Image:
    """The texture of camera 2 for the sums of some rows of cells; other rows are not set."""
    height = len(field[0])
    drift = float(shift[0]), float(shift[1])
    if part.step == 1:  # the bands would overlap
        return laid_over(spline, *field, drift, threads)
    bands = [(max(r * STEP - EDGE, 0), min((r + 1) * STEP + EDGE, height)) for r in part]
    return laid_over(spline, *field, drift, threads, only=bands)


def _step_ratio(step: Array, moved: Array) -> float:
    """Measured over intended length of a step, clipped to `STEP_RATIO`."""
    square = float(step @ step)
    if square < LEAST_STEP**2:
        return 1.0
    return float(np.clip(float(step @ moved) / square, *STEP_RATIO))


def rough_drift(
    displacement_x: Image, displacement_y: Image, view: Textures, *, threads: int = 1
) -> Array:
    """Measure the drift of textures against a dense displacement to some hundredths of a pixel.

    Only the first half of a `DriftSearch`, on the textures themselves after binning.

    Returns
    -------
    array, (2,)
        x first; NaN if the textures do not correlate beyond chance. [px]
    """
    binning = 4 if min(view.a.shape) >= LARGE else 2
    small = Textures(*binned(view.a, view.weight, binning), *binned(view.b, view.weight_b, binning))
    spline = small.spline(threads)
    dx, dy = binned_field(displacement_x, binning), binned_field(displacement_y, binning)

    shift = whole_pixels(small.a, laid_over(spline, dx, dy, (0.0, 0.0), threads))
    for _ in range(COARSE_PASSES):
        b = laid_over(spline, dx, dy, (float(shift[0]), float(shift[1])), threads)
        sums = cell_sums(small.a, small.weight, b, ROUGH_STEP, threads=threads)
        shift = shift + np.array(solve_shift(without_noise(sums)))

    correlation = beyond_chance(coefficients_of(sums), CHANCE)
    return binning * shift if correlation else np.full(2, np.nan)


def shift_std(sums: Array) -> tuple[float, float]:
    """Standard deviations of a common translation (dx, dy), from the scatter of the cell scores."""
    *products, bx, by = system_of(sums)
    gxx, gxy, gyy = (float(each.sum()) for each in products)
    matrix = np.array([[gxx, gxy], [gxy, gyy]])
    if not np.linalg.det(matrix) > 0:
        return float("nan"), float("nan")

    # the scatter of the scores holds shot noise, private texture and residual distortion alike
    scores = np.stack([bx.ravel(), by.ravel()])
    inverse = np.linalg.inv(matrix)
    covariance = inverse @ (scores @ scores.T) @ inverse
    return float(np.sqrt(covariance[0, 0])), float(np.sqrt(covariance[1, 1]))
