"""Positioned reads."""

import os
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from erlif.core.errors import FrameError
from erlif.io.readers.source import Source, find_beside, read_text


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


def test_the_first_ending_is_preferred(tmp_path):
    for name in ("run 1.5.cih", "run 1.5.cihx", "run 1.cihx"):
        (tmp_path / name).touch()
    assert find_beside(tmp_path / "run 1.5.mraw", (".cihx", ".cih")).name == "run 1.5.cihx"
    assert find_beside(tmp_path / "run 2.mraw", (".cihx", ".cih")) is None


def test_a_name_with_a_dot_and_no_ending_is_kept_whole(tmp_path):
    (tmp_path / "run1.toml").touch()
    assert find_beside(tmp_path / "run1.raw", (".toml",)).name == "run1.toml"


def test_comments_of_another_code_page_do_not_hide_the_entries(tmp_path):
    path = tmp_path / "a.cih"
    path.write_bytes(b"Comment : \x83\xff\nTotal Frame : 3\n")
    assert "Total Frame : 3" in read_text(path)


def test_a_huge_header_is_refused_before_it_is_read(tmp_path):
    path = tmp_path / "a.cih"
    with path.open("wb") as file:
        file.truncate(10**10)
    with pytest.raises(FrameError, match=r"a\.cih has 10000000000 bytes, too many for a header"):
        read_text(path)
