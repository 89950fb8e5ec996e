"""Limits of detection: measured films are unbiased, however large the noise of a pixel."""

import numpy as np
import numpy.testing as npt
import pytest
from scenes.fixture import log_ratio
from scenes.gap import known_calibration
from scenes.pair import ratio_images

from erlif.core.flags import Flag
from erlif.thickness import CLEAR, measure_thickness

SHAPE = (400, 600)


@pytest.fixture(scope="module")
def calibration():
    """Without error, calibrated up to 12 um, covered up to 18 um."""
    return known_calibration(valid=(0.1, 12.0), thickest=18.0, covariance=1e-14 * np.eye(3))


RAMP = np.linspace(0.5, 13.0, SHAPE[1]) * np.ones(SHAPE)


@pytest.mark.parametrize("noise", [0.0135, 0.025, 0.045], ids=["full light", "a third", "a tenth"])
def test_error_bars_cover_up_to_the_limits(calibration, noise):
    """A ramp through both limits: 66-70 and 94.5-96.5 % in each measurable octave, and no bias."""
    scatter = noise * np.random.default_rng(0).standard_normal(SHAPE)
    maps = measure_thickness(ratio_images(log_ratio(RAMP[0]) + scatter, noise**2), calibration)
    valid = maps.flags.values == 0
    error = (maps.thickness.values - RAMP)[valid]
    pull = error / maps.thickness_std.values[valid]
    film = RAMP[valid]
    seen = 0
    for low, high in ((1, 2), (2, 4), (4, 8), (8, 12)):
        here = (film >= low) & (film < high)
        if here.sum() < 3000:
            continue
        seen += 1
        assert 0.66 <= np.mean(np.abs(pull[here]) < 1) <= 0.70
        assert 0.945 <= np.mean(np.abs(pull[here]) < 2) <= 0.965
        assert abs(error[here].mean()) < 0.5 * maps.thickness_std.values[valid][here].mean()
    assert seen >= 2


def test_the_range_of_a_pixel_does_not_depend_on_its_own_value(calibration):
    """A pixel far too bright or far too dim in even surroundings: it is measurable by them."""
    for own in (-1.0, 1.0):
        image = uniform(5.0)
        image[20, 20] += own
        assert np.isfinite(measure_thickness(ratio_images(image), calibration).log_ratio_near).all()


def uniform(film, shape=(40, 40)):
    return np.full(shape, log_ratio(film), np.float32)


def test_flagged_pixels_do_not_affect_the_range_of_others(calibration):
    image, flags = uniform(5.0), np.zeros((40, 40), np.uint16)
    image[10:14], flags[10:14] = -3.0, Flag.NO_FILM
    maps = measure_thickness(ratio_images(image, flags=flags), calibration)
    npt.assert_array_equal(maps.flags, flags)
    npt.assert_allclose(maps.log_ratio_near, np.where(flags == 0, uniform(5.0), np.nan), rtol=1e-5)


@pytest.mark.parametrize(("factor", "expected"), [(0.9, 0), (1.1, int(Flag.BELOW_RANGE))])
def test_the_margin_is_two_standard_deviations_of_a_pixel(calibration, factor, expected):
    """0.5 um, and noise for which the end of the curve lies 0.9 or 1.1 margins away."""
    image = uniform(0.5)
    std = factor * (image[0, 0] - log_ratio(0.1)) / CLEAR
    maps = measure_thickness(ratio_images(image, std**2), calibration)
    npt.assert_array_equal(maps["flags"], expected)
