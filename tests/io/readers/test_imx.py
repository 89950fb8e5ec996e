"""The compression of LaVision images, against an encoder after its description."""

import numpy as np
import numpy.testing as npt
import pytest
from scenes.camera_files import encode_imx

from erlif.io.readers.imx import decode_imx


@pytest.mark.parametrize("spread", [2, 7, 30, 200, 60_000])
def test_counts_of_any_contrast_survive(spread):
    rng = np.random.default_rng(spread)
    counts = (2000 + rng.integers(-spread, spread + 1, 5000)).clip(0, 65535).astype(np.uint16)
    stream = np.frombuffer(encode_imx(counts), np.uint8).copy()
    found = np.empty_like(counts)
    assert decode_imx(stream, found) == counts.size
    npt.assert_array_equal(found, counts)


def test_a_stream_that_ends_early_gives_fewer_counts():
    stream = encode_imx(np.random.default_rng(1).integers(0, 65536, 100))
    counts = np.empty(100, np.uint16)
    for cut in range(len(stream)):
        assert decode_imx(np.frombuffer(stream[:cut], np.uint8).copy(), counts) < 100


def test_random_bytes_stay_within_the_image():
    rng = np.random.default_rng(2)
    for size in range(200):
        counts = np.empty(50, np.uint16)
        assert 0 <= decode_imx(rng.integers(0, 256, size, dtype=np.uint8), counts) <= 50
