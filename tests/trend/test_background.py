"""The background of a run, from light of simulated cells."""

from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest
from scenes.cells import CALIBRATION, P, X, Y, draw_run
from scenes.fixture import with_systematics

from conftest import FULL
from erlif.calibration.departure import Departure
from erlif.ratio import LightCells
from erlif.trend import estimate_background


@pytest.mark.parametrize("logged", [True, False])
def test_errors_of_the_shares_follow_their_covariance(logged):
    rng, background = np.random.default_rng(7), (0.02, 0.03)
    chi_squares, pulls = [], []
    for _ in range(25):
        record, energies = draw_run(rng, background=background)
        found = estimate_background(
            record, (X, Y), CALIBRATION, energies=energies if logged else None
        )
        # the unit is the median of all light; the background is a share of that of the film
        share = np.array(background) / (1 + np.array(background))
        error = found.share - share
        chi_squares.append(error @ np.linalg.solve(found.covariance, error))
        pulls.append(error / found.std)
    # chi-square of two numbers: 39 % lie below 1, 68 % below 2.30 and 95 % below 6.18
    shares = [np.mean(np.array(chi_squares) < limit) for limit in (2.30, 6.18)]
    assert 0.68 - 3.5 * 0.093 < shares[0] < 0.68 + 3.2 * 0.093
    assert shares[1] > 0.95 - 3.5 * 0.042
    npt.assert_allclose(np.mean(pulls, axis=0), 0, atol=3.5 / np.sqrt(25))


def test_no_false_alarm_and_no_miss():
    """A share of twice the stated detectable one is found, and none where there is none."""
    rng = np.random.default_rng(8)
    for _ in range(10):
        record, energies = draw_run(rng)
        clean = estimate_background(record, (X, Y), CALIBRATION, energies=energies)
        assert clean.determined
        assert not clean.significant
        share = 2 * clean.detectable
        record, energies = draw_run(rng, background=(share, share))
        assert estimate_background(record, (X, Y), CALIBRATION, energies=energies).significant


def test_singular_covariance_of_a_spline_gives_the_same_background():
    """A covariance of rank 2 for four functions, exactly and with 1e-7 of noise in each. [1]"""
    record, logged = draw_run(np.random.default_rng(4), background=(0.02, 0.02))
    knots = np.array([0.3] * 4 + [16.0] * 4)
    causes = 1e-3 * np.array([[1.0, 0.0], [2.0, 1.0], [-1.0, 3.0], [0.5, -1.0]])
    found = []
    for noise in (0.0, 1e-7):
        covariance = causes @ causes.T + noise**2 * np.eye(4)
        departure = Departure(knots, np.zeros(4), covariance)
        calibration = replace(CALIBRATION, departure=departure)
        found.append(estimate_background(record, (X, Y), calibration, energies=logged))
    npt.assert_allclose(found[0].share, found[1].share, rtol=1e-4)
    npt.assert_allclose(found[0].covariance, found[1].covariance, rtol=1e-4)


def test_cameras_that_lose_light_are_not_taken_for_a_background():
    """Both cameras lose 2 % of full scale, or gain it; the median light is 40 % of it."""
    pulls, count = [], 60 if FULL else 30
    for seed in range(count):
        rng = np.random.default_rng(seed)
        record, logged = draw_run(rng)
        lights = [np.exp(record.light), np.exp(record.light + record.log_ratio)]
        unit = [float(np.median(light)) for light in lights]
        one, two = (
            light * (1 - 0.02 * rng.standard_normal() * 0.4 * light / median)
            for light, median in zip(lights, unit, strict=True)
        )
        record = record._replace(light=np.log(one), log_ratio=np.log(two / one))

        film = np.median(CALIBRATION.inverse.look_up(record.log_ratio))
        of_film = float(CALIBRATION.model.light(film).signal)
        light = of_film, of_film * float(CALIBRATION.predict(film))
        calibration = with_systematics(CALIBRATION, light=light, linearity=0.02)
        found = estimate_background(record, (X, Y), calibration, energies=logged)
        assert not found.significant
        pulls.append(found.share / found.std)
    # three standard deviations of a scatter
    assert np.std(pulls, axis=0) == pytest.approx(1.0, abs=3 / np.sqrt(2 * count))


def test_shift_of_the_film_is_that_of_the_ratio_with_the_background():
    record, energies = draw_run(np.random.default_rng(9), background=(0.03, 0.03))
    found = estimate_background(record, (X, Y), CALIBRATION, energies=energies)
    film = np.array([3.0, 4.0])
    one = found.brightness * (1 - np.exp(-P * film)) / P
    two = one * CALIBRATION.predict(film)
    extra = found.share * np.array(found.unit)
    disturbed = np.log((two + extra[1]) / (one + extra[0]))
    grid = np.linspace(0.5, 9, 20001)
    measured = np.interp(disturbed, CALIBRATION.predict_log(grid), grid)
    npt.assert_allclose(found.film_shift(film, CALIBRATION), measured - film, rtol=0.1)


@pytest.mark.parametrize("meter", [0.002, 0.005])
def test_energies_of_the_log_are_used_with_the_accuracy_that_they_show(meter):
    record, energies = draw_run(np.random.default_rng(10), meter=meter, frames=200)
    found = estimate_background(record, (X, Y), CALIBRATION, energies=energies)
    assert found.energy_std == pytest.approx(meter, rel=0.2)


def test_a_pulse_that_the_meter_missed_costs_its_frame_alone():
    """The energies of the other frames stay known; without any, the scatter of the log is NaN."""
    record, energies = draw_run(np.random.default_rng(10), frames=60)
    kept = np.arange(60) != 7
    fewer = LightCells(*(part[kept] for part in record))
    expected = estimate_background(fewer, (X, Y), CALIBRATION, energies=energies[kept])

    found = estimate_background(record, (X, Y), CALIBRATION, energies=np.where(kept, energies, 0.0))
    npt.assert_allclose(found.share, expected.share, rtol=1e-12)
    npt.assert_allclose(found.std, expected.std, rtol=1e-12)
    assert np.isfinite(found.energy_std)

    few = np.where(np.arange(60) < 20, energies, 0.0)
    found = estimate_background(record, (X, Y), CALIBRATION, energies=few)
    without = estimate_background(record, (X, Y), CALIBRATION)
    npt.assert_array_equal(found.share, without.share)
    assert np.isnan(found.energy_std)


def test_one_film_all_over_the_image_needs_the_energies_of_the_log():
    """Without differences of film or light within a frame, film and energy are not separable."""
    background = (0.03, 0.03)
    record, energies = draw_run(
        np.random.default_rng(12), flat=True, background=background, frames=200, meter=0.002
    )
    without = estimate_background(record, (X, Y), CALIBRATION)
    assert without is None or not without.determined
    found = estimate_background(record, (X, Y), CALIBRATION, energies=energies)
    assert found.determined
    error = found.share - 0.03 / 1.03
    assert error @ np.linalg.solve(found.covariance, error) < 11.8


def test_runs_that_determine_nothing():
    """A film that never changes, a short run, no cells, and films that are too thick."""
    record, energies = draw_run(np.random.default_rng(12), flat=True, films=(4.0, 4.02))
    found = estimate_background(record, (X, Y), CALIBRATION, energies=energies)
    assert found is None or not found.determined
    record, _ = draw_run(np.random.default_rng(13), frames=8)
    assert estimate_background(record, (X, Y), CALIBRATION) is None
    empty = LightCells(*np.full((4, 50, X.size), np.nan))
    assert estimate_background(empty, (X, Y), CALIBRATION) is None
    thick, _ = draw_run(np.random.default_rng(14), films=(30.0, 40.0))
    assert estimate_background(thick, (X, Y), CALIBRATION) is None
