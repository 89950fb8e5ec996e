"""Results of each trigger besides its maps, saved and loaded by name."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from erlif.core.arrays import AnyArray, Array
from erlif.core.notes import Note, warn
from erlif.io.ingest import FramePairs, depth_warning
from erlif.ratio import (
    NO_CELLS,
    NO_DARK,
    NO_PULSE,
    LightCells,
    PairRatio,
    PulseSample,
    sample_cells,
    sample_pulse,
)
from erlif.thickness import NO_PATCH, PatchMean, sample_patch
from erlif.trend import (
    FilmNumber,
    FilmStatistics,
    FittedNumbers,
    GapMinimum,
    GapShape,
    PinPosition,
    Region,
    find_shift,
)

# Frames by which a step or drift of the registration is looked for, spread over the recording.
_FOLLOWED = 400

# Step or drift of the registration that is reported: several times what vibration leaves. [px]
_MOVED = 1.0

# Step or drift of the logarithm of the sharpness that is reported, and its standard deviations: of
# frames that differ by their speckle, not by chance alone. [1]
_BLURRED, _FOCUS_SIGNIFICANT = 0.03, 6.0

# Arrays of a trigger with one row for each frame pair: type in the file, and shape of a row.
_OF_FRAMES: dict[str, tuple[Any, tuple[int, ...]]] = {
    "frame": (np.int64, ()),
    "drift": (float, (2,)),
    "peaks": (np.int64, (2,)),
    "pulse_energy": (float, ()),
    # 64 hexadecimal digits; text of numpy would take four bytes for each
    "digests": ("S64", (2,)),
    "pulse": (np.float32, np.shape(NO_PULSE)),
    "cells": (np.float32, np.shape(NO_CELLS)),
    "patch": (float, (3,)),
    "dark": (float, (2, 2)),
    "sharpness": (float, (2,)),
}


@dataclass(frozen=True)
class FrameResult:
    """Results of one frame pair: drift, pulse, hashes, light in cells and patch.

    Attributes
    ----------
    frame : int
        Number of the frame pair, counted from 0.
    drift : tuple[float, float]
        Drift (x, y) of camera 2, NaN where the cameras show no common texture. [px]
    peaks : tuple[int, int]
        Highest counts of camera 1 and camera 2. [DN]
    pulse_energy : float
        Light of camera 1 over that of the same film at unit energy; NaN without a film. [DN]
    digests : tuple[str, str]
        SHA-256 of the files of camera 1 and camera 2 as they were read, hexadecimal; empty where a
        file holds more than this frame.
    pulse : PulseSample
        Means by which the pulse is recognised.
    cells : LightCells
        Light and ratio in coarse cells; NaN in frames that are not sampled.
    patch : PatchMean
        Light and ratio of the reference patch; NaN without one.
    dark : tuple[tuple[float, float], ...]
        Mean [DN] and variance [DN2] of the unlit pixels of each camera, dark subtracted,
        (camera, 2); NaN without such pixels.
    sharpness : tuple[float, float]
        Of camera 1 and camera 2; NaN without texture. [1]
    """

    frame: int
    drift: tuple[float, float]
    peaks: tuple[int, int]
    pulse_energy: float = float("nan")
    digests: tuple[str, str] = ("", "")
    pulse: PulseSample = field(default=NO_PULSE, compare=False)
    cells: LightCells = field(default=NO_CELLS, compare=False)
    patch: PatchMean = field(default=NO_PATCH, compare=False)
    dark: tuple[tuple[float, float], ...] = field(default=NO_DARK, compare=False)
    sharpness: tuple[float, float] = field(default=(float("nan"),) * 2, compare=False)

    @classmethod
    def of(
        cls, frame: int, pair: PairRatio, *, patch: Region | None = None, with_cells: bool = False
    ) -> FrameResult:
        """Collect the results of a frame pair, with its light in patch and cells if wanted."""
        light, log_ratio = pair.light_one, pair.log_ratio
        variance, flags = pair.variance, pair.flags
        kept = cls(
            frame,
            pair.drift,
            pair.peaks,
            digests=pair.digests,
            dark=pair.dark,
            sharpness=pair.sharpness,
            pulse=sample_pulse(light, log_ratio, flags),
            cells=sample_cells(light, log_ratio, variance, flags) if with_cells else NO_CELLS,
        )
        if patch is None:
            return kept

        # the mean over many pixels has the noise of neighbours that the interpolation correlates
        at, correlation = (patch.rows, patch.columns), pair.noise_correlation
        mean = sample_patch(
            light[at], log_ratio[at], variance[at], flags[at], noise_correlation=correlation
        )
        return replace(kept, patch=mean)


@dataclass(frozen=True)
class TriggerResult:
    """Results of one trigger besides its maps.

    Attributes
    ----------
    statistics : FilmStatistics
        Mean and minimum film thickness.
    frames : tuple[FrameResult, ...]
        What is kept of its frame pairs.
    pixels : tuple[int, ...]
        Valid pixels of its map, then those with each flag, as `count_flags` gives them.
    position : PinPosition | None
        Position of the pin; None without a joint.
    minima : Mapping[GapShape, GapMinimum]
        Minimum of each gap that the surfaces may have; empty where they can have one alone.
    """

    statistics: FilmStatistics
    frames: tuple[FrameResult, ...]
    pixels: tuple[int, ...]
    position: PinPosition | None = None
    minima: Mapping[GapShape, GapMinimum] = field(default_factory=dict)

    def with_parameter(
        self, like: int, weight: float, *, minimum: float | None = None
    ) -> TriggerResult:
        """Return a copy with one more parameter of the calibration, as the last.

        Parameters
        ----------
        like : int
            Parameter that acts on the film in the same way.
        weight : float
            Its share of that effect in this trigger. [1]
        minimum : float, optional
            Its share in the minimum of the gap; default: the weight. [1]

        Returns
        -------
        TriggerResult
        """

        def extend(gradient: Array, share: float = weight) -> Array:
            return np.concatenate([gradient, share * gradient[..., like : like + 1]], axis=-1)

        def extended(number: FilmNumber, share: float = weight) -> FilmNumber:
            return number._replace(gradient=extend(number.gradient, share))

        statistics, position = self.statistics, self.position
        statistics = replace(
            statistics,
            mean=extended(statistics.mean),
            inverse=extended(statistics.inverse),
            gap=statistics.gap._replace(
                minimum=extended(statistics.gap.minimum, weight if minimum is None else minimum),
                mean=extended(statistics.gap.mean),
                unseen=extended(statistics.gap.unseen),
                central=extended(statistics.gap.central, weight if minimum is None else minimum),
            ),
        )
        if position is not None:
            form = replace(position.form, gradient=extend(position.form.gradient))
            position = replace(position, gradient=extend(position.gradient), form=form)
        return replace(self, statistics=statistics, position=position)

    def to_arrays(self) -> dict[str, AnyArray]:
        """Arrays by name, for a file."""
        arrays: dict[str, AnyArray] = {}
        for one in fields(FilmStatistics):
            arrays |= _flatten(f"film_{one.name}", getattr(self.statistics, one.name))
        if self.position is not None:
            for key, numbers in ("pin", self.position), ("form", self.position.form):
                arrays |= {
                    f"{key}_{one.name}": getattr(numbers, one.name) for one in fields(FittedNumbers)
                }
        for contact, minimum in self.minima.items():
            arrays |= _flatten(f"gap_{contact}", minimum)
        arrays["pixels"] = np.array(self.pixels, np.int64)
        for name, (kind, shape) in _OF_FRAMES.items():
            rows = np.array([getattr(one, name) for one in self.frames], kind)
            arrays[name] = rows.reshape(-1, *shape)
        return arrays

    @classmethod
    def from_arrays(cls, arrays: Mapping[str, AnyArray]) -> TriggerResult:
        """Read back what `to_arrays` made."""
        statistics = FilmStatistics(
            _number(arrays, "film_mean"),
            _gap(arrays, "film_gap"),
            float(arrays["film_beyond_range"]),
            _number(arrays, "film_inverse"),
            float(arrays["film_measured"]),
            float(arrays["film_noise_correlation"]),
        )
        minima = {
            contact: _gap(arrays, f"gap_{contact}")
            for contact in GapShape
            if f"gap_{contact}_misfit" in arrays
        }

        frames = tuple(
            FrameResult(
                int(frame),
                (float(drift[0]), float(drift[1])),
                (int(peaks[0]), int(peaks[1])),
                float(energy),
                (digests[0].decode(), digests[1].decode()),
                PulseSample(*pulse),
                LightCells(*cells) if np.isfinite(cells).any() else NO_CELLS,
                PatchMean(*patch.tolist()),
                tuple(map(tuple, dark.tolist())),
                (float(sharpness[0]), float(sharpness[1])),
            )
            for frame, drift, peaks, energy, digests, pulse, cells, patch, dark, sharpness in zip(
                *(arrays[name] for name in _OF_FRAMES), strict=True
            )
        )
        position = None
        if "pin_value" in arrays:
            pin, form = (
                {one.name: arrays[f"{key}_{one.name}"] for one in fields(FittedNumbers)}
                for key in ("pin", "form")
            )
            position = PinPosition(**pin, form=FittedNumbers(**form))
        return cls(statistics, frames, tuple(arrays["pixels"].tolist()), position, minima)


def _flatten(name: str, value: Any) -> dict[str, AnyArray]:
    """Arrays of a number, or of a tuple with names."""
    if not isinstance(value, FilmNumber | GapMinimum):
        return {name: np.asarray(value)}
    parts = (_flatten(f"{name}_{part}", one) for part, one in value._asdict().items())
    return {key: array for part in parts for key, array in part.items()}


def _number(arrays: Mapping[str, AnyArray], name: str) -> FilmNumber:
    """Read back what `_flatten` made of the number of a film."""
    *parts, gradient = (arrays[f"{name}_{part}"] for part in FilmNumber._fields)
    value, random, surface = map(float, parts)
    return FilmNumber(value, random, surface, gradient)


def _gap(arrays: Mapping[str, AnyArray], name: str) -> GapMinimum:
    """Read back what `_flatten` made of a gap."""
    lowest, mean, unseen, central = (
        _number(arrays, f"{name}_{part}") for part in GapMinimum._fields[:4]
    )
    place, misfit, *shape = (arrays[f"{name}_{part}"] for part in GapMinimum._fields[4:])
    return GapMinimum(lowest, mean, unseen, central, place, float(misfit), *shape)


def frames_in(results: Iterable[TriggerResult]) -> list[FrameResult]:
    """Results of the frame pairs of several triggers, in one list."""
    return [one for result in results for one in result.frames]


def shares_passed(frames: npt.ArrayLike, count: int) -> Array:
    """Shares of a recording of `count` pairs that have passed at some of them, (frame,). [1]"""
    return np.asarray(frames, float) / max(count - 1, 1)


def share_passed(frames: Sequence[int], count: int) -> float:
    """Share that has passed at the mean of some frame pairs; 0 without any. [1]"""
    return float(shares_passed(frames, count).mean()) if frames else 0.0


def mean_drift(frames: Iterable[FrameResult]) -> Array:
    """Mean drift (x, y) over the frames whose drift is known; zero where there is none. [px]"""
    known = np.array([one.drift for one in frames if not np.isnan(one.drift[0])])
    return known.mean(axis=0) if known.size else np.zeros(2)


def known_digests(frames: Iterable[FrameResult], pairs: FramePairs) -> dict[Path, str]:
    """SHA-256 of the frame files that were hashed as they were read, for `hash_inputs`."""
    return {
        pages[one.frame].path: digest
        for one in frames
        for pages, digest in zip(pairs.pages, one.digests, strict=True)
        if digest
    }


def describe_frame_notes(frames: Sequence[FrameResult], pairs: FramePairs) -> list[Note]:
    """Notes on the counts of a recording, on pairs without common texture and on those left out."""
    notes: list[Note | None] = []
    if frames:
        highest = np.max([one.peaks for one in frames], axis=0)
        notes += [
            depth_warning(int(top), bit_depth=bit_depth, camera=camera)
            for camera, (bit_depth, top) in enumerate(
                zip(pairs.bit_depths, highest, strict=True), 1
            )
        ]
    lost = sorted(one.frame for one in frames if np.isnan(one.drift[0]))
    if lost:
        subject = f"frame pairs {', '.join(str(frame) for frame in lost)}"
        text = "no common texture, as after a misfired pulse; flagged poor_registration"
        notes.append(warn(subject, text))
    ordered = sorted(frames, key=lambda one: one.frame)
    followed = ordered[:: -(-len(ordered) // _FOLLOWED)] if ordered else []
    known = [note for note in notes if note is not None]
    return [*known, *_describe_moves(followed), *_describe_focus(followed)]


def _describe_focus(frames: Sequence[FrameResult]) -> list[Note]:
    """A step or drift of the sharpness of one camera against the other.

    Both see the same speckle: what it does to the sharpness of single frames is common to them.
    """
    numbers = np.array([one.frame for one in frames])
    sharpness = np.log([one.sharpness for one in frames]).reshape(-1, 2)
    found = find_shift(numbers, sharpness[:, 1] - sharpness[:, 0])
    if found is None or abs(found.size) < max(_BLURRED, _FOCUS_SIGNIFICANT * found.std):
        return []

    # the camera that changed is the one whose own sharpness did
    later = numbers >= (np.median(numbers) if found.frame is None else found.frame)
    own = np.nanmean(sharpness[later], axis=0) - np.nanmean(sharpness[~later], axis=0)
    camera = int(np.argmax(np.abs(own)))
    size = found.size if camera == 1 else -found.size
    size, std = 100 * float(np.expm1(size)), 100 * found.std
    text = (
        f"the sharpness over that of the other camera changes by {size:+.1f} ± {std:.1f} % from "
        "the first to the last frame. The focus yields or the window fogs; the difference of the "
        "cameras is removed from the ratio as one number for the run"
        if found.frame is None
        else f"from frame {found.frame} on, the sharpness over that of the other camera differs by "
        f"{size:+.1f} ± {std:.1f} %: focus, aperture or window changed. The difference of the "
        "cameras is removed from the ratio as one number for the run; process the frames before "
        "and after as two runs"
    )
    return [warn(f"camera{camera + 1}", text)]


def _describe_moves(ordered: Sequence[FrameResult]) -> list[Note]:
    """A step or drift of camera 2 against camera 1 along each axis."""
    numbers = np.array([one.frame for one in ordered])
    notes = []
    for axis, name in enumerate("xy"):
        found = find_shift(numbers, np.array([one.drift[axis] for one in ordered]))
        if found is not None and found.significant and abs(found.size) > _MOVED:
            change = f"by {found.size:+.2f} ± {found.std:.2f} px along {name}"
            text = (
                f"camera 2 moves against camera 1 {change} from the first to the last frame. A "
                "mount yields or warms. Every frame is registered by itself, which removes the "
                "displacement from the film"
                if found.frame is None
                else f"from frame {found.frame} on, camera 2 is displaced against camera 1 "
                f"{change}: one of them was touched. Every frame is registered by itself, which "
                "removes the displacement from the film; check the mounts, and focus and filters "
                "for a change of the ratio"
            )
            notes.append(warn("registration", text))
    return notes
