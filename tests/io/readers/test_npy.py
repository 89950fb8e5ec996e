"""NPY files against numpy, which wrote them."""

from __future__ import annotations

import pickle
from pathlib import Path

import numpy as np
import pytest

from erlif.core.errors import FrameError
from erlif.io.readers import FrameKind, open_frames

COUNTS = np.random.default_rng(5).integers(0, 4096, (4, 64, 80), dtype=np.uint16)


@pytest.mark.parametrize("dtype", ["<u2", ">u2", "|u1", "<i2", ">f4", "<f8"])
def test_frames_are_read_in_any_order(tmp_path, dtype):
    np.save(tmp_path / "a.npy", COUNTS.astype(dtype))
    file = open_frames(tmp_path / "a.npy")
    name = np.dtype(dtype).newbyteorder("=").name
    assert list(file.kinds) == [FrameKind((64, 80), name)] * 4
    for index in (3, 0, 2, 1):
        found = file.read(index)
        assert found.dtype.name == name
        np.testing.assert_array_equal(found, COUNTS[index].astype(dtype))
    file.close()


def test_a_single_frame_and_frames_of_three_columns_are_no_colours(tmp_path):
    np.save(tmp_path / "a.npy", COUNTS[0])
    np.save(tmp_path / "b.npy", COUNTS[:, :, :3])
    for name, expected in (("a", COUNTS[:1]), ("b", COUNTS[:, :, :3])):
        file = open_frames(tmp_path / f"{name}.npy")
        np.testing.assert_array_equal([file.read(k) for k in range(len(expected))], expected)
        assert len(file.kinds) == len(expected)
        file.close()


@pytest.mark.parametrize("version", [(1, 0), (2, 0)])
def test_both_versions_of_the_header_are_read(tmp_path, version):
    with (tmp_path / "a.npy").open("wb") as file:
        np.lib.format.write_array(file, COUNTS, version=version)
    opened = open_frames(tmp_path / "a.npy")
    np.testing.assert_array_equal(opened.read(2), COUNTS[2])
    opened.close()


class Harm:
    """Leaves a file where it is unpickled."""

    def __init__(self, path):
        self.path = path

    def __reduce__(self):
        return Path.touch, (self.path,)


def test_nothing_is_unpickled(tmp_path):
    trace = tmp_path / "trace"
    array = np.empty((2, 2, 2), object)
    array[:] = Harm(trace)
    np.save(tmp_path / "a.npy", array, allow_pickle=True)
    (tmp_path / "b.npy").write_bytes(pickle.dumps(Harm(trace)))
    for name in "ab":
        with pytest.raises(FrameError, match=r"object|not an NPY"):
            open_frames(tmp_path / f"{name}.npy")
    assert not trace.exists()


@pytest.mark.parametrize(
    "array",
    [
        np.zeros(5),
        np.zeros((2, 3, 4, 5)),
        np.zeros((2, 3), complex),
        np.zeros((2, 3), [("a", "<u2")]),
        np.asfortranarray(COUNTS),
    ],
    ids=["1-D", "4-D", "complex", "structured", "by columns"],
)
def test_another_array_is_refused_with_its_shape(tmp_path, array):
    np.save(tmp_path / "a.npy", array)
    with pytest.raises(FrameError, match=r"it holds an array of .*\. Save the frames as one array"):
        open_frames(tmp_path / "a.npy")


def test_a_header_that_claims_a_billion_frames_is_refused(tmp_path):
    for shape in ((10**9, 64, 80), (3, 10**9, 10**9)):
        with (tmp_path / "a.npy").open("wb") as file:
            entry = {"descr": "<u2", "fortran_order": False, "shape": shape}
            np.lib.format.write_array_header_1_0(file, entry)
            file.write(bytes(20480))
        with pytest.raises(FrameError, match="damaged"):
            open_frames(tmp_path / "a.npy")


def test_a_header_that_claims_more_frames_than_a_list_can_have_is_refused(tmp_path):
    header = str({"descr": "<u2", "fortran_order": False, "shape": (10**30, 64, 80)})
    start = b"\x93NUMPY\1\0" + len(header).to_bytes(2, "little")
    (tmp_path / "a.npy").write_bytes(start + header.encode() + COUNTS.tobytes())
    with pytest.raises(FrameError, match="names endless frames"):
        open_frames(tmp_path / "a.npy")
