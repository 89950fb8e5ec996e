"""The film as it is stored: statistics, light, theory and record, one step after the other."""

from __future__ import annotations

import json
import logging
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import xarray as xr

from erlif.calibration import RunCurve, note_pitch, record_calibration
from erlif.core.arrays import Array
from erlif.core.flags import Flag
from erlif.core.format import describe_origin
from erlif.core.notes import Note, join_notes, warn
from erlif.core.products import References
from erlif.core.timing import stage
from erlif.core.variables import FILM, FRAMES
from erlif.correction import CAMERA_NOISE, CHARACTERISTICS
from erlif.io.files import MapStore, describe_hashes
from erlif.io.ingest import Run, format_notes, skipped_notes
from erlif.io.settings import RunSettings, count_keys, stated_keys, to_toml
from erlif.kinematics import encoder_notes
from erlif.pipeline.audit.audits import audit_run
from erlif.pipeline.audit.evidence import Evidence
from erlif.pipeline.engines.results import (
    FrameResult,
    TriggerResult,
    describe_frame_notes,
    frames_in,
    mean_drift,
    share_passed,
)
from erlif.pipeline.physics.agreement import describe_agreement
from erlif.pipeline.physics.contact import note_contact, settle_contact
from erlif.pipeline.physics.dark import describe_dark_levels
from erlif.pipeline.physics.errors import describe_errors, name_largest_error, shared_errors
from erlif.pipeline.physics.exponents import (
    describe_exponents,
    note_moved_mean,
    note_steepness,
)
from erlif.pipeline.physics.fit import state_physics
from erlif.pipeline.physics.friction import describe_friction
from erlif.pipeline.physics.light import choose_frames, describe_light
from erlif.pipeline.physics.load_line import place_positions
from erlif.pipeline.physics.position import describe_positions, note_form
from erlif.pipeline.physics.prediction import (
    frames_of_run,
    join_theories,
    predict_theory,
    try_prediction,
)
from erlif.pipeline.physics.systematics import follow_course
from erlif.pipeline.physics.texture import find_within, with_texture
from erlif.pipeline.recording.omissions import note_omissions
from erlif.pipeline.recording.prepare import PreparedRun
from erlif.pipeline.recording.pulses import check_pulses, read_energies
from erlif.ratio import BlurDifference
from erlif.registration import CameraMap, move_map
from erlif.trend import GapShape, Texture

_logger = logging.getLogger(__name__)


# Share of the region outside the measurable range from which a note reports it.
_CENSORED = 0.01


@dataclass(frozen=True)
class FilmDraft:
    """A film between its measured triggers and its record.

    Attributes
    ----------
    ready : PreparedRun
        The run, and what its frames were measured with.
    results : Sequence[TriggerResult]
        Of all triggers, in their order.
    curve : RunCurve
        With the errors that the run shows.
    film : xarray.Dataset
        The root group without the maps.
    frames : xarray.Dataset
        What belongs to single frames besides log and drift.
    notes : tuple[Note, ...]
    texture : Texture | None
        What stands still in the image.
    """

    ready: PreparedRun
    results: Sequence[TriggerResult]
    curve: RunCurve
    film: xr.Dataset
    frames: xr.Dataset
    notes: tuple[Note, ...]
    texture: Texture | None = None

    @property
    def frame_results(self) -> list[FrameResult]:
        """Results of all frame pairs."""
        return frames_in(self.results)

    def adding(self, film: xr.Dataset, *notes: Note, **changed: Any) -> FilmDraft:
        """Return a copy with another root group and more notes."""
        return replace(self, film=film, notes=(*self.notes, *notes), **changed)


def summarise_triggers(
    ready: PreparedRun, triggers: xr.Dataset, results: Sequence[TriggerResult]
) -> FilmDraft:
    """Settle the contact of the run, and count frames and pixels.

    Parameters
    ----------
    ready : PreparedRun
    triggers : xarray.Dataset
        As `describe_triggers` returns it.
    results : sequence of TriggerResult
        Of all triggers.

    Returns
    -------
    FilmDraft

    Raises
    ------
    PulseError
        If the cameras show different pulses in a pair.
    """
    run, curve, plane = ready.run, ready.curve, ready.plane
    results, contact = settle_contact(results, plane.contacts)
    frames = frames_in(results)
    both = filter(None, (curve.calibration, curve.later))
    notes = (
        *(note for one in both for note in note_pitch(one.pixel_pitch, plane.pitch)),
        *format_notes(run.pairs),
        *run.log_notes,
        *encoder_notes(ready.cycle),
        *ready.notes,
        *check_pulses(frames, run.pairs),
        *describe_frame_notes(frames, run.pairs),
        *note_contact(results, contact),
    )

    numbers = [[one.frame for one in result.frames] for result in results]
    passed = [share_passed(each, len(run.pairs.pages[0])) for each in numbers]
    film = triggers.assign(
        frames_used=FILM["frames_used"].fill([len(each) for each in numbers]),
        share_passed=FILM["share_passed"].fill(passed),
    )
    film = film.assign(count_flagged_pixels(results)).assign_attrs(contact=str(contact))
    film = film.assign_coords(plane.grid(len(results)).coords)
    return FilmDraft(ready, results, curve, film, xr.Dataset(), notes)


def with_light(draft: FilmDraft, maps: MapStore) -> FilmDraft:
    """Add light that is not film, numbers with the errors that it leaves, and the audits.

    Parameters
    ----------
    draft : FilmDraft
    maps : MapStore
        Of all triggers.

    Returns
    -------
    FilmDraft
    """
    ready, run = draft.ready, draft.ready.run
    chosen = choose_frames(run.pairs)
    lights = {one.frame: one for one in draft.frame_results if one.frame in chosen}
    findings, counted, curve = ready.judge_light(lambda: lights)
    contact = GapShape(draft.film.attrs["contact"])
    # below a ball the film may be within the range in a small part of the picture alone
    if findings.texture is None and findings.errors is None and contact is GapShape.POINT:
        within = find_within(lights, maps, len(draft.results), ready.curve.at(0.5), ready.plane)
        findings = replace(findings, texture=within)
    light, notes = describe_light(findings, draft.results, run, ready.curve)
    films = np.array([one.statistics.mean.value for one in draft.results])
    median = float(np.median(films[np.isfinite(films)])) if np.isfinite(films).any() else math.nan
    darks = describe_dark_levels(findings.darks, ready.curve, median)

    # statistics and positions with the errors of the run, a significant course among them
    pairs = len(run.pairs.pages[0])
    results = follow_course(draft.results, ready.curve, counted.course, pairs=pairs)
    results, curve = with_texture(results, curve, findings, ready.plane, contact)
    film = draft.film.assign(describe_statistics(results, curve))
    positions = [one.position for one in results]
    film = film.assign(describe_positions(positions, curve, ready.plane.view)).assign(light)
    if (pattern := ready.chain.pattern) is not None:
        acts = {"ratios": pattern.ratios, "acts": pattern.acts}
        film = film.assign(ratio_pattern=FILM["ratio_pattern"].fill(pattern.log_ratio, **acts))
    largest = name_largest_error(film, run.settings, ready.curve, curve)
    film = film.assign_attrs(
        largest_error=largest,
        settings=to_toml(run.settings),
        settings_version=count_keys(RunSettings),
        calibration=record_calibration(curve),
    )
    with stage("audits", _logger):
        ordered = sorted(draft.frame_results, key=lambda one: one.frame)
        audited = audit_run(Evidence(run, ready.cycle, ordered, ready.faults, darks))
    draft = replace(draft, notes=(*audited, *draft.notes))
    return draft.adding(film, *notes, results=results, curve=curve, texture=findings.texture)


def with_theory(draft: FilmDraft) -> FilmDraft:
    """Add the films of theory, friction, the speed exponents, and which physics carries the film.

    Parameters
    ----------
    draft : FilmDraft

    Returns
    -------
    FilmDraft
    """
    ready, settings, plane = draft.ready, draft.ready.run.settings, draft.ready.plane
    frames = frames_of_run(ready.run, ready.cycle)
    with stage("prediction", _logger):
        film, about_line = place_positions(plane, draft.film, frames)
        prediction = try_prediction(plane, film, frames)
    theory = join_theories(settings, predict_theory(settings, film), prediction.triggers)
    film = film.merge(theory, combine_attrs="drop_conflicts")
    film = film.assign(describe_exponents(film, draft.results, draft.curve, plane=plane))
    film = film.assign(describe_agreement(film, settings))
    friction, about_friction = describe_friction(film, draft.results, draft.curve, plane)
    film = film.assign(friction)
    with stage("physics", _logger):
        shared = shared_errors([one.statistics for one in draft.results], draft.curve)
        physics, taken = state_physics(film, settings, frames, shared)
    if physics:
        film = film.assign_attrs(physics=physics)
    if taken and "film_over_predicted" in film:
        ratio = film["film_over_predicted"].assign_attrs(taken)
        film = film.assign(film_over_predicted=ratio)
    notes = (
        *about_line,
        *note_omissions(settings, film),
        *note_moved_mean(film),
        *note_steepness(film),
        *prediction.notes,
        *about_friction,
    )
    return draft.adding(film, *notes, frames=prediction.frames)


def with_record(
    draft: FilmDraft, hashes: Mapping[str, str]
) -> tuple[xr.Dataset, dict[str, xr.Dataset]]:
    """Add settings, hashes and notes, and the groups of frames and registration.

    Parameters
    ----------
    draft : FilmDraft
    hashes : mapping of str to str
        Of the inputs.

    Returns
    -------
    film : xarray.Dataset
        The root group without thickness, its standard deviations and flags.
    groups : dict of str to xarray.Dataset
        The groups frames and registration.
    """
    ready, run, film = draft.ready, draft.ready.run, draft.film
    settings, results = run.settings, draft.results
    load = float(np.median(film["joint_load"])) if "joint_load" in film else float("nan")
    positions = [one.position for one in results]
    # gain and noise of the cameras at the time of the calibration stand in its own notes
    from_calibration = [
        Note(note.level, "calibration", str(note))
        for note in draft.curve.calibration.notes
        if note.subject != CHARACTERISTICS
    ]
    notes = [
        *draft.notes,
        *from_calibration,
        *_censoring_notes(results),
        *note_form(positions, draft.curve, ready.plane, load),
        *skipped_notes(run.pairs),
    ]
    stated = settings.camera1.serial, settings.camera2.serial
    serials = [found or own or "" for found, own in zip(run.pairs.serials, stated, strict=True)]
    resolution = settings.thickness.smoothing
    smoothing = {
        "smoothing": resolution,
        "smoothing_comment": "full width at half maximum of the window [px] in which the ratio "
        "behind the maps was smoothed, steps kept; the noise of pixels closer than that is "
        "correlated; film_min, film_mean and their trend come from the ratio as measured",
    }
    film = film.assign_attrs(
        **describe_origin(f"oil-film thickness, {settings.name}", f"process {settings.name}"),
        settings_stated=stated_keys(settings),
        input_hashes=describe_hashes(hashes),
        recorded=run.pairs.date,
        camera_serials=json.dumps(serials),
        **({} if resolution is None else smoothing),
        notes=join_notes(notes),
    )

    # the stored map is that of the mean over the run; drifts are stored about it
    drift = mean_drift(draft.frame_results)
    frames = assemble_frames(run, ready.cycle, results, drift, ready.chain.ratio_change)
    camera_map = move_map(ready.chain.camera_map, drift)
    return film, {
        "frames": frames.assign(draft.frames),
        "registration": describe_registration(camera_map, ready.chain.blur, ready.chain.references),
    }


def count_flagged_pixels(results: Sequence[TriggerResult]) -> xr.Dataset:
    """Count the valid pixels of each map and those of each flag."""
    pixels = np.array([result.pixels for result in results], np.int64).reshape(-1, 1 + len(Flag))
    flag = np.array([flag.value for flag in Flag], np.uint16)
    return xr.Dataset(
        {
            "valid_pixels": FILM["valid_pixels"].fill(pixels[:, 0]),
            "flagged_pixels": FILM["flagged_pixels"].fill(pixels[:, 1:]),
        },
        {"flag": FILM["flag"].fill(flag)},
    )


def describe_statistics(results: Sequence[TriggerResult], calibration: RunCurve) -> dict[str, Any]:
    """Mean and minimum film of each trigger, as variables of the film."""
    covariance = calibration.full_covariance
    statistics = [result.statistics for result in results]
    places = np.array([one.gap.place for one in statistics]).reshape(-1, 2)
    values: dict[str, Any] = {
        "share_beyond_range": [one.beyond_range for one in statistics],
        "noise_correlation": [one.noise_correlation for one in statistics],
        "film_min_x": places[:, 0],
        "film_min_y": places[:, 1],
    }
    numbered = {
        "film_mean": [one.mean for one in statistics],
        "film_min": [one.gap.minimum for one in statistics],
        "film_gap_mean": [one.gap.mean for one in statistics],
    }
    central = [one.gap.central for one in statistics]
    if any(math.isfinite(one.value) for one in central):  # of a plateau
        numbered["film_central"] = central
    for name, numbers in numbered.items():
        values[name] = [one.value for one in numbers]
        values[f"{name}_std"] = [one.std(covariance) for one in numbers]
        values[f"{name}_std_random"] = [one.random_std for one in numbers]
    filled = {name: FILM[name].fill(column) for name, column in values.items()}
    return filled | describe_errors(statistics, calibration)


def assemble_frames(
    run: Run,
    cycle: xr.Dataset,
    results: Sequence[TriggerResult],
    mean_drift: Array,
    ratio_change: Array | None = None,
) -> xr.Dataset:
    """The group of the film that holds what belongs to single frames.

    Parameters
    ----------
    run : Run
    cycle : xarray.Dataset
        As `locate_frames` returns it.
    results : sequence of TriggerResult
    mean_drift : array, (2,)
        Part of the drifts (x, y) that the stored map has taken up. [px]
    ratio_change : array, (frame,), optional
        Change of the logarithm of the ratio that was taken out. [1]

    Returns
    -------
    xarray.Dataset
        On dim frame.
    """
    count = cycle.sizes["frame"]
    drift = np.full((count, 2), np.nan)
    energy = np.full(count, np.nan)
    for result in results:
        for one in result.frames:
            drift[one.frame] = np.array(one.drift) - mean_drift
            energy[one.frame] = one.pulse_energy
    if np.isfinite(energy).any():
        energy = energy / np.nanmean(energy)

    energies = read_energies(run.log)
    logged: dict[str, Any] = {}
    if energies is not None:
        logged["pulse_energy_logged"] = FRAMES["pulse_energy_logged"].fill(energies)
    if ratio_change is not None:
        logged["ratio_change"] = FRAMES["ratio_change"].fill(ratio_change)
    names = [np.array([page.name for page in pages]) for pages in run.pairs.pages]
    group = xr.Dataset(
        {
            "trigger": cycle.trigger,
            "cycle": cycle.cycle,
            "drift_x": FRAMES["drift_x"].fill(drift[:, 0]),
            "drift_y": FRAMES["drift_y"].fill(drift[:, 1]),
            "pulse_energy": FRAMES["pulse_energy"].fill(energy),
            **logged,
            "file_camera1": ("frame", names[0]),
            "file_camera2": ("frame", names[1]),
        }
    )
    time = run.log["time"].values if "time" in run.log else np.full(count, np.nan)
    fitted = run.log["time"].attrs if "time" in run.log else {}
    start = {name: fitted[name] for name in ("start", "start_std") if name in fitted}
    group["time"] = FRAMES["time"].fill(time, **start)
    if run.pairs.skipped:
        group.attrs["skipped_frames"] = "\n".join(map(str, skipped_notes(run.pairs)))
    return group.reset_coords(drop=True)


def describe_registration(
    camera_map: CameraMap, blur: BlurDifference, references: References
) -> xr.Dataset:
    """The group of the film that holds the camera map, and sharpness and noise of the cameras."""
    return camera_map.to_dataset().assign_attrs(
        blur_difference=[blur.x, blur.y],
        blur_difference_std=[blur.std_x, blur.std_y],
        blur_difference_comment="half the blur variance of camera 2 less that of camera 1, along x "
        "and y [px2]",
        ratio_excess=blur.excess,
        ratio_excess_std=blur.excess_std,
        **{f"camera_{name}": references[name].values.astype(float) for name in CAMERA_NOISE},
    )


def _censoring_notes(results: Sequence[TriggerResult]) -> list[Note]:
    shares = np.array([result.statistics.beyond_range for result in results])
    worst = int(np.argmax(shares))
    if shares[worst] < _CENSORED:
        return []
    text = (
        f"film_mean lacks up to {shares[worst]:.0%} of the region (trigger {worst}), too thin or "
        "thick to measure; film_min, a fit, is not affected. A mean that lacks more than 2 % "
        "counts in no exponent"
    )
    return [warn("", text)]
