"""One linkage with its measures."""

import numpy as np
import numpy.testing as npt

from erlif.models.linkage import measure_linkage
from erlif.models.mechanism import CrankRocker

RIG = CrankRocker(crank=0.055, coupler=0.44, rocker=0.26, ground=0.51)
RPM = np.pi / 30


def test_a_design_holds_the_measures_of_the_rig():
    found = measure_linkage(RIG, crank_speed=114 * RPM)
    npt.assert_allclose(np.degrees(found.swing), 24.4260, atol=5e-5)
    npt.assert_allclose(found.rocker_speed, 2.552104, rtol=1e-6)
    npt.assert_allclose(found.time_ratio, 1.0014, atol=5e-5)
    npt.assert_allclose(np.degrees(found.least_transmission), 75.31, atol=5e-3)
    assert found.kind == "crank-rocker"
    # from 180.1253 degrees of crank for the way out
    assert found.slower_stroke == "rising"


def test_strokes_of_a_centric_linkage_are_equal():
    coupler = np.sqrt(0.1**2 + 0.5**2 - 0.3**2)
    assert measure_linkage(CrankRocker(0.1, coupler, 0.3, 0.5)).slower_stroke == "neither"
