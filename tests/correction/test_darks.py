"""Darks of cameras whose level, noise and defects are known."""

import numpy as np
import numpy.testing as npt
import pytest
from scipy.stats import chi2, norm

from erlif.core.errors import FrameError
from erlif.correction import (
    DeclaredNoise,
    count_pixels,
    declare_darks,
    make_references,
    measure_camera,
    reduce_background,
    reduce_darks,
)

SHAPE = (72, 80)


def even_pages(count, level=64):
    return [np.full(SHAPE, level, np.uint16) for _ in range(count)]


def test_level_and_noise_are_those_of_the_camera(simulated):
    camera = simulated()
    darks = reduce_darks(camera.darks(16, np.random.default_rng(1)))
    assert darks.pages == 16
    assert abs(darks.temporal_var - camera.temporal_var) < 4 * darks.temporal_var_std
    # 16 pages of 5760 pixels: sqrt(2/(15 x 5760)) = 0.48 % of the variance
    npt.assert_allclose(darks.temporal_var_std / camera.temporal_var, 0.0048, rtol=0.02)
    npt.assert_allclose(darks.mean_var, darks.temporal_var / 16, rtol=1e-12)
    assert abs(darks.level - 64) < 4 * np.sqrt(camera.temporal_var / (16 * 5760))


@pytest.mark.parametrize("pages", [2, 3, 10])
def test_noise_of_many_cameras_scatters_by_its_standard_deviation(simulated, check_coverage, pages):
    rng = np.random.default_rng(pages)
    camera = simulated(shape=(24, 32))
    pulls = []
    for _ in range(60):
        darks = reduce_darks(camera.darks(pages, rng))
        pulls.append((darks.temporal_var - camera.temporal_var) / darks.temporal_var_std)
    # of 60, 3.5 binomial standard deviations are 21 % at one sigma and 9 % at two
    check_coverage(pulls)
    assert abs(np.mean(pulls)) < 4 / np.sqrt(60)


def test_a_level_that_drifts_from_page_to_page_is_less_certain(simulated):
    """A drift of 2 DN from page to page: with 16 pages the mean level is known to 0.5 DN."""
    rng = np.random.default_rng(3)
    camera = simulated(shape=(24, 32))
    levels, stds = [], []
    for _ in range(120):
        pages = [page + rng.normal(0, 2) for page in camera.darks(16, rng)]
        darks = reduce_darks(pages)
        levels.append(darks.level)
        stds.append(darks.level_std)
    # a standard deviation of 16 values is known to 18 %, the mean of 120 of them to 2 %
    npt.assert_allclose(np.mean(stds), 0.5, rtol=0.06)
    # that of 120 levels is known to 6.5 %
    npt.assert_allclose(np.std(levels), 0.5, rtol=0.23)


def test_a_fixed_pattern_is_measured_without_the_noise(simulated):
    rng = np.random.default_rng(5)
    camera = simulated(read_noise=20.0)
    pattern = rng.normal(0, 1.5, SHAPE)
    darks = reduce_darks([page + pattern for page in camera.darks(8, rng)])
    # 5760 pixels fix a spread to 0.9 %; with the noise of the mean left in it would be 2.2 DN
    npt.assert_allclose(darks.spread, pattern.std(), rtol=0.05)
    even = reduce_darks(camera.darks(8, rng))
    assert even.spread**2 < 4 * camera.temporal_var / 8 * np.sqrt(2 / 5760)


@pytest.mark.parametrize("sigma", [0.3, 0.4, 0.45])
def test_two_pages_of_a_quiet_camera_have_few_noisy_pixels(sigma):
    """Most pixels read the same count twice, and the median of their variances is zero."""
    found, bad = [], 0
    for seed in range(4):
        rng = np.random.default_rng(seed)
        darks = reduce_darks([np.rint(rng.normal(64, sigma, SHAPE)) for _ in range(2)])
        found.append(darks.temporal_var)
        bad += int(darks.bad.sum())
    assert bad < 5e-4 * len(found) * np.prod(SHAPE)
    # the variance of a normal variate rounded to whole counts; 4 x 5760 pairs fix it to 1.6 %
    counts = np.arange(-8, 9)
    expected = (counts**2 * np.diff(norm.cdf(np.arange(-8.5, 9), scale=sigma))).sum()
    npt.assert_allclose(np.mean(found), expected, rtol=0.05)


def test_one_page_has_no_variance_and_none_is_refused():
    darks = reduce_darks(even_pages(1))
    assert (darks.pages, darks.mean_var, darks.temporal_var) == (1, 0, None)
    assert np.isnan([darks.level_std, darks.spread]).all()
    with pytest.raises(FrameError, match="at least one dark page"):
        reduce_darks([])


@pytest.mark.parametrize(("excess", "hot"), [(8, False), (9, True), (-8, False), (-9, True)])
@pytest.mark.parametrize("pages", [1, 3])
def test_a_pixel_of_a_quiet_camera_is_hot_beyond_8_counts(pages, excess, hot):
    images = even_pages(pages)
    for image in images:
        image[30, 40] = 64 + excess
    darks = reduce_darks(images)
    assert darks.bad[30, 40] == hot
    assert darks.bad.sum() == int(hot)


def test_the_level_is_that_of_the_good_pixels(simulated):
    camera = simulated(hot=((10, 12), (50, 3)))
    taken = camera.darks(16, np.random.default_rng(7))
    darks = reduce_darks(taken)
    assert np.argwhere(darks.bad).tolist() == [[10, 12], [50, 3]]
    # with its two hot pixels it would be 0.14 DN higher
    assert abs(darks.level - 64) < 0.03
    assert darks.spread < 0.1

    # glow of the amplifier makes no pixel hot
    y, x = np.indices(SHAPE)
    glow = 200 * np.exp(-(x**2 + y**2) / 30.0**2)
    glowing = reduce_darks(page + glow for page in taken)
    npt.assert_array_equal(glowing.bad, darks.bad)


@pytest.mark.parametrize("amplitude", [1.0, 20.0])
@pytest.mark.parametrize("pages", [4, 16])
@pytest.mark.parametrize(("share", "noisy"), [(0.97, False), (1.03, True)])
def test_the_limit_for_noisy_pixels_is_a_chance_of_1e_7(amplitude, pages, share, noisy):
    """All pixels have one variance, which is the median of a chi-square of n - 1 degrees.

    The pages swing about 1000 DN: the variance of a pixel is amplitude^2 n/(n - 1). One count
    squared is added, which matters for a quiet camera.
    """
    freedom = pages - 1
    variance = amplitude**2 * pages / freedom
    typical = variance * freedom / chi2.ppf(0.5, freedom)
    limit = typical * chi2.isf(1e-7, freedom) / freedom + 1
    swing = np.full(SHAPE, amplitude)
    swing[30, 40] = amplitude * np.sqrt(share * limit / variance)
    darks = reduce_darks(1000.0 + sign * swing for sign in np.resize([1, -1], pages))
    assert darks.bad[30, 40] == noisy
    assert darks.bad.sum() == int(noisy)


def test_mean_light_and_its_share_of_the_light_of_the_run(simulated):
    camera = simulated(shape=(60, 64))
    rng = np.random.default_rng(4)
    darks = reduce_darks(camera.darks(16, rng))
    run = count_pixels(camera.expose(8000, rng), 4095)
    dry = [camera.expose(240, rng) for _ in range(16)]
    found = reduce_background(dry, darks=darks, histogram=run, camera="camera1")
    assert found.pages == 16
    noise = np.sqrt((240 + 2 * 81) / 16 / found.light.size)
    npt.assert_allclose(4.4 * found.light.mean(), 240, atol=5 * noise)
    assert found.share == pytest.approx(0.03, abs=0.002)
    assert reduce_background([], darks=darks, histogram=run, camera="camera1") is None


def test_frames_of_a_film_are_refused_as_background(simulated):
    camera = simulated(shape=(60, 64))
    rng = np.random.default_rng(5)
    run = count_pixels(camera.expose(8000, rng), 4095)
    darks, page = declare_darks(64.0, camera.shape), camera.expose(8000, rng)
    with pytest.raises(FrameError, match=r"camera2 .*dry .*100%"):
        reduce_background([page], darks=darks, histogram=run, camera="camera2")


def test_references_hold_the_background_with_the_variance_of_its_mean(simulated):
    """One camera alone was recorded dry: the other one has a background of zero."""
    camera = simulated(shape=(60, 64))
    rng = np.random.default_rng(6)
    histogram = count_pixels(camera.expose(8000, rng), 4095)
    both = {"darks": 64.0, "flats": (), "histogram": histogram, "shape": camera.shape}
    measured = [
        measure_camera(**both, camera="camera1", background=dry)
        for dry in ([camera.expose(400, rng) for _ in range(5)], ())
    ]
    found = make_references(measured, declared=[DeclaredNoise(4.4, 9.0)] * 2)
    light = found.references.background.values
    npt.assert_allclose(light[1], 0)
    variance = found.references.background_var.values
    npt.assert_allclose(variance[0].mean(), (400 / 4.4**2 + camera.temporal_var) / 5, rtol=0.03)
    npt.assert_allclose(light[0].var(), variance[0].mean(), rtol=4 * np.sqrt(2 / 3840))
    assert any("5 frames of the dry joint" in str(note) for note in found.notes)
