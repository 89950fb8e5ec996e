"""Films of earlier versions have today's variables."""

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr

from erlif.io.files.older import renew_film


def old_film(**attrs):
    """Three triggers, with lists in the attributes of their variables."""
    return xr.Dataset(
        {
            "film_mean": ("trigger", np.ones(3), {"share_beyond_range": [0.0, 0.1, 0.2], **attrs}),
            "film_curvature": ("trigger", np.ones(3), {"expected": np.array([0.3, 0.4, 0.5])}),
            "film_regime_map": ("trigger", np.ones(3), {"regimes_by_trigger": "rigid soft rigid"}),
        }
    )


def test_lists_in_attributes_become_variables():
    film = renew_film(old_film())
    npt.assert_allclose(film.share_beyond_range, [0.0, 0.1, 0.2])
    npt.assert_allclose(film.film_curvature_expected, [0.3, 0.4, 0.5])
    assert film.film_regime.values.tolist() == ["rigid", "soft", "rigid"]


@pytest.mark.parametrize("shares", [[0.1], "none", np.zeros((3, 2))])
def test_a_list_of_another_length_or_kind_is_refused(shares):
    with pytest.raises(ValueError, match="share_beyond_range"):
        renew_film(old_film(share_beyond_range=shares))


def test_a_curvature_without_that_of_circles_is_refused():
    film = xr.Dataset({"film_curvature": ("trigger", np.ones(3))})
    with pytest.raises(ValueError, match="film_curvature_expected"):
        renew_film(film)


def test_variables_of_today_stay():
    film = old_film().assign(share_beyond_range=("trigger", [0.7, 0.8, 0.9]))
    npt.assert_allclose(renew_film(film).share_beyond_range, [0.7, 0.8, 0.9])


def test_a_single_trigger_may_hold_a_bare_number():
    """netCDF gives back a list of one value as a number."""
    film = xr.Dataset({"film_mean": ("trigger", [4.0], {"share_beyond_range": 0.3})})
    npt.assert_allclose(renew_film(film).share_beyond_range, [0.3])
