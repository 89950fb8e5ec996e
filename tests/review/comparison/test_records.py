"""What a comparison takes from a film, and what it refuses."""

import json
from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest

from erlif.core.errors import ErlifError
from erlif.review.comparison import read_run, refuse_unlike


def test_the_parts_of_the_error_add_up(film):
    record = read_run(film.assign(film_min_std=film.film_min_std * 5))
    covariance = record.errors.curve.full_covariance
    gradient = record.gradient["film_min"]
    shared = np.einsum("ti,ij,tj->t", gradient, covariance, gradient)
    npt.assert_allclose(record.own_std["film_min"] ** 2 + shared, 0.15**2)


def test_an_error_is_never_that_of_the_calibration_alone(film):
    record = read_run(film.assign(film_min_std=film.film_min_std * 0.1))
    npt.assert_allclose(record.own_std["film_min"], 0.1 * 0.003)


def test_noise_of_the_mean_is_that_of_its_pixels(film, record):
    # 0.05 um in each of the valid pixels of the region, 49 x 17 less those without oil
    region = (film.x >= 2) & (film.x <= 14) & (film.y >= 1) & (film.y <= 5)
    pixels = int(((film.flags[0] == 0) & region).sum())
    mean_noise = record.own_std["film_mean"]
    assert mean_noise[0] >= 0.05 / np.sqrt(pixels) * 0.99


def test_a_mean_over_a_part_of_the_region_is_not_compared(film):
    shares = [0.0, 0.3, 0.0, 0.0, 0.01, 0.0]
    partly = film.drop_vars("share_beyond_range", errors="ignore")
    partly = partly.assign(share_beyond_range=("trigger", shares))
    assert np.isnan(read_run(partly).value["film_mean"]).tolist() == [False, True] + 4 * [False]


def test_what_cannot_be_compared_is_refused_in_one_message(film, record):
    with pytest.raises(ErlifError, match="two films or more; got 1"):
        refuse_unlike([record])
    twice = film.assign_attrs(input_hashes=json.dumps({"camera1/*.tif": "a"}))
    with pytest.raises(ErlifError, match="made from the same frames"):
        refuse_unlike([read_run(twice), read_run(twice)])
    with pytest.raises(ErlifError, match="made from the same frames"):
        refuse_unlike([replace(record, identity="5a")] * 2)
    longer = film.assign_attrs(settings=film.attrs["settings"].replace("26 cm", "24 cm"))
    with pytest.raises(ErlifError, match=r"one mechanism; example has crank-rocker \(crank 55 mm"):
        refuse_unlike([record, read_run(longer)])
    faster = film.assign_attrs(settings=film.attrs["settings"].replace("114 rpm", "60 rpm"))
    refuse_unlike([record, read_run(faster)])
    with pytest.raises(ErlifError, match="crank angles in all films or in none"):
        refuse_unlike([record, replace(record, by_angle=False)])
