"""Ratio of one pair as arrays and as a dataset."""

import numpy as np

from erlif.ratio import PairRatio


def test_dataset_and_arrays_say_the_same():
    rng = np.random.default_rng(3)
    images = [rng.random((4, 5)).astype(np.float32) for _ in range(4)]
    flags = rng.integers(0, 255, (4, 5)).astype(np.uint16)
    pair = PairRatio(*images, flags, images[0] + 1, 1.25)
    back = PairRatio.of(pair.to_images())
    for name in ("log_ratio", "variance", "variance_fixed", "variance_shared", "flags"):
        np.testing.assert_array_equal(getattr(back, name), getattr(pair, name))
    np.testing.assert_array_equal(back.light_one, pair.light_one)
    assert back.noise_correlation == 1.25
