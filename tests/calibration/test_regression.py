"""Orthogonal distance regression against known parameters, known outliers and Gauss's law."""

from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest
from scenes.fixture import K, P, Q, measure_points, through_filters

from erlif.calibration.pose import Freedom
from erlif.calibration.regression import fit_robustly

FILM = np.linspace(0.2, 15, 80)  # um
THICK = np.linspace(0.1, 18, 190)
"""Films up to those in which a wall bends the curve. [um]"""


def measure(rng, *, film_std=0.05, ratio_std=1e-3):
    """Points of the true curve with errors in both variables."""
    return measure_points(rng, FILM, film_std=film_std, ratio_std=ratio_std)


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
    """Invented dyes through their filters; one attenuation is fitted for each filter.

    The films are known to 0.05 um, the logarithms of the ratio to 3e-4.
    """
    true, rng = through_filters(reflectance), np.random.default_rng(6)
    found = fit(measure_points(rng, THICK, true=true, film_std=0.05, ratio_std=3e-4))
    assert found.reflects == (reflectance > 0.2)

    if found.reflects:
        std = np.sqrt(found.covariance[4, 4])
        assert abs(found.parameters[4] - reflectance) < 2 * std + 0.04  # one attenuation a band

        gradient = found.gradient(THICK)
        of_curve = np.sqrt(np.einsum("ip,ij,jp->p", gradient, found.covariance, gradient))
        assert np.all(np.abs(found.predict(THICK) - true(THICK)) < 4 * of_curve + 1e-4)
        assert found.reduced_chi_square < 1.5


def test_a_strong_wall_is_found_although_the_bent_part_looks_like_outliers():
    """A precise ratio, to 1e-4: the model of a black wall leaves out a sixth of the points."""
    true, rng = through_filters(0.6), np.random.default_rng(2)
    assert fit(measure_points(rng, THICK, true=true, film_std=0.15, ratio_std=1e-4)).reflects
