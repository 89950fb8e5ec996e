"""Fixed factors of cells, from drawn ones."""

import numpy as np
from scenes.pattern import CENTRES, CURVE, draw_field, photograph

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


def test_films_that_hardly_move_leave_a_noise_far_above_the_factor():
    factor = 0.01 * draw_field(50, np.random.default_rng(0))
    noise = [
        np.sqrt(np.median(np.diag(measure_factors(record, CENTRES, CURVE).noise)))
        for record in (photograph(factor, swing=1.5), photograph(factor, swing=0.0))
    ]
    assert noise[0] < 0.2 * 0.01
    assert noise[1] > 5 * 0.01
