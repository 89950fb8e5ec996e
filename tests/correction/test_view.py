"""The mean of some frames, pixel by pixel in the middle and in blocks over the whole."""

import numpy as np
import numpy.testing as npt

from erlif.correction.view import BLOCKS, ViewSum, mean_of_blocks


def test_the_middle_is_the_mean_of_the_frames():
    rng = np.random.default_rng(1)
    frames = rng.integers(0, 4096, (3, 600, 520), dtype=np.uint16)
    total = ViewSum((600, 520))
    for counts in frames:
        total.add(counts)
    view = total.mean()
    npt.assert_allclose(view.centre, frames[:, 44:556, 4:516].mean(axis=0), rtol=1e-6)
    assert view.window == (slice(44, 556), slice(4, 516))


def test_blocks_are_means_of_the_whole_frame():
    image = np.arange(64 * 128, dtype=np.uint16).reshape(64, 128)
    expected = image.reshape(BLOCKS, 8, BLOCKS, 16).mean(axis=(1, 3))
    npt.assert_allclose(mean_of_blocks(image), expected, atol=0.5)  # counts are rounded
    npt.assert_allclose(mean_of_blocks(image.astype(np.float32)), expected, rtol=1e-6)
