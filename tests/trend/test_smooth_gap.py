"""Smooth gaps through drawn cells."""

import numpy as np
from scenes.pattern import CENTRES, CURVE, NOISE, photograph

from erlif.trend.smooth_gap import fit_cells


def test_films_that_hardly_move_show_no_factor():
    assert fit_cells(photograph(np.zeros(120), swing=0.1), CENTRES, CURVE) is None


def test_a_gap_of_second_degree_is_found_and_leaves_the_noise():
    """Of cells without marks; ten amplitudes of a frame take a twelfth of it."""
    cells = fit_cells(photograph(np.zeros(120), marks=0.0), CENTRES, CURVE)
    x, y = (2 * at / np.ptp(at) - 1 for at in CENTRES)
    move = 1.5 * np.sin(np.linspace(0, 2 * np.pi, 40))
    used = cells.weight > 0
    drawn = 4 + move[:, None] + 0.8 * x**2 + 0.1 * y
    assert np.std((cells.film - drawn)[used]) < 0.02
    assert abs(cells.rest[used].std() / (NOISE * np.sqrt(1 - 10 / 120)) - 1) < 0.03
