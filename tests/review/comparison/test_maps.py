"""Difference maps of films whose difference is known."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif.core.errors import ErlifError
from erlif.review.comparison import difference_map


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
