"""The parts of the way from a run to a film: before its frames, its frames, after them."""

from __future__ import annotations

import logging
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import xarray as xr

from erlif.calibration import Calibration
from erlif.core.arrays import Array
from erlif.core.notes import Note
from erlif.core.progress import Progress
from erlif.core.timing import stage
from erlif.io.files import PartialFilm
from erlif.io.ingest import Run
from erlif.io.settings import RunSettings
from erlif.kinematics import encoder_notes
from erlif.pipeline.chain import FrameChain
from erlif.pipeline.engines.engine import Engine
from erlif.pipeline.engines.results import (
    TriggerResult,
    describe_frame_notes,
    frames_in,
    mean_drift,
)
from erlif.pipeline.engines.triggers import TriggerTask, run_triggers
from erlif.pipeline.film import (
    choose_region,
    describe_film,
    describe_frames,
    describe_registration,
    describe_statistics,
    pixel_positions,
)
from erlif.pipeline.physics.fit import state_physics
from erlif.pipeline.physics.light import (
    LightFindings,
    choose_frames,
    correct_light,
    describe_light,
    find_light,
    kept_lights,
    measure_lights,
    run_patch,
    widen_errors,
)
from erlif.pipeline.physics.position import choose_view, describe_positions
from erlif.pipeline.physics.prediction import (
    Prediction,
    frames_of_run,
    places_along_sliding,
    try_prediction,
)
from erlif.pipeline.recording.prepare import prepare_chain
from erlif.pipeline.recording.pulse_order import (
    check_first_pulses,
    check_pulses,
    refuse_stuck_cameras,
)
from erlif.pipeline.recording.pulses import read_energies
from erlif.pipeline.recording.register import stored_map
from erlif.pipeline.recording.swap import refuse_swapped_cameras
from erlif.ratio import PulseSample, sample_pulse
from erlif.registration import CameraMap, MapNodes, move_map

_logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class KnownMap:
    """What is kept of the camera map of the fixture.

    Attributes
    ----------
    stored : CameraMap | None
        The whole map, where the settings ask for its use.
    nodes : MapNodes | None
        A few points of it, by which exchanged cameras are recognised.
    """

    stored: CameraMap | None
    nodes: MapNodes | None

    @classmethod
    def of(cls, calibration: Calibration, settings: RunSettings) -> KnownMap:
        """Keep what a run needs of the map of its calibration."""
        found = calibration.camera_map
        return cls(
            stored_map(found, settings.registration), None if found is None else MapNodes.of(found)
        )


@dataclass(frozen=True)
class PreparedRun:
    """A run whose frames can be measured.

    Attributes
    ----------
    chain : FrameChain
        Counts to ratio, with the tables alone.
    measuring : Calibration
        Ratio to film thickness, for the light as it is corrected.
    light : LightFindings
        Light that is not film, as far as it is known before the films.
    energies : Array | None
        Relative pulse energy of each frame in the log, (frame,).
    notes : tuple[Note, ...]
        On both cameras.
    """

    chain: FrameChain
    measuring: Calibration
    light: LightFindings
    energies: Array | None
    notes: tuple[Note, ...]


def prepare_run(
    run: Run, cycle: xr.Dataset, calibration: Calibration, known: KnownMap, progress: Progress
) -> PreparedRun:
    """Characterise and register the cameras, and find the light that is to be subtracted.

    Parameters
    ----------
    run : Run
    cycle : xarray.Dataset
        As `locate_run` returns it.
    calibration : Calibration
        Without its camera map.
    known : KnownMap
        What is kept of that map.
    progress : callable

    Returns
    -------
    PreparedRun

    Raises
    ------
    FrameError, RegistrationError
        If references or frames cannot be used, a camera was stuck, or the cameras are exchanged.
    """
    refuse_stuck_cameras(run.pairs)
    options = run.settings.light
    correct = "correct" in (options.background, options.bleaching)
    prepared = prepare_chain(run, progress, stored=known.stored, tables_only=not correct)
    chain = prepared.chain
    refuse_swapped_cameras(chain, calibration, prepared.sample, stored=known.nodes)

    # a background that is to be subtracted is found before the films are measured
    energies, found, measuring = read_energies(run.log), LightFindings(), calibration
    if correct:
        with stage("light", _logger):
            lights = measure_lights(chain, run_patch(run))
            found = find_light(lights, calibration, cycle.trigger.values, energies)
        chain, measuring = correct_light(chain, calibration, found, options)

    # the frames need neither the sample nor the references
    return PreparedRun(chain.tabulated(), measuring, found, energies, tuple(prepared.notes))


def measure_run(
    run: Run,
    ready: PreparedRun,
    frames_of: Sequence[Sequence[int]],
    unfinished: PartialFilm,
    *,
    engine: Engine,
    progress: Progress,
) -> list[TriggerResult]:
    """Measure the triggers of a run that are not finished yet.

    Parameters
    ----------
    run : Run
    ready : PreparedRun
    frames_of : sequence of sequence of int
        Frame pairs of each trigger.
    unfinished : PartialFilm
        Receives the maps.
    engine : Engine
    progress : callable

    Returns
    -------
    list of TriggerResult
        Of all triggers, in their order.

    Raises
    ------
    PulseError
        If the cameras show different pulses among the first triggers.
    """
    return run_triggers(
        trigger_task(run, ready.chain, ready.measuring),
        frames_of,
        unfinished,
        engine=engine,
        progress=progress,
        places=[run.pairs.pages[0][0].path, run.pairs.pages[1][0].path],
        inspect=lambda first: check_first_pulses(
            frames_in(first), run.pairs, lambda frame: measure_pulse(ready.chain, frame)
        ),
    )


def measure_pulse(chain: FrameChain, frame: int) -> PulseSample:
    """What is kept of a frame pair to recognise its laser pulse."""
    pair = chain.measure(frame)
    return sample_pulse(pair.light_one, pair.log_ratio, pair.flags)


def trigger_task(run: Run, chain: FrameChain, calibration: Calibration) -> TriggerTask:
    """How the frames of one trigger of a run become its maps."""
    settings = run.settings
    return TriggerTask(
        chain,
        replace(calibration, camera_map=None),  # the chain has the map of the run
        choose_region(settings, run.pairs.shape),
        sliding_along_x=settings.optics.x_axis == "sliding",
        smoothing=settings.thickness.smoothing,
        sampled=choose_frames(run.pairs),
        patch=run_patch(run),
        view=choose_view(settings, run.pairs.shape),
    )


def complete_film(
    run: Run,
    cycle: xr.Dataset,
    triggers: xr.Dataset,
    ready: PreparedRun,
    results: Sequence[TriggerResult],
    calibration: Calibration,
    hashes: Mapping[str, str],
) -> tuple[xr.Dataset, dict[str, xr.Dataset]]:
    """Everything of a film but its maps.

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
    calibration : Calibration
        Of the fixture.
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
    frames, options = frames_in(results), run.settings.light
    drift = mean_drift(frames)
    notes = [
        *run.log_notes,
        *encoder_notes(cycle),
        *ready.notes,
        *check_pulses(frames, run.pairs),
        *describe_frame_notes(frames, run.pairs),
    ]

    remaining = find_light(
        kept_lights(frames, run.pairs), calibration, cycle.trigger.values, ready.energies
    )
    found = ready.light.complete(remaining, options)
    light, notes_on_light = describe_light(found, results, run, ready.measuring)

    with stage("prediction", _logger):
        view, positions = (
            choose_view(run.settings, run.pairs.shape),
            [one.position for one in results],
        )
        measured = describe_statistics(results) | describe_positions(
            positions, ready.measuring, view
        )
        prediction = _predict(run, cycle, triggers.assign(measured))
    film = describe_film(
        run,
        triggers,
        results,
        ready.measuring,
        prediction=prediction,
        hashes=hashes,
        notes=[*notes, *notes_on_light],
    )
    film = widen_errors(film.assign(light), found, results, options, calibration)
    with stage("physics", _logger):
        physics = state_physics(film, run.settings, frames_of_run(run, cycle))
    if physics:
        film = film.assign_attrs(physics=physics)
    camera_map = move_map(ready.chain.camera_map, drift)
    return film, {
        "frames": describe_frames(run, cycle, results, drift).assign(prediction.frames),
        "registration": describe_registration(camera_map, ready.chain.blur),
    }


def _predict(run: Run, cycle: xr.Dataset, measured: xr.Dataset) -> Prediction:
    """The transient film of a run whose film_min (trigger) is measured."""
    settings, shape = run.settings, run.pairs.shape
    region = choose_region(settings, shape)
    place = places_along_sliding(settings, *pixel_positions(settings, shape), region)
    return try_prediction(settings, measured, frames_of_run(run, cycle), place)
