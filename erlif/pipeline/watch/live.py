"""One frame pair of a recording that is not finished: its film, light and drift."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from erlif.calibration import RunCurve
from erlif.core.arrays import Counts, FlagImage, Image
from erlif.core.progress import silent
from erlif.io.ingest import FramePairs, Run, read_pair
from erlif.io.ingest.arrivals import Arrival
from erlif.io.ingest.exclusions import exclude_pixels
from erlif.io.ingest.recording import number_frames
from erlif.io.settings import LightOptions, RunSettings, TemperatureOptions
from erlif.pipeline.engines.results import TriggerResult
from erlif.pipeline.engines.triggers import TriggerTask
from erlif.pipeline.recording.prepare import prepare_run
from erlif.pipeline.recording.register import FixtureMap
from erlif.ratio import PulseSample
from erlif.trend import GapMinimum, GapShape, bent_gap, has_plateau

# Every n-th row and column gives the mean light and the share of saturated pixels. [px]
_EVERY = 4


class LivePair(NamedTuple):
    """Numbers of a pair that was measured while the recording went on.

    Attributes
    ----------
    place : int
        Number in the recording, counted from 0, as `erlif process` counts frame pairs.
    file : str
        Name of the frame of camera 1.
    time : float
        When its second image was found complete. [s since 1970]
    film_min : float
        Minimum of the smooth gap. [um]
    film_min_std : float
        [um]
    film_mean : float
        Mean over the region of interest. [um]
    film_mean_std : float
        [um]
    valid : float
        Share of measurable pixels. [1]
    light : tuple[float, float]
        Mean count of each camera. [DN]
    saturated : tuple[float, float]
        Share of pixels of each camera at full scale. [1]
    drift : tuple[float, float]
        Of camera 2 against the map of the cameras, x and y. [px]
    """

    place: int
    file: str
    time: float
    film_min: float
    film_min_std: float
    film_mean: float
    film_mean_std: float
    valid: float
    light: tuple[float, float]
    saturated: tuple[float, float]
    drift: tuple[float, float]


class LiveMap(NamedTuple):
    """The map of a pair.

    Attributes
    ----------
    title : str
        Which pair it is, for the page.
    thickness : Image
        (y, x). [um]
    flags : FlagImage
        (y, x), bits of `erlif.core.flags.Flag`.
    pulse : PulseSample
        By which its pulse is recognised.
    """

    title: str
    thickness: Image
    flags: FlagImage
    pulse: PulseSample


class LiveGaps(NamedTuple):
    """Minimum of a pair for each contact that the surfaces may have.

    Attributes
    ----------
    films : Mapping[GapShape, tuple[float, float]]
        Minimum and its standard deviation. [um]
    bent : tuple[GapShape, GapMinimum]
        The gap by whose bend the contact of the run is chosen (`erlif.trend.bent_gap`).
    level : bool
        Whether its map has a plateau.
    """

    films: Mapping[GapShape, tuple[float, float]]
    bent: tuple[GapShape, GapMinimum]
    level: bool


@dataclass(frozen=True)
class LiveFilm:
    """Task that computes the film of single pairs during the recording.

    Attributes
    ----------
    task : TriggerTask
        Frames to maps and numbers, with the map of the cameras.
    pairs : int
        Pairs from which references and map were found.
    """

    task: TriggerTask
    pairs: int

    @classmethod
    def prepare(cls, run: Run, calibration: RunCurve, known: FixtureMap) -> LiveFilm:
        """Register the cameras on the pairs that there are.

        What only a whole run determines (bleaching, scale of a patch, temperature of each row of
        the log) is left out; it is in film.nc.

        Raises
        ------
        ErlifError
            As `prepare_run`.
        """
        # without corrections that need a log or the whole run
        light = LightOptions(background=run.settings.light.background)
        alone = {"light": light, "temperature": TemperatureOptions()}
        run = replace(run, settings=run.settings.model_copy(update=alone))
        trigger = xr.Dataset({"trigger": ("frame", np.arange(len(run.pairs.pages[0])))})
        ready = prepare_run(run, trigger, calibration, known, silent)
        task = replace(TriggerTask.of(ready), sampled=frozenset(), with_position=False)
        return cls(task, len(run.pairs.pages[0]))

    def measure(
        self, pairs: FramePairs, frame: int, arrival: Arrival
    ) -> tuple[LivePair, LiveMap, LiveGaps | None]:
        """Measure one pair.

        Parameters
        ----------
        pairs : FramePairs
            The pairs so far.
        frame : int
            Number of the pair among them.
        arrival : Arrival

        Returns
        -------
        LivePair
        LiveMap
        LiveGaps or None
            None where the surfaces have one contact, whose minimum the pair has.

        Raises
        ------
        FrameError
            If its files cannot be read.
        """
        read = read_pair(pairs, frame)
        maps, result = self.task.measure_pair(read, 0, 0.0)
        light, saturated = measure_counts(read.counts, pairs.full_scales)
        film, name = result.statistics, arrival.pages[0].name
        covariance = self.task.curve.full_covariance
        pair = LivePair(
            arrival.place,
            name,
            arrival.time,
            film.gap.minimum.value,
            film.gap.minimum.std(covariance),
            film.mean.value,
            film.mean.std(covariance),
            result.pixels[0] / maps["flags"].size,
            light,
            saturated,
            result.frames[0].drift,
        )
        shown = LiveMap(
            f"pair {arrival.place}, {name}",
            maps["thickness"].copy(),
            maps["flags"].copy(),
            result.frames[0].pulse,
        )
        return pair, shown, self._gaps(result)

    def _gaps(self, result: TriggerResult) -> LiveGaps | None:
        if not result.minima:
            return None
        covariance = self.task.curve.full_covariance
        films = {
            contact: (gap.minimum.value, gap.minimum.std(covariance))
            for contact, gap in result.minima.items()
        }
        return LiveGaps(films, bent_gap(result.minima), has_plateau(result.minima))


def measure_counts(
    counts: Sequence[Counts], full_scales: tuple[int, int]
) -> tuple[tuple[float, float], tuple[float, float]]:
    """Mean count [DN] and share of pixels at full scale of both cameras.

    Examples
    --------
    >>> dark, bright = np.zeros((8, 8), np.uint16), np.full((8, 8), 4095, np.uint16)
    >>> measure_counts((dark, bright), (4095, 4095))
    ((0.0, 4095.0), (0.0, 1.0))
    """
    parts = [image[::_EVERY, ::_EVERY] for image in counts]
    one, two = (float(part.mean()) for part in parts)
    first, second = (
        float((part >= full).mean()) for part, full in zip(parts, full_scales, strict=True)
    )
    return (one, two), (first, second)


def run_of(directory: Any, settings: RunSettings, pairs: FramePairs) -> Run:
    """A run of the pairs so far; its frames are numbered in place of a log."""
    if pairs.pages[0]:  # before the first pair no size is known
        pairs = replace(pairs, excluded=exclude_pixels(directory, settings, pairs.shape))
    return Run(directory, settings, pairs, number_frames(pairs))
