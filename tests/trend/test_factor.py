"""Fixed factors of cells, from drawn ones."""

import numpy as np
from scenes.pattern import CENTRES, CURVE, draw_field, photograph

from erlif.trend.factor import measure_factors
from erlif.trend.factor_kind import FactorKind
from erlif.trend.smooth_gap import fit_cells

WINDOW = FactorKind(4.0)


def test_what_is_measured_is_the_drawn_factor_within_its_noise():
    """Chi-square over its degrees of freedom, without what is smooth; marks are no part of it."""
    reduced = []
    for seed in range(5):
        factor = 0.01 * draw_field(50, np.random.default_rng(seed))
        cells = fit_cells(photograph(factor, seed=seed, marks=0.05), CENTRES, CURVE)
        found = measure_factors(cells, WINDOW, CURVE)
        off = found.values - found.shown @ factor
        reduced.append(off @ np.linalg.solve(found.noise, off) / off.size)
        assert off.std() < 0.2 * found.values.std()
    assert 0.7 < np.mean(reduced) < 1.4


def test_films_that_move_show_a_factor():
    """To a fifth of a factor of 1 %."""
    factor = 0.01 * draw_field(50, np.random.default_rng(0))
    cells = fit_cells(photograph(factor, swing=1.5), CENTRES, CURVE)
    found = measure_factors(cells, WINDOW, CURVE)
    assert np.sqrt(np.median(np.diag(found.noise))) < 0.2 * 0.01
