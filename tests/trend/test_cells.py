"""Cells of a run whose light is compared with that of their film."""

import numpy as np
import numpy.testing as npt

from erlif.show.plots import example_calibration
from erlif.trend.cells import choose_cells, separate_light

CALIBRATION = example_calibration()


def test_films_beyond_the_response_of_the_light_are_left_out():
    """Below 1 um, and above 0.8 of the thickest film that the fixture covers."""
    thickest = CALIBRATION.covered_range[1]
    films = np.array([0.5, 1.5, 5.0, 0.75 * thickest, 0.85 * thickest])
    film = np.repeat(films, 30)[None].repeat(8, axis=0)
    chosen = choose_cells(film, np.ones(film.shape, bool), CALIBRATION)
    npt.assert_array_equal(chosen, (film > 1) & (film < 0.8 * thickest))


def test_a_pattern_keeps_its_pixels_within_the_range():
    """Films whose ratio by the narrow-band law is two sizes of the pattern below the thickest."""
    k, p, q = CALIBRATION.parameters
    films, size = np.linspace(2.0, CALIBRATION.thickness_range[1], 200), 0.05
    law = np.log(k * p * np.expm1(-q * films) / (q * np.expm1(-p * films)))
    film = np.repeat(films, 30)[None].repeat(8, axis=0)
    chosen = choose_cells(film, np.ones(film.shape, bool), CALIBRATION, size)[0, ::30]
    lifted = law + 2 * size
    npt.assert_array_equal(chosen[lifted < law[-1] - 0.002], True)
    npt.assert_array_equal(chosen[lifted > law[-1] + 0.002], False)
    assert not chosen[films < 0.8 * CALIBRATION.covered_range[1]].all()


def test_frames_of_few_cells_and_cells_of_few_frames_are_left_out():
    """Frame 0 has 23 cells, one less than are needed; cell 29 has then 5 frames of 6."""
    film, measured = np.full((10, 30), 4.0), np.ones((10, 30), bool)
    measured[0, :7] = False
    measured[5:9, 29] = False
    chosen = choose_cells(film, measured, CALIBRATION)
    assert not chosen[0].any()
    assert not chosen[:, 29].any()
    assert chosen[1:, :29].all()


def test_cells_and_frames_are_separated_where_some_are_missing():
    rng = np.random.default_rng(1)
    of_cell, of_frame = rng.normal(size=12), rng.normal(size=30)
    of_frame -= of_frame.mean()
    chosen = rng.random((30, 12)) > 0.2
    light = np.where(chosen, of_frame[:, None] + of_cell, 99.0)
    npt.assert_allclose(separate_light(light, chosen), of_cell, atol=1e-4)
