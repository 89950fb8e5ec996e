"""Photon transfer and response against counts drawn from known electrons by numpy alone."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif.correction import (
    LightLevel,
    PageStack,
    PhotonTransfer,
    fit_photon_transfer,
    measure_response_spread,
    reduce_level,
)

SHAPE = (24, 32)


def level_of(pages):
    """The level of some pages, freed of the lamp's flicker."""
    made = PageStack(pages[0])
    for page in pages:
        made.add(page, scale=pages[0].mean() / page.mean())
    return reduce_level(made, np.ones(SHAPE, bool))


def record(camera, rng, *, pages, flicker, levels):
    """Levels of a flat, and the temporal variance of a dark with its standard deviation."""
    flats = np.array(camera.flats(levels, pages, rng, flicker=flicker)) - camera.offset
    points = [level_of(taken) for taken in flats.reshape(-1, pages, *SHAPE)]
    variance = np.var(camera.darks(8, rng), axis=0, ddof=1).mean()
    std = variance * np.sqrt(2 / (7 * np.prod(SHAPE)))
    return points, {"dark_variance": variance, "dark_variance_std": std}


@pytest.mark.parametrize(
    ("pages", "flicker", "known"),
    [(2, 0.0, True), (3, 0.02, True), (8, 0.005, True), (4, 0.01, False)],
)
def test_gain_of_many_cameras_scatters_by_its_standard_deviation(
    pages, flicker, known, simulated, check_coverage
):
    """The variance of the dark is known or fitted along; straight curves are not called bent."""
    rng = np.random.default_rng(pages)
    pulls, bends = [], []
    for _ in range(60):
        gain, read = rng.uniform(0.5, 20), rng.uniform(1.5, 30)
        camera = simulated(gain=gain, read_noise=read, offset=256, shape=SHAPE)
        levels = gain * rng.uniform([400, 1200, 2500], [800, 2000, 3500])
        points, dark = record(camera, rng, pages=pages, flicker=flicker, levels=levels)
        found = fit_photon_transfer(points, **(dark if known else {"dark_variance": None}))
        pulls.append((found.gain - gain) / found.gain_std)
        bends.append(found.bend / found.bend_std)
        assert not found.is_bent
    # of 60, 3.5 binomial standard deviations are 21 % at one sigma and 9 % at two
    for each in (pulls, bends) if known else (pulls,):
        check_coverage(each)
        assert abs(np.mean(each)) < 3.5 / np.sqrt(60)


def test_a_response_that_falls_short_bends_the_curve_three_times_as_much():
    """The response f = N (1 - e N/Nmax) bends the curve.

    Variance per light is f'^2 N/f = N (1 - 2 e u)^2/(1 - e u), to first order 1 - 3 e u.
    """
    rng = np.random.default_rng(13)
    top, short = 14000.0, 0.04

    def page(level):
        electrons = rng.poisson(level * np.ones(SHAPE)) + rng.normal(0, 9, SHAPE)
        return np.rint(electrons * (1 - short * electrons / top) / 4.4)

    bends, stds = [], []
    for _ in range(40):
        lights = (2000, 5000, 9000, top)
        points = [level_of([page(level) for _ in range(8)]) for level in lights]
        found = fit_photon_transfer(points, dark_variance=(9 / 4.4) ** 2 + 1 / 12)
        bends.append(found.bend)
        stds.append(found.bend_std)
    # the curve is not quite a parabola: its exact change is (1 - 2 e)^2/(1 - e) - 1 = -11.8 %
    npt.assert_allclose(np.mean(bends), (1 - 2 * short) ** 2 / (1 - short) - 1, atol=0.012)
    assert np.std(bends) < 1.3 * np.mean(stds)


def test_response_spread_is_that_of_the_pixels_without_lens_and_noise():
    rng = np.random.default_rng(17)
    shape = (128, 160)
    y, x = np.indices(shape)
    lens = 1 - 0.3 * ((x / 160 - 0.5) ** 2 + (y / 128 - 0.5) ** 2)
    flat_var = 0.006**2 * np.ones(shape)
    flat = lens * (1 + 0.01 * rng.standard_normal(shape)) + 0.006 * rng.standard_normal(shape)
    bad = rng.random(shape) < 1e-3
    flat[bad] = 0.05
    spread = measure_response_spread(flat, flat_var, bad)
    npt.assert_allclose(spread, 0.01, rtol=0.04)
    assert measure_response_spread(lens + 0.006 * rng.standard_normal(shape), flat_var, bad) < 0.003


def test_noise_above_the_spread_gives_zero_and_too_many_bad_pixels_give_nan():
    flat = 1 + 0.01 * np.random.default_rng(19).standard_normal((96, 96))
    none = np.zeros(flat.shape, bool)
    assert measure_response_spread(flat, np.full(flat.shape, 0.02**2), none) == 0
    bad = none.copy()
    bad[1::3, 1::3] = True  # every pixel is bad or has a bad neighbour
    assert np.isnan(measure_response_spread(flat, np.zeros(flat.shape), bad))


def levels_on_a_line(*, gain, dark, lights=(500.0, 1500.0, 3000.0), std=1.0, square=0.0, scale=1.0):
    return [
        LightLevel(light, scale * dark + light / gain + square * light**2, std, scale)
        for light in lights
    ]


@pytest.mark.parametrize("scale", [1.0, 1.3])
@pytest.mark.parametrize("known", [True, False])
def test_a_straight_line_gives_its_gain(known, scale):
    levels = levels_on_a_line(gain=4.4, dark=7.0, scale=scale)
    found = fit_photon_transfer(levels, dark_variance=7.0 if known else None)
    npt.assert_allclose(found.gain, 4.4, rtol=1e-10)
    if known:  # a fitted dark and a slope leave one of three levels, as many as the bend takes
        npt.assert_allclose(found.bend, 0, atol=1e-10)


def test_the_standard_deviation_of_the_gain_is_that_of_a_weighted_mean():
    """One level: slope = (variance - dark)/light; the errors of both add."""
    levels = levels_on_a_line(gain=4.0, dark=5.0, lights=(1000.0,), std=3.0, scale=2.0)
    found = fit_photon_transfer(levels, dark_variance=5.0, dark_variance_std=1.5)
    slope_std = np.sqrt(3.0**2 + (2 * 1.5) ** 2) / 1000
    npt.assert_allclose((found.gain, found.gain_std), (4.0, slope_std * 4.0**2), rtol=1e-10)
    assert np.isnan(found.bend)
    assert not found.is_bent


@pytest.mark.parametrize("lights", [(1000.0,) * 3, (1000.0, 1003.0, 1006.0)])
def test_levels_of_one_light_count_as_one(lights):
    """Three flats of one exposure determine the gain, and neither the dark nor a bend.

    A level of equal pages, whose variance is not known, is left out.
    """
    levels = levels_on_a_line(gain=4.0, dark=5.0, lights=lights)
    known = fit_photon_transfer([LightLevel(100.0, 0.0, 0.0), *levels], dark_variance=5)
    npt.assert_allclose(known.gain, 4.0, rtol=1e-10)
    npt.assert_allclose(known.gain_std, 4.0**2 / 1000 / np.sqrt(3), rtol=0.01)
    assert np.isnan(known.bend)
    assert fit_photon_transfer([LightLevel(100.0, 0.0, 0.0)], dark_variance=0.0) is None

    levels = levels_on_a_line(gain=4.0, dark=0.0, lights=lights)
    npt.assert_allclose(fit_photon_transfer(levels, dark_variance=None).gain, 4.0, rtol=1e-10)


def test_more_certain_levels_have_more_weight():
    """Slopes of 0.25 and 0.27, known to 0.001 and 0.002: the first has four times the weight."""
    levels = [LightLevel(1000.0, 250.0, 1.0), LightLevel(2000.0, 540.0, 4.0)]
    found = fit_photon_transfer(levels, dark_variance=0.0)
    npt.assert_allclose(1 / found.gain, (0.25 * 4 + 0.27) / 5, rtol=1e-10)
    slope_std = 1 / np.sqrt(1 / 0.001**2 + 1 / 0.002**2)
    npt.assert_allclose(found.gain_std, found.gain**2 * slope_std, rtol=1e-10)


@pytest.mark.parametrize("bend", [-0.1, 0.05])
def test_the_bend_is_the_change_of_variance_per_light_up_to_the_brightest_level(bend):
    gain = 4.4
    levels = levels_on_a_line(gain=gain, dark=7.0, square=bend / gain / 3000, std=0.5)
    found = fit_photon_transfer(levels, dark_variance=7.0)
    npt.assert_allclose(found.bend, bend, rtol=1e-8)
    # slope a and square b of two-parameter least squares, bend = b top/a, by differences
    design = np.array([[500.0, 500.0**2], [1500.0, 1500.0**2], [3000.0, 3000.0**2]])
    covariance = 0.25 * np.linalg.inv(design.T @ design)
    a, b = 1 / gain, bend / gain / 3000
    gradient = np.array([-b * 3000 / a**2, 3000 / a])
    npt.assert_allclose(found.bend_std, np.sqrt(gradient @ covariance @ gradient), rtol=1e-6)


@pytest.mark.parametrize(
    ("bend", "std", "bent"),
    [
        (0.05, 0.010, True),
        (-0.05, 0.010, True),
        (0.05, 0.014, False),  # below four standard deviations
        (0.019, 0.001, False),  # below 2 %
        (0.021, 0.001, True),
    ],
)
def test_a_curve_is_bent_beyond_2_percent_and_four_standard_deviations(bend, std, bent):
    assert PhotonTransfer(4.4, 0.1, bend, std).is_bent == bent


def test_a_level_is_the_mean_of_its_usable_pixels():
    pages = PageStack(np.full((2, 3), 100.0))
    usable = np.array([[True, True, False], [True, True, False]])
    for page in (98.0, 102.0, 100.0):
        image = np.full((2, 3), page)
        image[:, 2] = 10 * page
        pages.add(image)
    level = reduce_level(pages, usable)
    # variance of 98, 102, 100 is 4; of three pages and four pixels its std is sqrt(2 16/(4 4))
    npt.assert_allclose((level.light, level.variance, level.dark_scale), (100, 4, 1))
    npt.assert_allclose(level.variance_std, np.sqrt(2 * 16 / (4 * 4)))
    assert reduce_level(pages, usable & (np.arange(3) == 0) & (np.arange(2) == 0)[:, None]) is None


def test_scaled_pages_keep_their_scales_in_the_level():
    """A page scaled by s has s times the shot variance, and s^2 times that of the dark."""
    pages = PageStack(np.full((2, 2), 100.0))
    for scale in (1.0, 0.5, 2.0):
        pages.add(np.full((2, 2), 100.0 / scale), scale=scale)
    level = reduce_level(pages, np.ones((2, 2), bool))
    npt.assert_allclose(level.light, 100 * 3.5 / 3)
    npt.assert_allclose(level.dark_scale, (1 + 0.25 + 4) / 3)
