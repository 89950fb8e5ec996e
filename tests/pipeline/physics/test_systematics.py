"""Errors that the frames of a run do not show: widths of the settings, and what a run measures."""

from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest
from scenes.film import run_settings
from scenes.fixture import with_systematics
from scenes.preparing import UNREAD
from scenes.results import make_statistics

from erlif.calibration import RunCurve
from erlif.core.terms import RISE
from erlif.io.settings import LightOptions
from erlif.pipeline.engines.results import FrameResult, TriggerResult
from erlif.pipeline.physics.dark import DarkLevel
from erlif.pipeline.physics.findings import LightFindings
from erlif.pipeline.physics.reference import PatchScale
from erlif.pipeline.physics.systematics import (
    add_systematics,
    follow_course,
    update_systematics,
    with_patch,
)
from erlif.show.plots import example_calibration
from erlif.trend import BackgroundEstimate, CourseChange, FittedNumbers, PinPosition, Trend

PLAIN = example_calibration()
CURVE = RunCurve.of(PLAIN)
REPORT, CORRECT = LightOptions(), LightOptions(background="correct", bleaching="correct")


EVEN = '[systematics]\nfield = "0 %"\nbatch = "0 %"\n'
"""No change over the field and one batch of dyes, whose parameters stand beside those of a test."""


def calibration_of(text="", plain=CURVE):
    """With the systematics of settings and an even field; no frame is sampled."""
    whole = text.replace("[systematics]\n", EVEN) if "[systematics]" in text else f"{text}\n{EVEN}"
    return add_systematics(plain, run_settings(whole), UNREAD, (), [])


def widths(calibration):
    return calibration.systematics.widths


def test_defaults_and_stated_widths_are_those_of_the_settings():
    found = widths(calibration_of('\n[systematics]\nratio = "0.2 %"\nwall = "0 %"\n'))
    assert found["ratio"] == 0.002
    assert found["wall"] == 0
    assert found["background"] == 0.015
    assert found["linearity"] == 0.01


def test_errors_of_the_fixture_stay_beside_those_of_the_run():
    fixture = with_systematics(PLAIN, position=0.056, size=0.004)
    found = widths(calibration_of(plain=fixture))
    assert (found["position"], found["size"]) == (0.056, 0.004)
    assert found["ratio"] == 0.01


def estimate(share=(0.02, 0.02), std=0.004):
    return BackgroundEstimate(
        share=np.array(share),
        covariance=std**2 * np.array([[1.0, 0.5], [0.5, 1.0]]),
        cross=np.zeros((12, 2)),  # K, p, q, and all systematics but the background
        chi_square=100.0,
        unit=(1000.0, 800.0),
        brightness=400.0,
        film=5.0,
        energy_std=np.nan,
    )


def update(calibration, background=None, bleaching=None, options=REPORT):
    """Of a run of 100 pulses."""
    findings = LightFindings(background=background, bleaching=bleaching)
    return update_systematics(calibration, findings, options, pulses=100)


def test_a_reported_background_leaves_its_second_moment_given_the_width():
    """A width of 1.5 % in both bands, of correlation 0.9, and an estimate of 2 ± 0.4 %."""
    before = calibration_of()
    after = update(before, estimate())
    prior = 0.015**2 * np.array([[1.0, 0.9], [0.9, 1.0]])
    scale = np.divide(before.systematics.light, (2.5, 2.0))
    prior *= np.outer(scale, scale)
    gain = prior @ np.linalg.inv(prior + estimate().covariance)
    mean = gain @ [0.02, 0.02]
    second = (np.eye(2) - gain) @ prior + np.outer(mean, mean)
    shares = [n for n, term in enumerate(after.systematics.terms) if term == "background"]
    found = after.systematics.covariance[np.ix_(shares, shares)]
    npt.assert_allclose(found, second / np.outer(scale, scale), rtol=1e-9)


def test_an_excluded_background_counts_where_the_run_shows_it():
    excluded = calibration_of('\n[systematics]\nbackground = "0 %"\n')
    shown = update(excluded, estimate())
    assert widths(shown)["background"] > 0
    weak = replace(estimate(), chi_square=5.0)
    assert widths(update(excluded, weak))["background"] == 0


@pytest.mark.parametrize(
    ("options", "text", "expected"),
    [
        # 1 ± 0.5 % over the run, of a width of 1 %: mean 0.8 %, and 0.45 % about it
        (REPORT, 'temperature = "0 %"', np.hypot(0.008, 0.01 * np.sqrt(0.2))),
        # the same with a temperature of 1 %, which has a half of the variance: mean 8/9 %
        (REPORT, 'temperature = "1 %"', np.hypot(0.08 / 9, 0.02**0.5 / 3 * 0.1) / np.sqrt(2)),
        (CORRECT, 'temperature = "0 %"', 0.005),
        (REPORT, 'bleaching = "0 %"\ntemperature = "0 %"', 0.0),
    ],
)
def test_bleaching_that_a_run_shows_takes_the_place_of_its_width(options, text, expected):
    trend = Trend(-1e-4, 5e-5, np.nan, np.nan)
    before = calibration_of(f"\n[systematics]\n{text}\n")
    found = update(before, bleaching=trend, options=options)
    npt.assert_allclose(widths(found)["bleaching"], expected, atol=1e-12)


@pytest.mark.parametrize("known", [False, True])
@pytest.mark.parametrize("options", [REPORT, CORRECT])
def test_a_wrong_dark_is_a_background_of_its_camera_unless_that_is_known(options, known):
    """30 ± 40 DN of 1000 DN, 5 %; a width of 1.5 %, or a background that contains the dark."""
    before, dark = calibration_of(), DarkLevel(2, 30.0, 40.0, 1000.0)
    background = estimate(share=(0.02, 0.3)) if known else None
    plain, found = (
        update_systematics(
            before, LightFindings(background=background, darks=darks), options, pulses=50
        ).systematics
        for darks in ((), (dark,))
    )
    camera_2 = plain.places("background")[1]
    growth = found.covariance - plain.covariance
    expected = 0.0 if known else 0.05**2 - 0.015**2
    npt.assert_allclose(growth[camera_2, camera_2], expected, atol=1e-12)
    growth[camera_2, camera_2] = 0.0
    npt.assert_array_equal(growth, 0.0)


STEP = CourseChange(frame=25, size=-0.03, std=0.04, significance=9.0)
"""Of 3 ± 4 %, root mean square 5 %."""


def follow(calibration, course):
    findings = LightFindings(course=course)
    return update_systematics(calibration, findings, REPORT, pulses=51, pairs=51)


@pytest.mark.parametrize(("stated", "own"), [("1 %", 0.01), ("0 %", 0.0)])
def test_step_of_the_ratio_counts_in_both_parts_and_drift_at_the_end(stated, own):
    rises = 'bleaching = "0 %"\ntemperature = "0 %"'
    before = calibration_of(f'\n[systematics]\nratio = "{stated}"\n{rises}\n')
    stepped, drifts = (follow(before, replace(STEP, frame=frame)) for frame in (25, None))

    def ratio_var(calibration, passed):
        """Variance by the term alone, from that of all terms with and without it."""
        none = follow(before, None)
        change = calibration.at(passed).log_ratio_std(3.0) ** 2
        return change - none.at(passed).log_ratio_std(3.0) ** 2 + own**2

    for passed in (0.0, 0.48, 0.5, 1.0):
        npt.assert_allclose(ratio_var(stepped, passed), own**2 + 0.05**2, rtol=1e-6)
        npt.assert_allclose(ratio_var(drifts, passed), own**2 + (0.05 * passed) ** 2, rtol=1e-6)
    assert widths(follow(before, replace(STEP, significance=3.0))) == widths(before)


def test_films_follow_the_course_by_the_share_of_their_frames_after_it():
    """Triggers of frames 0 to 3; that of frames 1 and 2 lies on both sides of a step at 2."""
    before = calibration_of()
    size = len(before.full_covariance)
    ratio = size - len(before.systematics.terms) + before.systematics.terms.index("ratio")
    results = [make_result(frames, size) for frames in ((0,), (1, 2), (3,), ())]
    stepped = follow_course(results, before, replace(STEP, frame=2), pairs=4)
    drifts = follow_course(results, before, replace(STEP, frame=None), pairs=4)
    for found, weights in ((stepped, (0.0, 0.5, 1.0, 0.0)), (drifts, (0.0, 0.5, 1.0, 0.0))):
        for result, weight in zip(found, weights, strict=True):
            gradient = result.statistics.mean.gradient
            npt.assert_allclose(gradient[:-1], np.arange(size))
            npt.assert_allclose(gradient[-1], weight * ratio)
            npt.assert_allclose(result.position.gradient[:, -1], weight * ratio)
    chance = replace(STEP, significance=3.0)
    assert follow_course(results, before, chance, pairs=4) == results


def make_result(frames, size):
    """A trigger whose film changes by n um with parameter n."""
    gradient = np.arange(size, dtype=float)
    statistics = make_statistics(random=0.1, gradient=gradient)
    numbers = [np.zeros(n) for n in (4, 2)]
    rows = [(value, np.eye(len(value)), np.eye(len(value))) for value in numbers]
    pin, form = ((*row, np.tile(gradient, (len(row[0]), 1))) for row in rows)
    position = PinPosition(*pin, form=FittedNumbers(*form))
    kept = tuple(FrameResult(frame, (0.0, 0.0), (0, 0)) for frame in frames)
    return TriggerResult(statistics, kept, (), position)


@pytest.mark.parametrize("scale", [0.5, 2.0])
def test_at_the_end_of_a_run_the_less_certain_of_two_fixtures_counts(scale):
    """Over the films of both: mean variance of a curve with twice, or half, the errors."""
    later = replace(PLAIN, covariance=scale**2 * PLAIN.covariance)
    excluded = "\n[systematics]\n" + "\n".join(
        f'{name} = "0 %"'
        for name in ("ratio", "lag", "temperature", "bleaching", "wall", "linearity", "background")
    )
    run = calibration_of(excluded, plain=RunCurve.of(PLAIN, later))
    films = np.linspace(*PLAIN.thickness_range, 50)
    mean = [np.mean(run.at(share).log_ratio_std(films) ** 2) for share in (0.0, 1.0)]
    alone = np.mean(PLAIN.log_ratio_std(films) ** 2)
    npt.assert_allclose(mean, [alone, max(scale, 1) ** 2 * alone], rtol=1e-9)


@pytest.mark.parametrize("std", [None, 0.004, 0.0005])
def test_films_of_the_patch_have_the_error_of_its_scale_whatever_else_a_run_shows(std):
    """0.1 % by the scatter of the frames, and 0.05 um of the patch through the slope; its ratio is
    beyond the widths.
    """
    before = calibration_of()
    scale = PatchScale(np.array([0.2, 0.0]), 0.001**2 * np.diag([1.0, 0.0]), 6.0, film_std=0.05)
    dark = DarkLevel(1, 20.0, 1.0, 1000.0)
    background = None
    if std is not None:  # K, p, q, and what neither the patch nor the background is
        background = replace(estimate(std=std), cross=np.zeros((12, 2)))
    findings = LightFindings(background=background, scale=scale, darks=(dark,))
    measuring = with_patch(before, scale)
    found = update_systematics(measuring, findings, LightOptions(ratio="correct"), pulses=50)
    expected = np.hypot(0.001, 0.05 * PLAIN.slope(6.0))
    for share in (0.0, 0.5, 1.0):
        npt.assert_allclose(found.at(share).log_ratio_std(6.0), expected, rtol=1e-6)


def test_ratios_beyond_those_of_all_films_put_their_scale_in_doubt():
    """By 5 % beside a width of 1 %."""
    found = add_systematics(CURVE, run_settings(f"\n{EVEN}"), UNREAD, (), [], misfit=0.05)
    npt.assert_allclose(widths(found)["ratio"], np.hypot(0.01, 0.05))


def test_a_drift_that_is_not_significant_takes_the_place_of_what_rises():
    """0.2 ± 0.3 % of a width of 0.5 %: mean 0.147 %, and 0.257 % about it."""
    before = calibration_of('\n[systematics]\nbleaching = "0.4 %"\ntemperature = "0.3 %"\n')
    chance = CourseChange(frame=3, size=0.004, std=0.002, significance=2.0, drift=(0.002, 0.003))
    found = update_systematics(before, LightFindings(course=chance), REPORT, pulses=50)
    gain = 0.25 / (0.25 + 0.09)
    rise = np.hypot(0.002 * gain, 0.005 * np.sqrt(1 - gain))
    std = np.sqrt(np.diag(found.systematics.covariance))
    for term, share in (("bleaching", 0.8), ("temperature", 0.6)):
        npt.assert_allclose(std[found.systematics.place(term, RISE)], share * rise)
    assert widths(found)["ratio"] == widths(before)["ratio"]
