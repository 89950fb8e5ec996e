"""The table of runs: columns, relative paths, and what is refused."""

import pytest

from erlif.io.ingest import RunEntry, read_run_table


@pytest.fixture
def table(tmp_path):
    """Write a table and give its path."""

    def write(text, encoding="utf-8"):
        path = tmp_path / "runs.csv"
        path.write_bytes(text.encode(encoding))
        return path

    return write


def test_paths_start_from_the_directory_of_the_table(table, tmp_path):
    found = read_run_table(table("run_dir,calibration,output\nmonday,cal/a.nc,out/m.zarr\n"))
    assert found == [RunEntry(tmp_path / "monday", tmp_path / "cal/a.nc", tmp_path / "out/m.zarr")]


def test_an_empty_cell_stands_for_the_default(table, tmp_path):
    found = read_run_table(table("output,run_dir,calibration\n,monday,\n"))
    assert found == [RunEntry(tmp_path / "monday")]


@pytest.mark.parametrize(
    "text", ["run_dir\r\nmonday\r\n\r\ntuesday\r\n", " run_dir \n monday\ntuesday"]
)
def test_tables_of_a_spreadsheet_are_read(table, text):
    found = read_run_table(table(text, "utf-8-sig"))
    assert [entry.run_dir.name for entry in found] == ["monday", "tuesday"]
