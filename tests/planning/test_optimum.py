"""Best concentrations, against a dense grid and against the scaling of the problem."""

from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest

from erlif.core.errors import ModelError
from erlif.planning import Spectrum, WantedFilm, find_optimum, largest_error
from erlif.planning.precision import dimmed_to_full_scale

FILL = 0.75  # of full scale, the default


def least_of_grid(design, film, size):
    """Smallest error over a grid of both concentrations, with the light as far as it may go."""
    grid = np.geomspace(1e-3, 0.3, size)
    mixed = [design.with_concentrations((one, two)) for one in grid for two in grid]
    return min(largest_error(dimmed_to_full_scale(one, 10.0, FILL), film) for one in mixed)


@pytest.fixture(scope="module")
def best(design, film):
    return find_optimum(design, film, largest=1.0)


def test_no_concentrations_of_a_dense_grid_are_better(design, film, best):
    least = least_of_grid(design, film, 20)
    assert best.error <= least < 1.1 * best.error  # the grid passes close by


def test_ten_times_the_films_need_a_tenth_of_the_dyes(design, film, best):
    """Attenuation enters as its product with thickness alone."""
    scaled = WantedFilm(10 * film.thinnest, 10 * film.thickest, (1.0, 180.0))
    found = find_optimum(design, scaled, largest=1.0)
    npt.assert_allclose(found.error, best.error, rtol=1e-3)
    npt.assert_allclose(10 * found.design.concentrations, best.design.concentrations, rtol=0.05)


def test_solubility_limits_a_concentration_and_is_reported(design, film, best):
    limit = 0.5 * float(best.design.concentrations[1])
    found = find_optimum(design, film, largest=limit)
    assert found.at_limit[1]
    assert found.design.concentrations.max() <= limit
    assert found.error > best.error


def test_a_dye_that_does_not_absorb_the_laser_has_a_best_concentration(design, film):
    """The ideal dye 2 reabsorbs and adds no light of its own."""
    nm = np.array([532.0, 580.0, 620.0])
    ideal = replace(
        design.dyes[1], absorption=Spectrum(nm, np.array([0.0, 3.5e4, 2e3]), "absorption of dye 2")
    )
    found = find_optimum(replace(design, dyes=(design.dyes[0], ideal)), film, largest=1.0)
    assert found.error <= least_of_grid(found.design, film, 8)


def test_exchanged_filters_have_no_optimum(design, film):
    exchanged = replace(design, cameras=design.cameras[::-1])
    with pytest.raises(ModelError, match="Exchange the cameras"):
        find_optimum(exchanged, film, largest=1.0)
