"""The ratio of one frame pair as plain arrays, as the pipeline hands it on."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import xarray as xr

from erlif.core.arrays import FlagImage, Image
from erlif.core.flags import FLAG_ATTRS
from erlif.core.products import RatioImages


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
    spare: tuple[Image, ...] = ()

    @classmethod
    def of(cls, ratios: RatioImages, frame: int = 0) -> PairRatio:
        """One frame of ratio images.

        Parameters
        ----------
        ratios : RatioImages
            On dim frame, as `erlif.ratio.compute_ratio` returns them; the coordinates drift_x,
            drift_y, peak_camera1, peak_camera2, digest_camera1 and digest_camera2 are read where
            they exist.
        frame : int
            Position on dim frame.

        Returns
        -------
        PairRatio
        """

        def number(name: str, default: float) -> float:
            return float(ratios[name].values[frame]) if name in ratios.variables else default

        def text(name: str) -> str:
            return str(ratios[name].values[frame]) if name in ratios.variables else ""

        def image(name: str) -> Image:
            return np.ascontiguousarray(ratios[name].values[frame], np.float32)

        # a mean over frames has no light of its own
        log_ratio = image("log_ratio")
        known = "signal_camera1" in ratios
        light = image("signal_camera1") if known else np.full_like(log_ratio, np.nan)
        return cls(
            log_ratio,
            image("log_ratio_var"),
            image("log_ratio_var_fixed"),
            image("log_ratio_var_shared"),
            ratios.flags.values[frame],
            light,
            number("noise_correlation", 1.0),
            (number("drift_x", 0.0), number("drift_y", 0.0)),
            (int(number("peak_camera1", 0)), int(number("peak_camera2", 0))),
            (text("digest_camera1"), text("digest_camera2")),
        )

    def to_images(self) -> RatioImages:
        """The same as a dataset with one frame, as the stages after the ratio take it.

        Returns
        -------
        RatioImages
            As `erlif.ratio.compute_ratio` returns them, with the coordinates that `of` reads.
        """
        dims, unit = ("frame", "y", "x"), {"units": "1"}

        images = {
            "log_ratio": self.log_ratio,
            "log_ratio_var": self.variance,
            "log_ratio_var_fixed": self.variance_fixed,
            "log_ratio_var_shared": self.variance_shared,
        }
        dataset = xr.Dataset(
            {name: (dims, image[None], unit) for name, image in images.items()}
            | {
                "flags": (dims, self.flags[None], FLAG_ATTRS),
                "signal_camera1": (dims, self.light_one[None], {"units": "DN"}),
                "noise_correlation": ("frame", [self.noise_correlation], unit),
            }
        )
        return RatioImages(
            dataset.assign_coords(
                drift_x=("frame", [self.drift[0]]),
                drift_y=("frame", [self.drift[1]]),
                peak_camera1=("frame", [self.peaks[0]]),
                peak_camera2=("frame", [self.peaks[1]]),
                digest_camera1=("frame", [self.digests[0]]),
                digest_camera2=("frame", [self.digests[1]]),
            )
        )
