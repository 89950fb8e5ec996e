"""What stands still in the image, from cells of known films, factors and marks."""

from dataclasses import replace

import numpy as np
import pytest
from scenes.pattern import CENTRES, CURVE, NOISE, draw_field, photograph

from erlif.ratio.cells import LightCells
from erlif.trend import GapMinimum, GapShape, Region, find_texture
from erlif.trend.factor_kind import FactorKind
from erlif.trend.pattern import CellPattern, PatternSize
from erlif.trend.texture import Texture

U, V = (one.ravel() for one in np.meshgrid(*[np.linspace(-1, 1, 20)] * 2))


@pytest.mark.parametrize("length", [40, 100])
def test_size_and_length_of_a_fixed_factor_are_found(length):
    sizes = []
    for seed in range(6):
        factor = 0.01 * draw_field(length, np.random.default_rng(seed))
        found = find_texture(photograph(factor, seed=seed), CENTRES, CURVE)
        assert 0.6 < found.found.length / length < 1.7
        sizes.append(found.found.size)
    # the mean over a cell of 40 pixels has less of it than a pixel: here cells are points
    assert 0.8 < np.mean(sizes) / 0.01 < (1.6 if length == 40 else 1.3)


def test_marks_that_stand_still_are_film():
    for seed in range(10):
        assert find_texture(photograph(0.0, seed=seed, marks=0.2), CENTRES, CURVE) is None


def test_a_factor_that_is_smooth_over_the_picture_is_left_to_the_gap():
    x, y = (2 * at / np.ptp(at) - 1 for at in CENTRES)
    assert find_texture(photograph(0.01 * (x - x * y + y**2)), CENTRES, CURVE) is None


def test_a_film_that_stands_still_shows_nothing():
    factor = 0.01 * draw_field(60, np.random.default_rng(1))
    assert find_texture(photograph(factor, swing=0.0), CENTRES, CURVE) is None


REGION = Region(slice(0, 200), slice(0, 300))
TEXTURE = Texture(PatternSize(0.01, std=0.001, length=60.0, gain=100.0), FactorKind(4.0))


def in_numbers(gap, *, along_x=True):
    """Changes of mean and minimum over a region by a pattern of 1 %, in shares of its size."""
    parts = TEXTURE.parts_in(REGION, along_x=along_x)
    return TEXTURE.in_numbers(parts, REGION, gap, CURVE, GapShape.LINE, along_x=along_x) / 0.01


def draw_fields(seed):
    """Fields of the log ratio over the region, (field, place)."""
    rng = np.random.default_rng(seed)
    return draw_field(TEXTURE.found.length, rng, (150 * U, 100 * V), count=(300,))


@pytest.mark.parametrize("along_x", [True, False])
@pytest.mark.parametrize("bend", [0.0, 4.0])
def test_error_of_mean_and_minimum_is_that_of_fits_to_drawn_fields(along_x, bend):
    s, z = (U, V) if along_x else (V, U)
    shapes = np.stack([np.ones_like(s), s, z, s**2])
    fields = draw_fields(3)

    # films at fields of the log ratio, over those by a change that is even over the region
    amplitudes = np.array([5.0, 0.0, -0.1, bend, 0.0])
    per_ratio = 1 / CURVE.slope(amplitudes[:4] @ shapes)
    fitted, even = (
        np.linalg.lstsq(shapes.T, (film * per_ratio).T, rcond=None)[0] for film in (fields, 1.0)
    )

    # in the middle along sliding, at the edge across it
    at_edge = (fitted[0] + fitted[2]).std() / (even[0] + even[2])
    of_mean = (fields * per_ratio).mean(axis=1).std() / per_ratio.mean()
    place = np.array([149.5, 199.0] if along_x else [299.0, 99.5])
    gap = GapMinimum.unknown(3)._replace(place=place, amplitudes=amplitudes)
    found = in_numbers(gap, along_x=along_x)
    np.testing.assert_allclose(np.linalg.norm(found, axis=1), [of_mean, at_edge], rtol=0.15)


@pytest.mark.parametrize("along_x", [True, False])
def test_error_of_a_mean_is_that_of_drawn_means_over_cells(along_x):
    """Cells of half the picture are better known; correlated errors of neighbours."""
    columns, rows = CENTRES
    std = np.where(rows < 100, 2e-4, 2e-3)
    apart = sum(np.subtract.outer(at, at) ** 2 for at in CENTRES)
    covariance = np.outer(std, std) * np.exp(-apart / 80**2)
    texture = replace(TEXTURE, means=CellPattern(CENTRES, np.zeros(std.size), covariance))

    inside = (columns < 300) & (rows < 200)
    drawn = np.random.default_rng(6).multivariate_normal(0 * std, covariance, 4000)
    parts = texture.parts_in(REGION, along_x=along_x)
    gap = GapMinimum.unknown(3)
    found = texture.in_numbers(parts, REGION, gap, CURVE, GapShape.LINE, along_x=along_x)
    expected = drawn[:, inside].mean(axis=1).std()
    np.testing.assert_allclose(np.linalg.norm(found, axis=1), expected, rtol=0.1)


def test_minima_of_thin_and_thick_films_differ_as_fits_to_drawn_fields():
    """Errors over those by an even change; what is common to the films leaves an exponent alone."""
    shapes, fields = np.stack([np.ones_like(U), U, V, U**2]), draw_fields(4)
    at_edge, rows = [], []
    for film in (2.5, 5.0):
        amplitudes = np.array([film, 0.0, -0.1, 4.0, 0.0])
        per_ratio = 1 / CURVE.slope(amplitudes[:4] @ shapes)
        changes = np.vstack([fields, np.ones_like(U)]) * per_ratio
        fitted = np.linalg.lstsq(shapes.T, changes.T, rcond=None)[0]
        at_edge.append((fitted[0] + fitted[2])[:-1] / (fitted[0] + fitted[2])[-1])
        gap = GapMinimum.unknown(3)._replace(place=np.array([149.5, 199]), amplitudes=amplitudes)
        rows.append(in_numbers(gap)[1])
    apart = np.linalg.norm(rows[1] - rows[0])
    np.testing.assert_allclose(apart, (at_edge[1] - at_edge[0]).std(), rtol=0.15)
    assert apart > 0.02


def test_error_of_a_gap_that_is_not_known_is_that_of_an_even_film():
    found = in_numbers(GapMinimum.unknown(3))
    share = draw_fields(5).mean(axis=1).std()
    np.testing.assert_allclose(np.linalg.norm(found, axis=1), share, rtol=0.15)


def test_size_of_a_smooth_factor_holds_where_the_gaps_take_up_most_of_it():
    """Mean square of errors over stated ones: 1 expected; 1.3 if the gaps took up nothing."""
    (x, y), squares = CENTRES, []
    part = (np.abs(x - x.mean()) < 150) & (np.abs(y - y.mean()) < 130)
    move = 1.8 * np.sin(np.linspace(0, 2 * np.pi, 40))[:, None]
    film = 3.5 + move + 9 * ((x - x.mean()) / 240) ** 2
    for seed in range(60):
        rng = np.random.default_rng(seed)
        factor = 0.02 * draw_field(100, rng)
        log_ratio = CURVE.predict_log(film) + factor + NOISE * rng.standard_normal(film.shape)
        record = LightCells(
            0 * film, np.where(part, log_ratio, np.nan), 0 * film, 0 * film + NOISE**2
        )
        squares.append((0.02 / find_texture(record, CENTRES, CURVE).found.size) ** 2)
    assert 0.8 < np.mean(squares) < 1.2
