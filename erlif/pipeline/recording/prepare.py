"""Preparation of a recording as a whole: references, camera map, sharpness and noise."""

from __future__ import annotations

import logging
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import xarray as xr

from erlif.calibration import RunCurve
from erlif.core.notes import Note, warn
from erlif.core.progress import Progress
from erlif.core.speed.memory import release_memory
from erlif.core.timing import stage
from erlif.correction import CameraNoise, make_references
from erlif.io.ingest import Fixture, Run
from erlif.io.settings import ReferenceSettings
from erlif.pipeline.audit.naming import naming
from erlif.pipeline.chain import FrameChain, FrameCorrection
from erlif.pipeline.engines.results import FrameResult
from erlif.pipeline.physics.findings import LightFindings
from erlif.pipeline.physics.gap import MeasuredCells, shows_errors
from erlif.pipeline.physics.light import correct_light, find_light, measure_lights
from erlif.pipeline.physics.systematics import add_systematics, update_systematics
from erlif.pipeline.physics.temperature import read_warming, without_warming
from erlif.pipeline.physics.texture import measure_pattern, take_out
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
from erlif.pipeline.recording.sample import compare_sharpness, divide_sample, sample_frames
from erlif.pipeline.recording.swap import judge_ratios
from erlif.ratio import BlurDifference
from erlif.ratio.softening import LARGEST
from erlif.registration import CameraMap
from erlif.trend.cells import FEWEST_FRAMES

_logger = logging.getLogger(__name__)

_FRAMES_OF_GAP = 100  # from which the errors that the gap shows are sought before the films


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
        faults, bits = known.faults, known.bits
        for note in (*known.cameras.notes, *faults, *bits):
            _logger.info("%s", note)

    with naming(bits):
        correct = correct_recording(recording, known)
        # where nothing is left to be estimated, the images of darks and flats end here
        if not find_unknowns(correct.references).any:
            correct = correct.tabulated() if tables_only else correct
            cameras = replace(known.cameras, references=correct.references)
            known = known._replace(cameras=cameras, measured=())
        release_memory()
        chain = _register(recording, correct, stored, progress)
        completed = _compare_cameras(chain, known)
    # the audits of a run name its bits; a fixture has none but these notes
    named = () if isinstance(recording, Run) else bits
    return replace(completed, notes=(*completed.notes, *faults, *named), bits=bits)


def _register(
    recording: Run | Fixture, correct: FrameCorrection, stored: CameraMap | None, progress: Progress
) -> FrameChain:
    """Find the map between the cameras."""
    settings = recording.settings
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
    return FrameChain(correct, camera_map, no_film_below=settings.thickness.no_film_below)


def _compare_cameras(chain: FrameChain, known: Characterised) -> NoiseCompletion:
    """Find the difference of sharpness, and the noise that is not known."""
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
        blur = completed.chain.blur
        if max(abs(blur.x), abs(blur.y)) > LARGEST:
            text = (
                "one camera is out of focus: the variances of the point spreads differ by more "
                f"than the {2 * LARGEST:.1f} px2 that a blur of the other one removes, and the "
                "error bars of single pixels lack the rest. Focus both alike"
            )
            completed = replace(completed, notes=(*completed.notes, warn("sharpness", text)))
        for note in completed.notes[len(known.cameras.notes) :]:
            _logger.info("%s", note)
    release_memory()
    return completed


def correct_recording(recording: Run | Fixture, known: Characterised) -> FrameCorrection:
    """Counts to light for the frames of a recording, with the energies of its log if it has any."""
    return FrameCorrection.of(
        recording.pairs,
        known.cameras.references,
        least_signal=recording.settings.thickness.least_signal,
        energies=read_energies(recording.log) if isinstance(recording, Run) else None,
        unlit=tuple(camera.unlit for camera in known.measured),
    )


def restore_chain(
    run: Run, camera_map: CameraMap, blur: BlurDifference, noise: Sequence[CameraNoise]
) -> FrameChain:
    """Prepare a chain whose camera map, sharpness and noise were found before.

    Parameters
    ----------
    run : Run
    camera_map : CameraMap
    blur : BlurDifference
    noise : sequence of two CameraNoise
        Used as far as settings, darks and flats leave it open.

    Returns
    -------
    FrameChain

    Raises
    ------
    FrameError
        As `prepare_chain`.
    """
    known = characterise_cameras(run)
    cameras = make_references(known.measured, declared=known.declared, estimated=noise)
    below = run.settings.thickness.no_film_below
    correct = correct_recording(run, known).with_references(cameras.references)
    return FrameChain(correct, camera_map, blur, below)


@dataclass(frozen=True)
class PreparedRun:
    """A run whose frames can be measured: what all of its frames share.

    Attributes
    ----------
    run : Run
    cycle : xarray.Dataset
        Trigger, position and speed of each frame, as `locate_run` returns it.
    chain : FrameChain
        Counts to ratio.
    curve : RunCurve
        Ratio to film thickness, for the light as it is corrected.
    light : LightFindings
        Light that is not film, as far as it is known before the films.
    notes : tuple[Note, ...]
        On both cameras and their ratio.
    faults : tuple[Note, ...]
        Of the counts: bits that are stuck, noise that is too low.
    """

    run: Run
    cycle: xr.Dataset
    chain: FrameChain
    curve: RunCurve
    light: LightFindings
    notes: tuple[Note, ...]
    faults: tuple[Note, ...]

    @cached_property
    def plane(self) -> ObjectPlane:
        """Positions of the pixels on the joint."""
        return ObjectPlane(self.run.settings, self.run.pairs.shape)

    def find_light(
        self,
        lights: Mapping[int, FrameResult],
        reference: ReferenceSettings | None = None,
        *,
        cells: MeasuredCells | None = None,
    ) -> LightFindings:
        """Find the light that is not film; parameters as for `erlif.pipeline.physics.light`."""
        return find_light(
            lights,
            self.curve,
            self.chain.correct,
            self.cycle.trigger.values,
            read_energies(self.run.log),
            plane=self.plane,
            options=self.run.settings.light,
            reference=reference,
            texture=self.light.texture,
            cells=cells,
        )

    def judge_light(
        self, lights: Callable[[], Mapping[int, FrameResult]]
    ) -> tuple[LightFindings, LightFindings, RunCurve]:
        """Find what light and films show of the errors of the run.

        Parameters
        ----------
        lights : callable
            Gives the light of the frames of `choose_frames`; called where it is needed.

        Returns
        -------
        findings : LightFindings
        counted : LightFindings
            Those that enter the error bars.
        curve : RunCurve
            That of the maps, with the errors that the findings leave.
        """
        findings, options = self.light, self.run.settings.light
        if findings.errors is None:  # nothing was taken out, or a part
            findings = findings.complete(self.find_light(lights()), options)
        counted = findings.for_error_bars(self.curve, options)
        curve = update_systematics(
            self.curve,
            counted,
            options,
            pulses=len(self.run.pairs.usable),
            pairs=len(self.run.pairs.pages[0]),
        )
        return findings, counted, curve


def prepare_run(
    run: Run,
    cycle: xr.Dataset,
    curve: RunCurve,
    known: FixtureMap,
    progress: Progress,
    *,
    tables_only: bool = True,
) -> PreparedRun:
    """Characterise and register the cameras, and find the light that is to be subtracted.

    Parameters
    ----------
    run : Run
    cycle : xarray.Dataset
        As `locate_run` returns it.
    curve : RunCurve
        With the errors of the fixture alone.
    known : FixtureMap
        What is kept of the camera map of the fixture.
    progress : callable
    tables_only : bool
        As for `prepare_chain`.

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
    warmer = read_warming(run, curve.calibration)
    plane = ObjectPlane(run.settings, run.pairs.shape)
    asks_gap = options.errors is None and not options.corrects
    asks_gap &= plane.view is not None and len(run.pairs.usable) >= FEWEST_FRAMES
    prepared = prepare_chain(
        run,
        progress,
        stored=known.stored,
        tables_only=tables_only and not (options.corrects or asks_gap),
    )
    chain = without_warming(prepared.chain, warmer, run.settings.temperature)
    ratios = divide_sample(chain, prepared.sample)
    faults = (*prepared.bits, *note_noise(ratios))
    misfit = judge_ratios(chain, curve.calibration, ratios, stored=known.nodes)
    chain = complete_energies(chain, curve)
    curve = add_systematics(
        curve, run.settings, chain, prepared.sample, ratios, warmer=warmer, misfit=misfit.size
    )
    del ratios  # 30 MB
    notes = (*prepared.notes, *misfit.notes)
    ready = PreparedRun(run, cycle, chain, curve, LightFindings(), notes, faults)

    # what is taken out is found before the films are measured: what was asked for, or the gap shows
    if options.corrects or (asks_gap and shows_errors(curve, plane)):
        with stage("light", _logger):
            patch = run.settings.reference if options.ratio == "correct" else None
            most = None if options.corrects else _FRAMES_OF_GAP
            lights = measure_lights(chain, curve, plane.patch, most=most)
            findings, small = ready.find_light(lights, patch), None
            if findings.texture is not None and options.errors != "report":
                # the same beside a pattern whose size and length small cells show better
                frames = run.pairs.spread(_FRAMES_OF_GAP)
                small = measure_pattern(chain, frames, curve, plane, findings.texture)
                if small is not None:
                    texture, cells = small
                    ready = replace(ready, light=LightFindings(texture=texture))
                    findings = ready.find_light(lights, patch, cells=cells)
        chain, curve, findings = correct_light(chain, curve, findings, options)
        if small is not None:
            chain, findings = take_out(chain, ready.curve, findings, plane)
        if options.corrects or curve.follows_run or chain.pattern is not None:
            ready = replace(ready, chain=chain, curve=curve, light=findings)

    # the frames need neither the sample nor the references
    return replace(ready, chain=ready.chain.tabulated()) if tables_only else ready
