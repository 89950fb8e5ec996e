"""What a recording determines as a whole: references, camera map, sharpness and noise."""

from __future__ import annotations

import logging
from dataclasses import replace

import numpy as np

from erlif.core.memory import release_memory
from erlif.core.products import References
from erlif.core.progress import Progress
from erlif.core.timing import stage
from erlif.correction import CameraMeasurement, find_reference_faults, make_references
from erlif.io.ingest import Fixture, Run
from erlif.pipeline.chain import FrameChain, FrameCorrection
from erlif.pipeline.recording.cameras import declared_noise, measure_cameras
from erlif.pipeline.recording.noise import NoiseCompletion, complete_noise, find_unknowns
from erlif.pipeline.recording.pulses import read_energies
from erlif.pipeline.recording.register import register_cameras
from erlif.pipeline.recording.sample import compare_sharpness, sample_frames
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
    settings = recording.settings
    with stage("darks and flats", _logger):
        measured: tuple[CameraMeasurement, ...] = measure_cameras(recording)
        declared = declared_noise(recording)
        cameras = make_references(measured, declared=declared)
        faults = find_reference_faults(measured, cameras.references)
        for note in (*cameras.notes, *faults):
            _logger.info("%s", note)

    # where nothing is left to be estimated, the references are all that is needed
    correct = correct_recording(recording, cameras.references)
    if not find_unknowns(cameras.references).any:
        measured = ()
        correct = correct.tabulated() if tables_only else correct
        cameras = replace(cameras, references=correct.references)
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
        chain = replace(chain, blur=compare_sharpness(sample))
        _logger.info(
            "difference of blur variance %.4f px2 along x, %.4f px2 along y, %s",
            chain.blur.x,
            chain.blur.y,
            "removed from the ratio" if chain.blur.significant else "not significant",
        )
        completed = complete_noise(
            chain, cameras, measured=measured, declared=declared, sample=sample
        )
        for note in completed.notes[len(cameras.notes) :]:
            _logger.info("%s", note)
    release_memory()
    return replace(completed, notes=(*completed.notes, *faults))


def correct_recording(recording: Run | Fixture, references: References) -> FrameCorrection:
    """Counts to light for the frames of a recording, with the energies of its log if it has any."""
    return FrameCorrection(
        recording.pairs,
        references,
        recording.settings.thickness.least_signal,
        read_energies(recording.log) if isinstance(recording, Run) else None,
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
    measured, declared = measure_cameras(recording), declared_noise(recording)
    cameras = make_references(measured, declared=declared)
    correct = correct_recording(recording, cameras.references)
    chain = FrameChain(correct, camera_map, blur, recording.settings.thickness.no_film_below)
    completed = complete_noise(chain, cameras, measured=measured, declared=declared)

    # an estimate of the noise compares the sharpness again; the given difference stays
    return replace(completed, chain=replace(completed.chain, blur=blur))
