"""The table of runs: columns, relative paths, and what is refused."""

import pytest

from erlif.core.errors import ConfigError
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


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("", "run_dir is missing"),
        ("monday\ntuesday\n", "got 'monday'"),
        ("calibration\na.nc\n", "run_dir is missing"),
        ("run_dir,calibratoin\nmonday,a.nc\n", "did you mean 'calibration'"),
        ("run_dir,run_dir\nmonday,tuesday\n", "comes 2 times"),
        ("run_dir\n", "header alone"),
        ("run_dir,output\nmonday\n", "2 cells in row 2"),
        ("run_dir,output\n,film.nc\n", "run_dir in row 2"),
        ("run_dir\nmo\x00nday\n", "CSV text"),
    ],
)
def test_other_tables_are_refused_with_the_reason(table, text, reason):
    with pytest.raises(ConfigError, match=reason):
        read_run_table(table(text))


def test_text_in_another_encoding_is_refused(table):
    with pytest.raises(ConfigError, match="UTF-8"):
        read_run_table(table("run_dir\nmätzli\n", "latin-1"))


def test_a_missing_table_is_refused(tmp_path):
    with pytest.raises(ConfigError, match="No such file"):
        read_run_table(tmp_path / "runs.csv")
