"""Errors that the frames of a run do not show: widths of the settings, and what a run measures."""

import tomllib
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import numpy.testing as npt
import pytest
from scenes.film import RUN_TOML
from scenes.fixture import with_systematics

from erlif.io.settings import LightOptions, RunSettings
from erlif.pipeline.physics.systematics import (
    add_systematics,
    update_systematics,
)
from erlif.show.plots import example_calibration
from erlif.trend import BackgroundEstimate, Change, Trend

PLAIN = example_calibration()
REPORT, CORRECT = LightOptions(), LightOptions(background="correct", bleaching="correct")


def settings_with(text=""):
    return RunSettings.model_validate(tomllib.loads(RUN_TOML + text))


def calibration_of(text="", plain=PLAIN):
    """With the systematics of settings; no frame is sampled."""
    return add_systematics(plain, settings_with(text), SimpleNamespace(), ())


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
    return update_systematics(calibration, background, bleaching, options, pulses=100)


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
        (REPORT, "", np.hypot(0.008, 0.01 * np.sqrt(0.2))),
        (CORRECT, "", 0.005),
        (REPORT, '\n[systematics]\nbleaching = "0 %"\n', 0.0),
    ],
)
def test_bleaching_that_a_run_shows_takes_the_place_of_its_width(options, text, expected):
    trend = Trend(-1e-4, 5e-5, np.nan, np.nan)
    found = update(calibration_of(text), bleaching=trend, options=options)
    npt.assert_allclose(widths(found)["bleaching"], expected, atol=1e-12)


@pytest.mark.parametrize(("stated", "width"), [("1 %", 0.0510), ("0 %", 0.0500)])
def test_change_of_the_ratio_is_added_to_its_width_where_it_is_significant(stated, width):
    """Roots of 0.03^2 + 0.04^2 and 0.01^2 + 0.03^2 + 0.04^2."""
    before = calibration_of(f'\n[systematics]\nratio = "{stated}"\n')
    step = Change(frame=25, size=-0.03, std=0.04, significance=9.0)
    found = update_systematics(before, None, None, REPORT, pulses=50, course=step)
    assert widths(found)["ratio"] == pytest.approx(width, abs=1e-4)
    chance = replace(step, significance=3.0)
    kept = update_systematics(before, None, None, REPORT, pulses=50, course=chance)
    assert widths(kept) == widths(before)


@pytest.mark.parametrize("scale", [0.5, 2.0])
def test_at_the_end_of_a_run_the_less_certain_of_two_fixtures_counts(scale):
    """Over the films of both: mean variance of a curve with twice, or half, the errors."""
    later = replace(PLAIN, covariance=scale**2 * PLAIN.covariance)
    excluded = "\n[systematics]\n" + "\n".join(
        f'{name} = "0 %"'
        for name in ("ratio", "lag", "temperature", "bleaching", "wall", "linearity", "background")
    )
    run = calibration_of(excluded, plain=PLAIN.until(later))
    films = np.linspace(*PLAIN.thickness_range, 50)
    mean = [np.mean(run.at(share).log_ratio_std(films) ** 2) for share in (0.0, 1.0)]
    alone = np.mean(PLAIN.log_ratio_std(films) ** 2)
    npt.assert_allclose(mean, [alone, max(scale, 1) ** 2 * alone], rtol=1e-9)
