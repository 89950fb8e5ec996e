"""Numbers of a film: errors that add up, and those that compensate."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif.trend.number import FilmNumber

COVARIANCE = np.diag([4.0, 1.0])
ONE = FilmNumber(3.0, 0.3, 0.4, np.array([0.5, 0.0]))


def test_parts_of_the_error_add_up_in_squares():
    assert ONE.std(COVARIANCE) == pytest.approx(np.sqrt(0.3**2 + 0.4**2 + 1.0))


def test_a_multiple_and_a_sum_have_all_errors_of_their_parts():
    twice, sum_of_both = ONE.scaled(2.0), ONE.plus(ONE)
    for both in (twice, sum_of_both):
        npt.assert_allclose([both.value, both.random_std, both.surface_std], [6.0, 0.6, 0.8])
        npt.assert_allclose(both.std(COVARIANCE), 2 * ONE.std(COVARIANCE))


def test_errors_of_opposite_gradients_compensate():
    other = FilmNumber(1.0, 0.0, 0.0, -ONE.gradient)
    assert ONE.plus(other).std(COVARIANCE) == pytest.approx(0.5)


def test_a_film_that_has_no_number_has_no_error_either():
    assert np.isnan(FilmNumber.unknown(2).std(COVARIANCE))
