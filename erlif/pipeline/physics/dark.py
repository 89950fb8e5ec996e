"""Dark level of both cameras over a run and against their dark frames, by pixels without light."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from erlif.calibration import RunCurve
from erlif.core.arrays import Array
from erlif.core.notes import Note, warn
from erlif.correction import UnlitPixels
from erlif.pipeline.engines.results import FrameResult
from erlif.trend import CourseChange, find_shift

# Standard deviations from which on a level is neither chance nor light.
_SIGNIFICANT = 3.0

# Share of the light from which on a level is reported: it shifts films of 3 um by some 20 nm. [1]
_LEAST = 0.005


@dataclass(frozen=True)
class DarkLevel:
    """Dark level of one camera in a run, less that of its dark frames.

    Attributes
    ----------
    camera : int
        1 or 2.
    level : float
        Mean over the run. [DN]
    std : float
        Its standard deviation, with the light that the noise of the pixels allows. [DN]
    light : float
        Median light of the run. [DN]
    change : CourseChange | None
        Step or drift during the run; None where there is none of consequence. [DN]
    """

    camera: int
    level: float
    std: float
    light: float
    change: CourseChange | None = None

    @property
    def counts(self) -> bool:
        """Whether the level differs from that of the dark frames, or changes during the run."""
        off = abs(self.level) > max(_SIGNIFICANT * self.std, _LEAST * self.light)
        return off or self.change is not None

    @property
    def share(self) -> float:
        """Root mean square of the largest level during the run, over the light. [1]"""
        half = 0.0 if self.change is None else abs(self.change.size)
        return math.hypot(abs(self.level) + half, self.std) / self.light


def find_dark_levels(
    lights: Mapping[int, FrameResult], unlit: Sequence[UnlitPixels | None], gains: Array
) -> list[DarkLevel]:
    """Dark levels that are not those of the dark frames, or change during a run.

    A level that is the same in all pixels without light may still be light. Its shot noise then
    exceeds that of the dark frames, and what it allows is part of the standard deviation.

    Parameters
    ----------
    lights : mapping of int to FrameResult
        By frame.
    unlit : sequence of UnlitPixels or None
        Of both cameras.
    gains : array, (camera,)
        [electron/DN]

    Returns
    -------
    list of DarkLevel
        Of cameras whose level differs by five thousandths of the light, and significantly.
    """
    frames = np.array(sorted(lights))
    found = []
    for n, pixels in enumerate(unlit):
        if pixels is None or not frames.size:
            continue
        level, variance = np.array([lights[frame].dark[n] for frame in frames], float).T
        if not np.isfinite(level).all():
            continue

        # light that would give the variance beyond that of the dark, and how well it is known
        of_frames = pixels.variance * math.sqrt(3 / (frames.size * (pixels.place.size - 1)))
        light_std = float(gains[n]) * math.hypot(of_frames, pixels.variance_std)
        light = float(gains[n] * (np.median(variance) - pixels.variance)) - light_std
        chance = float(level.std()) / math.sqrt(frames.size)
        std = math.hypot(max(light, 0.0), light_std, pixels.dark_std, chance)

        change = find_shift(frames, level)
        if change is not None:
            size = abs(change.size)
            consequence = size > max(_SIGNIFICANT * change.std, _LEAST * pixels.light, 2 * std)
            change = change if change.significant and consequence else None
        one = DarkLevel(n + 1, float(level.mean()), std, pixels.light, change)
        if one.counts:
            found.append(one)
    return found


def describe_dark_levels(
    levels: Sequence[DarkLevel], calibration: RunCurve, film: float
) -> list[Note]:
    """Notes about wrong dark levels.

    Parameters
    ----------
    levels : sequence of DarkLevel
        As `find_dark_levels` gives them.
    calibration : RunCurve
    film : float
        Median film of the run; NaN where it is not known. [um]

    Returns
    -------
    list of Note
    """
    at = film if math.isfinite(film) else calibration.covered_range[1] / 2
    notes = []
    for one in levels:
        change = one.change
        size, std = (one.level, one.std) if change is None else (change.size, change.std)
        sign = 1.0 if one.camera == 2 else -1.0
        per_count = sign * 1e3 / (one.light * float(calibration.slope(at)))
        films = f"films of {at:.1f} um"
        shift, size_and_std = f"{per_count * size:+.0f} nm", f"{size:+.1f} ± {std:.1f} DN"
        share = f"That is {100 * abs(size) / one.light:.1f} % of the median light"
        mean = f"{share} ({one.level:+.1f} DN above the dark frames in the mean of the run)"
        included = "film_mean_std and film_min_std include it, the maps do not"
        if change is None:
            text = (
                f"{films} are {shift} off by the dark: pixels that no light reaches read "
                f"{size_and_std} above it. {share}: the dark frames are not those of this run. "
                f"{included}. Record the dark again with the exposure, offset and temperature of "
                "the run"
            )
        elif change.frame is None:
            text = (
                f"{films} drift by {shift}: pixels that no light reaches change by {size_and_std} "
                f"from the first to the last frame. {mean}. Likely: the camera warms. {included}. "
                "Record darks before and after the run"
            )
        else:
            text = (
                f"from frame {change.frame} on {films} are {shift} off: pixels that no light "
                f"reaches read {size_and_std} more. {mean}. Likely: offset or exposure of the "
                f"camera was changed, or a lamp was switched on. {included}"
            )
        notes.append(warn(f"camera{one.camera}", text))
    return notes
