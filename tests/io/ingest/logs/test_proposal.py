"""The log among other files."""

import h5py
import numpy as np
import pytest

from erlif.io.ingest.logs.proposal import propose_log


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "notes.txt").write_text("Oil changed, force cell zeroed.\n")
    (tmp_path / "profile.csv").write_text("x_mm,thickness_um\n0,1\n1,2\n")
    return tmp_path


def test_columns_of_one_row_for_each_frame_are_proposed(folder):
    (folder / "rig.txt").write_text(
        "No\tWinkel\tEncoder [deg]\tOil temperature [°C]\n" + "1\t2\t3\t4\n" * 3
    )
    found = propose_log(sorted(folder.iterdir()), 3)
    assert found.path.name == "rig.txt"
    assert found.columns == {"angle": "Encoder [deg]", "temperature": "Oil temperature [°C]"}
    assert not found.in_time
    assert found.values.angle.values.tolist() == [3, 3, 3]


def test_a_log_in_time_is_proposed_with_its_trigger(folder):
    with h5py.File(folder / "rig.h5", "w") as file:
        file["Time [s]"], file["Encoder"] = np.arange(50) / 10, np.arange(50)
        file["Camera trigger [V]"] = np.arange(50) % 10 * 1.0
    found = propose_log(sorted(folder.iterdir()), 5)
    assert found.in_time
    assert found.pulse == "Camera trigger [V]"
    assert found.without_unit == ("angle",)
    assert list(found.values) == ["time"]


def test_files_without_an_angle_are_no_log(folder):
    assert propose_log(sorted(folder.iterdir()), 2) is None
    (folder / "a.csv").write_text("angle [deg],F\n1,2\n2,3\n")
    assert propose_log(sorted(folder.iterdir()), 7) is None  # neither rows of frames nor times


GERMAN = "Index;Zeit [s];Winkel Scheibe [deg];Normalkraft [N];T oil [degree C]\n"


def test_a_unit_shows_the_quantity_where_one_column_alone_has_it(folder):
    """No name of the first three is known; a row for each frame needs no column of numbers."""
    rows = [f"{k};0,{k};1{k},5;22{k},8;25,{k}\n" for k in range(4)]
    (folder / "rig.csv").write_text(GERMAN + "".join(rows))
    found = propose_log(sorted(folder.iterdir()), 4)
    assert found.by_unit == ("angle", "time", "load")
    assert found.columns["angle"] == "Winkel Scheibe [deg]"
    assert found.columns["load"] == "Normalkraft [N]"
    assert found.columns["temperature"] == "T oil [degree C]"
    assert found.values.angle.values.tolist() == [10.5, 11.5, 12.5, 13.5]


@pytest.mark.parametrize(
    ("samples", "found"), [("012", "Sample"), ("123", "Sample"), ("124", None), ("321", None)]
)
def test_a_column_of_samples_that_counts_is_the_number_of_the_frame(folder, samples, found):
    rows = [f"{k};1{k},5\n" for k in samples]
    (folder / "rig.csv").write_text("Sample;Encoder [deg]\n" + "".join(rows))
    assert propose_log(sorted(folder.iterdir()), 3).columns.get("frame") == found
    (folder / "rig.csv").write_text("Sample;Encoder [deg];t [s]\n0;1;1\n1;2;2\n")
    assert "frame" not in propose_log(sorted(folder.iterdir()), 9).columns  # a log in time


def test_two_columns_of_one_unit_are_no_proposal(folder):
    """Which of both angles is that of the disc, their unit does not show."""
    rows = [f"{k};1{k},5;2{k},5\n" for k in range(4)]
    (folder / "rig.csv").write_text("Index;Winkel A [deg];Winkel B [deg]\n" + "".join(rows))
    assert propose_log(sorted(folder.iterdir()), 4) is None
    assert propose_log(sorted(folder.iterdir()), 4, unnamed=True).columns == {}
