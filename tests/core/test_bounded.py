"""Files that are read whole, and those that have no end."""

import pytest

from erlif.core.bounded import read_bounded


def test_a_file_up_to_the_bound_is_read(tmp_path):
    (tmp_path / "a").write_bytes(b"12345")
    assert read_bounded(tmp_path / "a", largest=5) == b"12345"
    with pytest.raises(OSError, match=r"it holds .* MB or more"):
        read_bounded(tmp_path / "a", largest=4)
