"""The frames of each trigger to its maps and statistics, several triggers at a time."""

from __future__ import annotations

import os
import platform
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

from erlif.calibration import RunCurve
from erlif.core.arrays import AnyArray
from erlif.core.errors import ClusterError
from erlif.core.flags import FLAG_ATTRS, Flag, count_flags
from erlif.core.pickling import PickledByFields
from erlif.core.progress import Progress
from erlif.core.variables import FILM
from erlif.io.files import MapStore, MapVariable, PartialFilm
from erlif.io.ingest import PairCounts
from erlif.pipeline.chain import FrameChain
from erlif.pipeline.engines.engine import Engine
from erlif.pipeline.engines.results import FrameResult, TriggerResult, share_passed
from erlif.pipeline.passes import FilmMaps, measure_film, measure_pulse
from erlif.pipeline.physics.light import choose_frames
from erlif.pipeline.physics.reference import flag_thick_films
from erlif.pipeline.plane import ObjectPlane
from erlif.pipeline.recording.prepare import PreparedRun
from erlif.ratio import PairRatio, RatioSum, smooth_ratio
from erlif.thickness import FilmTables, flag_steps, measure_pulse_energy
from erlif.trend import FilmCurve, find_gap_minima, find_pin_in_blocks, summarise_blocks

# Triggers after which a run is inspected for the first time.
EARLY = 24

# What of each map is kept, as its uncertainty allows.
_PRECISION: dict[str, dict[str, Any]] = {
    "thickness": {"std": "thickness_std"},
    "thickness_std": {"bits": 5},  # at most 1.6 %; gain and read noise are known to 1 to 2 %
    "thickness_std_shared": {"bits": 4},  # at most 3 %; its covariance is known to 10 %
    "flags": {},
}

# The maps of film.nc, each with the precision that its uncertainty leaves.
MAPS = [
    MapVariable(
        name,
        FILM[name].dtype,
        FLAG_ATTRS if name == "flags" else FILM[name].attrs,
        **precision,
    )
    for name, precision in _PRECISION.items()
]


@dataclass(frozen=True)
class TriggerTask(PickledByFields):
    """Task that turns the frames of one trigger into maps, independent of other triggers.

    Attributes
    ----------
    chain : FrameChain
        Counts to ratio, frame by frame.
    curve : RunCurve
        Ratio to film thickness.
    plane : ObjectPlane
        Region of interest of the statistics, reference patch, and the joint as the camera sees it.
    sampled : frozenset[int]
        Frame pairs whose light is kept in coarse cells.
    with_position : bool
        Whether the position of the pin is found, where the joint shows it.
    """

    chain: FrameChain
    curve: RunCurve
    plane: ObjectPlane
    sampled: frozenset[int]
    with_position: bool = True

    @classmethod
    def of(cls, ready: PreparedRun) -> TriggerTask:
        """The task for the triggers of a run."""
        return cls(ready.chain, ready.curve, ready.plane, choose_frames(ready.run.pairs))

    def __call__(self, frames: Sequence[int]) -> tuple[dict[str, AnyArray], TriggerResult]:
        """Maps and numbers of a trigger.

        Parameters
        ----------
        frames : sequence of int
            Its frame pairs; a trigger without any is flagged as outside the overlap everywhere.

        Returns
        -------
        maps : dict of str to array
            The variables of `MAPS`, (y, x). The next call in the same thread may fill the same
            arrays.
        result : TriggerResult
        """
        passed = share_passed(frames, len(self.chain.pairs.pages[0]))
        if len(frames) == 1:
            return self.measure_pair(frames[0], frames[0], passed)
        kept, total = [], RatioSum(self.chain.pairs.shape)
        curve = self.film_curve.at(passed)
        tables, model = self._tables_at(passed, curve), self.curve.model
        for frame in frames:
            pair = self.chain.measure(frame)
            total.add(pair)
            if frame in self.sampled:
                flag_thick_films(pair, curve.calibration, self.plane.patch)
            energy = measure_pulse(pair, tables, model=model)
            kept.append(replace(self._keep(frame, pair), pulse_energy=energy))
        ratio = total.mean()
        if not frames:
            ratio.flags[:] = Flag.OUTSIDE_OVERLAP
        flag_thick_films(ratio, curve.calibration, self.plane.patch)
        film = self._measure_film(ratio, tables)
        return self._summarise(ratio, film, kept, curve, tables)

    def measure_pair(
        self, pair: int | PairCounts, frame: int, passed: float
    ) -> tuple[dict[str, AnyArray], TriggerResult]:
        """Maps and numbers of a trigger that has one frame pair.

        Parameters
        ----------
        pair : int or PairCounts
            As for `FrameChain.measure`.
        frame : int
            Its number.
        passed : float
            Share of the run that has passed. [1]

        Returns
        -------
        maps, result
            As for a call.
        """
        smooth = self.plane.settings.thickness.smoothing is not None
        ratio = self.chain.measure(pair, with_fixed=smooth)
        curve = self.film_curve.at(passed)
        tables = self._tables_at(passed, curve)
        flag_thick_films(ratio, curve.calibration, self.plane.patch)
        kept = self._keep(frame, ratio)  # the maps may take the place of the ratio
        film = self._measure_film(ratio, tables)
        energy = measure_pulse_energy(
            ratio.light_one, film.thickness, film.flags, model=self.curve.model
        )
        return self._summarise(ratio, film, [replace(kept, pulse_energy=energy)], curve, tables)

    def _measure_film(self, ratio: PairRatio, tables: FilmTables) -> FilmMaps:
        """Film of a ratio, with the sums over the region."""
        flag_steps(ratio.log_ratio, ratio.variance, ratio.flags)
        return measure_film(ratio, tables, self.plane.region)

    def _summarise(
        self,
        ratio: PairRatio,
        film: FilmMaps,
        kept: Sequence[FrameResult],
        curve: FilmCurve,
        tables: FilmTables,
    ) -> tuple[dict[str, AnyArray], TriggerResult]:
        """Maps and numbers of a film: minima, statistics and the position of the pin."""
        plane = self.plane
        minima = find_gap_minima(
            film.sums,
            curve,
            region=plane.region,
            sliding_along_x=plane.sliding_along_x,
            contacts=plane.contacts,
            bore=plane.bore,
        )
        statistics = summarise_blocks(
            film.sums, curve, minima[plane.contacts[0]], region=plane.region
        )
        position = None
        if self.with_position and plane.view is not None:
            position = find_pin_in_blocks(film.sums, curve, region=plane.region, view=plane.view)

        # the statistics above need pixels with independent noise, so smoothing comes last
        smoothing = plane.settings.thickness.smoothing
        if smoothing is not None:
            smooth = smooth_ratio(ratio.to_images(), resolution=smoothing)
            film = measure_film(PairRatio.of(smooth), tables, plane.region)
        maps = {variable.name: getattr(film, variable.name) for variable in MAPS}
        pixels = tuple(count_flags(maps["flags"]))
        several = minima if len(minima) > 1 else {}
        return maps, TriggerResult(statistics, tuple(kept), pixels, position, several)

    def _keep(self, frame: int, pair: PairRatio) -> FrameResult:
        """Collect the results of a frame, with its light in patch and cells if it is sampled."""
        cells = frame in self.sampled
        return FrameResult.of(frame, pair, patch=self.plane.patch, with_cells=cells)

    def _tables_at(self, passed: float, curve: FilmCurve) -> FilmTables:
        """The calibration in tables for the maps, when a share of the run has passed."""
        if self.curve.moves:
            return FilmTables.of(curve.calibration)
        first, last, middle = self.tables
        return first if last is None else first.growing_to(last, passed, middle)

    @cached_property
    def tables(self) -> tuple[FilmTables, FilmTables | None, FilmTables | None]:
        """The calibration in tables at the first frame, and at the last where they differ.

        And in the middle of the run, where what grows is correlated with what does not.
        """
        first, last = self.curve.at(0.0), self.curve.at(1.0)
        if last is first:
            return FilmTables.of(first), None, None
        apart = last.systematics.grows_apart
        middle = None if apart else FilmTables.of(self.curve.at(0.5))
        return FilmTables.of(first), FilmTables.of(last), middle

    @cached_property
    def film_curve(self) -> FilmCurve:
        """The calibration in tables for the statistics, at the last frame."""
        return FilmCurve.of(self.curve.at(1.0))


class FinishedTrigger(NamedTuple):
    """Compressed maps and numbers of a finished trigger.

    Attributes
    ----------
    chunks : dict[str, bytes]
        Maps as the file holds them; empty where the store has them already.
    numbers : dict[str, AnyArray]
        Everything else, as `TriggerResult.to_arrays` gives it.
    """

    chunks: dict[str, bytes]
    numbers: dict[str, AnyArray]


@dataclass(frozen=True)
class TriggerWork:
    """Computes a trigger and compresses what it leaves.

    A store that takes triggers in any order receives them here, in the thread or process that
    computed them. With either store this can be sent to other processes.

    Attributes
    ----------
    task : Callable[[Sequence[int]], tuple[Mapping[str, AnyArray], TriggerResult]]
        Frames of one trigger to its maps and numbers.
    frames_of : Sequence[Sequence[int]]
        Frame pairs of each trigger.
    maps : MapStore
        Where the triggers are kept.
    places : tuple[Path, ...]
        Files that every process reads.
    """

    task: Callable[[Sequence[int]], tuple[Mapping[str, AnyArray], TriggerResult]]
    frames_of: Sequence[Sequence[int]]
    maps: MapStore
    places: tuple[Path, ...] = ()

    def __call__(self, trigger: int) -> FinishedTrigger:
        """Compute a trigger.

        Parameters
        ----------
        trigger : int
            Number of the trigger, from 0.

        Returns
        -------
        FinishedTrigger
        """
        maps, result = self.task(self.frames_of[trigger])
        made = FinishedTrigger(self.maps.encode(maps), result.to_arrays())
        if not self.maps.any_order:
            return made
        self.maps.put(trigger, made.chunks, made.numbers)
        return made._replace(chunks={})

    def check(self) -> None:
        """Refuse a process that does not see the files; called once in each.

        Raises
        ------
        ClusterError
            If a file is missing.
        """
        output = (self.maps.path,) if self.maps.any_order else ()
        for path in (*self.places, *output):
            if not os.access(path, os.R_OK):
                raise ClusterError(
                    f"Expected {path} on every machine with workers; {platform.node()} cannot read "
                    "it. Run directory and output stand on a disk that all machines share, under "
                    "the same path."
                )


def run_triggers(
    task: Callable[[Sequence[int]], tuple[Mapping[str, AnyArray], TriggerResult]],
    frames_of: Sequence[Sequence[int]],
    unfinished: PartialFilm,
    *,
    engine: Engine,
    progress: Progress,
    places: Sequence[Path] = (),
    inspect: Callable[[Sequence[TriggerResult]], object] | None = None,
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
    places : sequence of Path, optional
        Files that every process of the engine reads.
    inspect : callable, optional
        Receives the results of the first triggers as soon as there are `EARLY`; what it raises ends
        the work. A long run in a wrong order is refused early.

    Returns
    -------
    list of TriggerResult
        In the order of the triggers.
    """
    triggers = range(len(frames_of))
    todo = [trigger for trigger in triggers if not unfinished.has(trigger)]
    finished = len(frames_of) - len(todo)
    place = {trigger: finished + n for n, trigger in enumerate(todo, 1)}

    results: dict[int, TriggerResult] = {}

    def collect(trigger: int, made: FinishedTrigger) -> None:
        if made.chunks:
            unfinished.put(trigger, made.chunks, made.numbers)
        results[trigger] = TriggerResult.from_arrays(made.numbers)
        progress("film", place[trigger], len(frames_of))
        if inspect is not None and len(results) == EARLY:
            inspect(list(results.values()))

    engine.compute(TriggerWork(task, frames_of, unfinished.maps, tuple(places)), todo, collect)

    # a shared disk may show a file later than the process that wrote it reports it
    return [
        results.get(trigger) or TriggerResult.from_arrays(unfinished.maps.numbers(trigger))
        for trigger in triggers
    ]
