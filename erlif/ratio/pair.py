"""The ratio of one frame pair as plain arrays, as the pipeline hands it on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr

from erlif.core.arrays import AnyArray, FlagImage, Image
from erlif.core.flags import FLAG_ATTRS
from erlif.core.products import RatioImages

# Names of the images in a dataset, and their fields.
_IMAGES = {
    "log_ratio": "log_ratio",
    "log_ratio_var": "variance",
    "log_ratio_var_fixed": "variance_fixed",
    "log_ratio_var_shared": "variance_shared",
}

# Stands for cameras all of whose pixels are lit.
NO_DARK = ((float("nan"), float("nan")),) * 2


@dataclass(frozen=True)
class PairRatio:
    """Logarithm of camera 2 over camera 1 of one frame pair; every image is (y, x).

    Attributes
    ----------
    log_ratio : Image
        NaN where a camera has no light. [1]
    variance : Image
        Variance of a pixel without that of the registration; it includes variance_fixed. [1]
    variance_fixed : Image
        Part of the variance that repeats from frame to frame: dark and flat; fewer rows where it
        is not asked for. [1]
    variance_shared : Image
        Variance by the registration, common to neighbouring pixels. [1]
    flags : FlagImage
        Bits of `erlif.core.flags.Flag`.
    light_one : Image
        Light of camera 1. [DN]
    noise_correlation : float
        Variance of a mean over many pixels, relative to that of independent pixels. [1]
    drift : tuple[float, float]
        Drift (x, y) of camera 2, NaN where the cameras show no common texture. [px]
    peaks : tuple[int, int]
        Highest counts of camera 1 and camera 2. [DN]
    digests : tuple[str, str]
        SHA-256 of the files, hexadecimal; empty where it is not known.
    dark : tuple[tuple[float, float], ...]
        Mean [DN] and variance [DN2] of the pixels of each camera that no light reaches, dark
        subtracted, (camera, 2); NaN without such pixels.
    sharpness : tuple[float, float]
        Of camera 1 and camera 2, as `measure_sharpness`; NaN where it is not known. [1]
    spare : tuple[Image, ...]
        Three images of the same shape whose content is not needed any more; `measure_film` fills
        them. They may be log_ratio, variance and variance_shared.
    """

    log_ratio: Image
    variance: Image
    variance_fixed: Image
    variance_shared: Image
    flags: FlagImage
    light_one: Image
    noise_correlation: float = 1.0
    drift: tuple[float, float] = (0.0, 0.0)
    peaks: tuple[int, int] = (0, 0)
    digests: tuple[str, str] = ("", "")
    dark: tuple[tuple[float, float], ...] = NO_DARK
    sharpness: tuple[float, float] = (float("nan"), float("nan"))
    spare: tuple[Image, ...] = ()

    @property
    def images(self) -> tuple[Image, Image, Image, Image, FlagImage]:
        """Log ratio, its three variances and the flags."""
        variances = self.variance, self.variance_fixed, self.variance_shared
        return self.log_ratio, *variances, self.flags

    @classmethod
    def of(cls, ratios: RatioImages, frame: int = 0) -> PairRatio:
        """One frame of ratio images.

        Parameters
        ----------
        ratios : RatioImages
            On dim frame, as `erlif.ratio.compute_ratio` returns them.
        frame : int
            Position on dim frame.

        Returns
        -------
        PairRatio
            Without drift, peaks and digests, which images do not have.
        """

        def image(name: str) -> Image:
            return np.ascontiguousarray(ratios[name].values[frame], np.float32)

        # a mean over frames has no light of its own
        log_ratio, variance, fixed, shared = (image(name) for name in _IMAGES)
        known = "signal_camera1" in ratios
        return cls(
            log_ratio,
            variance,
            fixed,
            shared,
            ratios.flags.values[frame],
            image("signal_camera1") if known else np.full_like(log_ratio, np.nan),
            float(ratios.noise_correlation[frame]) if "noise_correlation" in ratios else 1.0,
        )

    def to_images(self) -> RatioImages:
        """Convert to a dataset with one frame, as the stages after the ratio take it.

        Returns
        -------
        RatioImages
            As `erlif.ratio.compute_ratio` returns them.
        """
        return gather_ratios([self])


def gather_ratios(pairs: Sequence[PairRatio]) -> RatioImages:
    """Ratios of frame pairs as a dataset on dim frame, without coordinates.

    Parameters
    ----------
    pairs : sequence of PairRatio

    Returns
    -------
    RatioImages
    """
    dims, unit = ("frame", "y", "x"), {"units": "1"}

    def joined(name: str) -> AnyArray:
        """All frames; a single one is not copied."""
        images = [getattr(pair, name)[None] for pair in pairs]
        return images[0] if len(images) == 1 else np.concatenate(images)

    # of pixels that neighbours share by interpolation; it differs with the drift of each frame
    correlation = np.array([pair.noise_correlation for pair in pairs])
    return RatioImages(
        xr.Dataset(
            {name: (dims, joined(field), unit) for name, field in _IMAGES.items()}
            | {
                "flags": (dims, joined("flags"), FLAG_ATTRS),
                "signal_camera1": (dims, joined("light_one"), {"units": "DN"}),
                "noise_correlation": ("frame", correlation, unit),
            }
        )
    )
