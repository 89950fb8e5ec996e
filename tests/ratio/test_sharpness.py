"""The difference of sharpness, on textures whose blur is known in closed form."""

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr
from scenes.pair import aligned_frames

from erlif.core.products import AlignedFrames
from erlif.ratio import BlurDifference, BlurMoments, compute_ratio, measure_blur

SHAPE = (200, 240)
GAIN = 4.4


def measure_blur_difference(pair):
    """The difference that aligned frames show."""
    moments = BlurMoments.empty()
    moments.add(pair)
    return moments.solve()


def waves(rng, count=60):
    """Wave vectors [rad/px], phases and amplitudes of a texture of 9 % contrast."""
    length, angle = rng.uniform(0.5, 1.4, count), rng.uniform(0, np.pi, count)
    return (
        length * np.cos(angle),
        length * np.sin(angle),
        rng.uniform(0, 2 * np.pi, count),
        0.09 * np.sqrt(2 / count),
    )


def scene(texture, variance_x, variance_y):
    """Exponential of waves, each weakened by the Gaussian blur: exp(-k^2 s^2/2)."""
    y, x = np.indices(SHAPE)
    kx, ky, phase, amplitude = texture
    weight = amplitude * np.exp(-(kx**2 * variance_x + ky**2 * variance_y) / 2)
    waves = zip(weight, kx, ky, phase, strict=True)
    return np.exp(sum(w * np.sin(a * x + b * y + c) for w, a, b, c in waves))


def frames(one, two, rng, *, level=1500.0, noise=True):
    """Aligned frames (one frame) with photon noise in both cameras."""
    electrons = level * GAIN * np.stack([one, two])[:, None]
    signal = (rng.poisson(electrons) if noise else electrons) / GAIN
    return aligned_frames(signal, signal / GAIN * noise)


def test_blur_difference_is_half_the_difference_of_the_variances():
    """Camera 2 is blurred by 0.06 and 0.02 px2 more; in long waves the first order holds."""
    rng = np.random.default_rng(1)
    kx, ky, phase, amplitude = waves(rng)
    texture = (0.35 * kx, 0.35 * ky, phase, amplitude)
    pair = frames(scene(texture, 0, 0), scene(texture, 0.06, 0.02), rng, noise=False)
    found = measure_blur_difference(pair)
    npt.assert_allclose([found.x, found.y], [0.03, 0.01], rtol=0.08)


@pytest.mark.parametrize(("x", "y"), [(0.28, 0.28), (-0.28, -0.12), (0.1, -0.42)])
def test_large_differences_are_measured_as_well(x, y):
    """The softer camera is blurred by up to 0.84 px2 more; six noisy pairs."""
    rng = np.random.default_rng(11)
    pairs = []
    for _ in range(6):
        texture = waves(rng)
        one = scene(texture, 2 * max(-x, 0), 2 * max(-y, 0))
        two = scene(texture, 2 * max(x, 0), 2 * max(y, 0))
        pairs.append(frames(one, two, rng, level=600))
    found = measure_blur(pairs)
    npt.assert_allclose([found.x, found.y], [x, y], rtol=0.03, atol=3 * found.std_x)
    assert found.std_x < 0.01


def test_noise_causes_no_blur_difference():
    """Twelve pairs of equally sharp, noisy images: differences within their standard deviations."""
    rng = np.random.default_rng(2)
    pulls = []
    for _ in range(12):
        image = scene(waves(rng), 0.25, 0.25)
        found = measure_blur_difference(frames(image, image, rng, level=400))
        pulls += [found.x / found.std_x, found.y / found.std_y]
    assert abs(np.mean(pulls)) < 4 * np.std(pulls) / np.sqrt(len(pulls)) + 0.1
    assert np.std(pulls) < 1.3


@pytest.mark.parametrize("variance", [0.08, 0.56])
def test_speckle_is_removed_from_the_ratio(variance):
    rng = np.random.default_rng(3)
    texture = waves(rng)
    one, two = scene(texture, 0.25, 0.25), scene(texture, 0.25 + variance, 0.25 + variance)
    clean = frames(one, two, rng, noise=False)
    blur = measure_blur([frames(one, two, rng)])
    inside = (0, slice(4, -4), slice(4, -4))
    before = compute_ratio(clean).log_ratio.values[inside].std()
    after = compute_ratio(clean, blur=blur).log_ratio.values[inside].std()
    assert blur.significant
    assert after < 0.1 * before


def test_without_texture_the_ratio_is_not_changed():
    rng = np.random.default_rng(4)
    flat = np.ones(SHAPE)
    pair = frames(flat, flat, rng)
    blur = measure_blur([pair])
    assert not blur.significant
    for each in (blur, BlurDifference()):
        found = compute_ratio(pair, blur=each).log_ratio
        npt.assert_array_equal(found, compute_ratio(pair).log_ratio)


def test_moments_of_several_frames_are_added():
    rng = np.random.default_rng(7)
    texture = waves(rng)
    pairs = [frames(scene(texture, 0, 0), scene(texture, 0.1, 0.1), rng) for _ in range(2)]
    moments = BlurMoments.empty()
    for pair in pairs:
        moments.add(pair)
    frames_together = AlignedFrames(xr.concat(pairs, "frame", data_vars="minimal"))
    together = measure_blur_difference(frames_together)
    npt.assert_allclose(moments.solve().x, together.x, rtol=1e-9)
    single = measure_blur_difference(pairs[0])
    npt.assert_allclose(together.std_x, single.std_x / np.sqrt(2), rtol=0.1)
