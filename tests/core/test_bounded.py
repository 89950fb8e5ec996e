"""Files that are read whole, and those that have no end."""

import os
import time

import pytest

from erlif.core.bounded import read_bounded


def test_a_file_up_to_the_bound_is_read(tmp_path):
    (tmp_path / "a").write_bytes(b"12345")
    assert read_bounded(tmp_path / "a", largest=5) == b"12345"
    with pytest.raises(OSError, match=r"it holds .* MB or more"):
        read_bounded(tmp_path / "a", largest=4)


def test_a_pipe_without_a_writer_is_refused_at_once(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    start = time.monotonic()
    with pytest.raises(OSError, match="it is a pipe, not a regular file"):
        read_bounded(tmp_path / "pipe", largest=100)
    assert time.monotonic() - start < 1


@pytest.mark.parametrize("device", ["/dev/zero", "/dev/null"])
def test_a_device_is_refused_behind_a_link_too(tmp_path, device):
    (tmp_path / "log.csv").symlink_to(device)
    with pytest.raises(OSError, match="it is a device"):
        read_bounded(tmp_path / "log.csv", largest=100)


def test_a_directory_and_a_missing_file_are_refused_with_the_reason(tmp_path):
    with pytest.raises(OSError, match="it is a directory"):
        read_bounded(tmp_path, largest=100)
    with pytest.raises(FileNotFoundError):
        read_bounded(tmp_path / "none", largest=100)
