"""The stages from counts to ratio, one frame pair at a time.

What belongs to a recording as a whole (references, camera map, difference of sharpness) is found
first. Every frame can then be processed by itself, in any order and from any thread.
"""

from __future__ import annotations

import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import cv2
import numpy as np

from erlif.core.arrays import AnyArray, Array, Image
from erlif.core.pickling import PickledByFields
from erlif.core.products import AlignedFrames, CorrectedFrames, RatioImages, References
from erlif.correction import CameraTables, NoiseTables, PairLight, UnlitPixels, gather_light
from erlif.correction.light import measure_light, tabulate
from erlif.io.ingest import FramePairs, PairCounts, read_pair
from erlif.pipeline.passes.drift import PairDrift
from erlif.pipeline.passes.ratio import KEPT, measure_ratio
from erlif.pipeline.passes.warp import MapTables, PairWarp, tabulate_map, turn_noise
from erlif.ratio import BlurDifference, PairRatio, compute_ratio, measure_sharpness
from erlif.ratio.log_ratio import empty_ratio
from erlif.ratio.softening import Softening
from erlif.registration import CameraMap, align_bands, align_frames
from erlif.trend.pattern import Pattern


@dataclass(frozen=True)
class FrameCorrection:
    """Counts to light, frame by frame.

    Attributes
    ----------
    pairs : FramePairs
        Frame pairs of the recording.
    references : References
        Dark, flat, gain and read noise of both cameras.
    tables : tuple[CameraTables, CameraTables]
        The references as every frame needs them.
    least_signal : float
        Pixels with less light are flagged dim. [electron]
    energies : Array | None
        Pulse energy of each frame over the mean of the run, (frame,); it scales a background. None:
        not known, the mean is taken. [1]
    unlit : tuple of UnlitPixels or None
        Pixels of each camera that no light reaches, (camera,); None where there are none.
    """

    pairs: FramePairs
    references: References
    tables: tuple[CameraTables, CameraTables]
    least_signal: float
    energies: Array | None = None
    unlit: tuple[UnlitPixels | None, ...] = (None, None)

    @classmethod
    def of(
        cls, pairs: FramePairs, references: References, *, least_signal: float, **known: Any
    ) -> FrameCorrection:
        """The correction by some references; `known` are energies and unlit pixels."""
        tables = tabulate(references, least_signal=least_signal, excluded=pairs.excluded)
        return cls(pairs, references, tables, least_signal, **known)

    def with_references(self, references: References) -> FrameCorrection:
        """Return a copy with other references."""
        excluded = self.pairs.excluded
        tables = tabulate(references, least_signal=self.least_signal, excluded=excluded)
        return replace(self, references=references, tables=tables)

    def tabulated(self) -> FrameCorrection:
        """Return a copy that keeps the tables, and only the numbers of the references."""
        numbers = self.references.drop_dims(["y", "x"], errors="ignore")
        return replace(self, references=References(numbers))

    def light(self, frame: int, *, out: PairLight | None = None) -> PairLight:
        """Light of one frame pair as plain arrays, in those of ``out`` where they are given."""
        counts = read_pair(self.pairs, frame).counts
        return self.measure(counts, energy=self.energy(frame), out=out)

    def measure(
        self, counts: Sequence[AnyArray], *, energy: float = 1.0, out: PairLight | None = None
    ) -> PairLight:
        """Light of one frame pair whose counts were read."""
        return measure_light(counts, self.tables, out=out, energy=energy)

    def read_dark(self, counts: Sequence[AnyArray]) -> tuple[tuple[float, float], ...]:
        """Mean and variance of the unlit pixels of each camera, as `UnlitPixels.read`, or NaN."""
        nothing = (float("nan"), float("nan"))
        return tuple(
            nothing if unlit is None else unlit.read(image)
            for unlit, image in zip(self.unlit, counts, strict=True)
        )

    def energy(self, frame: int) -> float:
        """Energy of a pulse over the mean of the run; 1 where it is not known."""
        return 1.0 if self.energies is None else float(self.energies[frame])


@dataclass(frozen=True)
class _Buffers:
    """Arrays that a frame pair passes through, filled again by the next one."""

    light: PairLight
    warped: PairWarp
    ratio: PairRatio

    @classmethod
    def empty(cls, shape: tuple[int, int], orientation: str, *, with_fixed: bool) -> _Buffers:
        # the drift is known before the ratio, which then takes the place of the binned light
        log_ratio = np.empty(shape, np.float32)
        light = PairLight.empty(shape, with_noise=False, binned_in=log_ratio)
        replaces = log_ratio, light.light[1]
        ratio = empty_ratio(shape, with_fixed=with_fixed, replaces=replaces)
        return cls(light, PairWarp.empty(shape, orientation, rows=KEPT), ratio)


class _ThreadBuffers(threading.local):
    """The buffers of each thread: new ones for each pair would cost as much as the passes."""

    key: tuple[tuple[int, int], str, bool] | None = None
    buffers: _Buffers | None = None

    def take(self, shape: tuple[int, int], orientation: str, *, with_fixed: bool) -> _Buffers:
        if self.buffers is None or self.key != (shape, orientation, with_fixed):
            self.buffers = None  # before the new ones are made
            self.buffers = _Buffers.empty(shape, orientation, with_fixed=with_fixed)
            self.key = shape, orientation, with_fixed
        return self.buffers


_kept = _ThreadBuffers()


@dataclass(frozen=True)
class FrameChain(PickledByFields):
    """Counts to ratio, frame by frame.

    Each frame finds its own drift, so that frames depend on nothing but the map.

    Attributes
    ----------
    correct : FrameCorrection
        Counts to light.
    camera_map : CameraMap
        Displacement of camera 2.
    blur : BlurDifference
        Difference of sharpness, by which the sharper camera is blurred.
    no_film_below : float
        Light relative to the surroundings below which both bands show a bubble. [1]
    ratio_change : Array | None
        Change of the logarithm of the ratio by what is not film, (frame,), which is taken out; None
        where nothing is. [1]
    pattern : Pattern | None
        What stands still, and is taken out of the logarithm of the ratio.
    """

    correct: FrameCorrection
    camera_map: CameraMap
    blur: BlurDifference = field(default_factory=BlurDifference)
    no_film_below: float = 0.25
    ratio_change: Array | None = None
    pattern: Pattern | None = None

    @property
    def pairs(self) -> FramePairs:
        """The frame pairs of the recording."""
        return self.correct.pairs

    @property
    def references(self) -> References:
        """Dark, flat, gain and read noise of both cameras."""
        return self.correct.references

    @cached_property
    def softening(self) -> Softening:
        """The blur of the sharper camera."""
        return Softening.of(self.blur)

    def without(self, change: Array) -> FrameChain:
        """Return a chain that also subtracts a change from the log ratio, (frame,). [1]"""
        before = 0.0 if self.ratio_change is None else self.ratio_change
        return replace(self, ratio_change=before + change)

    def tabulated(self) -> FrameChain:
        """The chain with the tables alone, without the references from which they were made."""
        return replace(self, correct=self.correct.tabulated())

    @cached_property
    def tables(self) -> MapTables:
        """The camera map as every frame needs it."""
        return tabulate_map(self.camera_map)

    @cached_property
    def noise(self) -> tuple[NoiseTables, NoiseTables]:
        """Tables for the variances of both cameras, that of camera 2 turned like its image."""
        one, two = self.correct.tables
        return one.noise, turn_noise(two.noise, self.tables.orientation)

    @cached_property
    def search(self) -> PairDrift:
        """The search for the drift of each frame against the map."""
        return PairDrift.of(self.camera_map)

    def align(self, frame: int) -> tuple[CorrectedFrames, AlignedFrames]:
        """Light of one frame pair, as corrected and with camera 2 aligned to camera 1.

        The coordinates drift_x and drift_y (frame) hold the drift of camera 2, NaN where the
        cameras show no common texture. [px]
        """
        corrected = self._locate(frame)
        return corrected, align_frames(corrected, self.camera_map, drift=_drift_of(corrected))

    def align_bands(self, frame: int, bands: Sequence[slice]) -> tuple[AlignedFrames, ...]:
        """Some rows of one frame pair with camera 2 on the pixels of camera 1, as `align`."""
        corrected = self._locate(frame)
        return align_bands(corrected, self.camera_map, bands, drift=_drift_of(corrected))

    def _locate(self, frame: int) -> CorrectedFrames:
        """Light of one frame pair with its drift."""
        light = self.correct.light(frame)
        x, y = self._find_drift(light)
        return CorrectedFrames(
            gather_light([light]).assign_coords(
                frame=[frame], drift_x=("frame", [x]), drift_y=("frame", [y])
            )
        )

    def align_variances(
        self, corrected: CorrectedFrames, one: AnyArray, other: AnyArray
    ) -> AlignedFrames:
        """Align two variances as `align` aligns the light; they replace those of the light."""
        dims = corrected.signal.dims
        replaced = corrected.assign(signal_var=(dims, one), signal_var_fixed=(dims, other))
        # with the drift of the frame itself, which the light alone determines
        return align_frames(CorrectedFrames(replaced), self.camera_map, drift=_drift_of(corrected))

    def divide(self, aligned: AlignedFrames) -> RatioImages:
        """The ratio images of aligned frame pairs."""
        ratios = compute_ratio(aligned, no_film_below=self.no_film_below, blur=self.blur)
        # in single precision, as `_divide` does it for plain arrays
        for n, frame in enumerate(ratios.frame.values):
            self._take_out(ratios.log_ratio.values[n], self._change(int(frame)))
        return ratios

    def measure(self, frame: int | PairCounts, *, with_fixed: bool = True) -> PairRatio:
        """The ratio of one frame pair as plain arrays.

        Parameters
        ----------
        frame : int or PairCounts
            Number of a pair, whose files are hashed as they are read. A pair that was read has the
            mean energy, and no change of its ratio is taken out.
        with_fixed : bool
            Whether the part of the variance that repeats is needed, as where frames are summed or
            smoothed. Without it the maps of the film may replace the ratio.

        Returns
        -------
        PairRatio
            The next call in the same thread fills the same arrays: copy what is kept.
        """
        buffers = _kept.take(self.pairs.shape, self.tables.orientation, with_fixed=with_fixed)
        if isinstance(frame, PairCounts):
            (counts, digests), energy, change = frame, 1.0, 0.0
        else:
            counts, digests = read_pair(self.pairs, frame, digests=True)
            energy, change = self.correct.energy(frame), self._change(frame)

        # dark, flat and noise; registration; ratio
        light = self.correct.measure(counts, energy=energy, out=buffers.light)
        dark, sharpness = self.correct.read_dark(counts), self._compare_sharpness(light)
        del counts  # 5 MB a pair and thread, while the ratio is made
        drift = self._find_drift(light)
        ratio = self._divide(light, drift, change, buffers)

        ratio = replace(ratio, digests=digests, dark=dark, sharpness=sharpness)
        if with_fixed:
            return ratio
        return replace(ratio, spare=(ratio.log_ratio, ratio.variance, ratio.variance_shared))

    def restore(self, frame: int, drift: tuple[float, float]) -> tuple[PairRatio, Array]:
        """The ratio of one frame pair whose drift (x, y) [px] is known, and its light.

        The light (camera, y, x) [DN] is on the pixels of camera 1, NaN outside camera 2.
        """
        buffers = _Buffers.empty(self.pairs.shape, self.tables.orientation, with_fixed=True)
        light = self.correct.light(frame, out=buffers.light)
        ratio = self._divide(light, drift, self._change(frame), buffers)
        return ratio, np.stack([light.light[0], buffers.warped.light])

    def _divide(
        self, light: PairLight, drift: tuple[float, float], change: float, buffers: _Buffers
    ) -> PairRatio:
        """Warp camera 2 and compute the ratio, less a known change of its logarithm."""
        ratio = measure_ratio(
            light,
            self.tables,
            self.noise,
            drift,
            softening=self.softening,
            no_film_below=self.no_film_below,
            warped=buffers.warped,
            out=buffers.ratio,
        )
        self._take_out(ratio.log_ratio, change)
        return ratio

    def _take_out(self, log_ratio: Image, change: float) -> None:
        """Subtract a change of a frame, and the pattern, from the logarithm of its ratio."""
        if change:
            log_ratio -= np.float32(change)
        if self.pattern is not None:
            self.pattern.take_out(log_ratio)

    def _change(self, frame: int) -> float:
        """Change of the logarithm of the ratio that is taken out of a frame. [1]"""
        return 0.0 if self.ratio_change is None else float(self.ratio_change[frame])

    def _compare_sharpness(self, light: PairLight) -> tuple[float, float]:
        """Sharpness of camera 1 and camera 2. [1]"""
        one, two = (
            measure_sharpness(light.light[n], light.flags[n], table.noise)
            for n, table in enumerate(self.correct.tables)
        )
        return one, two

    def _find_drift(self, light: PairLight) -> tuple[float, float]:
        drift = self.search.find(light)
        return drift.dx, drift.dy


def _drift_of(corrected: CorrectedFrames) -> Array:
    """Drift (frame, 2) of located frames, x first. [px]"""
    return np.column_stack([corrected.drift_x.values, corrected.drift_y.values])


@contextmanager
def one_thread_per_frame() -> Iterator[None]:
    """Limit OpenCV to the calling thread: erlif's threads work on different frames."""
    before = cv2.getNumThreads()
    cv2.setNumThreads(1)
    try:
        yield
    finally:
        cv2.setNumThreads(before)
