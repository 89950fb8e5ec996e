"""Binary logs, written by the packages of their makers or by scipy and h5py."""

import gc
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
