"""Descriptions in zarr stores, whole and damaged."""

import os

import pytest

from erlif.io.files.descriptions import read_description


def test_the_description_of_an_inner_group_is_that_of_its_folder(tmp_path):
    (tmp_path / "frames").mkdir()
    (tmp_path / "frames" / "zarr.json").write_text('{"node_type": "group"}')
    assert read_description(tmp_path, "frames") == {"node_type": "group"}


@pytest.mark.parametrize("text", ["", "[]", "[" * 100_000, "{"])
def test_a_description_that_is_no_record_is_refused(tmp_path, text):
    (tmp_path / "zarr.json").write_text(text)
    with pytest.raises(ValueError, match=r"zarr\.json (is no JSON|describes no array)"):
        read_description(tmp_path, ".")


def test_a_pipe_is_no_description(tmp_path):
    os.mkfifo(tmp_path / "zarr.json")
    with pytest.raises(OSError, match="a pipe"):
        read_description(tmp_path, ".")
