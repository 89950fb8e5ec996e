"""Correlated noise of friction."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif.joint.endurance.noise import (
    UNKNOWN,
    Noise,
    NoiseSpread,
    combine_spreads,
    fit_noise,
    pool_spreads,
    restricted_likelihood,
    whiten,
)


def recursion(kept, size, rng):
    """Noise of the first order by its recursion, without a matrix."""
    values = np.empty(size)
    values[0] = rng.standard_normal()
    for n in range(1, size):
        values[n] = kept * values[n - 1] + np.sqrt(1 - kept**2) * rng.standard_normal()
    return values


def test_whitened_noise_of_the_first_order_is_its_innovation():
    values = np.random.default_rng(1).standard_normal(40)
    kept = np.exp(-0.5)
    white = whiten(Noise(2.0, 0.0).factor(np.arange(40.0)), values)
    npt.assert_allclose(white[1:], (values[1:] - kept * values[:-1]) / np.sqrt(1 - kept**2))


def test_factor_of_regular_times_is_that_of_the_matrix():
    noise, time = Noise(7.0, 0.2), 3.0 + 2.0 * np.arange(30)
    matrix = 0.8 * np.exp(-np.abs(time[:, None] - time) / 7.0) + 0.2 * np.eye(30)
    factor = noise.factor(time)
    npt.assert_allclose(factor @ factor.T, matrix, atol=1e-12)
    uneven = np.delete(time, [4, 9])
    factor = noise.factor(uneven)
    npt.assert_allclose(factor @ factor.T, np.delete(np.delete(matrix, [4, 9], 0), [4, 9], 1))


def test_restricted_likelihood_does_not_depend_on_the_level():
    time, values = np.arange(50.0), recursion(0.8, 50, np.random.default_rng(2))
    one, other = (
        restricted_likelihood(Noise(3.0, 0.1), [(time, np.ones((50, 1)), values + level)])
        for level in (0.0, 5.0)
    )
    assert one == pytest.approx(other)


@pytest.mark.parametrize("kept", [0.0, 0.5, 0.9])
def test_noise_is_found_in_spite_of_a_fitted_line(kept):
    rng = np.random.default_rng(3)
    time = np.arange(150.0)
    columns = np.column_stack([np.ones(150), time])
    noise = fit_noise([(time, columns, recursion(kept, 150, rng)) for _ in range(6)], interval=1.0)
    # correlation of neighbours; its standard error over 900 samples is below 0.035
    found = (1 - noise.white) * np.exp(-1 / noise.correlation_time)
    assert found == pytest.approx(kept, abs=0.09)


@pytest.mark.parametrize("freedom", [4.0, 20.0])
def test_variances_of_a_known_scatter_give_its_degrees_of_freedom(freedom):
    """Variances drawn as 2e-4 over chi-square by its degrees of freedom: the prior of Smyth."""
    rng = np.random.default_rng(3)
    true = 2e-4 * freedom / rng.chisquare(freedom, 2000)
    pooled = combine_spreads([NoiseSpread(one * rng.chisquare(50) / 50, 50) for one in true])
    assert pooled.freedom == pytest.approx(freedom, rel=0.1)
    assert pooled.variance == pytest.approx(2e-4, rel=0.05)

    # stages that are alike are worth their samples
    alike = [NoiseSpread(rng.chisquare(80) / 80, 80) for _ in range(1000)]
    assert combine_spreads(alike).freedom > 500


def test_one_other_stage_does_not_show_how_unlike_stages_are():
    assert pool_spreads([NoiseSpread(1.0, 50), NoiseSpread(2.0, 50)]) == [UNKNOWN, UNKNOWN]
