"""A pattern of known size and length, and what is known of it by the factors of cells."""

import numpy as np
import pytest
from scenes.pattern import CURVE, act_of_wall, draw_field, photograph

from erlif.ratio.cells import cell_centres
from erlif.trend.factor import CellFactors, measure_factors
from erlif.trend.factor_kind import FactorKind
from erlif.trend.pattern import (
    CellPattern,
    Pattern,
    PatternSize,
    correlate_cells,
    find_size,
    map_pattern,
)
from erlif.trend.smooth_gap import fit_cells

SHAPE = 192, 256
CENTRES = cell_centres(SHAPE, cells=(24, 32))
"""Cells of 8 x 8 pixels."""


@pytest.mark.parametrize("length", [16.0, 40.0])
def test_covariance_of_means_over_cells_is_the_integral_over_both(length):
    inside = (np.arange(80) + 0.5) / 10
    grid = np.meshgrid(inside, inside)
    x, y = (np.concatenate([one.ravel() + shift for shift in (0, 8)]) for one in grid)
    y[len(y) // 2 :] -= 8  # the second cell lies beside the first one
    rng = np.random.default_rng(1)
    one, two = rng.integers(0, 6400, 200_000), 6400 + rng.integers(0, 6400, 200_000)
    apart = (x[one] - x[two]) ** 2 + (y[one] - y[two]) ** 2
    expected = np.exp(-apart / length**2).mean()

    square = np.array([4.0, 12, 4, 12]), np.array([4.0, 4, 12, 12])
    found = correlate_cells(length, square)[0, 1]
    assert abs(found / expected - 1) < 0.01


def test_size_and_length_are_those_of_drawn_values():
    """Of single cells that are measured to a tenth of the size."""
    found, centres = [], cell_centres(SHAPE, cells=(12, 16))
    for seed in range(6):
        rng = np.random.default_rng(seed)
        values = 0.02 * draw_field(24, rng, centres)
        values += 0.002 * rng.standard_normal(values.size)
        cells = np.eye(values.size)
        factors = CellFactors(values, 0.002**2 * cells, cells, centres, kind=FactorKind(4.0))
        found.append(find_size(factors))
    assert 0.9 < np.mean([one.size for one in found]) / 0.02 < 1.2
    assert all(0.7 < one.length / 24 < 1.4 for one in found)


def test_the_most_likely_pattern_is_as_near_to_the_drawn_one_as_it_states():
    """A third of its size is left; shares within one and two standard deviations."""
    found = PatternSize(0.02, std=0.0, length=24.0, gain=100.0)
    middles, within = tuple(np.round(at).astype(int) for at in CENTRES[::-1]), []
    for seed in range(5):
        factor = 0.02 * draw_field(24, np.random.default_rng(seed), CENTRES)
        record = photograph(factor, seed=seed, marks=0.03, centres=CENTRES)
        factors = measure_factors(fit_cells(record, CENTRES, CURVE), FactorKind(4.0), CURVE)
        taken, std, *_ = map_pattern(factors, found, SHAPE)
        off = factor - taken[middles]
        within.append(np.abs(off) / std[middles])
        assert off.std() < 0.45 * 0.02
    assert 0.55 < np.mean(np.array(within) < 1) < 0.8
    assert 0.9 < np.mean(np.array(within) < 2) < 0.99


def test_means_over_cells_show_what_a_gap_of_any_form_would_take_up():
    """A pattern as long as half the picture, and its means over four cells to a tenth of its size.

    Shares of the pixels within one and two standard deviations.
    """
    found = PatternSize(0.02, std=0.0, length=120.0, gain=100.0)
    large, at = (
        cell_centres(SHAPE, cells=(12, 16)),
        tuple(np.round(one).astype(int) for one in CENTRES),
    )
    within, left = [], []
    for seed in range(3):
        rng = np.random.default_rng(seed)
        factor = 0.02 * draw_field(120, rng, CENTRES)
        record = photograph(factor, seed=seed, marks=0.03, centres=CENTRES)
        factors = measure_factors(fit_cells(record, CENTRES, CURVE), FactorKind(4.0), CURVE)
        merged = factor.reshape(12, 2, 16, 2).mean(axis=(1, 3)).ravel()
        merged += 0.002 * rng.standard_normal(merged.size)
        means = CellPattern(large, merged, 0.002**2 * np.eye(merged.size))
        off = []
        for known in (None, means):
            taken, std, *_ = map_pattern(factors, found, SHAPE, known)
            off.append(factor - taken[at[::-1]])
        within.append(np.abs(off[1]) / std[at[::-1]])
        left.append([one.std() for one in off])
    alone, beside = np.mean(left, axis=0)
    assert beside < 0.3 * alone
    assert 0.6 < np.mean(np.array(within) < 1) < 0.8
    assert 0.9 < np.mean(np.array(within) < 2) < 0.99


def test_what_is_taken_out_of_a_film_is_what_acts_there():
    """A factor of 3 % at 4 um, by a wall whose light is integrated over the depth."""
    films = np.linspace(1.0, 8.0, 15)
    pattern = Pattern(np.full(films.size, np.float32(0.03)), np.zeros(films.size))
    pattern = pattern.on_films(FactorKind(4.0, wall=1.0), CURVE)
    seen = CURVE.predict_log(films) + 0.03 * act_of_wall(films)
    left = seen.astype(np.float32)
    pattern.take_out(left)
    off = left - CURVE.predict_log(films)
    assert np.abs(off).max() < 0.05 * 0.03
