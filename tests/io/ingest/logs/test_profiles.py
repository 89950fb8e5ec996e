"""Columns of measured profiles by names and units of their own."""

import numpy.testing as npt
import pytest

from erlif.core.errors import CalibrationError
from erlif.io.ingest.logs.profiles import find_columns, read_columns
from erlif.io.ingest.logs.table import LogUse
from erlif.io.ingest.logs.text import read_log_table

USE = LogUse(
    CalibrationError, "call it {quantity}", "write it", "Correct it.", "profile in fixture.toml"
)


def columns_of(tmp_path, text, profile, needed):
    (tmp_path / "scan.txt").write_text(text, encoding="utf-8")
    table = read_log_table(tmp_path / "scan.txt", needed, USE)
    return read_columns(table, find_columns(table, profile), needed)


@pytest.mark.parametrize(
    ("text", "profile", "expected"),
    [
        ("x_mm,thickness_um\n0,1\n2,3\n", "profile", {"x_mm": [0, 2], "thickness_um": [1, 3]}),
        ("Weg [cm];Spalt [nm]\n0;1000\n2;3000\n", "profile", {"x_mm": [0, 20]}),
        ("axial (mm)\tDepth (mm)\n-5\t0.002\n5\t0\n", "bore", {"depth_um": [2, 0]}),
        ("z [m],height [um]\n-0.005,2\n0.005,0\n", "bore", {"axial_mm": [-5, 5]}),
    ],
)
def test_columns_are_found_by_their_names_and_scaled_by_their_units(
    tmp_path, text, profile, expected
):
    columns, remarks = columns_of(tmp_path, text, profile, tuple(expected))
    for name, values in expected.items():
        npt.assert_allclose(columns[name], values, rtol=1e-12)
        assert (name in text) != any(one.startswith(f"{name} from") for one in remarks)


@pytest.mark.parametrize(
    ("head", "words"),
    [
        ("x_mm,load_um", "Expected a column for the thickness_um"),
        ("x_mm,gap [um],film [um]", "'gap .um.' and 'film .um.' may be meant"),
        ("x_mm,gap", "Expected the unit of column gap"),
        ("x_mm,gap [N]", "N"),
    ],
)
def test_a_column_that_is_missing_doubtful_or_without_unit_is_refused(tmp_path, head, words):
    rows = "\n".join(",".join("1" for _ in head.split(",")) for _ in range(3))
    with pytest.raises(CalibrationError, match=words):
        columns_of(tmp_path, f"{head}\n{rows}\n", "profile", ("x_mm", "thickness_um"))


def test_a_missing_table_names_the_place_of_its_name(tmp_path):
    words = "scan.txt; it cannot be read: .*, or correct profile in fixture.toml"
    with pytest.raises(CalibrationError, match=words):
        read_log_table(tmp_path / "scan.txt", ("x_mm", "thickness_um"), USE)
