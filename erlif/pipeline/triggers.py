"""The frames of each trigger to its maps and statistics, several triggers at a time."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from erlif.calibration import Calibration
from erlif.core.arrays import AnyArray, Array
from erlif.core.flags import Flag
from erlif.core.products import RatioImages, ThicknessMaps
from erlif.core.progress import Progress
from erlif.files import MapStore, PartialFilm
from erlif.pipeline.chain import FrameChain
from erlif.pipeline.engines import Engine
from erlif.pipeline.film import MAPS
from erlif.pipeline.results import FrameResult, TriggerResult
from erlif.ratio import RatioSum, smooth_ratio
from erlif.thickness import measure_pulse_energy, measure_thickness
from erlif.trend import Region, summarise_film


@dataclass(frozen=True)
class TriggerTask:
    """How the frames of one trigger become its maps, independent of every other trigger.

    Attributes
    ----------
    chain : FrameChain
        Counts to ratio, frame by frame.
    calibration : Calibration
        Ratio to film thickness.
    x : Array
        Positions of the columns. [mm]
    y : Array
        Positions of the rows. [mm]
    region : Region
        Region of interest of the statistics.
    sliding_along_x : bool
        Whether image x is the sliding direction.
    smoothing : int | None
        Resolution of the smoothed ratio behind the maps; None: not smoothed. [px]
    """

    chain: FrameChain
    calibration: Calibration
    x: Array
    y: Array
    region: Region
    sliding_along_x: bool = True
    smoothing: int | None = None

    def __call__(self, frames: Sequence[int]) -> tuple[dict[str, AnyArray], TriggerResult]:
        """Maps and numbers of a trigger.

        Parameters
        ----------
        frames : sequence of int
            Its frame pairs; a trigger without any is flagged as outside the overlap everywhere.

        Returns
        -------
        maps : dict of str to array
            The variables of `MAPS`, (y, x).
        result : TriggerResult
        """
        total = RatioSum(self.chain.pairs.shape)
        kept: list[FrameResult] = []
        for frame in frames:
            ratios = self.chain.ratio(frame)
            total.add(ratios)
            if len(frames) > 1:
                own = measure_thickness(ratios, self.calibration)
                kept.append(self._describe_frame(frame, ratios, own))

        ratio = total.mean()
        if not frames:
            ratio.flags[:] = Flag.OUTSIDE_OVERLAP
        maps = measure_thickness(ratio, self.calibration)
        if len(frames) == 1:  # the film of the trigger is that of its only frame
            kept.append(self._describe_frame(frames[0], ratios, maps))

        statistics = summarise_film(
            ratio,
            maps,
            self.calibration,
            x=self.x,
            y=self.y,
            region=self.region,
            sliding_along_x=self.sliding_along_x,
        )
        # the statistics above need pixels with independent noise, so smoothing comes last
        if self.smoothing is not None:
            smooth = smooth_ratio(ratio, resolution=self.smoothing)
            maps = measure_thickness(smooth, self.calibration)
        images = {variable.name: maps[variable.name].values for variable in MAPS}
        return images, TriggerResult(statistics, tuple(kept))

    def _describe_frame(self, frame: int, ratios: RatioImages, maps: ThicknessMaps) -> FrameResult:
        """Drift, highest counts and pulse energy of one frame pair, given its film."""
        shape = self.chain.pairs.shape
        energy = measure_pulse_energy(
            ratios.signal_camera1.values[0],
            maps.thickness.values.reshape(shape),
            maps.flags.values.reshape(shape),
            attenuation=self.calibration.attenuation_camera1,
        )
        return FrameResult.of(frame, ratios, pulse_energy=energy)


class FinishedTrigger(NamedTuple):
    """What a trigger leaves, compressed.

    Attributes
    ----------
    chunks : dict[str, bytes]
        Maps as the file holds them.
    numbers : dict[str, AnyArray]
        Everything else, as `TriggerResult.to_arrays` gives it.
    """

    chunks: dict[str, bytes]
    numbers: dict[str, AnyArray]


@dataclass(frozen=True)
class TriggerWork:
    """Computes a trigger and compresses what it leaves.

    A store that takes triggers in any order receives them here, in the thread or process that
    computed them; with such a store this can be sent to other processes.

    Attributes
    ----------
    task : Callable[[Sequence[int]], tuple[Mapping[str, AnyArray], TriggerResult]]
        Frames of one trigger to its maps and numbers.
    frames_of : Sequence[Sequence[int]]
        Frame pairs of each trigger.
    maps : MapStore
        Where the triggers are kept.
    """

    task: Callable[[Sequence[int]], tuple[Mapping[str, AnyArray], TriggerResult]]
    frames_of: Sequence[Sequence[int]]
    maps: MapStore

    def __call__(self, trigger: int) -> FinishedTrigger | None:
        """Compute a trigger.

        Parameters
        ----------
        trigger : int
            Number of the trigger, from 0.

        Returns
        -------
        FinishedTrigger or None
            None where the store has it already.
        """
        maps, result = self.task(self.frames_of[trigger])
        made = FinishedTrigger(self.maps.encode(maps), result.to_arrays())
        if not self.maps.any_order:
            return made
        self.maps.put(trigger, made.chunks, made.numbers)
        return None


def run_triggers(
    task: Callable[[Sequence[int]], tuple[Mapping[str, AnyArray], TriggerResult]],
    frames_of: Sequence[Sequence[int]],
    unfinished: PartialFilm,
    *,
    engine: Engine,
    progress: Progress,
) -> list[TriggerResult]:
    """Compute the triggers that are not finished yet, and return the results of all.

    Parameters
    ----------
    task : callable
        Frames of one trigger to its maps and numbers.
    frames_of : sequence of sequence of int
        Frame pairs of each trigger.
    unfinished : PartialFilm
        Receives the maps and numbers of each trigger as soon as they are computed.
    engine : Engine
        Computes the triggers.
    progress : callable

    Returns
    -------
    list of TriggerResult
        In the order of the triggers.
    """

    triggers = range(len(frames_of))
    todo = [trigger for trigger in triggers if not unfinished.has(trigger)]
    finished = len(frames_of) - len(todo)
    place = {trigger: finished + n for n, trigger in enumerate(todo, 1)}

    def collect(trigger: int, made: FinishedTrigger | None) -> None:
        if made is not None:
            unfinished.put(trigger, made.chunks, made.numbers)
        progress("film", place[trigger], len(frames_of))

    engine.compute(TriggerWork(task, frames_of, unfinished.maps), todo, collect)
    return [TriggerResult.from_arrays(unfinished.numbers(trigger)) for trigger in triggers]
