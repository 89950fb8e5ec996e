"""The gap in the image, against the distance of two circles."""

import numpy as np
import numpy.testing as npt
from scenes.orbits import STATED

from erlif.prediction import ImageLine, gap_in_view, summarise_gap

PLACE = np.linspace(-0.01, 0.012, 2001)


def circles(load, side):
    """Distance between the circles along the radius of the bore at each place."""
    angle = PLACE / np.sqrt(0.03336 * 0.03359)
    along = load * np.cos(angle) + side * np.sin(angle)
    across = load * np.sin(angle) - side * np.cos(angle)
    return 0.03359 - along - np.sqrt(0.03336**2 - across**2)


def test_the_gap_is_the_distance_of_two_circles():
    """To second order in clearance over radius: some hundredths of a micrometre."""
    found = gap_in_view(np.array([220e-6, 150e-6]), np.array([20e-6, -90e-6]), STATED, PLACE)
    npt.assert_allclose(found[0], circles(220e-6, 20e-6), atol=0.15e-6)
    npt.assert_allclose(found[1], circles(150e-6, -90e-6), atol=0.3e-6)


def test_minimum_and_mean_are_those_of_the_region():
    """The thinnest place of the second position lies outside the region, on its right."""
    region = slice(300, 1700)
    load, side = np.array([224e-6, 200e-6]), np.array([10e-6, 105e-6])
    minimum, mean = summarise_gap(load, side, STATED, ImageLine(PLACE, region))
    gap = gap_in_view(load, side, STATED, PLACE[region])
    npt.assert_allclose(minimum, gap.min(axis=1), atol=1e-11)
    npt.assert_allclose(mean, gap.mean(axis=1), rtol=1e-12)

    clear = 230e-6 - np.hypot(load, side)
    npt.assert_allclose(minimum[0], clear[0], rtol=1e-6)
    assert minimum[1] > clear[1] + 1e-6
