"""Preparation of a recording as a whole: references, camera map, sharpness and noise."""

from __future__ import annotations

import logging
from dataclasses import dataclass, replace

import numpy as np
import xarray as xr

from erlif.calibration import Calibration
from erlif.core.arrays import Array
from erlif.core.notes import Note
from erlif.core.progress import Progress
from erlif.core.speed.memory import release_memory
from erlif.core.timing import stage
from erlif.io.ingest import Fixture, Run
from erlif.pipeline.audit.naming import naming
from erlif.pipeline.chain import FrameChain, FrameCorrection
from erlif.pipeline.physics.findings import LightFindings
from erlif.pipeline.physics.light import correct_light, find_light, measure_lights
from erlif.pipeline.physics.systematics import add_systematics
from erlif.pipeline.physics.temperature import read_warming, without_warming
from erlif.pipeline.plane import ObjectPlane
from erlif.pipeline.recording.cameras import Characterised, characterise_cameras
from erlif.pipeline.recording.noise import (
    NoiseCompletion,
    complete_noise,
    find_unknowns,
    note_noise,
)
from erlif.pipeline.recording.pulses import (
    complete_energies,
    read_energies,
    refuse_stuck_cameras,
)
from erlif.pipeline.recording.register import FixtureMap, register_cameras
from erlif.pipeline.recording.sample import compare_sharpness, sample_frames
from erlif.pipeline.recording.swap import judge_ratios
from erlif.ratio import BlurDifference
from erlif.registration import CameraMap

_logger = logging.getLogger(__name__)


def prepare_chain(
    recording: Run | Fixture,
    progress: Progress,
    *,
    stored: CameraMap | None = None,
    tables_only: bool = False,
) -> NoiseCompletion:
    """Characterise and register the cameras of a recording, so that its frames can be processed.

    Parameters
    ----------
    recording : Run or Fixture
    progress : callable
    stored : CameraMap, optional
        A map found before, to be used instead of a new one.
    tables_only : bool
        Whether the images of darks and flats may be dropped once they are in the tables of the
        chain.

    Returns
    -------
    NoiseCompletion
        The chain from counts to ratio, and the notes on both cameras.

    Raises
    ------
    FrameError
        If darks or flats cannot be used, or the frames do not determine an unknown gain.
    RegistrationError
        If the cameras cannot be registered, or the stored map no longer fits.
    """
    with stage("darks and flats", _logger):
        known = characterise_cameras(recording)
        for note in (*known.cameras.notes, *known.faults, *known.bits):
            _logger.info("%s", note)
    # the images of darks and flats end with their use: no name here may hold them
    faults, found, handed = known.faults, known.bits, [known]
    del known
    with naming(found):
        completed = _prepare(
            recording, handed.pop(), progress, stored=stored, tables_only=tables_only
        )
    # the audits of a run name its bits; a fixture has none but these notes
    bits = () if isinstance(recording, Run) else found
    return replace(completed, notes=(*completed.notes, *faults, *bits), bits=found)


def _prepare(
    recording: Run | Fixture,
    known: Characterised,
    progress: Progress,
    *,
    stored: CameraMap | None,
    tables_only: bool,
) -> NoiseCompletion:
    """Make the chain of characterised cameras: registration, sharpness and noise."""
    settings = recording.settings

    # where nothing is left to be estimated, the references are all that is needed
    correct = correct_recording(recording, known)
    if not find_unknowns(correct.references).any:
        correct = correct.tabulated() if tables_only else correct
        cameras = replace(known.cameras, references=correct.references)
        known = known._replace(cameras=cameras, measured=())
    release_memory()

    with stage("registration", _logger):
        camera_map = register_cameras(
            correct, settings.registration, stored=stored, progress=progress
        )

        _logger.info(
            "%s; rms displacement %.2f px, correlation of the textures %.2f",
            camera_map.model,
            np.sqrt(np.nanmean(camera_map.displacement_x**2 + camera_map.displacement_y**2)),
            camera_map.quality,
        )
    release_memory()

    chain = FrameChain(correct, camera_map, no_film_below=settings.thickness.no_film_below)
    with stage("sharpness and noise", _logger):
        sample = sample_frames(chain)
        chain = replace(chain, blur=compare_sharpness(chain, sample))
        _logger.info(
            "difference of blur variance %.4f px2 along x, %.4f px2 along y, %s; "
            "excess of the ratio %.3f %%",
            chain.blur.x,
            chain.blur.y,
            "removed from the ratio" if chain.blur.significant else "not significant",
            100 * chain.blur.corrected_excess,
        )
        completed = complete_noise(chain, known, sample=sample)
        for note in completed.notes[len(known.cameras.notes) :]:
            _logger.info("%s", note)
    release_memory()
    return completed


def correct_recording(recording: Run | Fixture, known: Characterised) -> FrameCorrection:
    """Counts to light for the frames of a recording, with the energies of its log if it has any."""
    return FrameCorrection(
        recording.pairs,
        known.cameras.references,
        recording.settings.thickness.least_signal,
        read_energies(recording.log) if isinstance(recording, Run) else None,
        tuple(camera.unlit for camera in known.measured),
    )


def prepare_with_map(
    recording: Run | Fixture, camera_map: CameraMap, *, blur: BlurDifference
) -> NoiseCompletion:
    """The chain of a recording whose camera map and difference of sharpness are known.

    Parameters
    ----------
    recording : Run or Fixture
    camera_map : CameraMap
    blur : BlurDifference

    Returns
    -------
    NoiseCompletion

    Raises
    ------
    FrameError
        As `prepare_chain`.
    """
    known = characterise_cameras(recording)
    correct = correct_recording(recording, known)
    chain = FrameChain(correct, camera_map, blur, recording.settings.thickness.no_film_below)
    completed = complete_noise(chain, known)

    # an estimate of the noise compares the sharpness again; the given difference stays
    return replace(completed, chain=replace(completed.chain, blur=blur))


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
        On both cameras and their ratio.
    faults : tuple[Note, ...]
        Of the counts: bits that are stuck, noise that is too low.
    """

    chain: FrameChain
    measuring: Calibration
    light: LightFindings
    energies: Array | None
    notes: tuple[Note, ...]
    faults: tuple[Note, ...] = ()


def prepare_run(
    run: Run, cycle: xr.Dataset, calibration: Calibration, known: FixtureMap, progress: Progress
) -> PreparedRun:
    """Characterise and register the cameras, and find the light that is to be subtracted.

    Parameters
    ----------
    run : Run
    cycle : xarray.Dataset
        As `locate_run` returns it.
    calibration : Calibration
        Without its camera map.
    known : FixtureMap
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
    correct = options.corrects
    warmer = read_warming(run, calibration)
    prepared = prepare_chain(run, progress, stored=known.stored, tables_only=not correct)
    chain = without_warming(prepared.chain, warmer, run.settings.temperature)
    faults = (*prepared.bits, *note_noise(chain, prepared.sample))
    misfit = judge_ratios(chain, calibration, prepared.sample, stored=known.nodes)
    chain = complete_energies(chain, calibration)
    calibration = add_systematics(
        calibration, run.settings, chain, prepared.sample, warmer=warmer, misfit=misfit.size
    )

    # a background that is to be subtracted is found before the films are measured
    energies, findings, measuring = read_energies(run.log), LightFindings(), calibration
    if correct:
        with stage("light", _logger):
            plane = ObjectPlane(run.settings, run.pairs.shape)
            lights = measure_lights(chain, plane.patch)
            findings = find_light(
                lights,
                calibration,
                chain.correct,
                cycle.trigger.values,
                energies,
                plane=plane,
                options=options,
                reference=run.settings.reference if options.ratio == "correct" else None,
            )
        chain, measuring = correct_light(chain, calibration, findings, options)

    # the frames need neither the sample nor the references
    notes = (*prepared.notes, *misfit.notes)
    return PreparedRun(chain.tabulated(), measuring, findings, energies, notes, faults)
