"""Means over cells of maps whose film and noise are known."""

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr

from erlif.core.errors import ErlifError
from erlif.review.comparison.cells import average_cells, cell_edges, noise_inflation
from erlif.show.plots import example_calibration


def noisy_map(film, noise, rng, *, pitch=0.1, shape=(64, 80)):
    """A map of an even film whose log ratio has a Gaussian error; stds in um."""
    calibration = example_calibration()
    slope = float(calibration.slope(film))
    log_ratio = calibration.predict_log(film) + noise * slope * rng.standard_normal(shape)
    values = calibration.inverse.look_up(log_ratio)
    dims = ("trigger", "y", "x")
    return xr.Dataset(
        {
            "thickness": (dims, values[None].astype(np.float32)),
            "thickness_std": (dims, np.full((1, *shape), noise, np.float32)),
            "thickness_std_shared": (dims, np.zeros((1, *shape), np.float32)),
        },
        {"y": pitch * np.arange(shape[0]), "x": pitch * np.arange(shape[1])},
    )


def cells_of(film):
    edges = {axis: cell_edges([film], axis) for axis in ("x", "y")}
    return average_cells(film, 0, example_calibration(), edges)


def test_the_mean_of_a_cell_has_neither_bias_nor_another_scatter_than_stated():
    rng = np.random.default_rng(5)
    cells = cells_of(noisy_map(6.0, 0.5, rng, shape=(240, 320)))
    pull = (cells.film - 6.0) / np.sqrt(cells.own_var)
    count = pull.size
    # without the correction for the curvature the mean pull would be about 1
    assert abs(float(pull.mean())) < 4 / np.sqrt(count)
    assert abs(float(pull.std()) - 1) < 4 / np.sqrt(2 * count)
    assert np.sqrt(cells.own_var).mean() == pytest.approx(0.5 / 8, rel=0.05)


def test_cells_lie_within_all_images():
    fine = xr.Dataset(coords={"x": 0.05 * np.arange(200)})
    coarse = xr.Dataset(coords={"x": 0.1 * np.arange(90)})
    edges = cell_edges([fine, coarse], "x")
    npt.assert_allclose(np.diff(edges), 0.8)
    assert edges[0] >= -0.05
    assert edges[-1] <= 8.95 + 1e-9


def test_an_image_whose_rows_run_upwards_has_the_same_cells():
    film = noisy_map(5.0, 0.1, np.random.default_rng(8))
    turned = film.isel(y=slice(None, None, -1), x=slice(None, None, -1))
    npt.assert_allclose(cell_edges([turned], "y"), cell_edges([film], "y"))
    npt.assert_allclose(cells_of(turned).film, cells_of(film).film)
    with pytest.raises(ErlifError, match="share 2 cells"):
        cell_edges([film.isel(x=[3])], "x")


def test_images_of_two_pixel_pitches_give_the_same_cells():
    rng = np.random.default_rng(6)
    maps = [noisy_map(5.0, 0.02, rng, pitch=pitch, shape=(80, 96)) for pitch in (0.1, 0.05)]
    edges = {axis: cell_edges(maps, axis) for axis in ("x", "y")}
    found = [average_cells(each, 0, example_calibration(), edges) for each in maps]
    assert found[1].count[1, 1] == 4 * found[0].count[1, 1] == 256
    npt.assert_allclose(found[0].film, found[1].film, atol=0.02)


def test_a_cell_with_few_valid_pixels_has_no_film():
    film = noisy_map(5.0, 0.02, np.random.default_rng(7))
    film.thickness.values[0, :7, :8] = np.nan
    cells = cells_of(film)
    assert np.isnan(cells.film[0, 0])
    assert np.isfinite(cells.film[0, 1])


def test_correlated_neighbours_enlarge_the_error_of_a_mean():
    rng = np.random.default_rng(8)
    white = rng.standard_normal((300, 301))
    half = (white[:, 1:] + white[:, :-1]) / np.sqrt(2)  # correlation 0.5 with either neighbour
    assert noise_inflation(half, np.ones_like(half)) == pytest.approx(2.0, abs=0.15)
