"""Logarithm of camera 2 over camera 1, which depends on the film and not on the laser.

The noise of the logarithm is nearly Gaussian, its standard deviation is the relative error of the
ratio, and exchanged cameras change its sign alone.
"""

from __future__ import annotations

import numba
import numpy as np
import xarray as xr

from erlif.core.arrays import Image
from erlif.core.flags import FLAG_ATTRS, Flag
from erlif.core.products import AlignedFrames, RatioImages, require
from erlif.ratio.bubbles import find_bubbles
from erlif.ratio.sharpness import BlurDifference, take_out_ghost

_DIM, _NO_FILM = int(Flag.DIM), int(Flag.NO_FILM)


def compute_ratio(
    frames: AlignedFrames, *, no_film_below: float = 0.25, blur: BlurDifference | None = None
) -> RatioImages:
    """Logarithm of camera 2 over camera 1 with its variance and flags.

    The logarithm of a noisy signal is too small by half its relative variance. This is corrected
    for each camera, so that the result is unbiased to second order.

    Parameters
    ----------
    frames : AlignedFrames
        signal, signal_var, signal_var_fixed and flags (camera, frame, y, x), displacement_std
        (y, x), and interpolation (frame) where camera 2 was interpolated.
    no_film_below : float
        Share of the light of its surroundings below which a pixel is flagged no_film with its
        neighbours: a bubble, or bare wall. [1]
    blur : BlurDifference, optional
        Difference of sharpness, whose ghost of the speckle is subtracted from the ratio.

    Returns
    -------
    RatioImages
        log_ratio (frame, y, x), its variances and flags; noise_correlation (frame), above 1 where
        the interpolation of camera 2 correlates the noise of neighbours [1]; signal_camera1, light
        of camera 1 for the energy of the pulse [DN].

    Raises
    ------
    ErlifError
        If a variable is missing.

    Examples
    --------
    Light of 4000 and 2000 DN with 1 % noise each:

    >>> dims = ("camera", "frame", "y", "x")
    >>> light = np.ones((2, 1, 16, 16), np.float32) * np.reshape([4000, 2000], (2, 1, 1, 1))
    >>> frames = AlignedFrames(xr.Dataset({
    ...     "signal": (dims, light),
    ...     "signal_var": (dims, 1e-4 * light**2),
    ...     "signal_var_fixed": (dims, np.zeros_like(light)),
    ...     "flags": (dims, np.zeros(light.shape, np.uint8)),
    ...     "displacement_std": (("y", "x"), np.zeros((16, 16))),
    ... }))
    >>> ratios = compute_ratio(frames)
    >>> round(float(np.exp(ratios.log_ratio[0, 8, 8])), 4)
    0.5
    >>> round(float(np.sqrt(ratios.log_ratio_var[0, 8, 8])), 5)
    0.01414
    """
    require(frames, "signal", "signal_var", "signal_var_fixed", "flags", "displacement_std")
    signal, variance, flags = frames.signal.values, frames.signal_var.values, frames.flags.values
    variance_fixed = frames.signal_var_fixed.values
    displacement_std = frames.displacement_std.values

    shape = signal.shape[1:]
    log_ratio, var, var_fixed, var_shared = (np.empty(shape, np.float32) for _ in range(4))
    correlation = np.ones(shape[0])
    flag = flags[0] | flags[1]
    for n in range(shape[0]):
        one, two = signal[:, n]
        share_of_two = _log_ratio(
            one,
            two,
            variance[:, n],
            variance_fixed[:, n],
            log_ratio[n],
            var[n],
            var_fixed[n],
            flag[n],
        )

        # interpolation lowers the variance of single pixels of camera 2, not that of their mean
        if "interpolation" in frames:
            correlation[n] = 1 + share_of_two * (1 / float(frames.interpolation[n]) - 1)
        if blur is not None and blur.significant:
            take_out_ghost(log_ratio[n], one, two, blur.x, blur.y)
        flag[n][find_bubbles(one, two, share=no_film_below)] |= _NO_FILM
        var_shared[n] = (displacement_std * log_gradient(two)) ** 2

    dims = ("frame", "y", "x")
    ancillary = {"ancillary_variables": "log_ratio_var flags"}
    return RatioImages(
        xr.Dataset(
            {
                "log_ratio": (dims, log_ratio, {"units": "1"} | ancillary),
                "log_ratio_var": (dims, var, {"units": "1"}),
                "log_ratio_var_fixed": (dims, var_fixed, {"units": "1"}),
                "log_ratio_var_shared": (dims, var_shared, {"units": "1"}),
                "flags": (dims, flag, FLAG_ATTRS),
                "signal_camera1": (dims, signal[0], {"units": "DN"}),
                "noise_correlation": ("frame", correlation, {"units": "1"}),
            },
            {name: value for name, value in frames.coords.items() if "camera" not in value.dims},
        )
    )


@numba.njit(nogil=True, cache=True)
def _log_ratio(  # type: ignore[no-untyped-def]
    one, two, var, var_fixed, log_ratio, ratio_var, ratio_var_fixed, flag
):
    """Fill the last four arguments; return the share of camera 2 in the variance of valid pixels.

    Variances of the light are those of cameras 1 and 2, (camera, y, x).
    """
    total, of_two = 0.0, 0.0
    for i in range(one.shape[0]):
        for j in range(one.shape[1]):
            a, b = one[i, j], two[i, j]
            if not (a > 0.0 and b > 0.0):
                log_ratio[i, j] = np.nan
                ratio_var[i, j] = np.nan
                ratio_var_fixed[i, j] = np.nan
                if flag[i, j] == 0:
                    flag[i, j] |= _DIM
                continue

            # the mean of log(1 + e) is -var(e)/2 for a small relative error e
            relative_one = (var[0, i, j] + var_fixed[0, i, j]) / (a * a)
            relative_two = (var[1, i, j] + var_fixed[1, i, j]) / (b * b)
            log_ratio[i, j] = np.log(b / a) + 0.5 * (relative_two - relative_one)
            ratio_var[i, j] = relative_one + relative_two
            ratio_var_fixed[i, j] = var_fixed[0, i, j] / (a * a) + var_fixed[1, i, j] / (b * b)
            if flag[i, j] == 0:
                total += relative_one + relative_two
                of_two += relative_two
    return of_two / total if total > 0.0 else 0.0


def log_gradient(signal: Image) -> Image:
    """Size of the gradient of the logarithm of an image, by Sobel's operator.

    Parameters
    ----------
    signal : array, (y, x)
        Light. [DN]

    Returns
    -------
    array, (y, x)
        0 at the border, and beside a pixel that is not positive or not finite. [1/px]

    Examples
    --------
    >>> x = np.arange(6) * np.ones((3, 1))
    >>> np.round(log_gradient(np.exp(0.05 * x).astype(np.float32))[1], 3)
    array([0.  , 0.05, 0.05, 0.05, 0.05, 0.  ], dtype=float32)
    """
    return np.asarray(_log_gradient(signal))


@numba.njit(nogil=True, cache=True)
def _log_gradient(signal):  # type: ignore[no-untyped-def]
    height, width = signal.shape
    size = np.zeros((height, width), np.float32)
    for i in range(1, height - 1):
        for j in range(1, width - 1):
            a, b, c = signal[i - 1, j - 1], signal[i - 1, j], signal[i - 1, j + 1]
            d, e, f = signal[i, j - 1], signal[i, j], signal[i, j + 1]
            g, h, k = signal[i + 1, j - 1], signal[i + 1, j], signal[i + 1, j + 1]
            along_x = (c - a) + 2 * (f - d) + (k - g)
            along_y = (g - a) + 2 * (h - b) + (k - c)

            # light changes little over three pixels: its relative gradient is that of the logarithm
            mean = (a + c + g + k + 2 * (b + d + f + h) + 4 * e) * np.float32(0.5)
            if mean > 0:  # false for NaN
                size[i, j] = np.sqrt(along_x * along_x + along_y * along_y) / mean
    return size
