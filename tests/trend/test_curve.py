"""The calibration in tables, against the formula written out and root finding."""

import numpy as np
import numpy.testing as npt
import pytest
from scenes.fixture import find_films, with_systematics
from scenes.gap import RANGE, P, Q, known_calibration, true_log_ratio

from erlif.trend.curve import FilmCurve


@pytest.fixture(scope="module")
def curve():
    return FilmCurve.of(known_calibration())


def test_log_ratio_and_slope_are_those_of_the_formula(curve):
    film = np.linspace(0.05, 23.9, 777)
    log_ratio, slope = curve.predict(film)
    npt.assert_allclose(log_ratio, true_log_ratio(film), atol=2e-8)
    expected = Q / np.expm1(Q * film) - P / np.expm1(P * film)
    npt.assert_allclose(slope, expected, rtol=1e-6)


def test_films_beyond_the_table_are_taken_for_its_ends(curve):
    ends = curve.films[[0, -1]]
    npt.assert_array_equal(curve.predict(np.add(ends, [-3.0, 9.0])), curve.predict(ends))
    npt.assert_allclose(ends, [RANGE[0] - 0.5, 1.5 * RANGE[1]])


def test_film_of_a_bin_is_that_of_the_log_ratio_in_its_middle(curve):
    log_ratio = true_log_ratio(np.array([0.3, 2.0, 7.0, 15.5]))
    place, distance = curve.find_bins(log_ratio)
    expected = find_films(known_calibration(), log_ratio - distance)
    npt.assert_allclose(curve.film[place], expected, atol=1e-5)
    assert np.abs(distance).max() < 0.5 * np.ptp(curve.bins) / 4000 * (1 + 1e-9)


def test_expansion_about_a_bin_gives_the_films_near_it(curve):
    """Terms up to the second order, over fifty bins."""
    calibration = known_calibration()
    middle = true_log_ratio(np.array([1.0, 4.0, 9.0]))
    place, distance = curve.find_bins(middle)
    step = 50 * np.ptp(curve.bins) / 4000
    off = step + distance
    found = curve.film[place] + curve.rate[place] * off + curve.curvature[place] * off**2 / 2
    exact = find_films(calibration, middle + step)
    # the third order: the rate itself changes over this step by some per cent
    npt.assert_allclose(found - curve.film[place], exact - curve.film[place], rtol=5e-3)


def test_log_ratios_beyond_the_calibrated_range_belong_to_the_outer_bins(curve):
    place, distance = curve.find_bins(np.add(curve.bins, [-0.01, 0.01]))
    npt.assert_array_equal(place, [0, 3999])
    npt.assert_allclose(np.abs(distance), 0.01 + 0.5 * np.ptp(curve.bins) / 4000)


def test_curve_within_a_run_has_the_errors_that_have_grown_by_then():
    run = with_systematics(known_calibration(), ratio=0.01, bleaching=0.02)
    found = FilmCurve.of(run.at(1.0)).at(0.25)
    # the ratio is wrong from the first frame on, both parameters of the bleaching grow from nothing
    grown = np.array([1, 0.25, 0.25]) * run.gradient(5.0)[3:]
    npt.assert_allclose(found.calibration.gradient(5.0)[3:], grown)


def test_films_are_looked_up_as_numpy_interpolates(curve):
    """At the entries of the table, beside them and beyond its ends, to the last bit."""
    inside = np.random.default_rng(1).uniform(-1, 40, 5000)
    beside = [np.nextafter(curve.films, end) for end in (-np.inf, np.inf)]
    film = np.concatenate([inside, curve.films, *beside, [np.nan, np.inf, -np.inf]])
    log_ratio, slope = curve.predict(film)
    npt.assert_array_equal(log_ratio, np.interp(film, curve.films, curve.log_ratio))
    npt.assert_array_equal(slope, np.interp(film, curve.films, curve.slope))
