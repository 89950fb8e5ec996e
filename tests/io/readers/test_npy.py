"""NPY files against numpy, which wrote them."""

import pickle
import re
from pathlib import Path

import numpy as np
import pytest
from scenes.reading import read, refusal

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
        assert re.search(r"object|not an NPY", refusal(tmp_path / f"{name}.npy"))
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
    message = refusal(tmp_path / "a.npy")
    assert re.search(r"it holds an array of .*\. Save the frames as one array", message)


def test_a_header_that_claims_more_frames_than_a_list_can_have_is_refused(tmp_path):
    header = str({"descr": "<u2", "fortran_order": False, "shape": (10**30, 64, 80)})
    start = b"\x93NUMPY\1\0" + len(header).to_bytes(2, "little")
    content = start + header.encode() + COUNTS.tobytes()
    assert "names endless frames" in refusal(tmp_path / "a.npy", content)


@pytest.mark.parametrize("version", [(1, 0), (2, 0)])
@pytest.mark.parametrize(
    "counts", [COUNTS, COUNTS.astype(">f4"), COUNTS[0], COUNTS[:, :, :3].copy()]
)
def test_a_single_frame_and_three_columns_are_frames_in_both_versions(tmp_path, counts, version):
    with (tmp_path / "a.npy").open("wb") as file:
        np.lib.format.write_array(file, counts, version=version)
    found = read(tmp_path / "a.npy")
    np.testing.assert_array_equal(found, counts.reshape(-1, *counts.shape[-2:]))
