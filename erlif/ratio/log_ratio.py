"""Camera 2 over camera 1: the quantity that depends on the film and not on the laser.

The ratio travels as its natural logarithm. Its noise is nearly Gaussian there, its standard deviation is the relative error of
the ratio, and swapping the cameras only changes its sign.
"""

from __future__ import annotations

import numba
import numpy as np
import xarray as xr

from erlif.core.flags import FLAG_ATTRS, Flag
from erlif.core.products import AlignedFrames, RatioImages, require
from erlif.ratio.bubbles import find_bubbles
from erlif.ratio.sharpness import BlurDifference, take_out_ghost

_DIM, _NO_FILM = int(Flag.DIM), int(Flag.NO_FILM)


def compute_ratio(
    frames: AlignedFrames, *, no_film_below: float = 0.25, blur: BlurDifference | None = None
) -> RatioImages:
    """Logarithm of camera 2 / camera 1 with its variance and flags.

    The logarithm of a noisy signal is too small by half its relative variance; each camera's share is put back, so that the
    answer is unbiased to second order.

    Parameters
    ----------
    frames : AlignedFrames
        signal and signal_var (camera, frame, y, x), flags, displacement_std (y, x).
    no_film_below : float
        Where the light of both cameras is below this share of its surroundings, the pixel and its neighbours are flagged
        no_film: a bubble, or a bare wall.
    blur : BlurDifference, optional
        By how much camera 2 is less sharp; the ghost of the speckle that this leaves in the ratio is taken out.

    Returns
    -------
    RatioImages
        log_ratio (frame, y, x) [1], log_ratio_var (random part), log_ratio_var_fixed (what of it dark and flat bring, the same
        in every frame), log_ratio_var_shared (registration), flags, and
        signal_camera1 [DN], from which the pulse energy is judged; noise_correlation (frame), by how much the variance of a mean over
        many pixels exceeds that of independent ones, because the interpolation of camera 2 spreads their noise.
    """
    require(frames, "signal", "signal_var", "signal_var_fixed", "flags", "displacement_std")
    signal, variance, flags = frames.signal.values, frames.signal_var.values, frames.flags.values
    variance_fixed = frames.signal_var_fixed.values
    shape = signal.shape[1:]
    log_ratio, random, fixed, shared = (np.empty(shape, np.float32) for _ in range(4))
    correlation = np.ones(shape[0])
    flag = flags[0] | flags[1]
    displacement_std = frames.displacement_std.values
    for n in range(shape[0]):
        one, two = signal[:, n]
        share_of_two = _log_ratio(
            one,
            two,
            variance[0, n],
            variance[1, n],
            variance_fixed[0, n],
            variance_fixed[1, n],
            log_ratio[n],
            random[n],
            fixed[n],
            flag[n],
        )
        if "interpolation" in frames:
            correlation[n] = 1 + share_of_two * (1 / float(frames.interpolation[n]) - 1)
        if blur is not None and blur.significant:
            take_out_ghost(log_ratio[n], one, two, blur.x, blur.y)
        flag[n][find_bubbles(one, two, share=no_film_below)] |= _NO_FILM
        shared[n] = (displacement_std * log_gradient(two)) ** 2
    dims = ("frame", "y", "x")
    return RatioImages(
        xr.Dataset(
            {
                "log_ratio": (
                    dims,
                    log_ratio,
                    {"units": "1", "ancillary_variables": "log_ratio_var flags"},
                ),
                "log_ratio_var": (dims, random, {"units": "1"}),
                "log_ratio_var_fixed": (dims, fixed, {"units": "1"}),
                "log_ratio_var_shared": (dims, shared, {"units": "1"}),
                "flags": (dims, flag, FLAG_ATTRS),
                "signal_camera1": (dims, signal[0], {"units": "DN"}),
                "noise_correlation": ("frame", correlation, {"units": "1"}),
            },
            {name: value for name, value in frames.coords.items() if "camera" not in value.dims},
        )
    )


@numba.njit(nogil=True, cache=True)
def _log_ratio(one, two, one_var, two_var, one_fixed, two_fixed, log_ratio, variance, fixed, flag):  # type: ignore[no-untyped-def]
    """Fill the last four arguments; returns the share that camera 2 has in the variance of the unflagged pixels."""
    total, of_two = 0.0, 0.0
    for i in range(one.shape[0]):
        for j in range(one.shape[1]):
            a, b = one[i, j], two[i, j]
            if a > 0.0 and b > 0.0:
                relative_one = (one_var[i, j] + one_fixed[i, j]) / (a * a)
                relative_two = (two_var[i, j] + two_fixed[i, j]) / (b * b)
                log_ratio[i, j] = np.log(b / a) + 0.5 * (relative_two - relative_one)
                variance[i, j] = relative_one + relative_two
                fixed[i, j] = one_fixed[i, j] / (a * a) + two_fixed[i, j] / (b * b)
                if flag[i, j] == 0:
                    total += relative_one + relative_two
                    of_two += relative_two
            else:
                log_ratio[i, j] = np.nan
                variance[i, j] = np.nan
                fixed[i, j] = np.nan
                if flag[i, j] == 0:
                    flag[i, j] |= _DIM
    return of_two / total if total > 0.0 else 0.0


@numba.njit(nogil=True, cache=True)
def log_gradient(signal):  # type: ignore[no-untyped-def]
    """Size of the gradient of the logarithm of an image, by Sobel's operator. [1/px]

    Parameters
    ----------
    signal : array, (y, x)
        Light; about a pixel that is not positive or not finite the image counts as level, and so it does at the border.
    """
    height, width = signal.shape
    size = np.zeros((height, width), np.float32)
    for i in range(1, height - 1):
        for j in range(1, width - 1):
            a, b, c = signal[i - 1, j - 1], signal[i - 1, j], signal[i - 1, j + 1]
            d, e, f = signal[i, j - 1], signal[i, j], signal[i, j + 1]
            g, h, k = signal[i + 1, j - 1], signal[i + 1, j], signal[i + 1, j + 1]
            along_x = (c - a) + 2 * (f - d) + (k - g)
            along_y = (g - a) + 2 * (h - b) + (k - c)
            # over a few pixels the light changes little, so its relative gradient is that of the logarithm
            mean = (a + c + g + k + 2 * (b + d + f + h) + 4 * e) * np.float32(0.5)
            if mean > 0:  # false for NaN
                size[i, j] = np.sqrt(along_x * along_x + along_y * along_y) / mean
    return size
