"""The frames of one trigger to its maps and statistics."""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

import numpy as np

from erlif.calibration import Calibration
from erlif.core.flags import Flag
from erlif.core.products import RatioImages
from erlif.core.progress import Progress
from erlif.files import PartialFilm
from erlif.models.fluorescence import band_signal
from erlif.pipeline.chain import Chain, FrameRecord, one_thread_per_frame
from erlif.pipeline.film import MAPS, pixel_positions
from erlif.ratio import RatioSum, smooth_ratio
from erlif.settings import RunSettings
from erlif.thickness import measure_thickness
from erlif.trend import region_mask, summarise_film


def _read_record(partial: PartialFilm, frames_of: list[list[int]]) -> FrameRecord:
    """What the frames of all triggers have shown."""
    record = FrameRecord()
    for trigger, frames in enumerate(frames_of):
        numbers = partial.numbers(trigger)
        for k, (x, y), (one, two) in zip(frames, numbers["drift"], numbers["peaks"], strict=True):
            record.drift[k] = (float(x), float(y))
            record.peaks[k] = (int(one), int(two))
    return record


def _run_tasks(
    task: _TriggerTask, frames_of: list[list[int]], workers: int | None, progress: Progress
) -> None:
    """Compute the triggers that are not finished, several at a time."""
    todo = [trigger for trigger in range(len(frames_of)) if not task.partial.has(trigger)]
    done = len(frames_of) - len(todo)
    with one_thread_per_frame(), ThreadPoolExecutor(workers or os.cpu_count() or 1) as pool:
        jobs = [pool.submit(task.run, trigger, frames_of[trigger]) for trigger in todo]
        try:
            for job in jobs:
                job.result()
                done += 1
                progress("film", done, len(frames_of))
        except BaseException:
            for job in jobs:
                job.cancel()
            raise


@dataclass(frozen=True)
class _TriggerTask:
    """All frames of one trigger to its maps and numbers, independent of every other trigger."""

    chain: Chain
    calibration: Calibration
    settings: RunSettings
    partial: PartialFilm

    def run(self, trigger: int, frames: list[int]) -> None:
        total, record = RatioSum(self.chain.recording.shape), FrameRecord()
        signals = []
        for k in frames:
            ratios = self.chain.ratio(k)
            record.add(k, ratios)
            signals.append(ratios.signal_camera1.values[0])
            total.add(ratios)
            if len(frames) > 1:
                signals[-1] = self._brightness(ratios)
        ratio = total.mean()
        if not frames:  # all were left out
            ratio.flags[:] = Flag.OUTSIDE_OVERLAP
        maps = measure_thickness(ratio, self.calibration)
        if len(frames) == 1:
            signals = [self._brightness_of(signals[0], maps.thickness.values, maps.flags.values)]
        x, y = pixel_positions(self.chain.recording)
        rows, columns = region_mask(self.settings, x, y)
        film = summarise_film(
            ratio,
            maps,
            self.calibration,
            x=x,
            y=y,
            rows=rows,
            columns=columns,
            sliding_along_x=self.settings.optics.x_axis == "sliding",
        )
        resolution = self.settings.thickness.smoothing
        if (
            resolution is not None
        ):  # the statistics above count on pixels whose noise is independent
            maps = measure_thickness(smooth_ratio(ratio, resolution=resolution), self.calibration)
        self.partial.put(
            trigger,
            {variable.name: maps[variable.name].values for variable in MAPS},
            MAPS,
            {
                **vars(film),
                "pulse_energy": np.array(signals),
                "frames_used": len(frames),
                "drift": np.array(list(record.drift.values())).reshape(-1, 2),
                "peaks": np.array(list(record.peaks.values())).reshape(-1, 2),
            },
        )

    def _brightness(self, ratios: RatioImages) -> float:
        maps = measure_thickness(ratios, self.calibration)
        return self._brightness_of(
            ratios.signal_camera1.values[0], maps.thickness.values[0], maps.flags.values[0]
        )

    def _brightness_of(self, signal: Any, thickness: Any, flags: Any) -> float:
        """Light of camera 1 over what this film would give at unit energy, in the middle of the image."""
        height, width = signal.shape
        middle = (slice(height // 4, 3 * height // 4, 2), slice(width // 4, 3 * width // 4, 2))
        good = flags[middle] == 0
        if good.sum() < 64:
            return float("nan")
        expected = band_signal(
            thickness[middle][good], attenuation=self.calibration.attenuation_camera1
        )
        return float(np.median(signal[middle][good] / expected))
