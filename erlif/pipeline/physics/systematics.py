"""Errors that the frames of a run do not show, in its calibration."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import xarray as xr

from erlif.calibration import NO_SYSTEMATICS, USUAL_LEVEL, Calibration, RunCurve, Systematics
from erlif.core.arrays import Array
from erlif.core.terms import CONSTANT, RISE, TERMS
from erlif.io.settings import LightOptions, RunSettings
from erlif.pipeline.chain import FrameChain
from erlif.pipeline.engines.results import TriggerResult, shares_passed
from erlif.pipeline.physics.dark import DarkLevel
from erlif.pipeline.physics.findings import LightFindings
from erlif.pipeline.physics.gap import with_errors
from erlif.pipeline.physics.reference import PatchScale
from erlif.pipeline.physics.temperature import error_of_warming
from erlif.pipeline.recording.sample import Bands, SampleRatios, ratios_of
from erlif.trend import BackgroundEstimate, CourseChange, Trend, of_curve

# Terms of the curve between two fixtures.
_OF_TWO = {key for key, term in TERMS.items() if term.of_two}

_FILMS = 50  # of the range, at which two curves are compared

# Standard deviations of all errors beyond which a patch shows a ratio that is none of theirs, and
# the width that its scale has then. [1]
_BEYOND, _UNKNOWN = 3.0, 10.0


def add_systematics(
    calibration: RunCurve,
    settings: RunSettings,
    chain: FrameChain,
    sample: Sequence[Bands],
    ratios: SampleRatios,
    *,
    warmer: Array | None = None,
    misfit: float = 0.0,
) -> RunCurve:
    """The calibration with the errors of a run beside those of its fixture.

    Parameters
    ----------
    calibration : RunCurve
        Of the fixture.
    settings : RunSettings
    chain : FrameChain
    sample : sequence of tuple of AlignedFrames
        Parts of some frames of the run: the light of their median film is that to which a
        background is compared. Where frames of the dry joint are subtracted, none is left.
    ratios : list of list of RatioImages
        Of the sample.
    warmer : array, (frame,), optional
        Temperature over that of the fixture, by which the ratio was corrected. [K]
    misfit : float
        By how much ratios exceed those of all films: the scale is off by as much at least. [1]

    Returns
    -------
    RunCurve
    """
    found = Systematics.of(
        calibration.systematics.widths | _widths_of_run(calibration, settings),
        parameters=len(calibration.fitted_covariance),
        light=_light_of_median(calibration, ratios),
        level=_levels_of_median(chain, sample),
        frame=chain.correct.pairs.shape,
    )
    if has_dry_joint(settings):
        energy_std = settings.systematics.shares["energy"]
        found = found.adding("background", _error_of_dry_joint(chain, sample, energy_std))
    if warmer is not None:
        found = found.adding("temperature", error_of_warming(warmer, settings.temperature))
    if misfit:
        found = found.adding("ratio", np.array(misfit**2))
    return replace(calibration, systematics=found)


def _less_certain(before: Calibration, after: Calibration) -> float:
    """Additional error of the later curve, rms over the films of the earlier one. [1]"""
    films = np.linspace(*before.thickness_range, _FILMS)
    one, two = (
        replace(each, systematics=NO_SYSTEMATICS).log_ratio_std(films) for each in (before, after)
    )
    return math.sqrt(max(float((two**2 - one**2).mean()), 0.0))


def _widths_of_run(calibration: RunCurve, settings: RunSettings) -> dict[str, float]:
    """Standard deviations of the settings, without what is measured. [1]"""
    shares, stated = settings.systematics.shares, settings.systematics.model_fields_set
    shown = {"background"} if has_dry_joint(settings) else set()
    if settings.temperature.coefficient is not None:
        shown.add("temperature")
    if calibration.later is None:
        shares = {key: share for key, share in shares.items() if key not in _OF_TWO}
    else:
        # a fixture after the run shows the sum of what lies between both
        shown |= {key for key, term in TERMS.items() if term.between}
        shares["later"] = _less_certain(calibration.calibration, calibration.later)
    return shares | dict.fromkeys(shown - stated, 0.0)


def _light_of_median(calibration: RunCurve, sample: SampleRatios) -> tuple[float, float]:
    """Light of both bands of the median film of a sample, per um of a very thin film. [um]"""
    film = calibration.covered_range[1] / 2
    if ratios := [ratio for ratio, _ in ratios_of(sample)]:
        median = np.median(np.concatenate(ratios))
        film = float(calibration.inverse.look_up(np.array([median]))[0])
    one = float(calibration.model.light(film).signal)
    return one, one * float(calibration.predict(film))


def _signals(sample: Sequence[Bands]) -> list[xr.DataArray]:
    """Light of both cameras in all bands of rows of a sample, (frame, camera, y, x). [DN]"""
    return [band.signal for each in sample for band in each]


def _medians(lights: Sequence[xr.DataArray]) -> Array:
    """Median light of both cameras. [DN]"""
    values = np.concatenate([light.values.reshape(2, -1) for light in lights], axis=1)
    return np.asarray(np.nanmedian(values, axis=1), float)


def _levels_of_median(chain: FrameChain, sample: Sequence[Bands]) -> tuple[float, float]:
    """Median light of both cameras over their full scale. [1]"""
    if not (signals := _signals(sample)):
        return USUAL_LEVEL
    one, two = _medians(signals) / np.exp2(chain.correct.pairs.bit_depths)
    return float(one), float(two)


def _error_of_dry_joint(chain: FrameChain, sample: Sequence[Bands], energy_std: float) -> Array:
    """Covariance of the residual error of the subtracted dry joint, (camera, camera). [1]

    Their mean energy over that of the run is an error common to both cameras. By chance it differs
    with the number of pages as well, in each camera for itself.
    """
    correct, pages = chain.correct, chain.references.background_pages.values
    lights = _medians([band / correct.energy(int(band.frame[0])) for band in _signals(sample)])
    dry = np.array(
        [
            np.median(table.noise.dry_light) / light
            for table, light in zip(correct.tables, lights, strict=True)
        ]
    )
    energies = np.ones(1) if correct.energies is None else correct.energies
    by_chance = np.var(energies) * (1 / np.maximum(pages, 1) + 1 / energies.size)
    return np.outer(dry, dry) * (energy_std**2 + np.diag(by_chance))


def with_background(calibration: RunCurve, measured: Systematics) -> RunCurve:
    """The calibration with the error of a background that was measured.

    Without systematics it receives those of the background alone.
    """
    systematics = calibration.systematics
    if not systematics:
        systematics = Systematics.of({"background": 0.0}, parameters=len(measured.cross))
    return replace(calibration, systematics=systematics.with_background(measured))


def with_patch(calibration: RunCurve, scale: PatchScale) -> RunCurve:
    """The calibration with what a patch of known film shows of its errors.

    Its ratio is two measurements of all errors together, of which each takes its part: at the first
    frame, and what is added until the last. Where one is beyond their widths, the scale of the
    ratio and its change during the run are as the patch shows them, whatever their widths.

    Parameters
    ----------
    calibration : RunCurve
        With the systematics of the run. What its curve has of a patch already stays there, with the
        error by which it differs.
    scale : PatchScale

    Returns
    -------
    RunCurve
        With the same parameters.
    """
    systematics = calibration.systematics
    place = None if scale.place is None else tuple(np.array(at) for at in scale.place)
    first, last = (calibration.at(share).gradient(scale.film, place=place) for share in (0.0, 1.0))
    acts, noise = np.array([first, last - first]), scale.covariance.copy()
    noise[0, 0] += (float(calibration.slope(scale.film)) * scale.film_std) ** 2

    prior = calibration.full_covariance.copy()
    expected = acts @ prior @ acts.T + noise
    if (np.abs(scale.course) > _BEYOND * np.sqrt(np.diag(expected))).any():
        both = systematics.place("ratio", CONSTANT), systematics.place("bleaching", RISE)
        alike = len(systematics.cross) + np.array(both)
        prior[alike, alike] += _UNKNOWN**2
        expected = acts @ prior @ acts.T + noise
    gain = np.linalg.solve(expected, acts @ prior).T
    covariance = prior - gain @ expected @ gain.T
    value, covariance = of_curve(gain @ scale.course, covariance, systematics)
    if systematics.value is not None:
        missed = value - systematics.value
        value, covariance = systematics.value, covariance + np.outer(missed, missed)
    scatter = gain @ scale.covariance @ gain.T
    found = systematics.with_errors(covariance, value, before=prior, scatter=scatter)
    return replace(calibration, systematics=found).where_it_rises()


def update_systematics(
    calibration: RunCurve,
    findings: LightFindings,
    options: LightOptions,
    *,
    pulses: int,
    pairs: int = 2,
) -> RunCurve:
    """Update the systematics of the calibration by the findings of a run.

    What was subtracted leaves its uncertainty. What was not leaves its second moment, with the
    width of the settings as prior; of a term that the settings exclude, only what is significant
    counts.

    Parameters
    ----------
    calibration : RunCurve
        With which the films were measured.
    findings : LightFindings
        As `LightFindings.for_error_bars` gives them: errors of the gap in place of all others.
    options : LightOptions
    pulses : int
        Frames of the run.
    pairs : int
        Frame pairs of the recording.

    Returns
    -------
    RunCurve
        With the same parameters, and one more for a significant course, as the last.
    """
    systematics = calibration.systematics
    if not systematics or findings.taken_out:
        return calibration
    if findings.errors is not None:
        return with_errors(calibration, findings.errors, corrected=False)

    background, bleaching, course = findings.background, findings.bleaching, findings.course
    # what a patch has shown already is in the maps
    systematics = replace(systematics.without_run, value=systematics.value)
    if background is None or options.background != "correct":
        if background is not None:
            systematics = _with_background_of_run(systematics, background)
        systematics = _with_darks(systematics, findings.darks)
    if findings.scale is not None:
        known = with_patch(replace(calibration, systematics=systematics), findings.scale)
        systematics = known.systematics
    # between two fixtures the curve follows the dyes, and the change of the ratio is no error
    elif calibration.later is None:
        if bleaching is not None:
            systematics = _with_bleaching(systematics, bleaching, options, pulses=pulses)
        elif course is not None and not course.significant and math.isfinite(course.drift[1]):
            systematics = systematics.with_rise(_rise_given(systematics, *course.drift))
    if course is not None and course.significant:
        start = None if course.frame is None else float(shares_passed(course.frame, pairs))
        # the course is all that changes the ratio of all films alike during the run
        systematics = systematics.with_rise(0.0).with_course(
            math.hypot(course.size, course.std), start=start
        )
    return replace(calibration, systematics=systematics)


def _with_darks(systematics: Systematics, darks: Sequence[DarkLevel]) -> Systematics:
    """Add the errors of wrong dark levels that the background does not contain yet."""
    for dark in darks:
        place = systematics.places("background")[dark.camera - 1]
        offset = np.zeros((2, 2))
        missing = dark.share**2 - systematics.covariance[place, place]
        offset[dark.camera - 1, dark.camera - 1] = max(missing, 0.0)
        systematics = systematics.adding("background", offset)
    return systematics


def follow_course(
    results: Sequence[TriggerResult],
    calibration: RunCurve,
    course: CourseChange | None,
    *,
    pairs: int,
) -> list[TriggerResult]:
    """Results of all triggers with the change of their films by the course of `update_systematics`.

    Parameters
    ----------
    results : sequence of TriggerResult
    calibration : RunCurve
        With which they were measured.
    course : CourseChange or None
    pairs : int
        Frame pairs of the recording.

    Returns
    -------
    list of TriggerResult
        Unchanged without a significant course.
    """
    systematics = calibration.systematics
    if not systematics or course is None or not course.significant:
        return list(results)
    parameter = len(systematics.cross) + int(systematics.places("ratio")[0])
    weights = []
    for result in results:
        frames = np.array([one.frame for one in result.frames], float)
        drifts = course.frame is None
        shares = shares_passed(frames, pairs) if drifts else frames >= course.frame
        weights.append(float(shares.mean()) if frames.size else 0.0)
    return [
        result.with_parameter(parameter, weight)
        for result, weight in zip(results, weights, strict=True)
    ]


def _with_background_of_run(
    systematics: Systematics, background: BackgroundEstimate
) -> Systematics:
    """The systematics with a background that is reported and not subtracted."""
    shares = systematics.places("background")
    prior = systematics.covariance[np.ix_(shares, shares)]
    if not prior.any():
        if not background.significant:
            return systematics
        return systematics.with_background(background.second_moment)

    # the width is a share of the light of the sample, the estimate of that of its cells
    scale = np.divide(systematics.light, background.error.light)
    posterior = background.given(np.outer(scale, scale) * prior)
    return systematics.with_background(posterior.second_moment)


def _with_bleaching(
    systematics: Systematics, trend: Trend, options: LightOptions, *, pulses: int
) -> Systematics:
    """The systematics with the change of the ratio that equal films show."""
    change, std = pulses * trend.log_ratio, pulses * trend.log_ratio_std
    if options.bleaching == "correct":
        return systematics.with_rise(std)
    if systematics.rise == 0:
        return systematics.with_rise(abs(change) if trend.significant() else 0.0)
    return systematics.with_rise(_rise_given(systematics, change, std))


def _rise_given(systematics: Systematics, change: float, std: float) -> float:
    """Rms change of the ratio over the run, from its prior width and its measurement. [1]"""
    width = systematics.rise
    if width == 0:
        return 0.0
    gain = width**2 / (width**2 + std**2)
    return math.hypot(gain * change, math.sqrt(1 - gain) * width)


def has_dry_joint(settings: RunSettings) -> bool:
    """Whether frames of the dry joint are named."""
    return bool(settings.camera1.background or settings.camera2.background)
