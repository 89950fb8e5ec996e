"""Headers in text files beside the counts."""

from __future__ import annotations

import pytest

from erlif.core.errors import FrameError
from erlif.io.readers.sidecar import find_beside, read_text


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
