"""NPY files against numpy, which wrote them."""

import pickle
from pathlib import Path

import numpy as np
import pytest
from scenes.reading import read

from erlif.core.errors import FrameError
from erlif.io.readers import open_frames

COUNTS = np.random.default_rng(5).integers(0, 4096, (4, 64, 80), dtype=np.uint16)


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


def test_a_header_that_claims_more_frames_than_a_list_can_have_is_refused(tmp_path):
    header = str({"descr": "<u2", "fortran_order": False, "shape": (10**30, 64, 80)})
    start = b"\x93NUMPY\1\0" + len(header).to_bytes(2, "little")
    (tmp_path / "a.npy").write_bytes(start + header.encode() + COUNTS.tobytes())
    with pytest.raises(FrameError, match="names endless frames"):
        open_frames(tmp_path / "a.npy")


@pytest.mark.parametrize("dtype", ["<u2", ">u2", "|u1", "<i2", ">f4", "<f8"])
def test_frames_of_each_type_are_read(tmp_path, dtype):
    np.save(tmp_path / "a.npy", COUNTS.astype(dtype))
    np.testing.assert_array_equal(read(tmp_path / "a.npy"), COUNTS.astype(dtype))


@pytest.mark.parametrize("version", [(1, 0), (2, 0)])
@pytest.mark.parametrize("counts", [COUNTS, COUNTS[0], COUNTS[:, :, :3].copy()])
def test_a_single_frame_and_three_columns_are_frames_in_both_versions(tmp_path, counts, version):
    with (tmp_path / "a.npy").open("wb") as file:
        np.lib.format.write_array(file, counts, version=version)
    found = read(tmp_path / "a.npy")
    np.testing.assert_array_equal(found, counts.reshape(-1, *counts.shape[-2:]))
