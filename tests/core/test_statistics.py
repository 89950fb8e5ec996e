"""Robust standard deviations, against the normal distribution."""

import numpy as np
import numpy.testing as npt
import pytest
from scipy.stats import norm

from erlif.core.statistics import MAD_TO_STD, neighbours_of, robust_rms, robust_std


def test_factor_is_that_of_the_normal_distribution():
    npt.assert_allclose(MAD_TO_STD, 1 / norm.ppf(0.75), rtol=2e-5)


@pytest.mark.parametrize(("statistic", "mean"), [(robust_std, 40.0), (robust_rms, 0.0)])
def test_normal_values_have_their_standard_deviation(statistic, mean):
    """Quantiles of the distribution in place of draws."""
    values = norm.ppf((np.arange(20_001) + 0.5) / 20_001, mean, 3.0)
    npt.assert_allclose(statistic(values), 3.0, rtol=1e-3)


@pytest.mark.parametrize("statistic", [robust_std, robust_rms])
def test_a_tenth_of_outliers_hardly_changes_it(statistic):
    """The median moves to the quantile 0.5/0.9 of the others: 13 % more at most."""
    values = norm.ppf((np.arange(9_000) + 0.5) / 9_000)
    outliers = np.where(np.arange(1_000) % 2, 1e6, -1e6)
    expected = norm.ppf(0.5 + 0.25 / 0.9) * MAD_TO_STD
    npt.assert_allclose(statistic(np.concatenate([values, outliers])), expected, rtol=2e-3)


def test_an_offset_counts_in_the_rms_alone():
    values = np.array([9.0, 10.0, 11.0])
    npt.assert_allclose(robust_std(values), MAD_TO_STD)
    npt.assert_allclose(robust_rms(values), 10 * MAD_TO_STD)


def test_a_series_is_mirrored_at_its_ends():
    npt.assert_array_equal(neighbours_of(np.array([4.0, 1.0, 2.0]), 2)[0], [2, 1, 1, 2])
