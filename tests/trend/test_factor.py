"""Fixed factors of cells, from drawn ones."""

import numpy as np
import pytest
from scenes.pattern import CENTRES, CURVE, act_of_wall, draw_field, photograph
from scipy.interpolate import CubicSpline

from erlif.trend.factor import measure_factors


def test_what_is_measured_is_the_drawn_factor_within_its_noise():
    """Chi-square over its degrees of freedom, without what is smooth; marks are no part of it."""
    reduced = []
    for seed in range(5):
        factor = 0.01 * draw_field(50, np.random.default_rng(seed))
        found = measure_factors(photograph(factor, seed=seed, marks=0.05), CENTRES, CURVE)
        off = found.values - found.shown @ factor
        reduced.append(off @ np.linalg.solve(found.noise, off) / off.size)
        assert off.std() < 0.2 * found.values.std()
    assert 0.7 < np.mean(reduced) < 1.4


def test_films_that_hardly_move_show_no_factor():
    factor = 0.01 * draw_field(50, np.random.default_rng(0))
    found = measure_factors(photograph(factor, swing=1.5), CENTRES, CURVE)
    assert np.sqrt(np.median(np.diag(found.noise))) < 0.2 * 0.01
    assert measure_factors(photograph(factor, swing=0.1), CENTRES, CURVE) is None


def test_derivative_by_a_wall_is_that_of_its_mean_reflectance():
    """Over that at 4 um."""
    films = np.array([1.0, 2.5, 6.0, 8.0])
    for mean in (0.0, 0.1, 0.25):
        found = CURVE.by_wall(films, mean) / CURVE.by_wall(4.0, mean)
        np.testing.assert_allclose(found, act_of_wall(films, mean), rtol=0.03)


@pytest.mark.parametrize(("of_wall", "least", "most"), [(False, 0.0, 0.3), (True, 0.7, 1.0)])
def test_a_factor_is_that_of_a_window_or_of_a_wall(of_wall, least, most):
    """Marks of 0.05 um beside it."""
    found, films = [], np.linspace(1.0, 9.0, 81)
    for seed in range(5):
        factor = 0.02 * draw_field(50, np.random.default_rng(seed))
        acts = CubicSpline(films, act_of_wall(films)) if of_wall else np.ones_like
        record = photograph(factor, seed=seed, marks=0.05, acts=acts)
        found.append(measure_factors(record, CENTRES, CURVE).kind.wall)
    assert least <= np.mean(found) <= most
