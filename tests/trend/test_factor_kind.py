"""How drawn factors act, beside marks."""

import numpy as np
import pytest
from scenes.pattern import CENTRES, CURVE, act_of_wall, draw_field, photograph
from scipy.interpolate import CubicSpline

from erlif.trend.factor_kind import judge_kind
from erlif.trend.pattern import correlate_cells
from erlif.trend.smooth_gap import fit_cells


def test_derivative_by_a_wall_is_that_of_its_mean_reflectance():
    """Over that at 4 um."""
    films = np.array([1.0, 2.5, 6.0, 8.0])
    for mean in (0.0, 0.1, 0.25):
        found = CURVE.by_wall(films, mean) / CURVE.by_wall(4.0, mean)
        np.testing.assert_allclose(found, act_of_wall(films, mean), rtol=0.03)


@pytest.mark.parametrize("marks", [0.05, 0.15])
@pytest.mark.parametrize("of_wall", [False, True])
def test_a_factor_acts_as_it_was_drawn(of_wall, marks):
    """Marks that are large where the factor is, by chance, look as if it acted otherwise on thin
    films: in each of four runs it acts there within two standard deviations of what was drawn.
    """
    films, table = np.array([2.5, 3.0]), np.linspace(1.0, 9.0, 81)
    acts = CubicSpline(table, act_of_wall(table)) if of_wall else np.ones_like
    for seed in range(4):
        factor = 0.02 * draw_field(50, np.random.default_rng(seed))
        record = photograph(factor, seed=seed, marks=marks, acts=acts)
        expected = 0.02**2 * correlate_cells(50, CENTRES)
        kind = judge_kind(fit_cells(record, CENTRES, CURVE), expected, CURVE)
        found, std = kind.acts(films, CURVE)
        drawn = acts(films) / acts(np.array([kind.film]))
        assert np.all(np.abs(found - drawn) < 2 * std)
        assert np.all(std < 0.1)
