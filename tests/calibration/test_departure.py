"""Departure from the reabsorption model: found where there is one, and only there."""

import re
from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest
from scenes.fixture import (
    WEDGE,
    assert_covers,
    autoregression,
    calibrate,
    calibrate_wedge,
    find_pulls,
    has_note,
    image,
    log_ratio,
    make_points,
    measure_points,
    wedge_profile,
)

from conftest import FULL
from erlif.calibration import Profile
from erlif.calibration.departure import (
    Correlation,
    Departure,
    choose_departure,
    find_correlation,
    fit_departure,
)
from erlif.calibration.pose import Freedom
from erlif.calibration.regression import fit_robustly
from erlif.rig import dyes

BACKGROUND = 0.01
"""Light that no dye absorbs, added to camera 2: the ratio departs from the model by up to 0.3 %."""
GRID = np.linspace(0.3, 12, 300)


def through_broad_filters(thickness, width):
    """Logarithm of the ratio of the rig's invented dyes by quadrature over the wavelength.

    The filters are Gaussian, of full width at half maximum `width`. [nm]
    """
    light = []
    for band in dyes.BANDS:
        wavelength = np.arange(band - 60, band + 60.1, 0.1)
        weight = dyes.emission(wavelength) * np.exp(
            -4 * np.log(2) * ((wavelength - band) / width) ** 2
        )
        depth = np.multiply.outer(
            thickness, dyes.absorption(np.asarray(dyes.LASER)) + dyes.absorption(wavelength)
        )
        light.append(thickness * ((-np.expm1(-depth) / depth) @ weight))
    return np.log(light[1] / light[0])


@pytest.fixture(scope="module")
def departing():
    return calibrate_wedge(np.random.default_rng(1), noise=0.001, background=BACKGROUND)


def largest_error(calibration, true):
    """Largest error of the ratio from 0.3 to 12 um. [%]"""
    return 100 * np.abs(calibration.predict_log(GRID) - true).max()


def model_alone(calibration):
    return replace(calibration, departure=None)


def test_background_light_is_followed_to_a_twentieth_of_a_per_cent(departing):
    true = log_ratio(GRID, background=BACKGROUND)
    assert departing.departure is not None
    assert largest_error(model_alone(departing), true) > 0.2
    assert largest_error(departing, true) < 0.05
    assert has_note(departing, "departs from the reabsorption model by")


@pytest.mark.parametrize("width", [30, 50])
def test_broad_filters_are_followed_to_a_twentieth_of_a_per_cent(width):
    rng = np.random.default_rng(2)
    ratios = image(rng, through_broad_filters(WEDGE, width))
    calibration = calibrate(ratios, wedge_profile(rng, noise=0.001))
    true = through_broad_filters(GRID, width)
    assert largest_error(model_alone(calibration), true) > 0.05
    assert largest_error(calibration, true) < 0.05


def test_filters_of_the_rig_need_no_departure():
    """They are 10 nm wide; once K, p and q are fitted, the ratio departs by less than 0.05 %."""
    rng = np.random.default_rng(3)
    one, two = (dyes.tabulate_signal(band) for band in dyes.BANDS)
    calibration = calibrate(
        image(rng, np.log(two(WEDGE) / one(WEDGE))), wedge_profile(rng, noise=0.001)
    )
    assert calibration.departure is None
    assert largest_error(calibration, np.log(two(GRID) / one(GRID))) < 0.05


def test_note_names_the_place_of_the_largest_departure():
    """A ratio that is 1.5 % higher about 6 um; the spline is noisiest at the thin end."""
    rng = np.random.default_rng(14)
    higher = log_ratio(WEDGE) + 0.015 * np.exp(-(((WEDGE - 6) / 1.5) ** 2))
    calibration = calibrate(image(rng, higher), wedge_profile(rng, noise=0.02))
    text = next(note.text for note in calibration.notes if "departs from the" in note.text)
    stated, film = map(float, re.search(r"by ([+-][\d.]+) .* % at ([\d.]+) um", text).groups())
    assert stated > 0
    assert abs(film - 6) < 0.75


def test_smaller_departure_is_reported_but_not_used():
    """Background light at which the criterion prefers the model, although the residuals show it."""
    rng = np.random.default_rng(6)
    found = (calibrate_wedge(rng, noise=0.15, background=0.003) for _ in range(15))
    assert any(  # ends at the first
        calibration.departure is None and has_note(calibration, "residuals have structure")
        for calibration in found
    )


@pytest.mark.slow
def test_range_ends_at_the_maximum_of_a_ratio_that_falls_and_films_cover():
    """The true ratio departs from the model by a wave of 1 %, and falls from 17.06 um on."""
    rng, pulls = np.random.default_rng(7), []

    def true(film):
        return log_ratio(film) + 0.01 * np.sin(film / 2)

    count = 30 if FULL else 6
    for _ in range(count):
        found = calibrate_wedge(rng, noise=0.1, true=true)
        low, high = found.thickness_range
        assert 14 < high < 17.1
        assert np.all(found.slope(np.linspace(low, high, 500)) > 0)
        pulls.append(find_pulls(found, np.linspace(1.0, 0.97 * high, 5), true))

    # five films of a fixture share their error: they count as three
    assert_covers(np.ravel(pulls), count=3 * count)


def test_correlated_errors_of_the_profile_are_reported_and_widen_the_error_bars():
    rng = np.random.default_rng(8)
    straight = wedge_profile(rng, noise=0.1)
    wavy = Profile(
        straight.position,
        straight.thickness + 0.15 * np.sin(4.2 * straight.position),
        straight.uncertainty,
    )
    ratios = image(rng, log_ratio(WEDGE))
    before, after = (calibrate(ratios, profile) for profile in (straight, wavy))
    assert has_note(after, "errors of neighbouring points along the profile are correlated")
    scatter = np.sqrt(after.reduced_chi_square)
    assert np.all(after.standard_deviations > 1.15 * scatter * before.standard_deviations)


def test_displacement_is_found_with_the_spline():
    """Films misplaced by 0.2 um in every second point; the spline starts without a displacement.

    The ratio includes background light, so the model alone does not follow it.
    """
    rng = np.random.default_rng(10)
    film = np.linspace(0.2, 15, 160)
    half = np.where(np.arange(film.size) % 2, 1.0, -1.0)[:, None]
    points = make_points(
        film,
        thickness=film - 0.2 * half[:, 0] + rng.normal(0, 0.01, film.size),
        thickness_std=np.full(film.size, 0.01),
        log_ratio=log_ratio(film, background=BACKGROUND) + rng.normal(0, 1e-4, film.size),
        gradient=half,
    )
    freedom = Freedom(half, np.eye(4)[:, :1], np.zeros(2), np.array([1.0, 0, 0, 0]))
    fit = fit_robustly(points, freedom)
    found = fit_departure(points, replace(fit, displacement=np.zeros(1)), freedom)
    assert abs(found.displacement[0] - 0.2) < 4 * 0.01 / np.sqrt(film.size)
    npt.assert_allclose(found.true_thickness, film, atol=5 * 0.01)


def test_noise_about_a_spline_is_one_where_the_errors_are_as_stated():
    """Mean over 60 wedges of 60 points: chi-square over points less K, p, q and the spline.

    Films are known to 0.001 um, logarithms of the ratio to 0.001.

    The scatter of a reduced chi-square is sqrt(2/n). Without the freedom of the spline the mean
    would be 0.95.
    """
    rng = np.random.default_rng(15)
    film = np.linspace(0.5, 15, 60)
    noises = []
    for _ in range(60):
        points = measure_points(rng, film, film_std=1e-3, ratio_std=1e-3)
        freedom = Freedom.none(points)
        spline = fit_departure(points, fit_robustly(points, freedom), freedom, test_knots=2)
        noises.append(spline.noise(film.size, 3))
    assert abs(np.mean(noises) - 1) < 2 * np.sqrt(2 / 54 / 60)


@pytest.mark.parametrize(("count", "pieces"), [(39, None), (40, 11), (140, 36), (400, 48)])
def test_pieces_of_a_spline_are_as_many_as_the_points_allow(count, pieces):
    """A step of 2 % in the ratio at 7 um; four points for each piece, and 48 at most."""
    film = np.linspace(0.5, 15, count)
    points = make_points(
        film,
        thickness_std=np.full(count, 1e-3),
        log_ratio=log_ratio(film) - 0.01 * np.tanh(film - 7),
    )
    freedom = Freedom.none(points)

    choice = choose_departure(points, fit_robustly(points, freedom), freedom)
    found = choice and choice.candidate and choice.candidate.pieces
    assert found == pieces


BELLS = [
    *((0.03, 5.0, 1.0, noise) for noise in (0.02, 0.1)),
    *((0.02, 10.0, 2.0, noise) for noise in (0.1, 0.02)),
    *((-0.02, 3.0, 1.0, noise) for noise in (0.02, 0.1)),
]
"""Height [1], place and width of a bell in the ratio, and noise of the CMM. [um]"""


@pytest.mark.slow
@pytest.mark.parametrize(("height", "middle", "width", "noise"), BELLS if FULL else BELLS[::2])
def test_films_cover_whatever_smooth_form_the_ratio_has(height, middle, width, noise):
    """A bell of 2 or 3 % in the ratio, which no reabsorption explains."""
    rng, pulls = np.random.default_rng(16), []

    def true(film):
        return log_ratio(film) + height * np.exp(-(((film - middle) / width) ** 2) / 2)

    count = 50 if FULL else 6
    for _ in range(count):
        found = calibrate_wedge(rng, noise=noise, true=true)
        assert found.departure is not None
        low, high = found.thickness_range
        pulls.append(find_pulls(found, np.linspace(max(low, 1.0), 0.95 * high, 5), true))

    # five films of a fixture share their error: they count as three
    assert_covers(np.ravel(pulls), count=3 * count)


# the spline


def test_spline_reproduces_a_cubic_and_is_constant_beyond_its_ends():
    """The B-splines span all cubics; outside the knots the value of the end continues."""
    knots = np.array([1.0] * 4 + [3.0, 5.0] + [9.0] * 4)
    film = np.linspace(1, 9, 100)
    blank = Departure(knots, np.zeros(6), np.eye(6))
    cubic = np.polynomial.Polynomial([0.2, -0.1, 0.03, -0.002])
    coefficients = np.linalg.lstsq(blank.basis(film).T, cubic(film), rcond=None)[0]
    spline = replace(blank, coefficients=coefficients)
    npt.assert_allclose(spline.predict(film), cubic(film), atol=1e-12)
    npt.assert_allclose(spline.slope(film), cubic.deriv()(film), atol=1e-11)
    npt.assert_allclose(spline.predict([0.0, 20.0]), cubic(np.array([1.0, 9.0])), atol=1e-12)
    npt.assert_array_equal(spline.slope([0.0, 20.0]), 0)
    npt.assert_allclose(spline.basis(film).sum(axis=0), 1, rtol=1e-12)


# correlation of neighbours


def test_correlation_of_an_autoregression_is_found_in_any_order():
    """Bartlett (1946): its estimate scatters by sqrt((1 - r^2)/n)."""
    rng = np.random.default_rng(11)
    residual = autoregression(rng, 0.6, 2000)
    order = rng.permutation(2000)
    found = find_correlation(order[:, None].astype(float), residual[order])
    assert abs(found.coefficient - 0.6) < 4 * np.sqrt((1 - 0.36) / 2000)
    npt.assert_allclose(found.significance, found.coefficient * np.sqrt(2000), rtol=1e-12)


def test_inflation_is_the_variance_of_a_mean_of_correlated_values():
    """Means of 400 values over 200 series, r = 0.5: three times that of independent ones."""
    rng = np.random.default_rng(12)
    means = [autoregression(rng, 0.5, 400).mean() for _ in range(200)]
    expected = Correlation(0.5, 10.0).inflation / 400
    npt.assert_allclose(np.var(means), expected, rtol=4 * np.sqrt(2 / 200))
    assert Correlation(0.99, 10.0).inflation == pytest.approx(1.99 / 0.1)


def test_independent_residuals_are_rarely_significant():
    rng = np.random.default_rng(13)
    place = np.arange(100.0)[:, None]
    found = [find_correlation(place, rng.normal(size=100)).significance for _ in range(200)]
    assert abs(np.mean(found)) < 4 / np.sqrt(200) + 0.1  # removing the mean costs 1/sqrt(n)
    assert np.std(found) == pytest.approx(1, rel=0.2)


def test_surfaces_few_points_and_constants_have_no_correlation():
    wave = np.sin(np.arange(100) / 10)
    place = np.arange(100.0)[:, None]
    assert find_correlation(place, wave).significance > 5
    none = Correlation(0.0, 0.0)
    assert find_correlation(np.ones((100, 2)), wave) == none
    assert find_correlation(place[:19], wave[:19]) == none
    assert find_correlation(place, np.ones(100)) == none
