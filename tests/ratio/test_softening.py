"""The blur of the sharper camera: Gaussian responses and noise in closed form, and plain loops."""

import numpy as np
import numpy.testing as npt
import pytest
from scenes import plain
from scenes.pair import aligned_frames
from scipy import ndimage

from erlif.ratio import BlurDifference, compute_ratio
from erlif.ratio.softening import FARTHEST, Softening, gaussian_taps, soften

SHAPE = (40, 56)


def known(x, y):
    """A difference that is significant."""
    return BlurDifference(x, y, 1e-3, 1e-3)


@pytest.mark.parametrize("half_variance", [0.02, 0.12, 0.28, 0.4, 0.9, 1.6])
def test_response_is_that_of_a_gaussian(half_variance):
    taps = gaussian_taps(half_variance)
    place = np.arange(taps.size) - taps.size // 2
    for k in np.linspace(0, 1.5, 16):
        npt.assert_allclose(
            taps @ np.cos(k * place), np.exp(-half_variance * k**2), rtol=0, atol=0.012
        )
    assert taps.size // 2 <= FARTHEST
    npt.assert_allclose(taps, taps[::-1], rtol=1e-12)


def test_a_camera_is_blurred_along_the_axes_on_which_it_is_sharper():
    one, two = Softening.of(known(0.2, -0.1)).taps
    npt.assert_array_equal([one[0], two[1]], [gaussian_taps(0.2), gaussian_taps(0.1)])
    npt.assert_array_equal(one[1], two[0])
    npt.assert_array_equal(one[1], [0, 0, 1, 0, 0])


def test_a_difference_that_is_not_significant_leaves_both_cameras_as_they_are():
    softening = Softening.of(BlurDifference(0.02, 0.01, 0.01, 0.01))
    assert softening.reach == 0
    assert softening.factors == (1.0, 1.0)


def test_a_difference_beyond_the_largest_is_removed_in_part():
    npt.assert_array_equal(gaussian_taps(7.0), gaussian_taps(1.6))


@pytest.mark.parametrize("blur", [known(0.28, 0.12), known(-0.4, -0.05), known(0.2, -0.7)])
def test_variances_are_those_of_white_noise(blur):
    """Camera 2 was interpolated by scipy's splines, over the positions between two pixels."""
    rng = np.random.default_rng(5)
    softening, noise = Softening.of(blur), rng.standard_normal((16, 256, 256))
    none = np.zeros(noise.shape[1:])
    one = np.mean([soften(image, none, softening.taps[0]).var() for image in noise])
    npt.assert_allclose(softening.factors[0], one, rtol=0.01)

    places = rng.uniform(size=(len(noise), 2))
    seen = [
        ndimage.shift(image, at, order=3, mode="grid-wrap")
        for image, at in zip(noise, places, strict=True)
    ]
    before = np.mean([image.var() for image in seen])
    after = np.mean([soften(image, none, softening.taps[1]).var() for image in seen])
    npt.assert_allclose(softening.factors[1], after / before, rtol=0.05)


@pytest.mark.parametrize("blur", [known(0.28, 0.12), known(0.2, -0.7), known(1.7, 0.1)])
def test_flagged_pixels_enter_no_other(blur):
    """As the plain loops have it, and whatever is read there; NaN stays where it was."""
    rng = np.random.default_rng(6)
    light = rng.uniform(500, 1500, SHAPE).astype(np.float32)
    flags = np.where(rng.uniform(size=SHAPE) < 0.1, 8, 0).astype(np.uint16)
    other = np.where(flags == 0, light, np.float32(np.nan))
    for taps in Softening.of(blur).taps:
        found = soften(light, flags, taps)
        npt.assert_allclose(found, plain.soften(light, flags, taps), rtol=1e-6)
        again = soften(other, flags, taps)
        npt.assert_array_equal(again[flags == 0], found[flags == 0])
        assert np.isnan(again[flags != 0]).all()


@pytest.mark.parametrize("sign", [1, -1])
def test_scatter_of_blurred_light_is_its_standard_deviation(sign):
    """Even light with photon noise, pixel on pixel: 68.3 and 95.4 % within one and two."""
    rng = np.random.default_rng(7)
    signal = rng.poisson(4000.0, (2, 1, 256, 256)).astype(float)
    blur = known(sign * 0.28, sign * 0.12)
    ratios = compute_ratio(aligned_frames(signal, signal), blur=blur)
    pull = np.abs(ratios.log_ratio.values) / np.sqrt(ratios.log_ratio_var.values)
    npt.assert_allclose([np.mean(pull < 1), np.mean(pull < 2)], [0.683, 0.954], atol=0.02)

    # of a mean over the image nothing is averaged but independent pixels
    mean = ratios.log_ratio_var.values.mean() * float(ratios.noise_correlation[0])
    npt.assert_allclose(mean, 2 / 4000, rtol=0.05)
