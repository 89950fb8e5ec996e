"""One linkage with its measures."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif.core.errors import ModelError
from erlif.joint.models.linkage import link_sensitivity, measure_linkage
from erlif.models.mechanism import CrankRocker

RIG = CrankRocker(crank=0.055, coupler=0.44, rocker=0.26, ground=0.51)
RPM = np.pi / 30


def test_a_design_holds_the_measures_of_the_rig():
    found = measure_linkage(RIG, crank_speed=114 * RPM)
    npt.assert_allclose(found.rocker_speed, 2.552104, rtol=1e-6)
    npt.assert_allclose(found.time_ratio, 1.0014, atol=5e-5)
    npt.assert_allclose(np.degrees(found.least_transmission), 75.31, atol=5e-3)
    assert found.kind == "crank-rocker"
    # from 180.1253 degrees of crank for the way out
    assert found.slower_stroke == "rising"


def test_strokes_of_a_centric_linkage_are_equal():
    coupler = np.sqrt(0.1**2 + 0.5**2 - 0.3**2)
    assert measure_linkage(CrankRocker(0.1, coupler, 0.3, 0.5)).slower_stroke == "neither"


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
