"""Crank-rockers in words: the table has the lengths and measures of each."""

import numpy as np

from erlif.joint.models.linkage import synthesise_crank_rocker
from erlif.joint.report import summarise_linkages

LINKS = {"crank": 0.055, "rocker": 0.26, "ground": 0.51}


def test_each_solution_has_a_row_and_broken_limits_a_sentence():
    limit = np.radians(55)
    found = synthesise_crank_rocker(
        swing=np.radians(26), rocker_speed=2.5, least_transmission_angle=limit, **LINKS
    )
    text = summarise_linkages(found)
    head, _, first, second = text.split("\n\n")[1].splitlines()
    assert head.split()[:4] == ["crank", "coupler", "rocker", "ground"]
    # the two couplers of 26 degrees, from eq. A.1
    assert (first.split()[1], second.split()[1]) == ("536.936", "366.105")
    assert first.split()[5] == second.split()[5] == "26.000"
    assert max(map(len, text.split("\n\n")[1].splitlines())) <= 80
    assert "Linkage 2: transmission angle 51.85 degrees, below 55." in text
    slopes = text.split("Change of the swing of the first by 1 mm more of a link")[1]
    assert slopes.startswith(", in degrees: crank +0.480, coupler +0.034")
