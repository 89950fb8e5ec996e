"""Gain, read noise and response spread of cameras from the frames themselves.

Both cameras image the same speckle pattern, so it cancels in the logarithm of their ratio, and the
differences from pixel to pixel that remain are mostly noise. Differences between frames also cancel
what is the same in both: film, pixel response, marks. Their variance depends on the light as the
noise of a camera does. This is the photon transfer of Poisson and Gaussian noise (Foi et al. 2008)
with a scene that need not be flat.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from itertools import pairwise

import cv2
import numpy as np
from scipy import ndimage

from erlif.core.arrays import Array
from erlif.core.errors import FrameError
from erlif.core.products import AlignedFrames, RatioImages, References
from erlif.correction import CameraNoise
from erlif.ratio.noise_fit import BLOCKS, NoiseCells, NoiseUnknowns, fit_pixel_noise, weigh_gains
from erlif.ratio.softening import BlurDifference, Softening
from erlif.registration import CameraMap, interpolation_variance_factor

# Minimum width of a cell. [px]
_CELL = 8

# Cells of a large frame, about: enough light levels, and 100 pixels and more in each.
_CELLS = 4000

# Share of its pixels that a cell needs.
_LEAST_FILLING = 0.25

# Cells from which an estimate is made.
_LEAST_CELLS = 50

# Relative standard deviation of a gain above which it is refused as undetermined.
_WORST = 0.3

# Share of a pattern in the variance of differences that a drift of about 0.01 px leaves.
_STILL = 1e-3

# A pixel less the mean of the eight two pixels away: removes a tilted film.
_RING = np.zeros((5, 5))
_RING[::2, ::2] = -1 / 8
_RING[2, 2] = 1


@dataclass(frozen=True)
class NoiseEstimate:
    """Noise of both cameras from their frames.

    Attributes
    ----------
    cameras : tuple[CameraNoise, CameraNoise]
    alike : float
        Probability that both cameras have one gain; NaN unless both gains were unknown. [1]
    frames : int
        Frames that were compared.
    """

    cameras: tuple[CameraNoise, CameraNoise]
    alike: float
    frames: int


@dataclass(frozen=True)
class NoiseView:
    """Log ratio of one frame, with its variance for noise of unit size.

    Attributes
    ----------
    log_ratio : Array
        (y, x), NaN where flagged. [1]
    shot : Array
        Variance for a gain of 1 electron/DN, (camera, y, x). [1]
    read : Array
        Variance for a dark variance of 1 DN2, (camera, y, x). [1]
    place : Array
        Displacement of camera 2 at the middle of each cell, drift included, (axis x y, row,
        column). [px]
    """

    log_ratio: Array
    shot: Array
    read: Array
    place: Array

    @classmethod
    def of(
        cls, ratio: RatioImages, unit: AlignedFrames, camera_map: CameraMap, *, size: int
    ) -> NoiseView:
        """View of one frame.

        Parameters
        ----------
        ratio : RatioImages
            Ratio of the frame.
        unit : AlignedFrames
            The same frame, with signal_var for a gain of 1 electron/DN and signal_var_fixed for a
            dark variance of 1 DN2; coordinates drift_x and drift_y.
        camera_map : CameraMap
        size : int
            Width of a cell. [px]

        Returns
        -------
        NoiseView
        """
        drift = float(unit.drift_x[0]), float(unit.drift_y[0])
        x = camera_map.displacement_x.astype(float) + drift[0]
        y = camera_map.displacement_y.astype(float) + drift[1]

        # the averaging of the interpolation is taken out here: the overlap of the splines counts
        # it cell by cell, together with that of the differences
        averaged = np.stack([np.ones_like(x), interpolation_variance_factor(x, y)])
        with np.errstate(divide="ignore", invalid="ignore"):
            per_light = 1 / (unit.signal.values[:, 0] ** 2 * averaged)
            shot = unit.signal_var.values[:, 0] * per_light
            read = unit.signal_var_fixed.values[:, 0] * per_light

        flagged = (ratio.flags.values[0] != 0) | ~np.isfinite(shot.sum(axis=0) + read.sum(axis=0))
        middles = (slice(size // 2, None, size), slice(size // 2, None, size))
        rows, columns = x.shape[0] // size, x.shape[1] // size
        return cls(
            np.where(flagged, np.nan, ratio.log_ratio.values[0]).astype(float),
            shot,
            read,
            np.stack([x[middles], y[middles]])[:, :rows, :columns],
        )


def cell_size(shape: tuple[int, ...]) -> int:
    """Width of the cells into which frames are divided.

    Parameters
    ----------
    shape : (rows, columns)
        [px]

    Returns
    -------
    int
        [px]

    Examples
    --------
    >>> cell_size((480, 640)), cell_size((2048, 2448))
    (9, 35)
    """
    height, width = shape
    return max(_CELL, round(float(np.sqrt(height * width / _CELLS))))


def estimate_camera_noise(
    views: Iterable[NoiseView],
    unknown: NoiseUnknowns,
    *,
    references: References,
    blur: BlurDifference,
    frames: int,
) -> NoiseEstimate | None:
    """Estimate what is unknown of the noise of both cameras from differences between frames.

    Parameters
    ----------
    views : iterable of NoiseView
        In the order of the frames; neighbours are compared.
    unknown : NoiseUnknowns
    references : References
        Gains and read noises, assumed where unknown, and the flat of camera 2.
    blur : BlurDifference
        Difference of sharpness, by which the sharper camera was blurred.
    frames : int
        Number of views.

    Returns
    -------
    NoiseEstimate or None
        None where only the response is unknown and the frames do not determine it.

    Raises
    ------
    FrameError
        If the frames do not determine the gain or the read noise.

    Examples
    --------
    Four frames of cameras with 4.4 electron/DN, pixel on pixel, in light up to 3000 DN:

    >>> import xarray as xr
    >>> rng = np.random.default_rng(1)
    >>> light = np.linspace(300, 3000, 320) * np.ones((2, 256, 1))
    >>> light[1] *= np.linspace(0.3, 1, 256)[:, None]
    >>> place = np.zeros((2, 32, 40))  # of the cells of 8 px
    >>> def take_frame():
    ...     one, two = rng.poisson(4.4 * light) / 4.4
    ...     return NoiseView(np.log(two / one), 1 / light, 1 / light**2, place)
    >>> references = References(xr.Dataset({
    ...     "gain": ("camera", np.ones(2)),
    ...     "read_noise": ("camera", np.zeros(2)),
    ...     "flat": (("camera", "y", "x"), np.ones(light.shape)),
    ...     "flat_var": (("camera", "y", "x"), np.zeros(light.shape)),
    ...     "bad": (("camera", "y", "x"), np.zeros(light.shape, bool)),
    ... }))
    >>> both, neither = np.array([True, True]), np.array([False, False])
    >>> estimate = estimate_camera_noise(
    ...     [take_frame() for _ in range(4)], NoiseUnknowns(both, neither, neither),
    ...     references=references, blur=BlurDifference(), frames=4,
    ... )
    >>> all(abs(camera.gain - 4.4) < 3 * camera.gain_std < 0.4 for camera in estimate.cameras)
    True
    """
    cells = _gather_cells(views, blur)
    # known values stay, unknown ones are assumptions that the fit replaces
    gain, read_noise = references.gain.values.copy(), references.read_noise.values.copy()
    if len(cells.variance) < _LEAST_CELLS:
        if not unknown.noise.any():
            return None
        camera = 1 + int(np.argmax(unknown.noise))
        raise FrameError(
            f"camera{camera} has no gain or read noise, and the frames do not determine them: "
            f"expected two or more frames with enough light and overlap, got {frames} with "
            f'{len(cells.variance)} usable patches. Give gain = "4.4 electron/DN" and read_noise = '
            '"9 electron", or flats and darks with at least two pages each.'
        )

    # the response of camera 2 shows as a pattern that moves with its drift
    pattern = bool(unknown.response[1] and cells.pattern.mean() > _STILL)
    fit = fit_pixel_noise(cells, references, unknown, one_gain=True, pattern=pattern)
    alike = float("nan")
    if pattern and not fit.determines_response:
        # a column almost proportional to the constant would exchange random amounts with it
        pattern = False
        fit = fit_pixel_noise(cells, references, unknown, one_gain=True, pattern=False)
    # two cameras of one kind have one gain; the frames decide how likely that is
    if unknown.gain.all():
        apart = fit_pixel_noise(cells, references, unknown, one_gain=False, pattern=pattern)
        fit, alike = weigh_gains(fit, apart)

    gain_std = np.zeros(2)
    for n in np.nonzero(unknown.gain)[0]:
        slope, std = fit.slope[n], float(np.sqrt(fit.slope_covariance[n, n]))
        if not std < _WORST * slope:
            raise FrameError(
                f"camera{n + 1} has no gain, and the frames do not determine it: expected noise "
                f"that rises with the light, got 1/gain = {slope:.3g} ± {std:.2g} DN/electron. "
                'Give gain = "4.4 electron/DN", or flats with at least two pages of one light '
                "level to measure it by photon transfer."
            )
        gain[n], gain_std[n] = 1 / slope, std / slope**2

    # the root of a variance near zero is uncertain by the root of that variance's own std
    read_std, dark = np.zeros(2), unknown.read_noise
    read_noise[dark] = gain[dark] * np.sqrt(fit.dark)
    of_root = 2 * np.sqrt(max(fit.dark, fit.dark_std / 4, 1e-12))
    read_std[dark] = gain[dark] * fit.dark_std / of_root

    # the response of camera 1 does not move against the film: that of camera 2 stands for both
    response = np.where(unknown.response & unknown.response[1], np.sqrt(fit.response), np.nan)
    columns = (gain, gain_std, read_noise, read_std, response)
    one, two = (CameraNoise(*(float(column[n]) for column in columns)) for n in range(2))
    return NoiseEstimate((one, two), alike, frames)


def _gather_cells(views: Iterable[NoiseView], blur: BlurDifference) -> NoiseCells:
    """Cells of the differences between neighbouring frames."""
    kernels = _difference_kernels(blur)
    return NoiseCells.join(
        [_difference_cells(*neighbours, kernels) for neighbours in pairwise(views)]
    )


def _difference_kernels(blur: BlurDifference) -> tuple[Array, Array]:
    """Weights of the log light of camera 1 and camera 2 in a difference, with their blur."""
    one, two = (_convolve(_RING, np.outer(*taps[::-1])) for taps in Softening.of(blur).taps)
    return one, two


def _convolve(image: Array, kernel: Array) -> Array:
    """Convolution of two small images, of all places at which they overlap.

    By scipy.ndimage: scipy.signal loads in a quarter of a second.
    """
    margins = [(length // 2, length // 2) for length in kernel.shape]
    whole = ndimage.convolve(np.pad(image, margins), kernel, mode="constant")
    return np.asarray(whole)


def _difference_cells(
    first: NoiseView, second: NoiseView, kernels: tuple[Array, Array]
) -> NoiseCells:
    """Cells of the difference of two frames."""
    difference = second.log_ratio - first.log_ratio
    size = cell_size(difference.shape)
    filtered = cv2.filter2D(difference, -1, _RING, borderType=cv2.BORDER_CONSTANT)
    squared = np.asarray(filtered, float) ** 2
    for edge in (squared, squared.T):
        edge[:2] = edge[-2:] = np.nan  # where the ring reaches beyond the image
    good = np.isfinite(squared)
    pixels = _sum_cells(good.astype(float), size)

    def mean(image: Array) -> Array:
        return _sum_cells(np.where(good, image, 0.0), size) / np.maximum(pixels, 1)

    # pixels of camera 1 are independent; those of camera 2 are mixed by the interpolation
    own = float((kernels[0] ** 2).sum())
    mixed = [_overlap(kernels[1], view.place, view.place) for view in (first, second)]
    common = _overlap(kernels[1], first.place, second.place)
    shot, read = (
        (own * mean(a[0] + b[0]), mixed[0] * mean(a[1]) + mixed[1] * mean(b[1]))
        for a, b in ((first.shot, second.shot), (first.read, second.read))
    )

    # what the drift has not moved cancels in the difference
    pattern = mixed[0] + mixed[1] - 2 * common

    rows, columns = np.indices(pixels.shape)
    block = rows * BLOCKS // pixels.shape[0] * BLOCKS + columns * BLOCKS // pixels.shape[1]
    use = (pixels >= _LEAST_FILLING * size**2) & np.isfinite(pattern)
    return NoiseCells(
        pixels[use],
        block[use].astype(np.int64),
        mean(squared)[use],
        np.stack([image[use] for image in shot], axis=1),
        np.stack([image[use] for image in read], axis=1),
        pattern[use],
    )


def _sum_cells(image: Array, size: int) -> Array:
    """Sums over the whole cells of an image; pixels beyond the last whole cell are left out."""
    rows, columns = (n // size for n in image.shape)
    whole = image[: rows * size, : columns * size]
    return np.asarray(whole.reshape(rows, size, columns, size).sum(axis=(1, 3)))


def _overlap(kernel: Array, first: Array, second: Array) -> Array:
    """Covariance of a difference taken at two places of camera 2, for independent unit pixels.

    The weights of the interpolation are those of the cardinal cubic spline. Places are those of the
    cells, (axis x y, row, column).
    """
    together = _convolve(kernel, kernel[::-1, ::-1])
    reach = kernel.shape[0] - 1
    lags = range(-reach, reach + 1)
    along = [
        np.stack([_overlap_along(first[axis], second[axis] + lag) for lag in lags])
        for axis in (0, 1)
    ]
    return np.asarray(np.einsum("vu,vij,uij->ij", together, along[1], along[0]))


def _overlap_along(first: Array, second: Array) -> Array:
    """Sum over k of eta(first - k) eta(second - k), eta being the cardinal cubic spline."""
    at, eta = _spline_table()
    base = np.floor(first)
    total = np.zeros(first.shape)
    for k in range(-7, 9):  # the spline falls by a factor of 3.7 per pixel
        one = np.interp(first - base - k, at, eta)
        total += one * np.interp(second - base - k, at, eta, left=0.0, right=0.0)
    return total


@cache
def _spline_table() -> tuple[Array, Array]:
    """The cardinal cubic spline: 1 at zero, 0 at every other whole number."""
    at = np.linspace(-9, 9, 18 * 128 + 1)
    pole = np.sqrt(3.0) - 2
    eta = np.zeros(at.size)
    for j in range(-16, 17):
        t = np.abs(at - j)
        b_spline = np.where(t < 1, (4 - 6 * t**2 + 3 * t**3) / 6, np.maximum(2 - t, 0) ** 3 / 6)
        eta += np.sqrt(3.0) * pole ** abs(j) * b_spline
    return at, eta
