"""Ratio images of several frames, combined with inverse-variance weights."""

from __future__ import annotations

from dataclasses import dataclass, field

import numba
import numpy as np
import xarray as xr

from erlif.core.arrays import Array, FlagImage, Image, Mask
from erlif.core.flags import FLAG_ATTRS
from erlif.core.neighbourhood import mean_of_surroundings
from erlif.core.products import RatioImages, require


@dataclass
class RatioSum:
    """Frames of one trigger, summed with inverse-variance weights without keeping them.

    Shot and read noise are new in every frame and average out; the noise of dark and flat and the
    registration error do not. The weight of a pixel follows from the mean variance of its
    surroundings. Its own variance is correlated with its noise, and a mean weighted by it would be
    biased. A pixel is valid if it is valid in any frame; otherwise it keeps the flags of all.

    Attributes
    ----------
    shape : tuple[int, int]
        Rows and columns of the images. [px]
    frames : int
        Frames that were added.
    weight : Array
        Sum of the weights w, (y, x). [1]
    total : Array
        Sum of w times log_ratio, (y, x). [1]
    total_var : Array
        Sum of w^2 times the variance that is new in every frame, (y, x). [1]
    total_var_fixed : Array
        Sum of w times the variance that repeats from frame to frame, (y, x). [1]
    total_var_shared : Array
        Sum of w times the variance by the registration, (y, x). [1]
    correlation : float
        Sum of the noise correlation of the frames. [1]
    flags : FlagImage
        Flags of all frames, (y, x).
    valid : Mask
        Pixels that are valid in a frame at least, (y, x).

    Examples
    --------
    Without frames no pixel is valid, and the mean is NaN:

    >>> total = RatioSum((480, 640))
    >>> int(total.valid.sum()), float(total.mean().log_ratio[240, 320])
    (0, nan)
    """

    shape: tuple[int, int]
    frames: int = 0
    weight: Array = field(init=False)
    total: Array = field(init=False)
    total_var: Array = field(init=False)
    total_var_fixed: Array = field(init=False)
    total_var_shared: Array = field(init=False)
    correlation: float = 0.0
    flags: FlagImage = field(init=False)
    valid: Mask = field(init=False)

    def __post_init__(self) -> None:
        """Set the sums to zero."""
        self.weight, self.total, self.total_var, self.total_var_fixed, self.total_var_shared = (
            np.zeros(self.shape) for _ in range(5)
        )
        self.flags = np.zeros(self.shape, np.uint8)
        self.valid = np.zeros(self.shape, bool)

    def add(self, ratios: RatioImages) -> None:
        """Add ratio images of the same trigger.

        Parameters
        ----------
        ratios : RatioImages
            log_ratio (frame, y, x) with its variances and flags, and noise_correlation (frame).

        Raises
        ------
        ErlifError
            If a variable is missing.
        """
        require(
            ratios,
            "log_ratio",
            "log_ratio_var",
            "log_ratio_var_fixed",
            "log_ratio_var_shared",
            "flags",
        )
        correlated = "noise_correlation" in ratios
        for n in range(ratios.sizes["frame"]):
            self.frames += 1
            self.correlation += float(ratios.noise_correlation[n]) if correlated else 1.0

            _add_frame(
                ratios.log_ratio.values[n],
                self.weigh(ratios, n),
                _new_variance(ratios, n),
                ratios.log_ratio_var_fixed.values[n],
                ratios.log_ratio_var_shared.values[n],
                ratios.flags.values[n],
                self.weight,
                self.total,
                self.total_var,
                self.total_var_fixed,
                self.total_var_shared,
                self.flags,
                self.valid,
            )

    @staticmethod
    def weigh(ratios: RatioImages, frame: int) -> Image:
        """Weights of the pixels of a frame.

        Parameters
        ----------
        ratios : RatioImages
            log_ratio_var, log_ratio_var_fixed and flags (frame, y, x).
        frame : int
            Position of the frame among them.

        Returns
        -------
        array, (y, x)
            One over the mean of the surroundings of the variance that is new in this frame; 0 where
            the pixel is flagged. [1]
        """
        sound = ratios.flags.values[frame] == 0
        expected = mean_of_surroundings(_new_variance(ratios, frame), sound)
        return np.divide(1, expected, out=np.zeros(sound.shape, np.float32), where=sound)

    def mean(self) -> RatioImages:
        """Weighted mean of the frames that were added.

        Returns
        -------
        RatioImages
            Without a frame dimension; NaN with the flags of all frames where a pixel is valid in
            none.
        """
        # the variance of independent errors falls with the weights, that of repeated ones does not
        with np.errstate(divide="ignore", invalid="ignore"):
            var_fixed = self.total_var_fixed / self.weight
            means = {
                "log_ratio": self.total / self.weight,
                "log_ratio_var": self.total_var / self.weight**2 + var_fixed,
                "log_ratio_var_fixed": var_fixed,
                "log_ratio_var_shared": self.total_var_shared / self.weight,
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
        flags = np.where(self.valid, 0, self.flags).astype(np.uint8)
        correlation = ((), self.correlation / max(self.frames, 1), {"units": "1"})
        return RatioImages(
            xr.Dataset(
                images | {"flags": (dims, flags, FLAG_ATTRS), "noise_correlation": correlation}
            )
        )


def _new_variance(ratios: RatioImages, frame: int) -> Image:
    """Variance of the pixels of a frame without the part that repeats from frame to frame."""
    variance = ratios.log_ratio_var.values[frame] - ratios.log_ratio_var_fixed.values[frame]
    return np.asarray(variance)


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
    total_var,
    total_var_fixed,
    total_var_shared,
    flags,
    valid,
):
    """Add the first six images to the sums in the others."""
    for i in range(log_ratio.shape[0]):
        for j in range(log_ratio.shape[1]):
            flags[i, j] |= flag[i, j]
            if flag[i, j] == 0:
                w = frame_weight[i, j]
                weight[i, j] += w
                total[i, j] += w * log_ratio[i, j]
                valid[i, j] = True

                # errors of one frame add in quadrature, those common to all frames linearly
                total_var[i, j] += w * w * variance[i, j]
                total_var_fixed[i, j] += w * variance_fixed[i, j]
                total_var_shared[i, j] += w * variance_shared[i, j]


def combine_frames(ratios: RatioImages) -> RatioImages:
    """Inverse-variance mean over the frame dimension.

    `RatioSum` does the same for frames that do not fit into memory together.

    Parameters
    ----------
    ratios : RatioImages
        log_ratio (frame, y, x) of one trigger with its variances and flags.

    Returns
    -------
    RatioImages
        log_ratio (y, x) with its variances and flags.

    Raises
    ------
    ErlifError
        If a variable is missing.

    Examples
    --------
    A frame with a quarter of the variance has four times the weight:

    >>> dims = ("frame", "y", "x")
    >>> variance = np.ones((2, 4, 4)) * [[[4e-4]], [[1e-4]]]
    >>> ratios = RatioImages(xr.Dataset({
    ...     "log_ratio": (dims, np.ones((2, 4, 4)) * [[[0.5]], [[1.0]]]),
    ...     "log_ratio_var": (dims, variance),
    ...     "log_ratio_var_fixed": (dims, np.zeros((2, 4, 4))),
    ...     "log_ratio_var_shared": (dims, np.zeros((2, 4, 4))),
    ...     "flags": (dims, np.zeros((2, 4, 4), np.uint8)),
    ... }))
    >>> mean = combine_frames(ratios)
    >>> round(float(mean.log_ratio[0, 0]), 6), round(float(mean.log_ratio_var[0, 0]), 6)
    (0.9, 8e-05)
    """
    height, width = ratios.sizes["y"], ratios.sizes["x"]
    total = RatioSum((height, width))
    total.add(ratios)
    return total.mean()
