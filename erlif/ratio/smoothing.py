"""The log ratio smoothed within its noise, with steps kept; done on request only.

About every pixel a plane is fitted to the log ratio, with weights 1/variance times a Gaussian
window: local linear regression (Fan and Gijbels 1996, section 2.3). Its weights reproduce planes
exactly, also beside a hole and at the border of the image. The remaining variance is the sum of
their squares times the variances of the pixels.

A film steps where a bushing is grooved or worn, and a window across a step would round it. The
plane is therefore compared with a plane with a step: first, everywhere, with a step through the
pixel along x or along y; then, about every pixel where that is significant, with steps at all
distances within the window and in sixteen directions. Where the best of these is significant, the
plane is fitted to this pixel's side of it alone, as the one-sided windows of Gijbels, Lambert and
Qiu (2006), who choose the side by the residuals. Significance includes noise and registration.

After smoothing, neighbours are correlated over about the resolution, and a mean over pixels does
not gain by their number. Interpolation of camera 2 correlates them a little before; this is
measured from the residuals, and the remaining variance is raised by it. The denoisers of
scikit-image and OpenCV take neither a variance for each pixel nor missing pixels.
"""

from __future__ import annotations

import math

import cv2
import numpy as np

from erlif.core.arrays import Array, Image, Mask
from erlif.core.errors import ModelError
from erlif.core.products import RatioImages, require
from erlif.core.speed.kernels import njit
from erlif.ratio.planes import find_steps, fit_one_side, fit_planes, step_distances, weigh_pixels

# Significance of a step through a pixel from which on its window is searched. [std]
_SUSPECT = 3.5

# Significance of a step in a window, the best of hundreds. [std]
_SIGNIFICANT = 4.5

# Half width of the window, where it has fallen to 4 %. [std of the window]
_REACH = 2.5

# Pixels over which neighbours may have noise in common before smoothing. [px]
_LAG = 2

# Pixels from which on only some rows give the correlation of the noise.
_SAMPLED = 400_000

# Pixels that determine the correlation of the noise, at least.
_LEAST_PAIRS = 1000

# Significance of a correlation of the noise. [std]
_CORRELATED = 3

# Residual of a pixel beyond which it gives no correlation: marks, steps. [std]
_OUTLIER = 5.0


def smooth_ratio(ratios: RatioImages, *, resolution: float) -> RatioImages:
    """Smooth ratio images, keeping steps and holes.

    Parameters
    ----------
    ratios : RatioImages
        log_ratio (..., y, x) with log_ratio_var, log_ratio_var_shared and flags. Flagged pixels
        are left out.
    resolution : float
        Full width at half maximum of the Gaussian window, at least 2. [px]

    Returns
    -------
    RatioImages
        log_ratio; log_ratio_var, the variance that remains, and where given log_ratio_var_fixed,
        lowered by the same factor. They carry the attribute `resolution` [px], over which
        neighbours are now correlated. Unchanged are log_ratio_var_shared, flags, flagged pixels,
        and pixels whose neighbourhood determines no plane.

    Raises
    ------
    ModelError
        If the resolution is below 2 px, where the window holds little but its own pixel.
    ErlifError
        If a variable is missing.

    Examples
    --------
    Away from the border, a window of standard deviation s leaves 1/(4 pi s^2) of the variance:

    >>> import xarray as xr
    >>> image = ("y", "x"), np.zeros((32, 32), np.float32)
    >>> ratios = RatioImages(xr.Dataset({
    ...     "log_ratio": image,
    ...     "log_ratio_var": (("y", "x"), np.full((32, 32), 1e-4, np.float32)),
    ...     "log_ratio_var_shared": image,
    ...     "flags": (("y", "x"), np.zeros((32, 32), np.uint16)),
    ... }))
    >>> smooth = smooth_ratio(ratios, resolution=5)
    >>> s = 5 / math.sqrt(8 * math.log(2))
    >>> round(float(smooth.log_ratio_var[16, 16]) / 1e-4 * 4 * math.pi * s**2, 1)
    1.0
    """
    require(ratios, "log_ratio", "log_ratio_var", "log_ratio_var_shared", "flags")
    if not (math.isfinite(resolution) and resolution >= 2):
        raise ModelError(
            f"Smoothing needs a resolution of at least 2 px; got {resolution:g}. Leave it out for "
            "no smoothing."
        )
    taps, step_noise = _gaussian_window(resolution)
    images = (-1, *ratios.log_ratio.shape[-2:])
    value, variance, shared = (
        np.ascontiguousarray(ratios[name].values, np.float32).reshape(images)
        for name in ("log_ratio", "log_ratio_var", "log_ratio_var_shared")
    )
    sound = (ratios.flags.values.reshape(images) == 0) & np.isfinite(value) & (variance > 0)

    smooth, remaining = value.copy(), variance.copy()
    for n in range(value.shape[0]):
        if sound[n].any():
            smooth[n], remaining[n] = _smooth_image(
                value[n], variance[n], shared[n], sound[n], taps, step_noise
            )

    smoothed = {"log_ratio": smooth, "log_ratio_var": remaining}
    if "log_ratio_var_fixed" in ratios:
        left = np.divide(remaining, variance, out=np.ones_like(variance), where=sound)
        smoothed["log_ratio_var_fixed"] = left * ratios.log_ratio_var_fixed.values.reshape(images)
    return RatioImages(
        ratios.assign(
            {
                name: ratios[name]
                .copy(data=image.reshape(ratios[name].shape))
                .assign_attrs(resolution=float(resolution))
                for name, image in smoothed.items()
            }
        )
    )


def _gaussian_window(resolution: float) -> tuple[Image, float]:
    """Window of a full width at half maximum [px], as `erlif.ratio.planes` reads it.

    And the mean reduction of the weighted sum of squares by a step in white noise. [1]
    """
    sigma = resolution / math.sqrt(8 * math.log(2))
    reach = math.ceil(_REACH * sigma)
    d = np.arange(-reach, reach + 1, dtype=float)
    window = np.exp(-0.5 * (d / sigma) ** 2)
    step = np.where(d >= 0, 1.0, -1.0)
    taps = np.stack(
        [
            *(window * d**n for n in range(3)),
            *(window**2 * d**n for n in range(3)),
            window * step,
            window * d * step,
        ]
    )

    # the step less its line; each axis contributes the square of the window over the window
    line = np.stack([np.ones_like(d), d])
    rest = step - line.T @ np.linalg.solve(window * line @ line.T, line @ (window * step))
    noise = (
        (window**2).sum() / window.sum() * (window**2 * rest**2).sum() / (window * rest**2).sum()
    )
    return taps.astype(np.float32), float(noise)


def _smooth_image(
    value: Image, variance: Image, shared: Image, sound: Mask, taps: Image, step_noise: float
) -> tuple[Image, Image]:
    """Value and variance of one image after smoothing."""
    smooth, remaining = value.copy(), variance.copy()
    reach = taps.shape[1] // 2
    middle = np.median(value[sound][::97])  # single precision is kept for the differences
    planes = weigh_pixels(value, variance, shared, sound, middle, reach)

    suspect = np.zeros(value.shape, np.uint8)
    limit = _SUSPECT**2 * step_noise
    fit_planes(planes, taps, limit, middle, smooth, remaining, suspect)
    factor = _correlation_factor(value, variance, smooth, sound, taps[0])

    # pixels with a step near enough for their window
    distances, limit = step_distances(reach), _SIGNIFICANT**2 * factor
    places = np.argwhere(suspect)
    on_step = np.zeros(value.shape, np.uint8)
    on_step[tuple(places[find_steps(planes, distances, places, limit)].T)] = 1
    if on_step.any():
        near = cv2.dilate(on_step, np.ones((2 * reach + 1, 2 * reach + 1), np.uint8)).astype(bool)
        places = np.argwhere(near & sound)
        fit_one_side(
            planes, taps[0], distances, places, limit, value, variance, middle, smooth, remaining
        )
        # again, because steps in the residuals look like correlated noise
        factor = _correlation_factor(value, variance, smooth, sound, taps[0])

    remaining[remaining < variance] *= factor
    return smooth, remaining


def _correlation_factor(
    value: Image, variance: Image, smooth: Image, sound: Mask, window: Image
) -> float:
    """Variance of a mean over the window, over that of independent pixels; 1 if not significant.

    The residuals of smoothing, r = n - S n for noise n and smoother S, have the autocovariance of n
    convolved with that of 1 - S. The latter is known, so that of n follows; it is taken to be zero
    beyond `_LAG` pixels.
    """
    every = max(1, value.size // _SAMPLED)
    sums, pairs = _correlate(value, variance, smooth, sound, _LAG, every)
    if pairs < _LEAST_PAIRS:
        return 1.0

    # autocovariance of 1 - S for white noise, up to the largest distance between two lags
    spread = 4 * _LAG
    kernel = window.astype(float) / window.sum(dtype=float)
    once, twice = _outer(kernel, spread), _outer(np.convolve(kernel, kernel), spread)
    residual = twice - 2 * once
    residual[spread, spread] += 1

    # that of the noise, by deconvolution
    lags = np.array([(y, x) for y in range(-_LAG, _LAG + 1) for x in range(-_LAG, _LAG + 1)])
    apart = lags[:, None] - lags + spread
    covariance = np.linalg.solve(residual[apart[..., 0], apart[..., 1]], sums.ravel())

    share = twice[lags[:, 0] + spread, lags[:, 1] + spread] / twice[spread, spread]
    factor = float(covariance @ share / covariance[lags.shape[0] // 2])
    noise = math.sqrt(2 * ((share**2).sum() - 1) / pairs)
    return factor if factor > 1 + _CORRELATED * noise else 1.0


def _outer(kernel: Array, spread: int) -> Array:
    """The function kernel(y) kernel(x), up to a distance from its middle."""
    half = min(spread, kernel.size // 2)
    middle = kernel.size // 2
    line = np.zeros(2 * spread + 1)
    line[spread - half : spread + half + 1] = kernel[middle - half : middle + half + 1]
    return np.outer(line, line)


@njit(nogil=True, cache=True)
def _correlate(value, variance, smooth, sound, lag, every):  # type: ignore[no-untyped-def]
    """Autocovariance of the residuals, in standard deviations, up to a lag; and their number."""
    height, width = value.shape
    sums = np.zeros((2 * lag + 1, 2 * lag + 1))
    pixels = 0
    rest = np.full((height, width), np.nan, np.float32)
    for i in range(height):
        for j in range(width):
            if sound[i, j]:
                r = (value[i, j] - smooth[i, j]) / np.sqrt(variance[i, j])
                if abs(r) < _OUTLIER:
                    rest[i, j] = r

    for i in range(lag, height - lag, every):
        for j in range(lag, width - lag):
            near = rest[i - lag : i + lag + 1, j - lag : j + lag + 1]
            if np.isfinite(near.sum()):
                pixels += 1
                for k in range(2 * lag + 1):
                    for m in range(2 * lag + 1):
                        sums[k, m] += near[lag, lag] * near[k, m]

    # the autocovariance is even
    return (sums + sums[::-1, ::-1]) / (2 * max(pixels, 1)), pixels
