"""Orthogonal distance regression against known parameters, known outliers and Gauss's law."""

from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest
from scenes.fixture import K, P, Q, log_ratio, make_points, through_filters

from erlif.calibration.pose import Freedom
from erlif.calibration.regression import fit_robustly

FILM = np.linspace(0.2, 15, 80)


def measure(rng, *, film_std=0.05, ratio_std=1e-3):
    """Points of the true curve with errors in both variables."""
    return make_points(
        FILM,
        thickness=FILM + rng.normal(0, film_std, FILM.size),
        thickness_std=np.full(FILM.size, film_std),
        log_ratio=log_ratio(FILM) + rng.normal(0, ratio_std, FILM.size),
        log_ratio_std=np.full(FILM.size, ratio_std),
    )


def fit(points):
    return fit_robustly(points, Freedom.none(points))


def test_scatter_of_the_parameters_matches_their_covariance():
    """Mahalanobis distance of 60 fits: its mean is 3, the number of parameters, +- sqrt(6/60)."""
    rng = np.random.default_rng(2)
    distances = []
    for _ in range(60):
        found = fit(measure(rng))
        error = found.parameters - [K, P, Q]
        distances.append(error @ np.linalg.solve(found.covariance, error))
    assert abs(np.mean(distances) - 3) < 4 * np.sqrt(6 / 60)


def test_chi_square_has_its_degrees_of_freedom():
    rng = np.random.default_rng(3)
    values = [fit(measure(rng)).reduced_chi_square for _ in range(20)]
    assert abs(np.mean(values) - 1) < 4 * np.sqrt(2 / 77 / 20)


def test_outliers_are_left_out_and_nothing_else():
    """Three slips of the CMM by 2 um among 80 points with 0.05 um of noise."""
    points = measure(np.random.default_rng(4))
    thickness = points.thickness.copy()
    slips = [10, 40, 47]
    thickness[slips] += 2.0
    found = fit(replace(points, thickness=thickness))
    assert np.nonzero(~found.kept)[0].tolist() == slips
    std = np.sqrt(np.diag(found.covariance))
    assert np.all(np.abs(found.parameters - [K, P, Q]) < 4 * std)


@pytest.mark.parametrize("std", [0.03, 0.3])
def test_unknown_error_of_the_cmm_is_estimated_from_the_scatter(std):
    """From the median absolute deviation of 80 points, which scatters by 13 %."""
    points = measure(np.random.default_rng(5), film_std=std, ratio_std=1e-4)
    found = fit(replace(points, thickness_std=np.full(FILM.size, np.nan)))
    npt.assert_allclose(found.thickness_std, std, rtol=0.4)
    npt.assert_array_equal(found.thickness_std, found.thickness_std[0])


@pytest.mark.parametrize("reflectance", [0.0, 0.3, 0.6])
def test_a_wall_that_reflects_is_found_where_it_bends_the_curve(reflectance):
    """Invented dyes through their filters, one attenuation for each of which is fitted."""
    film, rng = np.linspace(0.1, 18, 190), np.random.default_rng(6)
    true = through_filters(reflectance)
    points = make_points(
        film,
        thickness=film + rng.normal(0, 0.05, film.size),
        thickness_std=np.full(film.size, 0.05),
        log_ratio=true(film) + rng.normal(0, 3e-4, film.size),
        log_ratio_std=np.full(film.size, 3e-4),
    )
    found = fit(points)
    assert found.reflects == (reflectance > 0.2)
    if found.reflects:
        std = np.sqrt(found.covariance[4, 4])
        assert abs(found.parameters[4] - reflectance) < 2 * std + 0.04  # one attenuation a band
        gradient = found.gradient(film)
        of_curve = np.sqrt(np.einsum("ip,ij,jp->p", gradient, found.covariance, gradient))
        assert np.all(np.abs(found.predict(film) - true(film)) < 4 * of_curve + 1e-4)
        assert found.reduced_chi_square < 1.5


def test_a_strong_wall_is_found_although_the_bent_part_looks_like_outliers():
    """A precise fixture: the model before a black wall leaves out a sixth of the points."""
    film, rng = np.linspace(0.1, 18, 190), np.random.default_rng(2)
    true = through_filters(0.6)
    points = make_points(
        film,
        thickness=film + rng.normal(0, 0.15, film.size),
        thickness_std=np.full(film.size, 0.15),
        log_ratio=true(film) + rng.normal(0, 1e-4, film.size),
        log_ratio_std=np.full(film.size, 1e-4),
    )
    assert fit(points).reflects
