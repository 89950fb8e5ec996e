"""Options that several commands share."""

from pathlib import Path

import pytest

from erlif.commands.options import expect_output, expect_suffix
from erlif.core.errors import OutputError


def test_a_name_with_another_suffix_is_refused_with_the_ones_that_fit():
    with pytest.raises(OutputError, match=r"\.nc or \.zarr .* film\.csv"):
        expect_suffix(Path("out/film.csv"), ".nc", ".zarr")


@pytest.mark.parametrize("name", ["process", "calibrate", "export", "figures", "report", "watch"])
def test_an_output_in_a_folder_that_does_not_exist_is_refused(command, tmp_path, name):
    output = tmp_path / "wrong" / "path" / "film.nc"
    refused = command(name, tmp_path, "-o", output, status=2).stderr
    assert f"Expected an existing folder for the output {output}" in refused
    assert f"{output.parent} is none, of which {tmp_path} exists" in refused
    assert list(tmp_path.iterdir()) == []


def test_a_folder_without_permission_is_refused_before_the_work(tmp_path, monkeypatch):
    monkeypatch.setattr("os.access", lambda path, mode: False)
    with pytest.raises(OutputError, match=r"Permission denied.*Allow to write there"):
        expect_output(tmp_path / "calibration.nc", ".nc", overwrite=True)
