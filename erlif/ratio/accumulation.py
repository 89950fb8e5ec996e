"""Ratio images of several frames, combined with inverse-variance weights."""

from __future__ import annotations

from dataclasses import dataclass, field

import numba
import numpy as np
import xarray as xr

from erlif.core.arrays import Array, Image, Mask
from erlif.core.flags import FLAG_ATTRS
from erlif.core.neighbourhood import mean_of_surroundings
from erlif.core.products import RatioImages, require


@dataclass
class RatioSum:
    """Frames of one trigger, added up with inverse-variance weights without keeping them.

    Every cycle sees the trigger anew; shot and read noise average out, the noise of dark and flat and the registration error
    do not. The variance that decides the weights is that of a pixel's surroundings: its own goes with its noise, and a mean weighted
    by it would be biased. A pixel is answered if any of its frames is; one that none answers keeps the flags of all.
    """

    shape: tuple[int, int]
    frames: int = 0
    weight: Array = field(init=False)
    total: Array = field(init=False)
    random: Array = field(init=False)
    fixed: Array = field(init=False)
    shared: Array = field(init=False)
    correlation: float = 0.0
    flags: Mask = field(init=False)
    answered: Mask = field(init=False)

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
