"""Sensitivities: the law of cosines differentiated by hand, and positions of changed linkages."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif.core.errors import ModelError
from erlif.models.linkage import link_sensitivity
from erlif.models.mechanism import CrankRocker

RIG = CrankRocker(crank=0.055, coupler=0.44, rocker=0.26, ground=0.51)


def slopes_of_swing(crank, coupler, rocker, ground):
    """Derivatives of the rocker angle opposite to the reach, coupler -+ crank, at both limits."""
    total = np.zeros(4)
    for sign in (-1, 1):
        reach = coupler + sign * crank
        cosine = (rocker**2 + ground**2 - reach**2) / (2 * rocker * ground)
        by = np.array([sign * reach, reach, ground * cosine - rocker, rocker * cosine - ground]) / (
            rocker * ground * np.sqrt(1 - cosine**2)
        )
        total += sign * by
    return total


def test_swing_follows_the_law_of_cosines(draw_linkage):
    rng = np.random.default_rng(8)
    for links in [tuple(vars(RIG).values()), *(draw_linkage(rng) for _ in range(10))]:
        found = link_sensitivity(CrankRocker(*links))
        npt.assert_allclose(found.swing, slopes_of_swing(*links), rtol=1e-6, atol=1e-6)


def test_changed_links_change_the_measures_as_stated(solver):
    found = link_sensitivity(RIG)
    changes = np.array([1e-4, -1e-4, 1e-4, -1e-4])
    before, after = (solver(np.array([0.055, 0.44, 0.26, 0.51]) + k * changes) for k in (0, 1))
    npt.assert_allclose(found.swing @ changes, after.swing() - before.swing(), rtol=5e-3)
    npt.assert_allclose(
        found.speed_ratio @ changes, after.speed_ratio() - before.speed_ratio(), rtol=5e-3
    )


def test_tolerances_add_up():
    found = link_sensitivity(RIG)
    one, each = found.worst(1e-4)["swing"], found.worst([1e-4] * 4)["swing"]
    npt.assert_allclose([one, each], np.abs(slopes_of_swing(*vars(RIG).values())).sum() * 1e-4)
    squares = np.sqrt((slopes_of_swing(*vars(RIG).values()) ** 2).sum()) * 1e-4
    npt.assert_allclose(found.std(1e-4)["swing"], squares)
    with pytest.raises(ModelError, match="tolerance must not be negative"):
        found.worst(-1e-4)
