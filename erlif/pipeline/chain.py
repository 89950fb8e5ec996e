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
import xarray as xr

from erlif.core.arrays import AnyArray, Array, Image
from erlif.core.errors import RegistrationError
from erlif.core.flags import FLAG_ATTRS, Flag
from erlif.core.pickling import PickledByFields
from erlif.core.products import AlignedFrames, CorrectedFrames, RatioImages, References
from erlif.io.ingest import FramePairs, read_pair
from erlif.pipeline.passes import DriftSearch, PairLight, PairRatio
from erlif.pipeline.passes.light import CameraTables, measure_light, tabulate
from erlif.pipeline.passes.noise import CameraNoise
from erlif.pipeline.passes.ratio import BAND, empty_ratio, measure_ratio
from erlif.pipeline.passes.warp import MapTables, PairWarp, Warp, tabulate_map
from erlif.ratio import BlurDifference, compute_ratio
from erlif.registration import CameraMap, align_frames, estimate_drift, is_steep


@dataclass(frozen=True)
class FrameCorrection(PickledByFields):
    """Counts to light, frame by frame.

    Attributes
    ----------
    pairs : FramePairs
        Frame pairs of the recording.
    references : References
        Dark, flat, gain and read noise of both cameras.
    least_signal : float
        Pixels with less light are flagged dim. [electron]
    energies : Array | None
        Pulse energy of each frame over the mean of the run, (frame,); it scales a background. None:
        not known, the mean is taken. [1]
    """

    pairs: FramePairs
    references: References
    least_signal: float = 100.0
    energies: Array | None = None

    @cached_property
    def tables(self) -> tuple[CameraTables, CameraTables]:
        """The references of both cameras as every frame needs them."""
        return tabulate(self.references, least_signal=self.least_signal)

    def __getstate__(self) -> dict[str, Any]:
        """The fields, and the tables where the references that make them are gone."""
        gone = "dark" not in self.references
        return super().__getstate__() | ({"tables": self.tables} if gone else {})

    def tabulated(self) -> FrameCorrection:
        """The same with the tables alone; of the references only the numbers are kept."""
        tabulated = replace(
            self, references=References(self.references.drop_dims(["y", "x"], errors="ignore"))
        )
        tabulated.__dict__["tables"] = self.tables
        return tabulated

    def light(self, frame: int, *, out: PairLight | None = None) -> PairLight:
        """Light of one frame pair as plain arrays, in those of ``out`` where they are given."""
        return self.measure(frame, read_pair(self.pairs, frame).counts, out=out)

    def measure(
        self, frame: int, counts: Sequence[AnyArray], *, out: PairLight | None = None
    ) -> PairLight:
        """Light of one frame pair whose counts were read."""
        return measure_light(counts, self.tables, out=out, energy=self.energy(frame))

    def energy(self, frame: int) -> float:
        """Energy of a pulse over the mean of the run; 1 where it is not known."""
        return 1.0 if self.energies is None else float(self.energies[frame])

    def __call__(self, frame: int) -> CorrectedFrames:
        """One corrected frame pair.

        The coordinates peak_camera1 and peak_camera2 on dim frame are its highest counts [DN].
        """
        return CorrectedFrames(as_frames(self.light(frame)).assign_coords(frame=[frame]))


def as_frames(light: PairLight) -> CorrectedFrames:
    """Light of one frame pair as a dataset, without a copy."""
    dims = ("camera", "frame", "y", "x")
    ancillary = {"units": "DN", "ancillary_variables": "signal_var signal_var_fixed flags"}
    one, two = light.peaks
    return CorrectedFrames(
        xr.Dataset(
            {
                "signal": (dims, light.light[:, None], ancillary),
                "signal_var": (dims, light.variance[:, None], {"units": "DN2"}),
                "signal_var_fixed": (dims, light.variance_fixed[:, None], {"units": "DN2"}),
                "flags": (dims, light.flags[:, None], FLAG_ATTRS),
            },
            {
                "camera": [1, 2],
                "peak_camera1": ("frame", [int(one)]),
                "peak_camera2": ("frame", [int(two)]),
            },
        )
    )


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
        return cls(light, PairWarp.empty(shape, orientation, rows=BAND + 1), ratio)


class _Kept(threading.local):
    """The buffers of each thread: new ones for each pair would cost as much as the passes."""

    key: tuple[tuple[int, int], str, bool] | None = None
    buffers: _Buffers | None = None

    def take(self, shape: tuple[int, int], orientation: str, *, with_fixed: bool) -> _Buffers:
        if self.buffers is None or self.key != (shape, orientation, with_fixed):
            self.buffers = None  # before the new ones are made
            self.buffers = _Buffers.empty(shape, orientation, with_fixed=with_fixed)
            self.key = shape, orientation, with_fixed
        return self.buffers


_kept = _Kept()


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
        Difference of sharpness that is removed from the ratio.
    no_film_below : float
        Light relative to the surroundings below which both bands show a bubble. [1]
    ratio_drift : float
        Change of the logarithm of the ratio from frame to frame by bleaching dyes, which is taken
        out; frame 0 stays as it is. [1]
    """

    correct: FrameCorrection
    camera_map: CameraMap
    blur: BlurDifference = field(default_factory=BlurDifference)
    no_film_below: float = 0.25
    ratio_drift: float = 0.0

    @property
    def pairs(self) -> FramePairs:
        """The frame pairs of the recording."""
        return self.correct.pairs

    @property
    def references(self) -> References:
        """Dark, flat, gain and read noise of both cameras."""
        return self.correct.references

    def tabulated(self) -> FrameChain:
        """The chain with the tables alone, without the references from which they were made."""
        return replace(self, correct=self.correct.tabulated())

    @cached_property
    def tables(self) -> MapTables:
        """The camera map as every frame needs it."""
        return tabulate_map(self.camera_map)

    @cached_property
    def noise(self) -> tuple[CameraNoise, CameraNoise]:
        """What the variances of both cameras need, that of camera 2 turned as its image is."""
        one, two = self.correct.tables
        return one.noise(), two.noise().turned(self.tables.orientation)

    @cached_property
    def search(self) -> DriftSearch:
        """The search for the drift of each frame against the map."""
        return DriftSearch.of(self.camera_map)

    def align(self, corrected: CorrectedFrames, *, drift: Array | None = None) -> AlignedFrames:
        """Camera 2 of one corrected frame pair on the pixel grid of camera 1.

        The drift (x, y) [px] is estimated where it is not given. The coordinates drift_x and
        drift_y on dim frame hold it, NaN where the cameras show no common texture.
        """
        shift = (self._estimate_drift(corrected) if drift is None else drift)[None]
        aligned = align_frames(corrected, self.camera_map, drift=shift)
        return AlignedFrames(
            aligned.assign_coords(drift_x=("frame", shift[:, 0]), drift_y=("frame", shift[:, 1]))
        )

    def align_like(self, frames: CorrectedFrames, aligned: AlignedFrames) -> AlignedFrames:
        """Apply the alignment of a frame to other light or variances of the same frame."""
        drift = np.column_stack([aligned.drift_x.values, aligned.drift_y.values])
        moved = align_frames(frames, self.camera_map, drift=drift)
        return AlignedFrames(moved.assign_coords(drift_x=aligned.drift_x, drift_y=aligned.drift_y))

    def _estimate_drift(self, corrected: CorrectedFrames) -> Array:
        light = registration_light(corrected)
        try:
            drift = estimate_drift(
                self.camera_map,
                light.one,
                light.two,
                weight_reference=light.weight_one,
                weight_moving=light.weight_two,
                threads=1,
            )
        except RegistrationError:  # a misfired pulse: no drift, and no film
            return np.full(2, np.nan)
        return np.array([drift.dx, drift.dy])

    def compute_ratio(self, aligned: AlignedFrames) -> RatioImages:
        """The ratio image of an aligned frame pair."""
        ratios = compute_ratio(aligned, no_film_below=self.no_film_below, blur=self.blur)
        if self.ratio_drift:
            for n, frame in enumerate(ratios.frame.values):
                ratios.log_ratio.values[n] -= self.ratio_drift * int(frame)
        return ratios

    def ratio(self, frame: int) -> RatioImages:
        """The ratio image of one frame pair, its files hashed as they are read.

        Coordinates are those of `erlif.pipeline.passes.PairRatio.to_images`.
        """
        buffers = _Buffers.empty(self.pairs.shape, self.tables.orientation, with_fixed=True)
        return self._measure(frame, buffers).to_images()

    def measure(self, frame: int, *, with_fixed: bool = True) -> PairRatio:
        """The ratio of one frame pair as plain arrays, its files hashed as they are read.

        The next call in the same thread fills the same arrays: copy what is kept. Only where
        frames are summed or smoothed is the part of the variance needed that repeats; otherwise
        the maps of the film may replace the ratio.
        """
        shape, orientation = self.pairs.shape, self.tables.orientation
        ratio = self._measure(frame, _kept.take(shape, orientation, with_fixed=with_fixed))
        if with_fixed:
            return ratio
        return replace(ratio, spare=(ratio.log_ratio, ratio.variance, ratio.variance_shared))

    def _measure(self, frame: int, buffers: _Buffers) -> PairRatio:
        counts, digests = read_pair(self.pairs, frame, digests=True)
        light = self.correct.measure(frame, counts, out=buffers.light)
        del counts
        ratio = self._level(frame, self._divide(light, self._find_drift(light), buffers))
        return replace(ratio, digests=digests)

    def restore(self, frame: int, drift: tuple[float, float]) -> tuple[PairRatio, Array]:
        """The ratio of one frame pair whose drift (x, y) [px] is known, and its light.

        The light (camera, y, x) [DN] is on the pixels of camera 1, NaN outside camera 2.
        """
        buffers = _Buffers.empty(self.pairs.shape, self.tables.orientation, with_fixed=True)
        light = self.correct.light(frame, out=buffers.light)
        ratio = self._level(frame, self._divide(light, drift, buffers))
        return ratio, np.stack([light.light[0], buffers.warped.light])

    def _level(self, frame: int, ratio: PairRatio) -> PairRatio:
        """The ratio with fresh dyes."""
        if self.ratio_drift:
            ratio.log_ratio[:] -= np.float32(self.ratio_drift * frame)
        return ratio

    def _divide(self, light: PairLight, drift: tuple[float, float], buffers: _Buffers) -> PairRatio:
        return measure_ratio(
            light,
            self.tables,
            self.noise,
            drift,
            blur=self.blur,
            no_film_below=self.no_film_below,
            warped=buffers.warped,
            out=buffers.ratio,
        )

    def warp(self, frame: int) -> AlignedFrames:
        """Light of one frame pair on the pixels of camera 1, as `align` gives it."""
        (whole,) = self.warp_bands(frame, [slice(0, self.pairs.shape[0])])
        return whole

    def warp_bands(self, frame: int, bands: Sequence[slice]) -> list[AlignedFrames]:
        """Some rows of the same, each band by itself."""
        light = self.correct.light(frame)
        warped = PairWarp.empty(self.pairs.shape, self.tables.orientation)
        drift = self._find_drift(light)
        longest = max(band.stop - band.start for band in bands)
        warp = Warp(light, self.tables, self.noise[1], drift, warped, band=longest)
        for band in bands:
            warp.fill(band.start, band.stop)

        lost = np.uint8(Flag.POOR_REGISTRATION if np.isnan(drift[0]) else 0)
        aligned = []
        for band in bands:
            flags = warped.flags[band] | self.tables.flags[band] | lost
            both = replace(
                light,
                light=np.stack([light.light[0, band], warped.light[band]]),
                variance=np.stack([light.variance[0, band], warped.variance[band]]),
                variance_fixed=np.stack(
                    [light.variance_fixed[0, band], warped.variance_fixed[band]]
                ),
                flags=np.stack([light.flags[0, band], flags]),
            )
            std = self.camera_map.displacement_std[band]
            aligned.append(
                as_frames(both).assign(
                    displacement_std=(("y", "x"), std, {"units": "px"}),
                    interpolation=("frame", [warp.averaging], {"units": "1"}),
                )
            )
        return [AlignedFrames(one) for one in aligned]

    def _find_drift(self, light: PairLight) -> tuple[float, float]:
        drift = self.search.find(light)
        return drift.dx, drift.dy


@dataclass(frozen=True)
class RegistrationLight:
    """Light of one frame pair, as a registration needs it.

    Attributes
    ----------
    one : Image
        Light of camera 1. [DN]
    two : Image
        Light of camera 2. [DN]
    weight_one : Image
        1 where a pixel of camera 1 can be used, else 0.
    weight_two : Image
        The same for camera 2.
    """

    one: Image
    two: Image
    weight_one: Image
    weight_two: Image


def registration_light(corrected: CorrectedFrames) -> RegistrationLight:
    """Light of both cameras in one frame pair, and the pixels that a registration can use.

    Saturated and bad pixels are left out, and places where the light is too steep.
    """
    lit = (corrected.flags.values[:, 0] & (Flag.SATURATED | Flag.BAD_PIXEL)) == 0
    one, two = corrected.signal.values[:, 0]
    weight_one = (lit[0] & ~is_steep(one)).astype(np.float32)
    weight_two = (lit[1] & ~is_steep(two)).astype(np.float32)
    return RegistrationLight(one, two, weight_one, weight_two)


@contextmanager
def one_thread_per_frame() -> Iterator[None]:
    """Limit OpenCV to the calling thread: erlif's threads work on different frames."""
    before = cv2.getNumThreads()
    cv2.setNumThreads(1)
    try:
        yield
    finally:
        cv2.setNumThreads(before)
