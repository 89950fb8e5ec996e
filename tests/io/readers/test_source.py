"""Positioned reads."""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import numpy.testing as npt
import pytest

from erlif.core.errors import FrameError
from erlif.io.readers.source import Source


@pytest.fixture(params=["positioned", "as on Windows"])
def ramp(request, tmp_path, monkeypatch):
    """A file whose 16-bit words are their place, read in both ways."""
    if request.param == "as on Windows" and hasattr(os, "preadv"):
        monkeypatch.delattr(os, "preadv")
    path = tmp_path / "ramp.raw"
    np.arange(60_000, dtype="<u2").tofile(path)
    with Source(path) as source:
        yield source


def test_threads_read_their_own_places(ramp):
    def word(place):
        return int.from_bytes(ramp.read(2 * place, 2), "little")

    places = np.random.default_rng(1).integers(0, 60_000, 400).tolist()
    with ThreadPoolExecutor(8) as pool:
        assert list(pool.map(word, places)) == places


def test_an_array_is_filled_in_place(ramp):
    counts = np.zeros((4, 5), "<u2")
    ramp.fill(counts, 100)
    npt.assert_array_equal(counts, np.arange(50, 70).reshape(4, 5))


@pytest.mark.parametrize(("offset", "count"), [(119_999, 2), (-1, 2), (0, 10**18), (10**18, 1)])
def test_a_part_outside_the_file_is_refused_without_memory(ramp, offset, count):
    with pytest.raises(FrameError, match="truncated"):
        ramp.read(offset, count)


def test_a_file_that_shrinks_while_it_is_open_is_truncated(tmp_path):
    path = tmp_path / "frames.raw"
    path.write_bytes(bytes(1000))
    with Source(path) as source:
        os.truncate(path, 10)
        with pytest.raises(FrameError, match="ends within"):
            source.read(0, 1000)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="Windows has no such pipes")
def test_a_pipe_is_refused_and_not_waited_for(tmp_path):
    os.mkfifo(tmp_path / "frames.mraw")
    with pytest.raises(FrameError, match=r"frames\.mraw is not an ordinary file"):
        Source(tmp_path / "frames.mraw")


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(FrameError, match=r"frames\.mraw cannot be read: No such file"):
        Source(tmp_path / "frames.mraw")
