"""Saturation below full scale: histograms of drawn images that stop at a count or not."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from erlif.correction import find_pile_up


def histogram(counts, full_scale=4095):
    return np.bincount(np.asarray(counts, int).ravel(), minlength=full_scale + 1)


def made(pixels, full_scale=4095):
    """Histogram from pixels by count."""
    counts = np.zeros(full_scale + 1, np.int64)
    for count, number in pixels.items():
        counts[count] = number
    return counts


def broad(start, stop, each):
    return dict.fromkeys(range(start, stop), each)


@given(
    light=st.floats(20, 3500),
    gain=st.floats(0.3, 30),
    contrast=st.floats(0, 0.4),
    bits=st.sampled_from([8, 10, 12]),
    seed=st.integers(0, 10**6),
)
@settings(max_examples=120, deadline=None, database=None)
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
@settings(max_examples=80, deadline=None, database=None)
def test_counts_that_stop_below_full_scale_are_found(top, share, contrast, seed):
    rng = np.random.default_rng(seed)
    scene = 1 + contrast * rng.standard_normal((96, 96))
    scene *= top / np.quantile(scene, 1 - share)
    counts = rng.poisson(np.maximum(scene, 0) * 4.4) / 4.4
    assert find_pile_up(histogram(np.clip(np.rint(counts), 0, top))) == top


@pytest.mark.parametrize(("pile", "found"), [(51, 3000), (50, None)])
def test_a_pile_up_holds_five_times_as_many_pixels_as_any_count_below(pile, found):
    assert find_pile_up(made(broad(2900, 3000, 10) | {3000: pile})) == found


@pytest.mark.parametrize(("above", "found"), [(9, 3000), (10, None), (30, None)])
def test_a_hundredth_of_the_pile_up_may_lie_above_it(above, found):
    pixels = broad(2900, 3000, 10) | {3000: 1000, 3500: above // 2, 4000: above - above // 2}
    assert find_pile_up(made(pixels)) == found


@pytest.mark.parametrize(("distance", "found"), [(16, None), (17, 3000)])
def test_the_16_counts_below_must_be_thin(distance, found):
    """Many pixels at one count further down are another part of the image."""
    pixels = broad(2900, 3000, 10) | {3000: 500, 3000 - distance: 200}
    assert find_pile_up(made(pixels)) == found


@pytest.mark.parametrize(("levels", "found"), [(15, None), (16, 3000)])
def test_an_image_of_fewer_than_16_counts_is_not_judged(levels, found):
    assert find_pile_up(made(broad(3001 - levels, 3000, 10) | {3000: 500})) == found


@pytest.mark.parametrize(("count", "found"), [(15, None), (16, 16), (4094, 4094), (4095, None)])
def test_a_pile_up_lies_between_the_first_counts_and_full_scale(count, found):
    pixels = broad(max(count - 20, 0), count, 2) | {count: 5000}
    assert find_pile_up(made(pixels)) == found
