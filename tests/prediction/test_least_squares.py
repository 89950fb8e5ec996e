"""Least squares against the normal equations of a line, with and without shared errors.

The search ends within a hundredth of a standard deviation of the minimum.
"""

from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest

from erlif.core.errors import ModelError
from erlif.prediction.least_squares import LeastSquares, Observations, Unknowns, interval

PLACE = np.linspace(0.0, 1.0, 12)
DESIGN = np.stack([np.ones(12), PLACE], axis=1)


def unknowns(low=-np.inf, expected_std=(np.inf, np.inf)):
    both = np.ones(2)
    return Unknowns(
        names=("height", "slope"),
        start=np.array([0.3, 0.1]),
        step=1e-3 * both,
        low=low * both,
        high=np.inf * both,
        expected=0 * both,
        expected_std=np.array(expected_std),
    )


def line(sets):
    return (sets @ DESIGN.T)[..., np.newaxis]


def observe(values, std=0.1, shared=None):
    columns = np.zeros((12, 1, 0)) if shared is None else shared[:, np.newaxis, np.newaxis]
    return Observations(values[:, np.newaxis], np.full((12, 1, 1), std**2), columns)


def test_line_has_value_and_covariance_of_the_normal_equations():
    values = np.random.default_rng(1).normal(2 + 3 * PLACE, 0.1)
    found = LeastSquares(observe(values), unknowns(), line).solve()
    npt.assert_allclose(found.value, np.linalg.lstsq(DESIGN, values)[0], atol=1e-3)
    if found.inflation == 1:
        npt.assert_allclose(found.covariance, 0.01 * np.linalg.inv(DESIGN.T @ DESIGN), rtol=1e-6)


def test_error_that_all_share_stays_in_the_error_of_the_mean():
    """It adds its whole variance to that of the height, however many values there are."""
    values = 2 + 3 * PLACE
    found = LeastSquares(observe(values, shared=np.full(12, 0.5)), unknowns(), line).solve()
    expected = 0.01 * np.linalg.inv(DESIGN.T @ DESIGN) + np.diag([0.25, 0.0])
    npt.assert_allclose(found.covariance, expected, rtol=1e-6)


def test_likelihood_is_that_of_the_whole_covariance():
    values = np.random.default_rng(3).normal(2 + 3 * PLACE, 0.1)
    shared = np.linspace(0.1, 0.6, 12)
    found = LeastSquares(observe(values, shared=shared), unknowns(), line).solve()
    whole = 0.01 * found.inflation**2 * np.eye(12) + np.outer(shared, shared)
    miss = values - DESIGN @ found.value
    expected = -0.5 * (
        miss @ np.linalg.solve(whole, miss) + np.linalg.slogdet(whole)[1] + 12 * np.log(2 * np.pi)
    )
    npt.assert_allclose(found.log_likelihood, expected, rtol=1e-9)


def test_profile_of_a_linear_model_is_its_parabola():
    least = LeastSquares(observe(2 + 3 * PLACE, shared=np.full(12, 0.3)), unknowns(), line)
    found = least.solve()
    for k in (0, 1):
        ((value, rise),) = least.profiles(found, [k])
        expected = (value - found.value[k]) ** 2 / found.covariance[k, k]
        npt.assert_allclose(rise, expected, atol=0.02)


def test_profile_of_a_curved_model_refits_the_others():
    """Height and slope enter as exp and product: the rise is that of the linear parameters."""

    def curved(sets):
        height, slope = np.exp(sets[:, :1]), sets[:, :1] + sets[:, 1:]
        return (height + slope * PLACE)[..., np.newaxis]

    least = LeastSquares(observe(2 + 3 * PLACE), unknowns(), curved)
    found = least.solve()
    npt.assert_allclose(found.value, [np.log(2), 3 - np.log(2)], atol=1e-3)
    ((value, rise),) = least.profiles(found, [0])
    variance = 0.01 * np.linalg.inv(DESIGN.T @ DESIGN)[0, 0]
    npt.assert_allclose(rise, (np.exp(value) - 2) ** 2 / variance, atol=0.02)


def test_misfit_widens_the_errors():
    values = 2 + 3 * PLACE + 0.4 * (-1.0) ** np.arange(12)
    found = LeastSquares(observe(values), unknowns(), line).solve()
    left = values - DESIGN @ np.linalg.lstsq(DESIGN, values)[0]
    npt.assert_allclose(found.inflation, np.sqrt(left @ left / 10) / 0.1, rtol=5e-3)


def test_an_unknown_that_is_left_out_is_fixed_where_it_is_expected():
    kept = replace(unknowns(), expected=np.array([0.0, 0.7])).without("slope", np.array([2.0, 5.0]))
    assert kept.names == ("height",)
    assert kept.one_by_name(kept.start) == {"height": 2.0, "slope": 0.7}
    assert kept.step.size == kept.low.size == kept.high.size == kept.expected_std.size == 1


def test_unknown_stays_within_its_bounds():
    found = LeastSquares(observe(-2 + 3 * PLACE), unknowns(low=0.0), line).solve()
    slope = PLACE @ (-2 + 3 * PLACE) / (PLACE @ PLACE)
    npt.assert_allclose(found.value, [0.0, slope], atol=5e-3)  # a misfit widens the tolerance


def test_model_without_values_is_refused():
    with pytest.raises(ModelError, match="no film at the start"):
        LeastSquares(observe(PLACE), unknowns(), lambda sets: np.nan * line(sets)).solve()


def test_interval_without_an_end_is_open():
    value = np.array([0.0, 0.0, 1.0, 2.0, 3.0])
    low, high = interval(value, np.array([0.5, 0.5, 0.0, 2.0, 8.0]), 3.841)
    assert low == -np.inf
    assert 2.0 < high < 3.0


def test_end_just_beyond_the_last_point_of_a_profile_follows_from_a_parabola():
    place = np.array([-2.1, 0.0, 2.1])
    low, high = interval(place, 0.8 * place**2, 3.841)
    npt.assert_allclose([low, high], np.sqrt(3.841 / 0.8) * np.array([-1, 1]), rtol=1e-12)
