"""The excess of the mean log ratio, on speckle drawn with numpy and interpolated with scipy."""

import numpy as np
import numpy.testing as npt
import pytest
from scenes.pair import aligned_frames
from scipy import ndimage

from erlif.core.errors import ErlifError
from erlif.core.products import AlignedFrames
from erlif.ratio import BlurDifference, ExcessSums, compute_ratio, measure_blur

SIZE, FINE = 256, 4
"""Pixels of an image, and points of the light per pixel."""

GAIN, READ = 4.4, 9.0
RATIO = 0.8


def speckle(rng, contrast, *, size=0.72):
    """Positive light with Gaussian correlation, sampled at the pixels and at (0.5, 0.25) px."""
    noise = rng.standard_normal((SIZE * FINE, SIZE * FINE))
    grains = ndimage.gaussian_filter(noise, size * FINE, mode="wrap")
    light = np.maximum(1 + contrast * grains / grains.std(), 0.02)
    return light[::FINE, ::FINE], light[2::FINE, 1::FINE]


def photograph(rng, one, two, *, level=1000.0, shifted=True):
    """Frames whose camera 2, interpolated onto the pixels of camera 1, has 0.8 of its light."""
    light = level * np.stack([one, RATIO * two])
    signal = (rng.poisson(GAIN * light) + rng.normal(0, READ, light.shape)) / GAIN
    variance = (GAIN * light + READ**2) / GAIN**2
    if shifted:
        weights = (
            ndimage.shift(np.eye(1, 41, 20)[0], 0.5),
            ndimage.shift(np.eye(1, 41, 20)[0], 0.25),
        )
        signal[1] = ndimage.shift(signal[1], (0.5, 0.25), order=3, mode="grid-wrap")
        variance[1] = ndimage.shift(light[1] / GAIN, (0.5, 0.25), mode="grid-wrap")
        variance[1] = (variance[1] + (READ / GAIN) ** 2) * np.prod([w @ w for w in weights])
    return aligned_frames(signal[:, None], variance[:, None])


def measure(frames):
    """Difference of sharpness with its excess, as the pipeline finds it."""
    blur, sums = measure_blur([frames]), ExcessSums()
    sums.add(frames, compute_ratio(frames), compute_ratio(frames, blur=blur))
    excess, std = sums.solve()
    return BlurDifference(blur.x, blur.y, blur.std_x, blur.std_y, excess, std)


def mean_error(frames, blur):
    """Mean log ratio of the sound pixels less that of the light."""
    ratios = compute_ratio(frames, blur=blur)
    return float(ratios.log_ratio.values[ratios.flags.values == 0].mean() - np.log(RATIO))


def test_mean_ratio_of_interpolated_speckle_is_that_of_the_light():
    """Speckle of 35 %: without the correction the ratio is 0.3 to 0.6 % high."""
    rng = np.random.default_rng(31)
    errors = []
    for _ in range(6):
        frames = photograph(rng, *speckle(rng, 0.35))
        blur = measure(frames)
        blur_alone = BlurDifference(blur.x, blur.y, blur.std_x, blur.std_y)
        assert 0.003 < mean_error(frames, blur_alone) < 0.006
        assert blur.corrected_excess == blur.excess
        assert 0 < blur.excess_std < 3e-4
        errors.append(mean_error(frames, blur))
    assert abs(np.mean(errors)) < 3 * np.std(errors, ddof=1) / np.sqrt(6) + 5e-5
    assert np.max(np.abs(errors)) < 5e-4


def test_noise_of_equal_images_is_no_excess():
    """Twenty pairs of equal sharpness in dim light: errors within the standard deviations."""
    rng = np.random.default_rng(32)
    pulls = []
    for _ in range(20):
        one, _ = speckle(rng, 0.2)
        found = measure(photograph(rng, one, one, level=150.0, shifted=False))
        pulls.append(found.excess / found.excess_std)
    assert abs(np.mean(pulls)) < 4 * np.std(pulls) / np.sqrt(len(pulls)) + 0.1
    assert 0.6 < np.std(pulls) < 1.3


def test_a_film_that_brightens_both_cameras_is_no_excess():
    """Light that falls to a third across the image while the ratio rises by half."""
    across = np.linspace(0, 1, SIZE)
    light = np.stack([np.exp(-across), RATIO * np.exp(-0.6 * across)])[:, None, None]
    signal = 1000 * np.broadcast_to(light, (2, 1, SIZE, SIZE))
    frames = aligned_frames(signal, 0 * signal)
    npt.assert_allclose(measure(frames).excess, 0, atol=2e-6)


def test_without_pixels_there_is_no_excess():
    assert ExcessSums().solve() == (0.0, 0.0)
    rng = np.random.default_rng(33)
    frames = photograph(rng, *speckle(rng, 0.2))
    ratios = compute_ratio(frames)
    with pytest.raises(ErlifError, match="signal_var"):
        ExcessSums().add(AlignedFrames(frames.drop_vars("signal_var")), ratios, ratios)
