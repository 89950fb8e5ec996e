"""Errors of the mean and the change of correlated series."""

import numpy as np
import numpy.testing as npt
import pytest
from scipy.signal import lfilter

from erlif.joint.friction.scatter import spread_of_line


def make_series(rng, *, size, kept):
    """Stationary series of variance 1 whose neighbours have the correlation `kept`."""
    steps = np.sqrt(1 - kept**2) * rng.normal(size=size)
    return lfilter([1], [1, -kept], steps, zi=[kept * rng.normal()])[0]


@pytest.mark.parametrize(("size", "kept"), [(12, 0.5), (30, 0.5), (100, 0.8)])
def test_intervals_cover_correlated_series_of_several_lengths(size, kept):
    """80 series: never less than a binomial share allows, nor half as wide again as the errors."""
    rng = np.random.default_rng(8)
    time = np.arange(size, dtype=float)
    away = time - time.mean()
    errors, widths = [], []
    for _ in range(80):
        values = make_series(rng, size=size, kept=kept) + away / size
        change = away @ values / (away @ away) * (size - 1)
        errors.append([values.mean(), change - (size - 1) / size])
        widths.append([[one.std, one.wide] for one in spread_of_line(time, values)])
    errors, widths = np.array(errors), np.array(widths)
    held = np.mean(abs(errors)[..., None] < widths, axis=0)
    for share, both in zip((0.683, 0.95), held.T, strict=True):
        assert np.all(both > share - 3 * np.sqrt(share * (1 - share) / 80))
    assert np.all(np.median(widths[..., 0], axis=0) < 1.5 * errors.std(axis=0))


def test_many_values_without_correlation_have_the_standard_error():
    values = np.random.default_rng(2).normal(size=2000)
    mean, change = spread_of_line(np.arange(2000.0), values)
    npt.assert_allclose(mean.std, 2000**-0.5, rtol=0.3)
    assert 1.96 * 2000**-0.5 < mean.wide < 1.6 * 1.96 * 2000**-0.5
    npt.assert_allclose(change.std, (12 / 2000) ** 0.5, rtol=0.3)


def test_two_values_have_students_factor():
    """Without correlation: one degree of freedom, tan(0.683 pi/2) times the standard error."""
    mean, change = spread_of_line(np.array([0.0, 1.0]), np.array([1.0, 3.0]))
    assert mean.std > np.tan(0.682689 * np.pi / 2)
    assert np.isnan(change.std)
    assert np.isnan(change.wide)
