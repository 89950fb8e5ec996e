"""The film of the documentation follows from the formulas that it is described by."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif.show import plots
from erlif.trend import average_across_sliding, rigid_gap


@pytest.fixture(scope="module")
def film():
    return plots.example_film()


def test_gap_is_that_of_two_cylinders(film):
    """0.2053 um/mm2 where circles of 33.59 and 33.36 mm touch, less where the film is thicker."""
    for trigger in range(film.sizes["trigger"]):
        gap = rigid_gap(average_across_sliding(film, trigger=trigger), film)
        bend = 0.20525 * (1 - float(film.film_min[trigger]) / 230)
        assert abs(gap.curvature - bend) < 4 * gap.curvature_std
        npt.assert_allclose(gap.minimum, film.film_min[trigger], atol=0.05)


def test_scatter_is_that_of_the_error_bars(film):
    x = film.x.values - film.x.values.mean()
    bend = 0.20525 * (1 - film.film_min / 230)
    truth = film.film_min + bend * film.x.copy(data=x) ** 2 / 2
    pull = ((film.thickness - truth) / film.thickness_std).values
    pull = pull[np.isfinite(pull)]
    assert 0.95 < pull.std() < 1.05
    assert abs(pull.mean()) < 0.05
