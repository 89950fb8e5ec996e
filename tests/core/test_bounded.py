"""Files that are read whole, and those that have no end."""

import pytest

from erlif.core.bounded import read_bounded


def test_a_file_up_to_the_bound_is_read(tmp_path):
    (tmp_path / "a").write_bytes(b"12345")
    assert read_bounded(tmp_path / "a", largest=5) == b"12345"
    with pytest.raises(OSError, match=r"it holds .* MB or more"):
        read_bounded(tmp_path / "a", largest=4)


@pytest.mark.parametrize("device", ["/dev/zero", "/dev/null"])
def test_a_device_is_refused_behind_a_link_too(tmp_path, device):
    (tmp_path / "log.csv").symlink_to(device)
    with pytest.raises(OSError, match="it is a device"):
        read_bounded(tmp_path / "log.csv", largest=100)
