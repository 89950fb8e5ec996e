"""The film as it is stored: what log, kinematics, statistics and theory give for each trigger."""

from __future__ import annotations

import logging
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import scipy
import xarray as xr

from erlif.calibration import Calibration, note_pitch, record_calibration
from erlif.core.arrays import Array
from erlif.core.flags import FLAG_ATTRS, Flag
from erlif.core.format import describe_origin
from erlif.core.notes import Note, join_notes, warn
from erlif.core.timing import stage
from erlif.core.units import count_of
from erlif.core.variables import FILM, FRAMES
from erlif.correction import CHARACTERISTICS
from erlif.io.files import MapVariable, describe_hashes
from erlif.io.ingest import FramePairs, Run, format_notes, skipped_notes
from erlif.io.settings import RunSettings, stated_keys, to_toml
from erlif.kinematics import encoder_notes
from erlif.pipeline.audit.audits import audit_run
from erlif.pipeline.audit.evidence import Evidence
from erlif.pipeline.engines.results import (
    TriggerResult,
    describe_frame_notes,
    frames_in,
    mean_drift,
    share_passed,
)
from erlif.pipeline.physics.contact import note_contact, settle_contact
from erlif.pipeline.physics.dark import describe_dark_levels
from erlif.pipeline.physics.errors import describe_errors, name_largest_error
from erlif.pipeline.physics.fit import state_physics
from erlif.pipeline.physics.joint import describe_joint, missing_load
from erlif.pipeline.physics.light import (
    describe_light,
    find_light,
    kept_lights,
)
from erlif.pipeline.physics.load_line import place_positions
from erlif.pipeline.physics.position import describe_positions, note_form
from erlif.pipeline.physics.prediction import (
    Prediction,
    frames_of_run,
    join_theories,
    note_correlation,
    note_difference,
    try_prediction,
)
from erlif.pipeline.physics.systematics import follow_course, update_systematics
from erlif.pipeline.plane import ObjectPlane
from erlif.pipeline.recording.omissions import note_omissions
from erlif.pipeline.recording.prepare import PreparedRun
from erlif.pipeline.recording.pulses import check_pulses, read_energies
from erlif.ratio import BlurDifference
from erlif.registration import CameraMap, describe_map, move_map
from erlif.trend import (
    LARGEST_BEYOND,
    compare_with_roughness,
    fit_exponent,
    mean_at_constant_minimum,
    predict_film,
)

_logger = logging.getLogger(__name__)


# Share of the region outside the measurable range from which a note reports it.
_CENSORED = 0.01

# Standard deviations of the exponent of the mean film that the moving place of the minimum may
# change, and the change that never counts.
_MOVED, _UNMOVED = 3.0, 0.01

# What the motion gives for each frame, and a mean for each trigger.
_MOTION = ("encoder_angle", "position", "rocker_speed", "sliding_speed")

# Variables of the two statistics.
_FILM_OF = {"minimum": "film_min", "mean": "film_mean"}

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


def group_frames(cycle: xr.Dataset, pairs: FramePairs) -> list[list[int]]:
    """Usable frame pairs of each trigger; `cycle` as `locate_frames` returns it."""
    trigger = cycle.trigger.values
    frames: list[list[int]] = [[] for _ in range(int(trigger.max()) + 1)]
    for k in pairs.usable:
        frames[trigger[k]].append(k)
    return frames


def summarise_cycle(cycle: xr.Dataset) -> str:
    """Triggers, cycles and highest speed of a run in words; `cycle` as `locate_run` returns it."""
    triggers, cycles = int(cycle.trigger.max()) + 1, int(cycle.cycle.max()) + 1
    text = count_of(triggers, "trigger")
    if cycles > 1 or "encoder_angle" in cycle:  # without angles one cycle is a convention
        text += f" in {count_of(cycles, 'cycle')}"
    if "rocker_speed" in cycle:
        return f"{text}, joint speed up to {float(np.abs(cycle.rocker_speed).max()):.3f} rad/s"
    if "sliding_speed" in cycle:
        return f"{text}, sliding speed up to {float(cycle.sliding_speed.max()):.4g} m/s"
    return f"{text}, no speed"


def describe_triggers(run: Run, cycle: xr.Dataset) -> xr.Dataset:
    """Average all quantities of log and kinematics over the frames of each trigger.

    Parameters
    ----------
    run : Run
    cycle : xarray.Dataset
        As `locate_frames` returns it.

    Returns
    -------
    xarray.Dataset
        On dim trigger; complete enough for the theory. What needs a table that run.toml lacks is
        left out.

    Raises
    ------
    ConfigError
        If neither log nor settings give the load, Vogel's law has no temperature, or the region of
        interest or the load line lies outside the image.
    """
    columns = _columns_by_frame(run, cycle)
    usable = group_frames(cycle, run.pairs)
    film = xr.Dataset(coords={"trigger": np.arange(len(usable))})

    # a trigger whose frames were all left out keeps its place in the cycle
    of = cycle.trigger.values
    every = [frames or np.flatnonzero(of == k).tolist() for k, frames in enumerate(usable)]
    for name, column in columns.items():
        if column.dtype.kind in "fiu":
            values = np.array([_trigger_mean(column, frames) for frames in every])
        else:
            values = np.array([str(column.values[frames[0]]) for frames in every])
        film[name] = ("trigger", values, column.attrs)

    if "stroke" in cycle:
        stroke = cycle.stroke.values[[frames[0] for frames in every]]
        film["stroke"] = ("trigger", stroke, cycle.stroke.attrs)
    if "crank_angle" in cycle:
        angle = np.radians(cycle.crank_angle.values)
        circle = [np.exp(1j * angle[frames]).mean() for frames in every]
        attrs = cycle.crank_angle.attrs
        film["crank_angle"] = ("trigger", np.degrees(np.angle(circle)) % 360, attrs)

    # frames that are averaged over cycles have no common time
    apart = all(len(frames) == 1 for frames in every)
    if "time" in run.log and (apart or not cycle.cycle.any()):
        read = run.log.time.values
        film["time"] = FILM["time"].fill(np.array([read[frames].mean() for frames in every]))

    # what would fail at the end fails here
    predict_theory(run.settings, film)
    ObjectPlane(run.settings, run.pairs.shape).check()
    return film


def complete_film(
    run: Run,
    cycle: xr.Dataset,
    triggers: xr.Dataset,
    ready: PreparedRun,
    results: Sequence[TriggerResult],
    hashes: Mapping[str, str],
) -> tuple[xr.Dataset, dict[str, xr.Dataset]]:
    """Make all groups of a film, without the maps.

    Parameters
    ----------
    run : Run
    cycle : xarray.Dataset
        As `locate_run` returns it.
    triggers : xarray.Dataset
        As `describe_triggers` returns it, before any frame is measured: it refuses a run that lacks
        a load or a temperature.
    ready : PreparedRun
    results : sequence of TriggerResult
        Of all triggers.
    hashes : mapping of str to str
        Of the inputs.

    Returns
    -------
    film : xarray.Dataset
        The root group.
    groups : dict of str to xarray.Dataset
        The groups frames and registration.

    Raises
    ------
    PulseError
        If the cameras show different pulses in a pair.
    """
    results, contact = settle_contact(results, ready.measuring)
    frames, options = frames_in(results), run.settings.light
    drift = mean_drift(frames)
    with stage("audits", _logger):
        measured_frames = sorted(frames, key=lambda one: one.frame)
        audited = audit_run(Evidence(run, cycle, measured_frames, ready.faults))
    notes = [
        *run.log_notes,
        *encoder_notes(cycle),
        *ready.notes,
        *check_pulses(frames, run.pairs),
        *describe_frame_notes(frames, run.pairs),
        *note_contact(results, contact),
    ]

    # light that is not film, as the finished frames show it
    plane = ObjectPlane(run.settings, run.pairs.shape)
    findings = ready.light
    if findings.errors is None:  # nothing was taken out, or a part
        lights = kept_lights(frames, run.pairs)
        remaining = find_light(
            lights,
            ready.measuring,
            ready.chain.correct,
            cycle.trigger.values,
            ready.energies,
            plane=plane,
            options=options,
        )
        findings = findings.complete(remaining, options)
    light, notes_on_light = describe_light(findings, results, run, ready.measuring)
    films = np.array([one.statistics.mean for one in results])
    median = float(np.median(films[np.isfinite(films)])) if np.isfinite(films).any() else math.nan
    notes += describe_dark_levels(findings.darks, ready.measuring, median)
    counted = findings.for_error_bars(ready.measuring, options)
    pairs = len(run.pairs.pages[0])
    measured_with = update_systematics(
        ready.measuring, counted, options, pulses=len(run.pairs.usable), pairs=pairs
    )
    results = follow_course(results, ready.measuring, counted.course, pairs=pairs)

    of_frames = frames_of_run(run, cycle)
    with stage("prediction", _logger):
        positions = [one.position for one in results]
        measured = describe_statistics(results, measured_with)
        measured |= describe_positions(positions, measured_with, plane.view)
        measured, about_line = place_positions(plane, measured, measured_with, of_frames)
        prediction = try_prediction(plane, triggers.assign(measured), of_frames)
    film = assemble_film(
        run,
        triggers,
        results,
        measured_with,
        measured=measured,
        prediction=prediction,
        hashes=hashes,
        notes=[*notes, *notes_on_light, *about_line],
        audited=audited,
    )
    film = film.assign(light)
    film = film.assign_attrs(
        largest_error=name_largest_error(film, run.settings, ready.measuring, measured_with),
        contact=str(contact),
    )
    with stage("physics", _logger):
        physics = state_physics(film, run.settings, of_frames)
    if physics:
        film = film.assign_attrs(physics=physics)

    # the stored map is that of the mean over the run; drifts are stored about it
    camera_map = move_map(ready.chain.camera_map, drift)
    return film, {
        "frames": assemble_frames(run, cycle, results, drift, ready.chain.ratio_change).assign(
            prediction.frames
        ),
        "registration": describe_registration(camera_map, ready.chain.blur),
    }


def assemble_film(
    run: Run,
    triggers: xr.Dataset,
    results: Sequence[TriggerResult],
    calibration: Calibration,
    *,
    measured: Mapping[str, Any],
    prediction: Prediction,
    hashes: Mapping[str, str],
    notes: Iterable[Note],
    audited: Iterable[Note] = (),
) -> xr.Dataset:
    """Make the root group of a film, without the maps.

    Parameters
    ----------
    run : Run
    triggers : xarray.Dataset
        From `describe_triggers`.
    results : sequence of TriggerResult
        In the order of the triggers.
    calibration : Calibration
    measured : mapping of str to variable
        Statistics and positions of the pin.
    prediction : Prediction
        Of the transient film.
    hashes : mapping of str to str
        Of the inputs.
    notes : iterable of Note
        On cameras and frames.
    audited : iterable of Note
        Of the audits; they come first.

    Returns
    -------
    xarray.Dataset
        The root group of film.nc without thickness, its standard deviations and flags.
    """
    film = triggers.copy()
    frames = [[one.frame for one in result.frames] for result in results]
    film["frames_used"] = FILM["frames_used"].fill([len(each) for each in frames])
    passed = [share_passed(each, len(run.pairs.pages[0])) for each in frames]
    film["share_passed"] = FILM["share_passed"].fill(passed)
    film = film.assign(count_flagged_pixels(results)).assign(measured)
    settings, plane = run.settings, ObjectPlane(run.settings, run.pairs.shape)
    theory = join_theories(settings, predict_theory(settings, film), prediction.triggers)
    film = film.merge(theory, combine_attrs="drop_conflicts")
    film = film.assign(describe_exponents(film, results, calibration, plane=plane))

    film = film.assign_coords(plane.grid(len(results)).coords)
    both = filter(None, (calibration, calibration.later))
    own = [
        *audited,
        *(note for one in both for note in note_pitch(one.pixel_pitch, plane.pitch)),
        *format_notes(run.pairs),
        *notes,
        *note_omissions(settings, film),
        *_note_moved_mean(film),
        *prediction.notes,
        *note_difference(film, settings.prediction),
        *note_correlation(film),
    ]
    load = float(np.median(film["joint_load"])) if "joint_load" in film else float("nan")
    positions = [one.position for one in results]
    own += [*_censoring_notes(results), *note_form(positions, calibration, plane, load)]
    resolution = settings.thickness.smoothing
    smoothing = {
        "smoothing": resolution,
        "smoothing_comment": "full width at half maximum of the window [px] in which the ratio "
        "behind the maps was smoothed, steps kept; the noise of pixels closer than that is "
        "correlated; film_min, film_mean and their trend come from the ratio as measured",
    }
    # gain and noise of the cameras at the time of the calibration stand in its own notes
    from_calibration = [
        Note(note.level, "calibration", str(note))
        for note in calibration.notes
        if note.subject != CHARACTERISTICS
    ]
    return film.assign_attrs(
        **describe_origin(f"oil-film thickness, {settings.name}", f"process {settings.name}"),
        settings=to_toml(settings),
        settings_stated=stated_keys(settings),
        input_hashes=describe_hashes(hashes),
        calibration=record_calibration(calibration),
        **({} if resolution is None else smoothing),
        notes=join_notes([*own, *from_calibration, *skipped_notes(run.pairs)]),
    )


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


def describe_statistics(
    results: Sequence[TriggerResult], calibration: Calibration
) -> dict[str, Any]:
    """Mean and minimum film of each trigger, as variables of the film."""
    covariance = calibration.full_covariance
    statistics = [result.statistics.with_errors(covariance) for result in results]
    places = np.array([one.minimum_place for one in statistics]).reshape(-1, 2)
    values: dict[str, Any] = {
        "film_mean": [one.mean for one in statistics],
        "film_mean_std": [one.mean_std for one in statistics],
        "film_mean_std_random": [one.mean_random_std for one in statistics],
        "share_beyond_range": [one.beyond_range for one in statistics],
        "film_min": [one.minimum for one in statistics],
        "film_min_std": [one.minimum_std for one in statistics],
        "film_min_std_random": [one.minimum_random_std for one in statistics],
        "film_min_x": places[:, 0],
        "film_min_y": places[:, 1],
    }
    filled = {name: FILM[name].fill(column) for name, column in values.items()}
    return filled | describe_errors(statistics, calibration)


def predict_theory(settings: RunSettings, film: xr.Dataset) -> xr.Dataset:
    """Films by theory, and the film parameter, as far as tables and log allow.

    Parameters
    ----------
    settings : RunSettings
    film : xarray.Dataset
        On dim trigger.

    Returns
    -------
    xarray.Dataset
        As `erlif.trend.predict_film`; empty without [joint].

    Raises
    ------
    ConfigError
        If Vogel's law has no temperature.
    """
    joint = describe_joint(settings)
    if joint is not None and "sliding_speed" in film and "joint_load" in film:
        return predict_film(film, joint)
    if settings.joint is None or "film_min" not in film:
        return xr.Dataset()
    sides = settings.joint.pin.roughness, settings.joint.bushing.roughness
    return compare_with_roughness(film.film_min, *sides)


def describe_exponents(
    film: xr.Dataset,
    results: Sequence[TriggerResult],
    calibration: Calibration,
    *,
    plane: ObjectPlane | None = None,
) -> dict[str, Any]:
    """Speed exponents of the minimum and of the mean film, as variables of the film.

    Empty where the film has no speed or no load. With a plane and positions of the pin, the mean
    film has no exponent where the place of the minimum moves so far that this alone gives one
    beyond the error.
    """
    name = _speed_of_trend(film)
    if name not in film or "joint_load" not in film:
        return {}

    statistics = [result.statistics for result in results]
    films = {
        "minimum": np.array([one.minimum for one in statistics]),
        "mean": np.array(
            [one.mean if one.beyond_range <= LARGEST_BEYOND else np.nan for one in statistics]
        ),
    }
    speed, load = film[name].values, film["joint_load"].values
    shared = scipy.linalg.block_diag(calibration.full_covariance, np.eye(1))

    exponents: dict[str, Any] = {}
    moved = np.array([]) if plane is None else _moved_mean(film, plane)
    for variable, kind in (("speed_exponent", "minimum"), ("speed_exponent_mean", "mean")):
        # marks of the surfaces are the same at every trigger; the mean film includes them as
        # they are
        surface = [one.minimum_surface_std if kind == "minimum" else 0.0 for one in statistics]
        exponent = fit_exponent(
            films[kind],
            np.array([getattr(one, f"{kind}_random_std") for one in statistics]),
            speed=speed,
            load=load,
            gradient=np.column_stack(
                [[getattr(one, f"{kind}_gradient") for one in statistics], surface]
            ),
            covariance=shared,
        )
        alone: dict[str, float] = {}
        if kind == "mean" and moved.size:
            counted = np.where(np.isfinite(films[kind]), moved, np.nan)
            geometry = fit_exponent(
                counted,
                np.array([one.mean_random_std for one in statistics]),
                speed=speed,
                load=load,
            ).value
            if abs(geometry) > max(_MOVED * exponent.std, _UNMOVED):
                alone = {"geometry": geometry, "fitted": exponent.value}
                exponent = replace(exponent, value=math.nan, std=math.nan, log_scale=math.nan)
        exponents[variable] = FILM[variable].fill(
            exponent.value,
            **alone,
            long_name=f"power of |{name}|/load that {_FILM_OF[kind]} follows",
            speed=name,
            log_scale=exponent.log_scale,
            triggers_used=exponent.triggers,
        )
        exponents[f"{variable}_std"] = FILM[f"{variable}_std"].fill(exponent.std)
    return exponents


def _moved_mean(film: xr.Dataset, plane: ObjectPlane) -> Array:
    """Mean films of the pin at a constant minimum; empty without its positions. [um]"""
    view = plane.view
    if view is None or "pin_displacement" not in film:
        return np.array([])
    line = float(film["pin_displacement"].attrs["load_line"])
    angle = (plane.along[plane.within] - line) / view.radius
    return mean_at_constant_minimum(film["pin_displacement"].values, view.clearance, angle)


def _note_moved_mean(film: xr.Dataset) -> list[Note]:
    """Warn that the exponent of the mean film is due to the moving place of the minimum."""
    attrs = film["speed_exponent_mean"].attrs if "speed_exponent_mean" in film else {}
    if "geometry" not in attrs:
        return []
    text = (
        "no power of speed: the place of the minimum moves in the region, which alone makes n = "
        f"{attrs['geometry']:.3f} of the fitted {attrs['fitted']:.3f}. Use that of film_min, or a "
        "region of interest over which the film differs less"
    )
    return [warn("film_mean", text)]


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


def describe_registration(camera_map: CameraMap, blur: BlurDifference) -> xr.Dataset:
    """The group of the film that holds the camera map and the difference of sharpness."""
    return describe_map(camera_map).assign_attrs(
        blur_difference=[blur.x, blur.y],
        blur_difference_std=[blur.std_x, blur.std_y],
        blur_difference_comment="half the blur variance of camera 2 less that of camera 1, along x "
        "and y [px2]",
        ratio_excess=blur.excess,
        ratio_excess_std=blur.excess_std,
    )


def _trigger_mean(column: xr.DataArray, frames: Sequence[int]) -> float:
    """Mean of a column over the frames of a trigger."""
    values = column.values[list(frames)].astype(float)
    if column.name == "encoder_angle" and column.attrs.get("mounted_on", "crank") == "crank":
        # on a crank, a disc or a drive 359 and 1 degree are near 0; readings may count on
        values = values[0] + (values - values[0] + 180.0) % 360.0 - 180.0
    return float(values.mean())


def _columns_by_frame(run: Run, cycle: xr.Dataset) -> dict[str, xr.DataArray]:
    """Quantities that have one value per frame and are averaged over each trigger."""
    columns = {name: cycle[name] for name in _MOTION if name in cycle}
    of_log = ("number", "angle", "angle_rate", "time", *_MOTION)
    columns |= {str(name): run.log[name] for name in run.log if name not in of_log}
    if "joint_load" not in columns:
        load = run.settings.load
        if load is not None:
            columns["joint_load"] = xr.full_like(cycle.trigger, load, float)
            columns["joint_load"].attrs = dict(FILM["joint_load"].attrs)
        elif run.settings.joint is not None:
            raise missing_load()
    return columns


def _speed_of_trend(film: xr.Dataset) -> str:
    """Name of the speed: that of the joint, unless there is none or the log has its own."""
    computed = "rocker_speed" in film
    if "sliding_speed" in film:
        computed = computed and film.sliding_speed.attrs.get("source") != "log"
    return "rocker_speed" if computed else "sliding_speed"


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
