"""Difference maps of films whose difference is known."""

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr

from erlif.core.errors import ErlifError
from erlif.review.comparison import difference_map
from erlif.review.comparison.maps import average_cells, cell_edges, noise_inflation
from erlif.show.plots import example_calibration


def with_noise(film, seed, thicker=0.0):
    """The film with new noise of 0.05 um, and a step in its right half."""
    rng = np.random.default_rng(seed)
    smooth = 3.0 + np.zeros(film.thickness.shape)
    smooth[..., 32:] += thicker
    noisy = smooth + 0.05 * rng.standard_normal(smooth.shape)
    values = np.where(film.flags.values == 0, noisy, np.nan).astype(np.float32)
    return film.assign(thickness=(film.thickness.dims, values, film.thickness.attrs))


def test_a_step_is_found_where_it_is_and_with_its_size(film):
    false, stated = 0, 0
    for n in range(20):
        pair = with_noise(film, 2 * n), with_noise(film, 2 * n + 1, 0.2)
        found = difference_map(*pair, triggers=(0, 0))
        right = found.x.values > film.x.values[31]
        npt.assert_allclose(found.difference.values[:, right], 0.2, atol=0.06)
        assert (found.differs.values[:, right] == 1).all()
        false += int(found.differs.values[:, ~right].sum())
        stated += int(found.differs.values.sum())
    # 5 % of the cells stated to differ may be false, here with three binomial standard deviations
    assert false / stated < 0.05 + 3 * np.sqrt(0.05 / stated)


def test_the_scatter_of_equal_films_is_as_stated(film):
    pulls = np.concatenate(
        [
            difference_map(
                with_noise(film, 2 * n), with_noise(film, 2 * n + 1), triggers=(0, 0)
            ).significance.values.ravel()
            for n in range(15)
        ]
    )
    pulls = pulls[np.isfinite(pulls)]
    assert 0.65 < (np.abs(pulls) < 1).mean() < 0.85  # the stated error has a part of registration
    assert (np.abs(pulls) < 1.96).mean() > 0.94


def test_two_calibrations_add_their_errors(film):
    other = film.assign_attrs(calibration=film.attrs["calibration"].replace("wedge", "wedge 2"))
    assert other.attrs["calibration"] != film.attrs["calibration"]
    same = difference_map(film, film, triggers=(0, 1))
    apart = difference_map(film, other, triggers=(0, 1))
    assert (same.attrs["same_calibration"], apart.attrs["same_calibration"]) == (1, 0)
    known = np.isfinite(same.difference_std.values)
    assert (apart.difference_std.values[known] > same.difference_std.values[known]).all()


def test_images_that_lie_along_other_axes_are_refused(film):
    turned = film.attrs["settings"].replace('x_axis = "sliding"', 'x_axis = "axial"')
    with pytest.raises(ErlifError, match="x_axis in"):
        difference_map(film, film.assign_attrs(settings=turned), triggers=(0, 0))


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
    edges = {f"{axis}_edges": cell_edges([film], axis) for axis in ("x", "y")}
    return average_cells(film, 0, example_calibration(), **edges)


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
    edges = {f"{axis}_edges": cell_edges(maps, axis) for axis in ("x", "y")}
    found = [average_cells(each, 0, example_calibration(), **edges) for each in maps]
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
