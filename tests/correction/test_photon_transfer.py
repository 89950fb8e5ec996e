"""Photon transfer, saturation and response against counts drawn from known electrons by numpy alone."""

import numpy as np
import numpy.testing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from erlif.correction import (
    PageStack,
    find_pile_up,
    fit_photon_transfer,
    measure_response_spread,
    reduce_level,
)

SHAPE = (24, 32)
FALLOFF = np.linspace(1, 0.7, SHAPE[1]) * np.ones(SHAPE)


def expose(electrons, rng, *, gain, read=9.0, offset=0.0):
    counts = (rng.poisson(electrons) + rng.normal(0, read, SHAPE)) / gain + offset
    return np.rint(counts)


def stack(pages):
    """Pages of one level, freed of the lamp's flicker."""
    made = PageStack(pages[0])
    for page in pages:
        made.add(page, scale=pages[0].mean() / page.mean())
    return made


def record(rng, *, gain, read, pages, flicker, levels, response=lambda electrons: electrons):
    """Levels of a flat, and the temporal variance of a dark with its standard deviation."""
    points = []
    for level in levels:
        exposures = [
            expose(response(level * rng.normal(1, flicker) * FALLOFF), rng, gain=gain, read=read)
            for _ in range(pages)
        ]
        points.append(reduce_level(stack(exposures), np.ones(SHAPE, bool)))
    darks = np.stack([expose(0 * FALLOFF, rng, gain=gain, read=read) for _ in range(8)])
    variance = darks.var(axis=0, ddof=1).mean()
    return points, variance, variance * np.sqrt(2 / (7 * darks[0].size))


@pytest.mark.parametrize(("pages", "flicker"), [(2, 0.0), (3, 0.02), (8, 0.005)])
def test_gain_of_many_cameras_scatters_as_its_uncertainty_says(pages, flicker):
    rng = np.random.default_rng(pages)
    pulls = []
    for _ in range(200):
        gain, read = rng.uniform(0.5, 20), rng.uniform(1.5, 30)
        levels = gain * rng.uniform([400, 1200, 2500], [800, 2000, 3500])
        points, variance, std = record(
            rng, gain=gain, read=read, pages=pages, flicker=flicker, levels=levels
        )
        found = fit_photon_transfer(points, dark_variance=variance, dark_variance_std=std)
        pulls.append((found.gain - gain) / found.gain_std)
    # binomial scatter of 200: 3.3 % at one standard deviation, 1.5 % at two; of the mean 0.07
    assert abs(np.mean(np.abs(pulls) < 1) - 0.683) < 0.1
    assert abs(np.mean(np.abs(pulls) < 2) - 0.954) < 0.045
    assert abs(np.mean(pulls)) < 0.25


def test_an_unknown_dark_variance_is_fitted_along():
    rng = np.random.default_rng(11)
    pulls, shares = [], []
    for _ in range(100):
        points, *_ = record(
            rng, gain=4.0, read=60.0, pages=4, flicker=0.01, levels=(1000, 4000, 9000)
        )
        found = fit_photon_transfer(points, dark_variance=None)
        pulls.append((found.gain - 4.0) / found.gain_std)
        shares.append(found.gain / 4.0)
    assert abs(np.mean(pulls)) < 0.4
    assert 0.8 < np.std(pulls) < 1.2
    # with none taken off, the read variance would make a third of the dimmest level's and a few per cent of the gain
    npt.assert_allclose(np.mean(shares), 1, atol=0.01)


def test_variance_that_does_not_rise_gives_no_gain():
    flat = PageStack(np.full(SHAPE, 1000.0))
    for _ in range(4):
        flat.add(np.full(SHAPE, 1000.0))
    assert (
        fit_photon_transfer([reduce_level(flat, np.ones(SHAPE, bool))], dark_variance=4.0) is None
    )
    assert reduce_level(stack([np.full(SHAPE, 1000.0)]), np.ones(SHAPE, bool)) is None


def test_straight_curves_are_seldom_called_bent():
    rng = np.random.default_rng(12)
    pulls = []
    for _ in range(200):
        points, variance, std = record(
            rng, gain=4.4, read=9, pages=4, flicker=0.005, levels=(4500, 9000, 14000)
        )
        found = fit_photon_transfer(points, dark_variance=variance, dark_variance_std=std)
        pulls.append(found.bend / found.bend_std)
        assert not found.is_bent
    assert 0.88 < np.std(pulls) < 1.12
    assert abs(np.mean(pulls)) < 0.25


def test_a_response_that_falls_short_bends_the_curve_three_times_as_much():
    """f = N (1 - e N/Nmax): variance per light is f'^2 N/f = N (1 - 2 e u)^2/(1 - e u), to first order 1 - 3 e u."""
    rng = np.random.default_rng(13)
    top, short = 14000.0, 0.04
    bends, stds = [], []
    for _ in range(40):
        points = []
        for level in (2000, 5000, 9000, top):
            pages = []
            for _ in range(8):
                electrons = rng.poisson(level * np.ones(SHAPE)) + rng.normal(0, 9, SHAPE)
                pages.append(np.rint(electrons * (1 - short * electrons / top) / 4.4))
            points.append(reduce_level(stack(pages), np.ones(SHAPE, bool)))
        found = fit_photon_transfer(points, dark_variance=(9 / 4.4) ** 2 + 1 / 12)
        bends.append(found.bend)
        stds.append(found.bend_std)
    # the curve is not quite a parabola: its exact change is (1 - 2 e)^2/(1 - e) - 1 = -11.8 %
    npt.assert_allclose(np.mean(bends), (1 - 2 * short) ** 2 / (1 - short) - 1, atol=0.012)
    assert np.std(bends) < 1.3 * np.mean(stds)


def test_a_bend_is_said_where_it_is_relevant_and_significant():
    rng = np.random.default_rng(14)
    bent = lambda electrons: electrons * (1 - 0.1 * electrons / 14000)  # noqa: E731
    points = []
    for level in (2000, 5000, 9000, 14000):
        pages = [
            np.rint(bent(rng.poisson(level * np.ones((96, 96))) * 1.0) / 4.4) for _ in range(8)
        ]
        points.append(reduce_level(stack(pages), np.ones((96, 96), bool)))
    assert fit_photon_transfer(points, dark_variance=1 / 12).is_bent


# saturation


def histogram(counts, full_scale=4095):
    return np.bincount(np.asarray(counts, int).ravel(), minlength=full_scale + 1)


@given(
    light=st.floats(20, 3500),
    gain=st.floats(0.3, 30),
    contrast=st.floats(0, 0.4),
    bits=st.sampled_from([8, 10, 12]),
    seed=st.integers(0, 10**6),
)
@settings(max_examples=150, deadline=None)
def test_images_of_any_light_do_not_look_saturated(light, gain, contrast, bits, seed):
    rng = np.random.default_rng(seed)
    full = 2**bits - 1
    scene = light / 4095 * full * (1 + contrast * rng.standard_normal((64, 64))).clip(0)
    counts = rng.poisson(scene * gain) / gain + rng.normal(0, 2, (64, 64)) + 16
    assert find_pile_up(histogram(np.clip(np.rint(counts), 0, full), full)) is None


@given(
    top=st.integers(1500, 4000),
    share=st.floats(0.02, 0.6),
    contrast=st.floats(0.02, 0.4),
    seed=st.integers(0, 10**6),
)
@settings(max_examples=100, deadline=None)
def test_counts_that_stop_below_full_scale_are_found(top, share, contrast, seed):
    rng = np.random.default_rng(seed)
    scene = 1 + contrast * rng.standard_normal((96, 96))
    scene *= top / np.quantile(scene, 1 - share)
    counts = rng.poisson(np.maximum(scene, 0) * 4.4) / 4.4
    assert find_pile_up(histogram(np.clip(np.rint(counts), 0, top))) == top


def test_full_scale_itself_and_even_pictures_are_no_pile_up():
    rng = np.random.default_rng(15)
    counts = np.clip(rng.normal(4000, 60, SHAPE), 0, 4095).round()
    assert find_pile_up(histogram(counts)) is None
    assert find_pile_up(histogram(np.full(SHAPE, 1500))) is None


def test_a_few_hot_pixels_above_do_not_hide_a_pile_up():
    rng = np.random.default_rng(16)
    counts = np.minimum(rng.normal(3880, 30, (96, 96)).round(), 3900)
    counts[0, :5] = 4095
    assert find_pile_up(histogram(counts)) == 3900


# response


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
