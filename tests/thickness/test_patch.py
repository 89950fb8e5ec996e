"""Means over a patch of known film."""

import numpy as np
import numpy.testing as npt

from erlif.thickness import NO_PATCH, sample_patch


def test_means_are_those_of_the_valid_pixels():
    rng = np.random.default_rng(1)
    light, ratio = rng.uniform(900, 1100, (20, 30)), rng.normal(0.4, 0.01, (20, 30))
    flags = (rng.uniform(size=light.shape) < 0.1).astype(np.uint16)
    found = sample_patch(light, ratio, np.full(light.shape, 2e-4), flags, noise_correlation=1.5)
    good = flags == 0
    npt.assert_allclose(np.exp(found.light), light[good].mean())
    npt.assert_allclose(found.log_ratio, ratio[good].mean())
    npt.assert_allclose(found.variance, 1.5 * 2e-4 / good.sum())


def test_too_few_valid_pixels_give_none():
    image = np.ones((8, 8))
    flags = np.zeros((8, 8), np.uint16)
    assert np.isfinite(sample_patch(image, image, image, flags).log_ratio)
    flags[0, 0] = 1
    npt.assert_array_equal(sample_patch(image, image, image, flags), NO_PATCH)
