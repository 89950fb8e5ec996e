"""The uncertainty of one map by source of error: in a pixel, in the mean and in the minimum."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import zip_longest
from pathlib import Path

import numpy as np
import xarray as xr

from erlif.calibration import Calibration, RunCurve
from erlif.core.arrays import Array, Mask
from erlif.core.detector import QUANTISATION_VAR
from erlif.core.errors import ConfigError
from erlif.core.products import AlignedFrames, CorrectedFrames, RatioImages
from erlif.core.progress import ShowProgress, choose_progress
from erlif.core.terms import TERMS
from erlif.io.files import takes
from erlif.io.ingest import open_run
from erlif.pipeline.chain import FrameChain, one_thread_per_frame
from erlif.pipeline.cycle import group_frames
from erlif.pipeline.engines.results import TriggerResult, share_passed
from erlif.pipeline.fixture import find_calibration
from erlif.pipeline.physics.clock import fit_start
from erlif.pipeline.physics.joint import locate_run
from erlif.pipeline.physics.light import measure_lights
from erlif.pipeline.physics.texture import with_texture
from erlif.pipeline.recording.prepare import prepare_run
from erlif.planning.target import NINE_OF_TEN, read_target, shortest_list
from erlif.ratio import PairRatio, RatioSum
from erlif.review.target import errors_of_run
from erlif.thickness import flag_beyond_maximum, flag_steps, measure_thickness
from erlif.trend import FilmStatistics, summarise_film

# Errors that average out over pixels and frames, over pixels only, and not at all.
RANDOM, FIXED, SHARED = "random", "random, the same in every frame", "shared"


_DRY = "frames of the dry joint"  # A source of runs with a background alone


# Sources of noise in a camera, in the order of the chain.
_KINDS = {
    "photons": RANDOM,
    "reading and rounding": RANDOM,
    "dark frames": FIXED,
    "flat frames": FIXED,
    _DRY: FIXED,
}


def _term(what: str, camera: int) -> str:
    """Name of a source in the budget; `camera` counts from 0."""
    return f"{what}, camera {camera + 1}"


_NOISE_TERMS = tuple(_term(what, camera) for what in _KINDS for camera in range(2))

_MARKS, _FORM = "marks of the surfaces", "form of the gap"
_SHARED_TERMS = ("registration", "calibration", *TERMS, _MARKS, _FORM)
_ALL_NOISE = "noise of all kinds"

# Rows that a budget may lack: an error that is absent, or that the settings exclude, has none.
_MAY_LACK = {*(_term(_DRY, camera) for camera in range(2)), *TERMS, _FORM}

_NEAR = 0.05  # relative distance within which pixels represent a film thickness

_LEAST_PIXELS = 50  # pixels that represent a film thickness, at least


@dataclass(frozen=True)
class _Column:
    """One quantity of the budget: a film thickness, and its standard deviation by source. [um]"""

    title: str
    value: float
    terms: Mapping[str, float]


@dataclass(frozen=True)
class _Sources:
    """Variance of the log ratio of one trigger by source, (camera, y, x)."""

    variances: dict[str, Array]
    ratio: RatioImages
    # factors by which blur and interpolation lower the variance of a pixel of each camera [1]
    averaging: tuple[float, float]


@takes(run_dir="run", calibration="calibration path")
def budget(
    run_dir: str | Path,
    *,
    trigger: int | None = None,
    calibration: Calibration | str | Path | None = None,
    films: tuple[float, ...] | None = None,
    target: str | None = None,
    skip_bad_frames: bool = False,
    allow_outside: bool = False,
    progress: ShowProgress = None,
) -> xr.Dataset:
    """Compute what each source of error leaves in the map of one trigger.

    Parameters
    ----------
    run_dir : path
        As for `erlif.process`.
    trigger : int, optional
        Default: the fastest.
    calibration : Calibration or path, optional
        As for `erlif.process`.
    films : tuple of float, optional
        Film thicknesses for whose pixels the budget is made; default: the 10th, 50th and 90th
        percentile of the map. [um]
    target : str, optional
        Error within which nine of ten runs shall lie at the median film, "1 %" or "50 nm", by the
        shortest list of remedies. Their standard deviation is 1/1.645 of it at most.
    skip_bad_frames, allow_outside : bool
        As for `erlif.process`.
    progress : "bar", bool or callable, optional
        As for `erlif.process`.

    Returns
    -------
    xarray.Dataset
        std (term, quantity): standard deviation, NaN where a term does not enter [um]; kind (term);
        value (quantity), the film thickness itself [um]. The quantities are single pixels of the
        given films, the mean and the minimum film thickness of the region of interest. The sums
        among the terms are in quadrature. The attribute declared_zero names the terms whose key in
        [systematics] is 0. With a target, target_std (remedy, target_film): what the remedies
        leave, each with those before it. [um]

    Raises
    ------
    ErlifError
        As `erlif.process`, and where the trigger does not exist or has no valid pixel of a given
        film.

    Examples
    --------
    >>> table = budget("data_samples/straight_bushing", trigger=12)  # doctest: +SKIP
    >>> table["std"].sel(term="total", quantity="mean film")  # doctest: +SKIP
    """
    progress = choose_progress(progress)
    goal = None if target is None else read_target(target)
    run = open_run(
        Path(run_dir),
        skip_bad_frames=skip_bad_frames,
        find_start=fit_start,
        allow_outside=allow_outside,
    )
    cycle = locate_run(run)
    trigger, frames = _choose_trigger(trigger, cycle, group_frames(cycle, run.pairs))
    curve, known = find_calibration(
        run, calibration, allow_outside=allow_outside, progress=progress
    )

    # errors of noise by source need the references, light that is not film the whole run
    ready = prepare_run(run, cycle, curve, known, progress, tables_only=False)
    findings, _, whole = ready.judge_light(
        lambda: measure_lights(ready.chain, ready.curve, ready.plane.patch)
    )
    measuring = whole.at(share_passed(frames, len(run.pairs.pages[0])))
    plane = ready.plane

    sources = _separate_sources(ready.chain, frames)
    images = sources.ratio
    flag_beyond_maximum(images.log_ratio.values, images.flags.values, measuring)
    flag_steps(images.log_ratio.values, images.log_ratio_var.values, images.flags.values)
    maps = measure_thickness(images, measuring)
    valid = maps.flags.values == 0
    if not valid.any():
        raise ConfigError(
            f"Expected a trigger with valid pixels; trigger {trigger} has none, every pixel is "
            "flagged. Name another trigger."
        )

    region = plane.region
    statistics = summarise_film(
        sources.ratio,
        maps,
        measuring,
        region=region,
        sliding_along_x=plane.sliding_along_x,
        contacts=plane.contacts,
    )
    (result,), measuring = with_texture(
        [TriggerResult(statistics, (), ())], measuring, findings, plane, plane.contacts[0]
    )
    statistics = result.statistics

    # film thickness by the surroundings of each pixel
    near = np.where(valid, maps.log_ratio_near.values, 0.0)
    film = measuring.inverse.look_up(near)

    # single pixels, then the two statistics of the region
    columns = _pixel_columns(sources, film, valid, measuring, films, trigger)
    inside = np.zeros_like(valid)
    inside[region.rows, region.columns] = valid[region.rows, region.columns]
    rate = 1 / measuring.slope(film)
    columns += [
        _budget_of_mean(statistics, measuring, sources, rate, inside),
        _minimum_column(statistics, measuring),
    ]
    table = _as_dataset(columns, run.settings.name, trigger, len(frames))
    shares = run.settings.systematics.shares
    table.attrs["declared_zero"] = [key for key, share in shares.items() if share == 0]
    if goal is not None:
        noise = statistics.mean.random_std * float(measuring.slope(statistics.mean.value))
        table["target_std"] = shortest_list(
            errors_of_run(ready, whole, noise), goal, within=NINE_OF_TEN
        )
    return table


def _choose_trigger(
    trigger: int | None, cycle: xr.Dataset, frames_of: Sequence[list[int]]
) -> tuple[int, list[int]]:
    """The trigger asked for, or the fastest, with its frames."""
    if trigger is None:
        name = "rocker_speed" if "rocker_speed" in cycle else "sliding_speed"
        fastest = int(np.argmax(np.abs(cycle[name].values))) if name in cycle else 0
        trigger = int(cycle.trigger[fastest])
    if not 0 <= trigger < len(frames_of) or not frames_of[trigger]:
        raise ConfigError(
            f"Expected a trigger from 0 to {len(frames_of) - 1} that has frames; got {trigger}. "
            "Choose another with --trigger."
        )
    return trigger, frames_of[trigger]


def _separate_sources(chain: FrameChain, frames: Sequence[int]) -> _Sources:
    """Combine the frames of a trigger, and keep the variance of each source apart."""
    shape = chain.pairs.shape
    total = RatioSum(shape)
    variances = {what: np.zeros((2, *shape)) for what in _KINDS}
    averaging = []
    with one_thread_per_frame():
        for frame in frames:
            corrected, aligned = chain.align(frame)
            weight = total.add(PairRatio.of(chain.divide(aligned))).astype(float)
            _add_sources(variances, chain, corrected, aligned, weight)
            averaging.append(float(aligned.interpolation[0]))
    one, two = chain.softening.factors

    # random errors of frames add in quadrature, those of dark and flat linearly
    weight = np.where(total.weight > 0, total.weight, np.inf)
    for what, variance in variances.items():
        variance /= weight**2 if _KINDS[what] == RANDOM else weight
    ratio = RatioImages(total.mean().to_images().isel(frame=0))
    return _Sources(variances, ratio, (one, two * float(np.mean(averaging))))


def _add_sources(
    variances: dict[str, Array],
    chain: FrameChain,
    corrected: CorrectedFrames,
    aligned: AlignedFrames,
    weight: Array,
) -> None:
    """Add the weighted relative variance of each source in one frame."""
    references = chain.references
    flat, flat_var, dark_var = (
        references[name].values[:, None].astype(float) for name in ("flat", "flat_var", "dark_var")
    )
    gain, read_noise = (
        references[name].values[:, None, None, None] for name in ("gain", "read_noise")
    )
    signal = corrected.signal.values.astype(float)
    reading = (read_noise / gain) ** 2 + QUANTISATION_VAR
    counts = signal * flat
    of_page = np.zeros_like(dark_var)
    if "background" in references:
        energy = chain.correct.energy(int(corrected.frame[0]))
        recorded = references.background_recorded.values[:, None, None, None]
        counts += energy * references.background.values[:, None]
        dark_var *= (1 - energy * recorded) ** 2
        of_page = energy**2 * references.background_var.values[:, None].astype(float)
    lowered = np.reshape(chain.softening.factors, (2, 1, 1))
    sources = {
        "photons": np.maximum(counts, 0) / (flat**2 * gain),
        "reading and rounding": reading / flat**2 + 0 * signal,
        "dark frames": dark_var / flat**2 + 0 * signal,
        "flat frames": (signal / flat) ** 2 * flat_var,
        _DRY: of_page / flat**2 + 0 * signal,
    }

    # two sources at a time take the places of the two variances in the alignment
    names = list(sources)
    if not of_page.any():
        names.remove(_DRY)
    for one, other in zip_longest(names[::2], names[1::2]):
        single = (sources[name].astype(np.float32) for name in (one, other or one))
        moved = chain.align_variances(corrected, *single)
        images = {other or one: moved.signal_var_fixed} | {one: moved.signal_var}
        for name, image in images.items():
            with np.errstate(divide="ignore", invalid="ignore"):  # pixels without light or weight
                relative = image.values[:, 0] / np.square(aligned.signal.values[:, 0], dtype=float)
                relative *= lowered
            power = weight**2 if _KINDS[name] == RANDOM else weight
            variances[name] += power * np.where(weight > 0, relative, 0.0)


def _pixel_columns(
    sources: _Sources,
    film: Array,
    valid: Mask,
    calibration: RunCurve,
    films: tuple[float, ...] | None,
    trigger: int,
) -> list[_Column]:
    """The budget of single pixels of some film thicknesses."""
    rate = 1 / calibration.slope(film)
    displaced = np.sqrt(sources.ratio.log_ratio_var_shared.values)
    columns = []
    typical = {float(f"{value:.3g}") for value in np.percentile(film[valid], [10, 50, 90])}
    for wanted in films or sorted(typical):
        # a film thickness is represented by the median of the pixels near it
        near = valid & (np.abs(film / wanted - 1) < _NEAR)
        if near.sum() < _LEAST_PIXELS:
            raise ConfigError(
                f"Expected at least {_LEAST_PIXELS} valid pixels of {wanted:g} um in the map of "
                f"trigger {trigger}, which runs from {film[valid].min():.2f} to "
                f"{film[valid].max():.2f} um; got {int(near.sum())}. Name other films or another "
                "trigger."
            )

        terms = {
            _term(what, camera): float(np.median(np.sqrt(variance[near]) * rate[near]))
            for what, pair in sources.variances.items()
            for camera, variance in enumerate(pair)
        }
        terms["registration"] = float(np.median(displaced[near] * rate[near]))
        terms |= calibration.split_error(calibration.film_gradient(wanted), anywhere=True)
        columns.append(_Column(f"pixel of {wanted:g} um", wanted, terms))
    return columns


def _budget_of_mean(
    statistics: FilmStatistics,
    calibration: RunCurve,
    sources: _Sources,
    rate: Array,
    region: Mask,
) -> _Column:
    """The budget of the mean film thickness.

    Interpolation and blur move noise between pixels, and do not lower it in the mean.
    """
    terms = {}
    for what, pair in sources.variances.items():
        for camera, variance in enumerate(pair):
            spread = sources.averaging[camera]
            total = float(np.sqrt((rate[region] ** 2 * variance[region]).sum() / spread))
            terms[_term(what, camera)] = total / int(region.sum())

    # What the noise of the mean holds beyond these terms is the registration. Where the films of a
    # block differ much, as near the end of the range, its mean has less noise than its pixels by
    # their slopes: the terms are then shares of it.
    known, random = sum(value**2 for value in terms.values()), statistics.mean.random_std**2
    share = math.sqrt(min(random / known, 1.0)) if known else 0.0
    terms = {term: share * value for term, value in terms.items()}
    terms["registration"] = math.sqrt(max(random - known, 0.0))
    terms |= calibration.split_error(statistics.mean.gradient)
    return _Column("mean film", statistics.mean.value, terms)


def _minimum_column(statistics: FilmStatistics, calibration: RunCurve) -> _Column:
    """The budget of the minimum film thickness."""
    lowest = statistics.gap.minimum
    terms = {
        _ALL_NOISE: lowest.random_std,
        _FORM if statistics.departs else _MARKS: lowest.surface_std,
        **calibration.split_error(lowest.gradient),
    }
    return _Column("minimum film", lowest.value, terms)


def _as_dataset(columns: Sequence[_Column], name: str, trigger: int, frames: int) -> xr.Dataset:
    """Terms in the order of the chain, with the sums of the random and of the shared ones."""
    random = [*_NOISE_TERMS, _ALL_NOISE]
    sums = {
        "random part": random,
        "shared part": list(_SHARED_TERMS),
        "total": [*random, *_SHARED_TERMS],
    }
    rows = {
        term: [column.terms.get(term, np.nan) for column in columns]
        for term in (*_NOISE_TERMS, *_SHARED_TERMS)
    }
    for title, members in sums.items():
        rows[title] = [
            float(np.sqrt(sum(column.terms.get(term, 0.0) ** 2 for term in members)))
            for column in columns
        ]

    noise, shared = (
        [term for term in terms if term not in _MAY_LACK or np.nan_to_num(rows[term]).any()]
        for terms in (_NOISE_TERMS, _SHARED_TERMS)
    )
    order = [*noise, "random part", *shared, "shared part", "total"]
    kinds = {_term(what, camera): _KINDS[what] for what in _KINDS for camera in range(2)}
    kinds |= dict.fromkeys(_SHARED_TERMS, SHARED) | dict.fromkeys(sums, "sum")
    std = np.array([rows[term] for term in order])
    return xr.Dataset(
        {
            "std": (("term", "quantity"), std, {"units": "um"}),
            "kind": ("term", np.array([kinds[term] for term in order])),
            "value": ("quantity", np.array([column.value for column in columns]), {"units": "um"}),
        },
        {"term": order, "quantity": [column.title for column in columns]},
        {"run": name, "trigger": trigger, "frames": frames},
    )
