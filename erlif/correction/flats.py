"""Flat pages: light levels, pixel response, dead pixels."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from erlif.core.arrays import Array, Mask
from erlif.core.detector import QUANTISATION_VAR
from erlif.core.errors import FrameError
from erlif.correction.darks import _Darks, _median_of_surroundings
from erlif.correction.pages import PageStack
from erlif.correction.photon_transfer import (
    LightLevel,
    PhotonTransfer,
    fit_photon_transfer,
    reduce_level,
)
from erlif.correction.saturation import find_pile_up
from erlif.ingest import Recording, find_reference_pages, read_reference
from erlif.settings import CameraSettings

_SAME_LEVEL = 0.05  # flat pages whose means differ by less were taken at one light level


def _read_flats(
    recording: Recording,
    settings: CameraSettings,
    dark: Array,
    camera: int,
    seen: npt.NDArray[np.int64],
) -> tuple[list[PageStack], int]:
    """Flats above dark, level by level, and the count at which the camera saturates.

    A level is consecutive pages of one brightness, freed of the lamp's flicker. Saturated pages are left out, those too that pile up
    below full scale; `seen`, pixels by count in some frames, is searched for such a pile-up as well.
    """
    levels: list[PageStack] = []
    saturation = find_pile_up(seen) or settings.full_scale
    if settings.flat is None:
        return levels, saturation
    pages = find_reference_pages(recording.directory, settings.flat, what=f"camera{camera} flat")
    total = seen.copy()
    for page in pages:
        image = read_reference(page, settings, directory=recording.directory, shape=recording.shape)
        histogram = np.bincount(image.ravel(), minlength=settings.full_scale + 1)
        total += histogram
        top = find_pile_up(histogram) or settings.full_scale
        if histogram[top:].sum() > 1e-3 * image.size:
            continue
        light = image - dark
        if not levels or abs(light.mean() / levels[-1].first.mean() - 1) >= _SAME_LEVEL:
            levels.append(PageStack(light))
        levels[-1].add(light, scale=levels[-1].first.mean() / light.mean())
    saturation = find_pile_up(total) or settings.full_scale
    if not levels or max(level.first.mean() for level in levels) < settings.full_scale / 50:
        raise FrameError(
            f"Expected flats of camera{camera} well above dark and below saturation ({saturation}); none is. Record flats with the light "
            "at a quarter to three quarters of full scale."
        )
    return levels, saturation


def _photon_transfer(
    levels: Sequence[PageStack], settings: CameraSettings, darks: _Darks, saturation: int
) -> PhotonTransfer | None:
    """Photon transfer over the pixels that are sound and clear of saturation."""
    points: list[LightLevel] = []
    for level in levels:
        point = reduce_level(level, ~darks.bad & (level.mean + darks.mean < 0.95 * saturation))
        if point is not None:
            points.append(point)
    if darks.temporal_var is not None or settings.read_noise is None:
        return fit_photon_transfer(
            points, dark_variance=darks.temporal_var, dark_variance_std=darks.temporal_var_std
        )
    # a read noise declared in electrons is a variance of counts once the gain is known: two rounds settle it
    found = fit_photon_transfer(points, dark_variance=QUANTISATION_VAR)
    for _ in range(3):
        if found is not None:
            dark_variance = (settings.read_noise / found.gain) ** 2 + QUANTISATION_VAR
            found = fit_photon_transfer(points, dark_variance=dark_variance)
    return found


def _reduce_flats(
    levels: Sequence[PageStack],
    dark_var: Array,
    bad: Mask,
    gain: float,
    page_var: float,
) -> tuple[Array, Array, Mask]:
    """Response of each pixel relative to the mean, its variance, and the dead pixels."""
    count = sum(level.count for level in levels)
    total = np.sum([level.count * level.mean for level in levels], axis=0)
    scale = float(total[~bad].mean())
    surroundings = _median_of_surroundings(total)
    dead = (total < 0.5 * surroundings) | (total > 1.5 * surroundings) | (total < 0.02 * scale)
    flat = np.where(dead | bad, np.maximum(surroundings, 0.02 * scale), total) / scale
    variance = np.maximum(total, 0.0) / gain + count * page_var + count**2 * dark_var
    return flat, variance / scale**2, dead
