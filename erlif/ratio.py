"""Camera 2 over camera 1: the quantity that depends on the film and not on the laser.

The ratio travels as its natural logarithm. Its noise is nearly Gaussian there, its standard deviation is the relative error of
the ratio, and swapping the cameras only changes its sign.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import cv2
import numba
import numpy as np
import numpy.typing as npt
import xarray as xr
from scipy import ndimage

from erlif.core.flags import FLAG_ATTRS, Flag
from erlif.core.products import AlignedFrames, RatioImages, require
from erlif.sharpness import BlurDifference, take_out_ghost

Image = npt.NDArray[np.float32]
Mask = npt.NDArray[np.uint8]

_DIM, _NO_FILM = int(Flag.DIM), int(Flag.NO_FILM)

_NEAR = 9  # width of the surroundings of a pixel, if not said otherwise [px]
_BLOCK, _REACH = 8, 9  # surroundings of a bubble: the median of 9 x 9 blocks of 8 px


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


def find_bubbles(one: Image, two: Image, *, share: float, margin: int = 3) -> npt.NDArray[np.bool_]:
    """Find where fluorescence is missing from both cameras.

    Parameters
    ----------
    one, two : array, (y, x)
        Light of the two cameras on one grid; NaN counts as lit.
    share : float
        A pixel counts as dark below this share of the median light about it, taken over 9 x 9 blocks of 8 px.
    margin : int
        Pixels about a dark patch that are taken for its meniscus.

    Returns
    -------
    array of bool, (y, x)
    """
    blocks = _block_light(one, two, _BLOCK)
    known = np.isfinite(blocks)
    if not known.any():
        return np.zeros(one.shape, bool)
    surroundings = ndimage.median_filter(
        np.where(known, blocks, np.median(blocks[known])), size=_REACH, mode="nearest"
    )
    dark = _below(one, two, share * surroundings, _BLOCK)
    if not dark.any():
        return np.asarray(dark, bool)
    disc = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (2 * margin + 1, 2 * margin + 1))
    return cv2.dilate(dark, disc).astype(bool)


def is_steep(signal: Image, *, limit: float = 0.04) -> npt.NDArray[np.bool_]:
    """Find where the film itself makes the light steep, as at the thin end of a wedge.

    There the two bands rise differently, because the ratio does, and a registration that took the rise for texture would
    shift one camera against the other.

    Parameters
    ----------
    signal : array, (y, x)
        Light of one camera.
    limit : float
        Relative rise over blocks of 8 px above which a block counts as steep. [1/px]

    Returns
    -------
    array of bool, (y, x)
    """
    blocks = np.log(np.maximum(np.nan_to_num(_block_light(signal, signal, _BLOCK)), 1e-3))
    rise = np.hypot(*np.gradient(ndimage.median_filter(blocks, size=3, mode="nearest"))) / _BLOCK
    steep = np.repeat(np.repeat(rise > limit, _BLOCK, axis=0), _BLOCK, axis=1)
    return np.asarray(steep[: signal.shape[0], : signal.shape[1]])


@numba.njit(nogil=True, cache=True)
def _block_light(one, two, block):  # type: ignore[no-untyped-def]
    """Mean light of both cameras in each block; NaN where no pixel is known."""
    height, width = one.shape
    rows, columns = (height + block - 1) // block, (width + block - 1) // block
    total = np.zeros((rows, columns), np.float32)
    count = np.zeros((rows, columns), np.float32)
    for i in range(height):
        for j in range(width):
            light = one[i, j] + two[i, j]
            if np.isfinite(light):
                total[i // block, j // block] += light
                count[i // block, j // block] += 1
    for i in range(rows):
        for j in range(columns):
            total[i, j] = total[i, j] / count[i, j] if count[i, j] > 0 else np.nan
    return total


@numba.njit(nogil=True, cache=True)
def _below(one, two, limit, block):  # type: ignore[no-untyped-def]
    """Pixels whose light is below `limit`, given per block and interpolated between the centres of blocks."""
    height, width = one.shape
    rows, columns = limit.shape
    dark = np.zeros((height, width), np.uint8)
    for i in range(height):
        y = min(max((i + 0.5) / block - 0.5, 0.0), rows - 1.0)
        k = min(int(y), rows - 2)
        v = y - k
        for j in range(width):
            x = min(max((j + 0.5) / block - 0.5, 0.0), columns - 1.0)
            m = min(int(x), columns - 2)
            u = x - m
            top = limit[k, m] + u * (limit[k, m + 1] - limit[k, m])
            bottom = limit[k + 1, m] + u * (limit[k + 1, m + 1] - limit[k + 1, m])
            if one[i, j] + two[i, j] < top + v * (bottom - top):
                dark[i, j] = 1
    return dark


def mean_of_surroundings(
    image: Image, sound: npt.NDArray[np.bool_], *, width: int = _NEAR, without: int = 0
) -> Image:
    """Mean of the sound pixels in a square about each pixel; NaN where there are none.

    Parameters
    ----------
    image : array, (y, x)
    sound : array of bool, (y, x)
        Pixels that count.
    width : int
        Of the square. [px]
    without : int
        Width of the middle of the square that is left out. [px]
    """
    # about the middle, because the sums are taken in single precision
    middle = np.float32(np.median(image[sound][::97])) if sound.any() else np.float32(0)
    values, count = np.where(sound, image - middle, np.float32(0)), sound.astype(np.float32)
    total, count = (
        _box(plane, width) - (_box(plane, without) if without else 0) for plane in (values, count)
    )
    return np.where(count > 0.5, middle + total / np.maximum(count, 1), np.float32(np.nan))


def _box(image: Image, width: int) -> Image:
    summed = cv2.boxFilter(
        image, -1, (width, width), normalize=False, borderType=cv2.BORDER_CONSTANT
    )
    return np.asarray(summed, np.float32)


@dataclass
class RatioSum:
    """Frames of one trigger, added up with inverse-variance weights without keeping them.

    Every cycle sees the trigger anew; shot and read noise average out, the noise of dark and flat and the registration error
    do not. The variance that decides the weights is that of a pixel's surroundings: its own goes with its noise, and a mean weighted
    by it would be biased. A pixel is answered if any of its frames is; one that none answers keeps the flags of all.
    """

    shape: tuple[int, int]
    frames: int = 0
    weight: npt.NDArray[np.float64] = field(init=False)
    total: npt.NDArray[np.float64] = field(init=False)
    random: npt.NDArray[np.float64] = field(init=False)
    fixed: npt.NDArray[np.float64] = field(init=False)
    shared: npt.NDArray[np.float64] = field(init=False)
    correlation: float = 0.0
    flags: Mask = field(init=False)
    answered: npt.NDArray[np.bool_] = field(init=False)

    def __post_init__(self) -> None:
        """Start from nothing."""
        self.weight, self.total, self.random, self.fixed, self.shared = (
            np.zeros(self.shape) for _ in range(5)
        )
        self.flags = np.zeros(self.shape, np.uint8)
        self.answered = np.zeros(self.shape, bool)

    def add(self, ratios: RatioImages) -> None:
        """Add ratio images (frame, y, x) of the same trigger."""
        require(
            ratios,
            "log_ratio",
            "log_ratio_var",
            "log_ratio_var_fixed",
            "log_ratio_var_shared",
            "flags",
        )
        for n in range(ratios.sizes["frame"]):
            fixed = ratios.log_ratio_var_fixed.values[n]
            _add_frame(
                ratios.log_ratio.values[n],
                self.weigh(ratios, n),
                ratios.log_ratio_var.values[n] - fixed,
                fixed,
                ratios.log_ratio_var_shared.values[n],
                ratios.flags.values[n],
                self.weight,
                self.total,
                self.random,
                self.fixed,
                self.shared,
                self.flags,
                self.answered,
            )
            self.frames += 1
            self.correlation += (
                float(ratios.noise_correlation[n]) if "noise_correlation" in ratios else 1.0
            )

    @staticmethod
    def weigh(ratios: RatioImages, frame: int) -> Image:
        """Weight of each pixel of a frame: one over the variance, new in this frame, of its surroundings; 0 where it is flagged."""
        sound = ratios.flags.values[frame] == 0
        variance = ratios.log_ratio_var.values[frame] - ratios.log_ratio_var_fixed.values[frame]
        expected = mean_of_surroundings(variance, sound)
        return np.divide(1, expected, out=np.zeros(sound.shape, np.float32), where=sound)

    def mean(self) -> RatioImages:
        """Weighted mean of what was added, as RatioImages without a frame dimension."""
        with np.errstate(divide="ignore", invalid="ignore"):
            means = {
                "log_ratio": self.total / self.weight,
                "log_ratio_var": self.random / self.weight**2 + self.fixed / self.weight,
                "log_ratio_var_fixed": self.fixed / self.weight,
                "log_ratio_var_shared": self.shared / self.weight,
            }
        dims = ("y", "x")
        images = {
            name: (
                dims,
                np.where(self.weight > 0, image, np.nan).astype(np.float32),
                {"units": "1"},
            )
            for name, image in means.items()
        }
        flags = np.where(self.answered, 0, self.flags).astype(np.uint8)
        correlation = ((), self.correlation / max(self.frames, 1), {"units": "1"})
        return RatioImages(
            xr.Dataset(
                images | {"flags": (dims, flags, FLAG_ATTRS), "noise_correlation": correlation}
            )
        )


@numba.njit(nogil=True, cache=True)
def _add_frame(  # type: ignore[no-untyped-def]
    log_ratio,
    frame_weight,
    variance,
    variance_fixed,
    variance_shared,
    flag,
    weight,
    total,
    random,
    fixed,
    shared,
    flags,
    answered,
):
    """Weight each frame by what is new in it; the fixed part is weighted along and divided out at the end."""
    for i in range(log_ratio.shape[0]):
        for j in range(log_ratio.shape[1]):
            flags[i, j] |= flag[i, j]
            if flag[i, j] == 0:
                w = frame_weight[i, j]
                weight[i, j] += w
                total[i, j] += w * log_ratio[i, j]
                random[i, j] += w * w * variance[i, j]
                fixed[i, j] += w * variance_fixed[i, j]
                shared[i, j] += w * variance_shared[i, j]
                answered[i, j] = True


def combine_frames(ratios: RatioImages) -> RatioImages:
    """Inverse-variance mean over the frame dimension; see `RatioSum` for frames that do not fit into memory together."""
    height, width = ratios.sizes["y"], ratios.sizes["x"]
    total = RatioSum((height, width))
    total.add(ratios)
    return total.mean()
