"""The uncertainty of one map, term by term: what a pixel, the mean film and the least film owe to each source of error."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import xarray as xr

from erlif.calibration import Calibration, check_bands
from erlif.core.arrays import Array, Mask
from erlif.core.detector import QUANTISATION_VAR
from erlif.core.errors import ConfigError
from erlif.core.products import CorrectedFrames
from erlif.core.progress import Progress, silent
from erlif.correction import correct_frames, measure_references
from erlif.ingest import open_run, read_frames
from erlif.kinematics import locate_frames
from erlif.pipeline.chain import Chain, one_thread_per_frame
from erlif.pipeline.film import group_frames, pixel_positions
from erlif.pipeline.fixture import find_calibration
from erlif.pipeline.run import open_chain
from erlif.ratio import RatioSum
from erlif.registration import align_frames
from erlif.settings import RunSettings
from erlif.thickness import measure_thickness
from erlif.trend import FilmStatistics, region_mask, summarise_film

RANDOM, FIXED, SHARED = "random", "random, the same in every frame", "shared"
"""What an average over pixels and frames lessens, over pixels only, and not at all."""


_SOURCES = {
    "photons, camera 1": RANDOM,
    "photons, camera 2": RANDOM,
    "reading and rounding, camera 1": RANDOM,
    "reading and rounding, camera 2": RANDOM,
    "dark frames, camera 1": FIXED,
    "dark frames, camera 2": FIXED,
    "flat frames, camera 1": FIXED,
    "flat frames, camera 2": FIXED,
}


_NEAR = 0.05  # pixels whose film is this close, relatively, stand for a film


def budget(
    run_dir: str | Path,
    *,
    trigger: int | None = None,
    calibration: Calibration | str | Path | None = None,
    films: tuple[float, ...] | None = None,
    progress: Progress = silent,
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
        Films for whose pixels the budget is made; default: the 10th, 50th and 90th percentile of the map. [um]
    progress : callable, optional

    Returns
    -------
    xarray.Dataset
        std (term, quantity): standard deviation, NaN where a term does not enter [um]; kind (term); value (quantity), the film itself
        [um]. The quantities are single pixels of the given films, the mean film and the least film of the region of interest. The
        sums among the terms are in quadrature.

    Raises
    ------
    ErlifError
        As `erlif.process`, and where the trigger does not exist or has no valid pixel of a given film.
    """
    recording = open_run(Path(run_dir))
    settings = recording.settings
    assert isinstance(settings, RunSettings)
    assert recording.log is not None
    located = locate_frames(recording.log, settings)
    frames_of = group_frames(located, recording)
    if trigger is None:
        trigger = int(located.trigger[int(np.argmax(np.abs(located.rocker_speed.values)))])
    if not 0 <= trigger < len(frames_of) or not frames_of[trigger]:
        raise ConfigError(
            f"Expected a trigger from 0 to {len(frames_of) - 1} that has frames; got {trigger}."
        )
    calibration = find_calibration(recording, calibration, progress=progress)
    check_bands(calibration, (settings.camera1.band, settings.camera2.band))
    chain = open_chain(recording, measure_references(recording), calibration, progress)
    total = RatioSum(recording.shape)
    variances = {source: np.zeros(recording.shape) for source in _SOURCES}
    averaging = []
    with one_thread_per_frame():
        for frame in frames_of[trigger]:
            ratios = chain.ratio(frame)
            averaging.append(
                _add_sources(variances, chain, frame, total.weigh(ratios, 0).astype(float))
            )
            total.add(ratios)
    frames = len(averaging)
    weight = np.where(total.weight > 0, total.weight, np.inf)
    for source, variance in variances.items():
        variance /= weight**2 if _SOURCES[source] == RANDOM else weight
    ratio = total.mean()
    maps = measure_thickness(ratio, calibration)
    x, y = pixel_positions(recording)
    rows, columns = region_mask(settings, x, y)
    sliding_along_x = settings.optics.x_axis == "sliding"
    statistics = summarise_film(
        ratio,
        maps,
        calibration,
        x=x,
        y=y,
        rows=rows,
        columns=columns,
        sliding_along_x=sliding_along_x,
    )
    valid = maps.flags.values == 0
    if not valid.any():
        raise ConfigError(
            f"Expected a trigger with valid pixels; trigger {trigger} has none, every pixel is flagged. Name another trigger."
        )
    table = calibration.inverse
    places = table.start + table.step * np.arange(table.thickness.size)
    film = np.interp(np.where(valid, maps.log_ratio_near.values, 0.0), places, table.thickness)
    rate = 1 / calibration.slope(film)
    displaced = np.sqrt(ratio.log_ratio_var_shared.values)
    columns_of: list[tuple[str, float, dict[str, float]]] = []
    for wanted in films or _typical_films(film[valid]):
        near = valid & (np.abs(film / wanted - 1) < _NEAR)
        if near.sum() < 50:
            raise ConfigError(
                f"Expected at least 50 valid pixels of {wanted:g} um in the map of trigger {trigger}, which runs from {film[valid].min():.2f} "
                f"to {film[valid].max():.2f} um; got {int(near.sum())}. Name other films or another trigger."
            )
        terms = {
            source: float(np.median(np.sqrt(variance[near]) * rate[near]))
            for source, variance in variances.items()
        }
        terms["registration"] = float(np.median(displaced[near] * rate[near]))
        terms["calibration"] = float(calibration.thickness_std(wanted))
        columns_of.append((f"pixel of {wanted:g} um", wanted, terms))
    region = np.zeros_like(valid)
    region[rows, columns] = valid[rows, columns]
    columns_of.append(
        _mean_column(statistics, calibration, variances, rate, region, float(np.mean(averaging)))
    )
    least = {
        "noise of all kinds": statistics.minimum_random_std,
        "marks of the surfaces": statistics.minimum_surface_std,
    }
    least["calibration"] = _by_calibration(statistics.minimum_gradient, calibration)
    columns_of.append(("least film", statistics.minimum, least))
    return _as_dataset(columns_of, settings.name, trigger, frames)


def _typical_films(film: Array) -> tuple[float, ...]:
    """Three percentiles, to three digits."""
    return tuple(sorted({float(f"{value:.3g}") for value in np.percentile(film, [10, 50, 90])}))


def _add_sources(variances: dict[str, Array], chain: Chain, frame: int, weight: Array) -> float:
    """Add the weighted relative variance of each source in one frame; returns how far interpolation lowers that of camera 2."""
    frames = read_frames(chain.recording, [frame])
    corrected = correct_frames(
        frames, chain.references, least_signal=chain.recording.settings.thickness.least_signal
    )
    aligned = chain.aligned(frame)
    drift = np.column_stack([aligned.drift_x.values, aligned.drift_y.values])
    references = chain.references
    flat, flat_var, dark_var = (
        references[name].values[:, None].astype(float) for name in ("flat", "flat_var", "dark_var")
    )
    gain, read_noise = (
        references[name].values[:, None, None, None] for name in ("gain", "read_noise")
    )
    signal = corrected.signal.values.astype(float)
    sources = {
        "photons": np.maximum(signal, 0) / (flat * gain),
        "reading and rounding": ((read_noise / gain) ** 2 + QUANTISATION_VAR) / flat**2
        + 0 * signal,
        "dark frames": dark_var / flat**2 + 0 * signal,
        "flat frames": (signal / flat) ** 2 * flat_var,
    }
    names = list(sources)
    for one, other in zip(names[::2], names[1::2], strict=True):
        single = corrected.assign(
            signal_var=(corrected.signal.dims, sources[one].astype(np.float32)),
            signal_var_fixed=(corrected.signal.dims, sources[other].astype(np.float32)),
        )
        moved = align_frames(CorrectedFrames(single), chain.camera_map, drift=drift)
        for name, image in ((one, moved.signal_var), (other, moved.signal_var_fixed)):
            with np.errstate(
                divide="ignore", invalid="ignore"
            ):  # where nothing was seen, and nothing weighs
                relative = image.values[:, 0] / np.square(aligned.signal.values[:, 0], dtype=float)
            for camera in (1, 2):
                source = f"{name}, camera {camera}"
                power = weight**2 if _SOURCES[source] == RANDOM else weight
                variances[source] += power * np.where(weight > 0, relative[camera - 1], 0.0)
    return float(aligned.interpolation[0])


def _mean_column(
    statistics: FilmStatistics,
    calibration: Calibration,
    variances: dict[str, Array],
    rate: Array,
    region: Mask,
    averaging: float,
) -> tuple[str, float, dict[str, float]]:
    """The same for the mean film, whose noise the interpolation moves between pixels and does not lessen."""
    terms = {}
    for source, variance in variances.items():
        spread = averaging if source.endswith("camera 2") else 1.0
        terms[source] = float(np.sqrt((rate[region] ** 2 * variance[region]).sum() / spread)) / int(
            region.sum()
        )
    known = sum(value**2 for value in terms.values())
    terms["registration"] = float(np.sqrt(max(statistics.mean_random_std**2 - known, 0.0)))
    terms["calibration"] = _by_calibration(statistics.mean_gradient, calibration)
    return "mean film", statistics.mean, terms


def _by_calibration(gradient: Array, calibration: Calibration) -> float:
    return float(np.sqrt(gradient @ calibration.full_covariance @ gradient))


def _as_dataset(
    columns: list[tuple[str, float, dict[str, float]]], name: str, trigger: int, frames: int
) -> xr.Dataset:
    """Terms in the order of the chain, with the sums of the random and of the shared ones and of all."""
    random = [*_SOURCES, "noise of all kinds"]
    shared = ["registration", "calibration", "marks of the surfaces"]
    rows: dict[str, list[float]] = {}
    for term in [*_SOURCES, *shared]:
        rows[term] = [terms.get(term, np.nan) for _, _, terms in columns]
    for title, members in (
        ("random part", random),
        ("shared part", shared),
        ("total", [*random, *shared]),
    ):
        rows[title] = [
            float(np.sqrt(sum(terms.get(term, 0.0) ** 2 for term in members)))
            for _, _, terms in columns
        ]
    order = [*_SOURCES, "random part", *shared, "shared part", "total"]
    kinds = (
        _SOURCES
        | dict.fromkeys(shared, SHARED)
        | {"random part": "sum", "shared part": "sum", "total": "sum"}
    )
    return xr.Dataset(
        {
            "std": (
                ("term", "quantity"),
                np.array([rows[term] for term in order]),
                {"units": "um"},
            ),
            "kind": ("term", np.array([kinds[term] for term in order])),
            "value": ("quantity", np.array([value for _, value, _ in columns]), {"units": "um"}),
        },
        {"term": order, "quantity": [title for title, _, _ in columns]},
        {"run": name, "trigger": trigger, "frames": frames},
    )
