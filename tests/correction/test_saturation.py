"""Saturation below full scale: histograms of drawn images that stop at a count or not."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from erlif.correction import find_pile_up


def histogram(counts, full_scale=4095):
    return np.bincount(np.asarray(counts, int).ravel(), minlength=full_scale + 1)


def broad(start, stop, each):
    return dict.fromkeys(range(start, stop), each)


@given(
    light=st.floats(20, 3500),
    gain=st.floats(0.3, 30),
    contrast=st.floats(0, 0.4),
    bits=st.sampled_from([8, 10, 12]),
    seed=st.integers(0, 10**6),
)
@settings(max_examples=60)
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
@settings(max_examples=40)
def test_counts_that_stop_below_full_scale_are_found(top, share, contrast, seed):
    rng = np.random.default_rng(seed)
    scene = 1 + contrast * rng.standard_normal((96, 96))
    scene *= top / np.quantile(scene, 1 - share)
    counts = rng.poisson(np.maximum(scene, 0) * 4.4) / 4.4
    assert find_pile_up(histogram(np.clip(np.rint(counts), 0, top))) == top


EDGE = broad(2900, 3000, 10)


@pytest.mark.parametrize(
    ("pixels", "found"),
    [
        # five times as many pixels as any count below
        (EDGE | {3000: 51}, 3000),
        (EDGE | {3000: 50}, None),
        # a hundredth of the pile-up may lie above it
        (EDGE | {3000: 1000, 3500: 4, 4000: 5}, 3000),
        (EDGE | {3000: 1000, 3500: 5, 4000: 5}, None),
        # many pixels at one of the 16 counts below are another part of the image
        (EDGE | {3000: 500, 2984: 200}, None),
        (EDGE | {3000: 500, 2983: 200}, 3000),
        # an image of fewer than 16 counts is not judged
        (broad(2986, 3000, 10) | {3000: 500}, None),
        (broad(2985, 3000, 10) | {3000: 500}, 3000),
        # between the first counts and full scale
        (broad(0, 15, 2) | {15: 5000}, None),
        (broad(0, 16, 2) | {16: 5000}, 16),
        (broad(4074, 4094, 2) | {4094: 5000}, 4094),
        (broad(4075, 4095, 2) | {4095: 5000}, None),
    ],
)
def test_a_pile_up_stands_alone_below_full_scale(pixels, found):
    counts = np.zeros(4096, np.int64)
    counts[list(pixels)] = list(pixels.values())
    assert find_pile_up(counts) == found
