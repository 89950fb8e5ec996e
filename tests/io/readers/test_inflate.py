"""Deflate against zlib, which compressed it; with isal and without."""

import tracemalloc
import zlib

import numpy as np
import pytest

from erlif.core.errors import FrameError
from erlif.io.readers import inflate as module
from erlif.io.readers.inflate import inflate

NOISE = np.random.default_rng(2).integers(0, 50, 70_000, dtype=np.uint8).tobytes()


@pytest.fixture(params=["installed", "zlib"], autouse=True)
def inflater(request, monkeypatch):
    if request.param == "zlib":
        monkeypatch.setattr(module, "inflater", zlib)


@pytest.mark.parametrize("most", [1, 69_999, 70_000, 70_001, 500_000])
def test_as_many_bytes_come_as_are_asked_for_and_as_there_are(most):
    assert inflate(zlib.compress(NOISE), most) == NOISE[:most]


def test_what_is_not_asked_for_takes_no_memory():
    bomb = zlib.compress(bytes(30_000_000))
    tracemalloc.start()
    assert inflate(bomb, 1000) == bytes(1000)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 1_000_000


@pytest.mark.parametrize("cut", [1, 4, 100])
def test_a_cut_stream_is_refused(cut):
    with pytest.raises(FrameError, match="cut"):
        inflate(zlib.compress(NOISE)[:-cut], len(NOISE) + 1)


def test_a_wrong_checksum_is_refused():
    data = zlib.compress(NOISE)
    with pytest.raises(FrameError, match="deflate: "):
        inflate(data[:-1] + bytes([data[-1] ^ 1]), len(NOISE) + 1)
