"""Minimum film and position of the pin in bores with lobes, written out as circles."""

from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest
from scenes.fixture import assert_covers
from scenes.gap import (
    AXIAL_ORIGIN,
    TURNED,
    VIEW,
    WHOLE,
    Y,
    circle_gap,
    exact_ratios,
    exchange_axes,
    known_calibration,
    noisy_ratios,
)

from erlif.rig import RigSettings
from erlif.rig.film import draw_marks
from erlif.trend import AxialShape, FilmCurve, find_gap_minimum, find_pin_position, sum_blocks
from erlif.trend.gap import MISFIT

LOBES, RADIUS, HEIGHT = (-2.4, 2.6), 200.0, 14.0  # mm, mm, um
PLACE = np.linspace(-15, 15, 3001)
POSITIONS = [(212.5, 0.0, 0.0, 0.0), (213.5, 9.0, 0.04, -0.2), (208.0, -12.0, -0.1, 0.3)]
"""Displacements and tilts of pins that leave 2.5 to 8 um on the crests."""


def lobed(axial):
    """Height that circular lobes add to the gap, at places from the middle of the joint. [um]"""
    rise = [1e3 * (RADIUS - np.sqrt(RADIUS**2 - np.minimum(axial - one, 9) ** 2)) for one in LOBES]
    return -np.maximum(HEIGHT - np.min(rise, axis=0), 0)


def film_of(truth):
    return circle_gap(*truth) + lobed(Y - AXIAL_ORIGIN)[:, None]


BORE = AxialShape(AXIAL_ORIGIN + PLACE, lobed(PLACE), VIEW.pitch)
LOBED = replace(VIEW, bore=BORE)
ON_THE_BORE = np.array([1, np.sqrt(33.59 / 33.36)] * 2)
"""Numbers of the formula over those of circles (tests/trend/test_position.py)."""


def minimum(ratios, *, bore=BORE, region=WHOLE, calibration=None, along_x=True):
    curve = FilmCurve.of(calibration or known_calibration())
    sums = sum_blocks(ratios, region)
    return find_gap_minimum(sums, curve, region=region, sliding_along_x=along_x, bore=bore)


@pytest.mark.parametrize("truth", POSITIONS)
def test_minimum_over_a_lobe_is_that_of_the_map(truth):
    """Without a tilt to the side: a twist is no part of the smooth gap, and leaves its error."""
    film = film_of((*truth[:3], 0.0))
    found = minimum(exact_ratios(film))
    npt.assert_allclose(found.minimum.value, film.min(), atol=4e-3)
    npt.assert_allclose(found.mean.value, film.mean(), atol=4e-3)
    row = np.unravel_index(film.argmin(), film.shape)[0]
    assert abs(found.place[1] - row) <= 2


def test_a_straight_gap_does_not_describe_a_lobe():
    found = minimum(exact_ratios(film_of(POSITIONS[0])), bore=None)
    assert np.isnan(found.minimum.value)
    assert found.misfit > MISFIT


@pytest.mark.parametrize("truth", POSITIONS)
def test_position_of_a_pin_in_a_lobed_bore_comes_back(truth):
    """To a hundredth of a film; 2 nm and 5 nm/mm are those of a straight bore."""
    ratios = exact_ratios(film_of(truth))
    found = find_pin_position(ratios, known_calibration(), region=WHOLE, view=LOBED)
    error = np.abs(found.value - truth * ON_THE_BORE)
    assert (error <= [0.01, 0.03, 3e-3, 1e-2]).all(), error


def test_image_with_x_and_y_exchanged_gives_the_same_film():
    ratios = noisy_ratios(film_of(POSITIONS[1]), 0.01, np.random.default_rng(6))
    turned = minimum(exchange_axes(ratios), region=TURNED, along_x=False)
    npt.assert_allclose(turned.minimum.value, minimum(ratios).minimum.value, rtol=1e-6)


def test_error_bars_cover_film_and_position_over_marked_lobes():
    """With a new calibration, new noise and new marks of the surfaces each."""
    covariance = known_calibration().full_covariance
    root = np.linalg.cholesky(covariance)
    rows, columns = np.indices(film_of(POSITIONS[0]).shape, dtype=float)
    pulls = []
    for seed in range(40):
        rng = np.random.default_rng([47, seed])
        truth = POSITIONS[seed % 3]
        smooth = film_of(truth)
        film = np.maximum(smooth + draw_marks(RigSettings(), rng)(columns + 60, rows + 40), 0.05)
        fitted = known_calibration().parameters + root @ rng.standard_normal(3)
        calibration, ratios = known_calibration(*fitted), noisy_ratios(film, 0.0135, rng)
        lowest = minimum(ratios, calibration=calibration)
        std = lowest.minimum.std(covariance)
        found = find_pin_position(ratios, calibration, region=WHOLE, view=LOBED)
        error = (found.value - truth * ON_THE_BORE) / np.sqrt(np.diag(found.covariance(covariance)))
        pulls.append([(lowest.minimum.value - smooth.min()) / std, *error])
    assert_covers(pulls)
