"""What a recording determines as a whole: references, camera map, sharpness and noise."""

from __future__ import annotations

from dataclasses import replace

from erlif.core.progress import Progress
from erlif.core.timing import stage
from erlif.correction import make_references
from erlif.ingest import Fixture, Run
from erlif.pipeline.cameras import declared_noise, measure_cameras
from erlif.pipeline.chain import FrameChain, FrameCorrection, compare_sharpness
from erlif.pipeline.noise import NoiseCompletion, complete_noise
from erlif.pipeline.register import register_cameras
from erlif.ratio import BlurDifference
from erlif.registration import CameraMap


def prepare_chain(
    recording: Run | Fixture, progress: Progress, *, stored: CameraMap | None = None
) -> NoiseCompletion:
    """Characterise and register the cameras of a recording, so that its frames can be processed.

    Parameters
    ----------
    recording : Run or Fixture
    progress : callable
    stored : CameraMap, optional
        A map found before, to be used instead of a new one.

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
    with stage("darks and flats"):
        measured, declared = measure_cameras(recording), declared_noise(recording)
        cameras = make_references(measured, declared=declared)

    correct = FrameCorrection(recording.pairs, cameras.references, settings.thickness.least_signal)
    with stage("registration"):
        camera_map = register_cameras(
            correct, settings.registration, stored=stored, progress=progress
        )

    chain = FrameChain(correct, camera_map, no_film_below=settings.thickness.no_film_below)
    with stage("sharpness and noise"):
        chain = replace(chain, blur=compare_sharpness(chain))
        return complete_noise(chain, cameras, measured=measured, declared=declared)


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
    options = recording.settings.thickness
    measured, declared = measure_cameras(recording), declared_noise(recording)
    cameras = make_references(measured, declared=declared)
    correct = FrameCorrection(recording.pairs, cameras.references, options.least_signal)
    chain = FrameChain(correct, camera_map, blur, options.no_film_below)
    completed = complete_noise(chain, cameras, measured=measured, declared=declared)

    # an estimate of the noise compares the sharpness again; the given difference stays
    return replace(completed, chain=replace(completed.chain, blur=blur))
