"""Differences of maps with known noise."""

import numpy as np
import numpy.testing as npt

from erlif.show.view.differences import significance, subtract_maps


def noisy(mean, std, seed):
    values = np.random.default_rng(seed).normal(mean, std, (80, 100)).astype(np.float32)
    return values, np.full(values.shape, std, np.float32), np.zeros(values.shape, np.uint8)


def test_the_difference_of_equal_films_scatters_as_its_standard_deviation():
    difference, std, _ = subtract_maps(noisy(5, 0.3, 1), noisy(5, 0.4, 2))
    npt.assert_allclose(std, 0.5, rtol=1e-6)
    pull = significance(difference, std)
    assert abs(float(pull.mean())) < 4 / 8000**0.5
    assert 0.97 < float(pull.std()) < 1.03


def test_a_pixel_is_valid_where_both_maps_are():
    one, other = noisy(5, 0.3, 1), noisy(4, 0.3, 2)
    one[2][0, 0], other[2][0, 1] = 16, 128
    difference, std, flags = subtract_maps(one, other)
    assert flags[0, :3].tolist() == [16, 128, 0]
    assert np.isnan(difference[0, :2]).all()
    assert np.isnan(std[0, :2]).all()
    npt.assert_allclose(difference[0, 2], other[0][0, 2] - one[0][0, 2])


def test_no_standard_deviation_gives_no_significance():
    assert np.isnan(significance(np.ones((1, 1), np.float32), np.zeros((1, 1), np.float32)))
