"""Light of a run that is not film: found, reported, and subtracted where that is asked for."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import xarray as xr

from erlif.calibration import RunCurve
from erlif.core.arrays import AnyArray, Array
from erlif.core.notes import Note, remark, warn
from erlif.core.products import References
from erlif.core.variables import FILM
from erlif.io.ingest import FramePairs, Run
from erlif.io.settings import LightOptions, ReferenceSettings
from erlif.pipeline.chain import FrameChain, FrameCorrection
from erlif.pipeline.engines.engine import Threads
from erlif.pipeline.engines.results import FrameResult, TriggerResult, shares_passed
from erlif.pipeline.physics.dark import find_dark_levels
from erlif.pipeline.physics.findings import LightFindings
from erlif.pipeline.physics.gap import (
    MeasuredCells,
    cells_of_region,
    describe_gap,
    find_errors,
    with_errors,
)
from erlif.pipeline.physics.reference import (
    describe_reference,
    describe_scale,
    fit_patch_scale,
    flag_thick_films,
)
from erlif.pipeline.physics.systematics import (
    with_background,
    with_patch,
)
from erlif.pipeline.physics.texture import describe_texture
from erlif.pipeline.plane import ObjectPlane
from erlif.ratio import LightCells, cell_places
from erlif.trend import (
    BackgroundEstimate,
    CourseChange,
    Region,
    Texture,
    Trend,
    estimate_background,
    find_ratio_change,
    find_texture,
    fit_trend,
)

# Standard deviations of its width up to which a drift of the ratio is one of the known errors.
_MOST_RISING = 3.0

# Frames of an estimate, spread over the run: their number bounds memory and time.
_MOST_FRAMES = 400


def choose_frames(pairs: FramePairs, most: int | None = None) -> frozenset[int]:
    """Frames whose light is kept for the estimate of a background.

    Parameters
    ----------
    pairs : FramePairs
    most : int, optional
        Of these frames, where fewer do.

    Returns
    -------
    frozenset of int
    """
    return frozenset(pairs.spread(_MOST_FRAMES if most is None else most))


def measure_lights(
    chain: FrameChain, calibration: RunCurve, patch: Region | None, *, most: int | None = None
) -> dict[int, FrameResult]:
    """Measure the light of the frames that `choose_frames` names.

    Parameters
    ----------
    chain : FrameChain
    calibration : RunCurve
    patch : Region or None
        Rows and columns of the reference patch.
    most : int, optional
        As for `choose_frames`.

    Returns
    -------
    dict of int to FrameResult
    """
    lights: dict[int, FrameResult] = {}

    def measure(frame: int) -> FrameResult:
        pair = chain.measure(frame)
        flag_thick_films(pair, calibration, patch)
        return FrameResult.of(frame, pair, patch=patch, with_cells=True)

    frames = sorted(choose_frames(chain.pairs, most))
    Threads(None).compute(measure, frames, lights.__setitem__)
    return lights


def find_background(
    lights: Mapping[int, FrameResult],
    calibration: RunCurve,
    energies: Array | None,
    *,
    pairs: int,
) -> BackgroundEstimate | None:
    """Estimate the background of a run.

    Parameters
    ----------
    lights : mapping of int to FrameResult
        By frame.
    calibration : RunCurve
    energies : array, (frame,), optional
        Relative pulse energies of all frames of the run, from the log. [1]
    pairs : int
        Frame pairs of the run.

    Returns
    -------
    BackgroundEstimate or None
        None where the run does not determine it.
    """
    frames = sorted(lights)
    if not frames:
        return None
    record, calibration = _record(lights, calibration, pairs)
    estimate = estimate_background(
        record,
        cell_places(),
        replace(calibration, systematics=calibration.systematics.prior),
        energies=None if energies is None else energies[frames],
        passed=shares_passed(frames, pairs),
    )
    return estimate if estimate is not None and estimate.determined else None


def _record(
    lights: Mapping[int, FrameResult], calibration: RunCurve, pairs: int
) -> tuple[LightCells, RunCurve]:
    """Light and ratio of the cells, frames in their order, and the curve that holds for all."""
    frames = np.array(sorted(lights))
    parts = np.array([lights[frame].cells for frame in frames], float)
    record = LightCells(*parts.transpose(1, 0, 2))
    if calibration.later is None:
        return record, calibration

    # between two fixtures: the ratios of the same films in the middle of the run
    middle = calibration.at(0.5)
    early = 0.5 - shares_passed(frames, pairs)[:, None]
    change = middle.change(middle.inverse.look_up(record.log_ratio))
    return record._replace(log_ratio=record.log_ratio + early * change), middle


def describe_background(
    estimate: BackgroundEstimate | None, calibration: RunCurve, *, corrected: bool
) -> tuple[dict[str, Any], list[Note]]:
    """Variables of the film and notes about a background.

    Parameters
    ----------
    estimate : BackgroundEstimate or None
    calibration : RunCurve
    corrected : bool
        Whether it was to be subtracted.

    Returns
    -------
    variables : dict of str to variable
        background and background_std on dim camera; none where the run does not determine them.
    notes : list of Note
    """
    if estimate is None:
        text = "light and films of this run do not determine light that is not film"
        needs = "needs a dozen frames, films that differ and an even wall. Frames of the dry "
        needs += "joint (background in [camera1] and [camera2]) measure it"
        return {}, [
            warn("background", f"nothing was subtracted: {text}. That {needs}")
            if corrected
            else remark("background", f"{text}: it {needs}")
        ]

    variables = {
        "background": FILM["background"].fill(
            estimate.share,
            subtracted=str(corrected).lower(),
            chi_square=estimate.chi_square,
            detectable=estimate.detectable,
        ),
        "background_std": FILM["background_std"].fill(estimate.std),
    }
    return variables, [_note_background(estimate, calibration, corrected=corrected)]


def _note_background(
    estimate: BackgroundEstimate, calibration: RunCurve, *, corrected: bool
) -> Note:
    """Make the note on the background that was found."""
    one, two = (
        f"camera {n} {100 * share:.1f} ± {100 * std:.1f} %"
        for n, (share, std) in enumerate(zip(estimate.share, estimate.std, strict=True), 1)
    )
    shares = f"{one}, {two} of the median light"
    if corrected:
        return remark("background", f"light that is not film subtracted: {shares}")
    if not estimate.significant:
        return remark(
            "background",
            f"no light that is not film was found; {100 * estimate.detectable:.1f} % of the "
            "median light in both cameras would have been significant",
        )

    film = 0.5 * estimate.film  # thinner than the median, where the joint carries its load
    low = max(film, calibration.thickness_range[0])
    shift, std = (
        1e3 * float(value(np.array(low), calibration))
        for value in (estimate.film_shift, estimate.film_shift_std)
    )
    return warn(
        "background",
        f"light and films of the run do not agree without light that is not film: {shares}. Films "
        f"of {low:.1f} um are then off by {shift:+.0f} ± {std:.0f} nm; film_mean_std and "
        "film_min_std include this shift, the maps do not. Photograph the dry joint (background "
        'in [camera1] and [camera2]), or set background = "correct" in [light]',
    )


def subtract(chain: FrameChain, estimate: BackgroundEstimate) -> FrameChain:
    """The chain with an even background subtracted from every frame.

    Parameters
    ----------
    chain : FrameChain
        With its references.
    estimate : BackgroundEstimate

    Returns
    -------
    FrameChain
    """
    references = chain.references
    level = np.array(estimate.share * np.array(estimate.unit))
    even = level[:, None, None] * references.flat.values
    before = references.get("background", xr.zeros_like(references.flat))
    variance = references.get("background_var", xr.zeros_like(references.flat))
    recorded = references.get("background_recorded", xr.zeros_like(references.gain, dtype=bool))
    added = references.assign(
        background=before.copy(data=(before.values + even).astype(np.float32)),
        background_var=variance,
        background_recorded=recorded,
    )
    return replace(chain, correct=chain.correct.with_references(References(added)))


def find_bleaching(
    lights: Mapping[int, FrameResult], triggers: AnyArray, energies: Array | None
) -> tuple[Trend | None, str]:
    """Change of ratio and light with every pulse, at equal film.

    Parameters
    ----------
    lights : mapping of int to FrameResult
        By frame.
    triggers : array of int, (frame,)
        Trigger of every frame of the run.
    energies : array, (frame,), optional
        Relative pulse energies from the log. [1]

    Returns
    -------
    trend : Trend or None
        None where neither a patch nor several cycles determine it.
    source : str
        Where the film is the same: the reference patch, or equal triggers.
    """
    frames = np.array(sorted(lights), int)
    if not frames.size:
        return None, ""
    # the light of a frame without a logged energy, or of a missed pulse, is not compared
    energy = np.full(frames.size, np.nan) if energies is None else energies[frames]
    lowered = np.log(np.where(energy > 0, energy, np.nan))[:, None]
    patch = np.array([lights[frame].patch for frame in frames])
    if np.isfinite(patch[:, 1]).any():
        group = np.zeros(frames.size, int)
        trend = fit_trend(frames.astype(float), group, patch[:, 1:2], patch[:, :1] - lowered)
        return trend, "on the patch"

    light = np.array([lights[frame].cells.light for frame in frames], float)
    ratio = np.array([lights[frame].cells.log_ratio for frame in frames], float)
    trend = fit_trend(frames.astype(float), triggers[frames], ratio, light - lowered)
    return trend, "at equal triggers"


def describe_bleaching(
    trend: Trend | None, source: str, *, frames: int, corrected: bool, followed: bool = False
) -> tuple[dict[str, Any], list[Note]]:
    """Variables of the film and notes about bleaching dyes.

    Parameters
    ----------
    trend : Trend or None
    source : str
        As `find_bleaching` returns it.
    frames : int
        Frames of the run.
    corrected : bool
        Whether it was to be taken out.
    followed : bool
        Whether the curve between two fixtures contains it.

    Returns
    -------
    variables : dict of str to variable
    notes : list of Note
    """
    if trend is None:
        text = (
            "bleaching cannot be separated from a change of the film: this takes several cycles or "
            "a reference patch. Nothing was taken out of the ratio"
        )
        return {}, [warn("bleaching", text)] if corrected else []
    values = {"ratio": (trend.log_ratio, trend.log_ratio_std)}
    if np.isfinite(trend.light):
        values["light"] = trend.light, trend.light_std
    variables: dict[str, Any] = {}
    for name, (change, std) in values.items():
        of = FILM[f"bleaching_{name}"]
        long_name = f"{of.attrs['long_name']}, {source}"
        variables[of.name] = of.fill(change, long_name=long_name)
        variables[f"{of.name}_std"] = FILM[f"{of.name}_std"].fill(std)
    variables["bleaching_ratio"].attrs["corrected"] = str(corrected).lower()
    if not trend.significant() and not corrected:
        return variables, []
    ratio, light = (
        f"{100 * frames * change:+.2f} ± {100 * frames * std:.2f} %"
        for change, std in ((trend.log_ratio, trend.log_ratio_std), (trend.light, trend.light_std))
    )
    light = f", the light of camera 1 by {light}" if "light" in values else ""
    text = f"{source}, the ratio changes by {ratio}{light} over the run, as with dyes that bleach"
    if source == "at equal triggers":
        text += " or films that change from cycle to cycle"
    if corrected:
        return variables, [remark("bleaching", f"{text}; taken out of the ratio")]
    if followed:
        text += "; the curve between the fixtures before and after the run follows it"
        return variables, [remark("bleaching", text)]
    text += '; bleaching = "correct" in [light] takes the change out of the ratio'
    return variables, [warn("bleaching", text)]


def find_light(
    lights: Mapping[int, FrameResult],
    calibration: RunCurve,
    correct: FrameCorrection,
    triggers: AnyArray,
    energies: Array | None,
    *,
    plane: ObjectPlane,
    options: LightOptions,
    reference: ReferenceSettings | None = None,
    texture: Texture | None = None,
    cells: MeasuredCells | None = None,
) -> LightFindings:
    """Background, bleaching, course and errors of a run, and the scale of its ratio on a patch.

    Parameters as for the first two, `find_dark_levels`, `find_errors` and `fit_patch_scale`;
    `texture` is what stands still in the image where it was found before.
    """
    bleaching, source = find_bleaching(lights, triggers, energies)
    course = None
    if lights:
        frames = np.array(sorted(lights))
        record, curve = _record(lights, calibration, triggers.size)
        course = find_ratio_change(frames, record, cell_places(), curve)

    # equal films show a drift better than one cycle does
    if course is not None and course.frame is None and bleaching is not None:
        course = None
    darks = find_dark_levels(lights, correct.unlit, correct.references.gain.values)
    # the lobes of a bore are no smooth gap
    smooth = plane.bore is None and bool(calibration.systematics)
    if smooth and texture is None:
        coarse = cells_of_region([lights[frame].cells for frame in sorted(lights)], plane)
        texture = None if coarse is None else find_texture(*coarse, calibration.at(0.5))

    background, scale = None, None
    if texture is None:  # a pattern of the ratio looks like light that is not film
        background = find_background(lights, calibration, energies, pairs=triggers.size)
    if reference is not None:
        scale = fit_patch_scale(
            lights, calibration, reference, pairs=triggers.size, patch=plane.patch, texture=texture
        )

    errors = None
    # darks that are wrong are a background beyond its width
    beyond = bool(darks)
    # the patch shows a drift of the ratio
    drifts = (bleaching, course)
    if scale is not None:
        drifts = None, None if course is None or course.frame is None else course
    beyond |= is_beyond_widths(calibration, background, *drifts, triggers.size)
    if not options.corrects_light and not beyond:
        # beside those that a patch shows
        known = calibration if scale is None else with_patch(calibration, scale)
        errors = find_errors(
            lights, known, plane, pairs=triggers.size, texture=texture, cells=cells
        )
    return LightFindings(
        background, bleaching, source, course, scale, errors, tuple(darks), texture
    )


def is_beyond_widths(
    calibration: RunCurve,
    background: BackgroundEstimate | None,
    bleaching: Trend | None,
    course: CourseChange | None,
    pulses: int,
) -> bool:
    """Whether a change found in the run exceeds the widths of its errors.

    Parameters
    ----------
    calibration : RunCurve
        With the systematics of the settings.
    background, bleaching, course
        As the run shows them; None where it does not determine them.
    pulses : int
        Frames of the run.

    Returns
    -------
    bool
    """
    systematics = calibration.systematics
    if not systematics:
        return False
    excluded = systematics.widths.get("background", 0.0) == 0
    if background is not None and background.significant and excluded:
        return True

    # bleaching and half of the temperature rise during the run; a small step looks like them
    most = _MOST_RISING * systematics.rise
    drifts = [] if bleaching is None or not bleaching.significant() else [bleaching.log_ratio]
    if any(pulses * abs(drift) > most for drift in drifts):
        return True
    if course is None or not course.significant:
        return False
    return bool(abs(course.size) > (most if course.frame is None else most / _MOST_RISING))


def describe_course(course: CourseChange | None, calibration: RunCurve) -> list[Note]:
    """Notes about a step or a drift of the ratio.

    Parameters
    ----------
    course : CourseChange or None
    calibration : RunCurve

    Returns
    -------
    list of Note
        Empty where nothing is significant.
    """
    if course is None or not course.significant:
        return []
    per_share = 1e3 / float(calibration.slope(course.film))
    films = f"films of {course.film:.1f} um"
    shift = f"{per_share * course.size:+.0f} ± {per_share * course.std:.0f} nm"
    change = f"{100 * np.expm1(course.size):+.2f} ± {100 * course.std:.2f} %"
    text = (
        f"{films} drift by {shift} over the run: the ratio at equal film changes by {change}. "
        "Likely: dyes that bleach, oil that warms, or a gain that drifts. film_mean_std and "
        "film_min_std include the shift, the maps do not. Photograph the fixture before and after"
        if course.frame is None
        else f"from frame {course.frame} on {films} are {shift} off: the ratio at equal film "
        f"differs by {change}. Likely: gain, exposure or filter of one camera. film_mean_std and "
        "film_min_std include the shift, the maps do not. Photograph the fixture again, and "
        "process the frames before and after as two runs"
    )
    return [warn("course", text)]


def correct_light(
    chain: FrameChain, calibration: RunCurve, findings: LightFindings, options: LightOptions
) -> tuple[FrameChain, RunCurve, LightFindings]:
    """Apply the requested corrections to chain and calibration; findings without other errors."""
    if options.background == "correct" and findings.background is not None:
        chain = subtract(chain, findings.background)
        calibration = with_background(calibration, findings.background.error)
    if options.bleaching == "correct" and findings.bleaching is not None:
        frames = np.arange(len(chain.pairs.pages[0]), dtype=float)
        chain = chain.without(findings.bleaching.log_ratio * frames)
    if options.ratio == "correct" and findings.scale is not None:
        calibration = with_patch(calibration, findings.scale)
    errors = None if options.errors == "report" else findings.errors
    if errors is not None and (
        options.errors == "correct" or not errors.exceeds_widths(calibration)
    ):
        calibration = with_errors(calibration, errors, corrected=True)
        # a course within the widths is among these errors
        return chain, calibration, replace(findings, course=None, taken_out=True)
    return chain, calibration, replace(findings, errors=None)


def describe_light(
    findings: LightFindings, results: Sequence[TriggerResult], run: Run, calibration: RunCurve
) -> tuple[dict[str, Any], list[Note]]:
    """Variables and notes about background, bleaching, reference patch and course."""
    options = run.settings.light
    parts = [
        describe_background(
            findings.background, calibration, corrected=options.background == "correct"
        ),
        describe_bleaching(
            findings.bleaching,
            findings.source,
            frames=len(run.pairs.usable),
            corrected=options.bleaching == "correct" or findings.scale is not None,
            followed=calibration.later is not None,
        ),
    ]
    patch, notes_on_patch = describe_reference(
        results, run.settings.reference, calibration, pairs=len(run.pairs.pages[0])
    )
    # a patch that sets the ratio agrees with its film
    parts.append((patch, describe_scale(findings.scale) or notes_on_patch))
    variables: dict[str, Any] = {}
    notes = describe_course(findings.course, calibration)
    taken_out = options.errors == "correct" or findings.taken_out
    notes += describe_gap(findings.errors, calibration, corrected=taken_out)
    notes += describe_texture(findings.texture, calibration)
    for more, also in parts:
        variables |= more
        notes += also
    return variables, notes
