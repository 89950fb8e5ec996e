"""Dark pages: dark level, temporal variance, hot and noisy pixels."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from scipy.stats import chi2

from erlif.core.arrays import Array, Mask
from erlif.core.detector import QUANTISATION_VAR
from erlif.core.statistics import robust_std
from erlif.correction.pages import PageStack
from erlif.ingest import Recording, find_reference_pages, read_reference
from erlif.settings import CameraSettings


@dataclass(frozen=True)
class _Darks:
    """Darks of one camera, reduced."""

    mean: Array
    """Mean of each pixel. [DN]"""
    mean_var: float
    """Its variance. [DN2]"""
    bad: Mask
    """Hot or noisy pixels."""
    pages: int
    """0 where the dark is a declared level."""
    temporal_var: float | None = None
    """Temporal variance of a pixel. [DN2]"""
    temporal_var_std: float = 0.0
    mean_std: float = float("nan")
    """Standard deviation of the mean level, from page to page. [DN]"""
    spread: float = float("nan")
    """Standard deviation over the pixels. [DN]"""


def _reduce_darks(recording: Recording, settings: CameraSettings, camera: int) -> _Darks:
    shape = recording.shape
    if settings.dark is None:
        assert settings.offset is not None  # the settings hold one or the other
        return _Darks(np.full(shape, settings.offset), 0.0, np.zeros(shape, bool), 0)
    found = find_reference_pages(recording.directory, settings.dark, what=f"camera{camera} dark")
    read = (
        read_reference(page, settings, directory=recording.directory, shape=shape).astype(float)
        for page in found
    )
    pages: PageStack | None = None
    levels = []
    for image in read:
        pages = pages or PageStack(image)
        pages.add(image)
        levels.append(float(np.median(image - pages.first)))
    assert pages is not None  # find_reference_pages refuses an empty file
    mean, variance, n = pages.mean, pages.variance, pages.count
    excess = mean - _median_of_surroundings(mean)
    hot = np.abs(excess) > np.maximum(8 * robust_std(excess), 8.0)
    if n < 2:
        return _Darks(mean, 0.0, hot, 1)
    # the variance of n pages is a chi-square of n - 1: a noisy pixel stands above what one in ten million does
    typical = max(
        float(np.median(variance)) * (n - 1) / chi2.ppf(0.5, n - 1),
        # of few pages of a quiet camera most counts are alike, and the median is 0; noisy pixels must not lift this mean
        float(np.minimum(variance, np.quantile(variance, 0.99)).mean()),
        QUANTISATION_VAR,
    )
    noisy = variance > typical * chi2.isf(1e-7, n - 1) / (n - 1) + 1.0
    bad = hot | noisy
    temporal_var = float(variance[~bad].mean())
    drift = float(np.std(levels, ddof=1)) / np.sqrt(n)
    pixels = int((~bad).sum())
    return _Darks(
        mean,
        temporal_var / n,
        bad,
        n,
        temporal_var,
        temporal_var * float(np.sqrt(2 / ((n - 1) * pixels))),
        float(np.hypot(drift, np.sqrt(temporal_var / (n * pixels)))),
        float(np.sqrt(max(float(mean[~bad].var()) - temporal_var / n, 0.0))),
    )


def _median_of_surroundings(image: Array) -> Array:
    """Median over 5 x 5 pixels."""
    return np.asarray(cv2.medianBlur(np.ascontiguousarray(image, np.float32), 5), float)
