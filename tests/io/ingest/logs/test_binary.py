"""Binary logs, written by the packages of their makers or by scipy and h5py."""

import gc
import hashlib
import sys
import tomllib
from pathlib import Path

import h5py
import numpy as np
import pytest
from scipy.io import savemat

from erlif.core.errors import EncoderError
from erlif.io.ingest.logs.binary import read_binary_table

TIME = np.arange(5) * 0.1
ANGLE = np.array([10.0, 11, 12, 13.5, 14])


def columns(path):
    table = read_binary_table(path)
    return {column.name: (column.unit, column.values.tolist()) for column in table.columns}


def write_tdms(path, *channels):
    nptdms = pytest.importorskip("nptdms")
    with nptdms.TdmsWriter(path) as file:
        file.write_segment(
            [nptdms.ChannelObject("run", name, data, props) for name, data, props in channels]
        )


def test_channels_of_tdms_have_their_units(tmp_path):
    path = tmp_path / "log.tdms"
    write_tdms(path, ("Time", TIME, {"unit_string": "s"}), ("Enc", ANGLE, {"unit_string": "deg"}))
    assert columns(path) == {"Time": ("s", TIME.tolist()), "Enc": ("deg", ANGLE.tolist())}


def test_a_waveform_of_tdms_gives_the_times(tmp_path):
    path = tmp_path / "log.tdms"
    wave = {"wf_increment": 0.1, "wf_start_offset": 2.0}
    write_tdms(path, ("Enc [deg]", ANGLE, wave))
    found = columns(path)
    np.testing.assert_allclose(found["time"][1], 2 + TIME)
    assert found["Enc [deg]"] == ("deg", ANGLE.tolist())


def start_later(lead, rate=100.0, size=400):
    """Waveforms of three tasks: what each has measured at the times of its own clock."""
    clock = np.datetime64("2026-03-04T08:00:00")
    time = np.arange(size) / rate
    wave = {"wf_increment": 1 / rate, "wf_start_offset": 0.0, "wf_start_time": clock}
    late = {**wave, "wf_start_time": clock + np.timedelta64(round(1e6 * lead), "us")}
    return (
        ("Enc [deg]", 30 * np.sin(time), wave),
        ("Force [N]", 100 + 10 * (time + lead), late),
        ("Ticks", np.arange(size, dtype=np.int32), wave),
    )


@pytest.mark.parametrize("lead", [0.35, 0.354, -0.2, 1.5])
def test_tasks_that_start_one_after_the_other_have_the_same_time_in_a_row(tmp_path, lead):
    write_tdms(tmp_path / "log.tdms", *start_later(lead))
    table = read_binary_table(tmp_path / "log.tdms")
    found = {column.name: column.values for column in table.columns}
    time = found["time"] + min(lead, 0.0)  # the clock starts with the first task
    assert len(time) == 400 - np.ceil(round(100 * abs(lead), 6))
    np.testing.assert_allclose(found["Enc [deg]"], 30 * np.sin(time), atol=1e-3)
    np.testing.assert_allclose(found["Force [N]"], 100 + 10 * time, atol=1e-9)
    np.testing.assert_allclose(found["Ticks"], 100 * time, atol=0.51)
    assert not (found["Ticks"] % 1).any()
    assert any(f"start {abs(lead):g} s apart" in remark for remark in table.remarks)


def test_tasks_without_a_common_time_are_refused(tmp_path):
    write_tdms(tmp_path / "log.tdms", *start_later(4.0))
    with pytest.raises(EncoderError, match="4 s apart and have no time in common"):
        read_binary_table(tmp_path / "log.tdms")


def test_a_log_of_a_laboratory_is_read_as_by_another_decoder():
    """Analog inputs of NI-DAQmx at 100 Hz; origin and decoder are in samples.toml."""
    pytest.importorskip("nptdms")
    folder = Path(__file__).parents[3] / "samples"
    expected = tomllib.loads((folder / "samples.toml").read_text("utf-8"))["nidaqmx"]
    *channels, time = read_binary_table(folder / "nidaqmx.tdms").columns
    found = {c.name: hashlib.sha256(c.values.astype("<f8").tobytes()).hexdigest() for c in channels}
    assert {name: text[:16] for name, text in found.items()} == expected
    assert {column.unit for column in channels} == {"Volts"}
    np.testing.assert_allclose(time.values, np.arange(3240) / 100, rtol=1e-12)


def test_a_missing_package_is_named_with_the_command_that_installs_it(tmp_path, monkeypatch):
    path = tmp_path / "log.tdms"
    path.write_bytes(b"TDSm" + bytes(24))
    monkeypatch.setitem(sys.modules, "nptdms", None)
    with pytest.raises(EncoderError, match=r'pip install "erlif\[logs\]"'):
        read_binary_table(path)


def test_vectors_matrices_and_structures_of_matlab_5_are_columns(tmp_path):
    path = tmp_path / "log.mat"
    data = np.column_stack([TIME, ANGLE])
    savemat(
        path, {"t": TIME[:, None], "log": {"angle": ANGLE}, "data": data, "name": "x", "n": 3.0}
    )
    found = {name: values for name, (_, values) in columns(path).items()}
    assert found == {
        "t": TIME.tolist(),
        "log/angle": ANGLE.tolist(),
        "data(1)": TIME.tolist(),
        "data(2)": ANGLE.tolist(),
    }


@pytest.mark.parametrize("header", [0, 512])
def test_datasets_of_hdf5_and_matlab_7_are_columns(tmp_path, header):
    path = tmp_path / "log.mat"
    with h5py.File(path, "w", userblock_size=header) as file:
        file["log/angle"] = ANGLE[None]  # MATLAB stores a column as one row
        file["log/angle"].attrs["units"] = "deg"
        file["log/t [s]"] = TIME
        file["#refs#/a"] = TIME
        file["label"] = "text"
    assert columns(path) == {
        "log/angle": ("deg", ANGLE.tolist()),
        "log/t [s]": ("s", TIME.tolist()),
    }


def test_columns_of_another_length_are_left_out_with_a_remark(tmp_path):
    path = tmp_path / "log.h5"
    with h5py.File(path, "w") as file:
        file["angle"], file["other"] = ANGLE, ANGLE[:3]
    table = read_binary_table(path)
    assert table.names == ["angle"]
    assert "columns of another length left out: 'other'" in table.remarks


def test_values_that_are_not_finite_are_kept_as_text(tmp_path):
    path = tmp_path / "log.h5"
    with h5py.File(path, "w") as file:
        file["angle"] = np.array([1.0, np.nan, np.inf])
    assert read_binary_table(path).columns[0].texts == {1: "nan", 2: "inf"}


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(
    "content",
    [
        b"TDSm" + bytes(range(200)),
        b"TDSm" + b"\xff" * 24,
        b"\x89HDF\r\n\x1a\n" + bytes(range(200)),
        b"MATLAB 5.0 MAT-file, made by nobody" + bytes(range(200)),
    ],
)
def test_a_damaged_file_is_refused_by_its_name_and_closed(tmp_path, content):
    path = tmp_path / "log.bin"
    path.write_bytes(content)
    with pytest.raises(EncoderError, match=r"log\.bin"):
        read_binary_table(path)
    gc.collect()  # a file left open is reported here


def test_text_and_directories_are_not_binary(tmp_path):
    (tmp_path / "a.csv").write_text("frame,angle_deg\n")
    assert read_binary_table(tmp_path / "a.csv") is None
    assert read_binary_table(tmp_path) is None


def test_a_truncated_tdms_file_is_refused_and_its_package_prints_nothing(tmp_path, capfd):
    path = tmp_path / "log.tdms"
    write_tdms(path, ("Enc", ANGLE, {}))
    path.write_bytes(path.read_bytes()[:-9])
    with pytest.raises(EncoderError, match=r"log\.tdms to be a TDMS .*less data than expected"):
        read_binary_table(path)
    assert capfd.readouterr() == ("", "")


def test_a_unit_of_a_damaged_file_is_kept_in_part(tmp_path):
    path = tmp_path / "log.h5"
    with h5py.File(path, "w") as file:
        file["angle"] = ANGLE
        file["angle"].attrs["units"] = "x" * 60_000
    assert len(columns(path)["angle"][0]) == 80


def external(file):
    """A log from somebody else might name any file of this machine."""
    other = Path(file.filename).with_name("other.raw")
    ANGLE.tofile(other)
    file.create_dataset("angle", (5,), "f8", external=[(str(other), 0, h5py.h5f.UNLIMITED)])


def half_written(file):
    file["time"] = TIME
    file.create_dataset("angle", (5,), "f8", chunks=(2,))[:3] = ANGLE[:3]


CHUNK = {"maxshape": (None,), "chunks": (150_000_000,), "compression": "gzip"}

REFUSED = [
    (lambda f: f.create_dataset("angle", (10**9,), "f8", chunks=(9,)), "header states 1000000000"),
    (lambda f: f.create_dataset("angle", (5,), "f8"), "numbers of angle are not in the file"),
    (half_written, "numbers of angle are not in the file"),
    (external, "values of angle are in another file"),
    # three numbers in it took 1.6 GB
    (
        lambda f: f.create_dataset("angle", (3,), "f8", **CHUNK),
        "numbers of angle are in a chunk of 1200 MB",
    ),
]


@pytest.mark.parametrize(("fill", "words"), REFUSED)
def test_numbers_that_are_not_in_the_file_are_refused(tmp_path, fill, words):
    with h5py.File(tmp_path / "log.h5", "w") as file:
        fill(file)
    with pytest.raises(EncoderError, match=words):
        read_binary_table(tmp_path / "log.h5")
