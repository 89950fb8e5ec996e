"""Films beyond the maximum of the ratio, on the virtual rig with a wall that reflects."""

from dataclasses import replace

import numpy as np
import pytest
import scipy
from scenes.rig import small_rig

import erlif
from conftest import Laboratory
from erlif.core.flags import Flag
from erlif.show.plots import example_calibration
from erlif.thickness import flag_beyond_maximum

pytestmark = pytest.mark.usefixtures("without_theory")

RIG = small_rig(
    width=256, field_width=28.0, film_reference=6.0, wall=(0.6, 0.6), dark_pages=4, flat_pages=3
)
"""Films of 4 um in the middle of the image to 28 um at its ends; no ratio exceeds that of 12 um."""

REFLECTING = replace(
    example_calibration(),
    attenuation_laser=0.2,
    reflectance=0.3,
    covariance=1e-6 * np.eye(5),
    thickness_range=(0.5, 12.0),
)
"""Its ratio is highest at 13.6 um; a film without end has that of 6.8 um."""


def test_films_beyond_the_maximum_are_not_taken_for_thin_ones(tmp_path):
    """Without their surroundings, 87 % of those of 18 to 22 um would be 12 um too thin."""
    lab = Laboratory.simulated(tmp_path, seed=61, rig=RIG)
    film = erlif.process(lab.run, workers=1)
    true, measured = lab.truth.film.values, np.isfinite(film.thickness.values)
    beyond = true > 15
    assert beyond.mean() > 0.2
    assert measured[beyond].mean() < 0.02
    thin = true < 8
    assert measured[thin].mean() > 0.85
    assert abs(np.median((film.thickness.values - true)[measured & thin])) < 0.1


@pytest.mark.parametrize("film", [np.linspace(1, 30, 320), np.r_[1:30:160j, 30:1:160j]])
def test_a_black_wall_has_no_maximum(film):
    calibration = example_calibration()
    image = np.tile(calibration.predict_log(film), (32, 1)).astype(np.float32)
    flags = np.where(np.arange(320) < 20, np.uint16(Flag.DIM), np.uint16(0)) * np.ones(
        (32, 1), np.uint8
    )
    before = flags.copy()
    flag_beyond_maximum(image, flags, calibration)
    np.testing.assert_array_equal(flags, before)


def test_a_larger_part_beyond_the_maximum_is_not_taken_for_the_thin_one():
    """A ball on a disc: 3 um in the middle, 47 um in the median, of the ratio of 7 um."""
    y, x = np.indices((256, 320))
    film = 3.0 + ((x - 150) ** 2 + (y - 120) ** 2) / 350.0
    flags = np.zeros(film.shape, np.uint16)
    ratio = REFLECTING.predict_log(film)
    ratio += 0.01 * np.random.default_rng(3).standard_normal(film.shape)
    flag_beyond_maximum(ratio.astype(np.float32), flags, REFLECTING)
    assert (film > 20).mean() > 0.7
    assert (flags[film > 20] == 0).mean() < 0.01
    assert (flags[film < 10] != 0).mean() < 0.05


def test_a_film_that_is_nowhere_thin_without_doubt_is_told_from_one_beyond():
    """A ball 7.5 um above its disc: a film without end has the ratio of 6.8 um."""
    y, x = np.indices((256, 320))
    film = 7.5 + ((x - 250) ** 2 + (y - 60) ** 2) / 600.0
    ratio = REFLECTING.predict_log(film)
    ratio += 0.01 * np.random.default_rng(4).standard_normal(film.shape)
    flags = np.zeros(film.shape, np.uint16)
    flag_beyond_maximum(ratio.astype(np.float32), flags, REFLECTING)
    assert (film > 20).mean() > 0.7
    assert (flags[film > 15] == 0).mean() < 0.01
    assert (flags[film < 10] != 0).mean() < 0.05


def test_an_uneven_wall_does_not_hide_films_beyond_the_maximum():
    """Before a texture of 3 % half of the films of 15 to 20 um have a ratio in the range."""
    y, x = np.indices((256, 320))
    film = 6.0 + (x - 140) ** 2 / 1300.0 + y / 256
    rng = np.random.default_rng(5)
    grains = scipy.ndimage.gaussian_filter(rng.standard_normal(film.shape), 11)
    ratio = REFLECTING.predict_log(film) + 0.03 * grains / grains.std()
    flags = np.zeros(film.shape, np.uint16)
    flag_beyond_maximum(ratio.astype(np.float32), flags, REFLECTING)
    assert (ratio[film > 15] < REFLECTING.predict_log(11.0)).mean() > 0.4
    assert (flags[film > 14] == 0).mean() < 0.02
    assert (flags[film < 9] != 0).mean() < 0.02


def test_two_thin_parts_with_a_ridge_between_them_are_both_thin():
    """Two balls side by side: each part has films without doubt thin."""
    y, x = np.indices((256, 320))
    near = np.minimum((x - 80) ** 2, (x - 250) ** 2)
    film = 3.0 + (near + (y - 128) ** 2) / 350.0
    flags = np.zeros(film.shape, np.uint16)
    flag_beyond_maximum(REFLECTING.predict_log(film).astype(np.float32), flags, REFLECTING)
    assert (flags[film < 10] != 0).mean() < 0.05
    assert (flags[film > 20] == 0).mean() < 0.01
