"""Which chunks of a dataset a file holds."""

import h5py
import numpy as np
import pytest

from erlif.core.hdf5 import chunk_count, find_chunks


@pytest.mark.parametrize("options", [{}, {"libver": "latest"}, {"userblock_size": 512}])
def test_chunks_that_were_never_written_are_found(tmp_path, options):
    with h5py.File(tmp_path / "a.h5", "w", **options) as file:
        data = file.create_dataset("a", (5, 7), "f4", chunks=(2, 3), compression="gzip")
        data[:3, :2] = 1.0
        whole = file.create_dataset("b", data=np.ones((5, 7)))
        never = file.create_dataset("c", (5, 7), "f4")
        assert chunk_count(data) == 9
        assert find_chunks(data).tolist() == [[True, False, False]] * 2 + [[False] * 3]
        assert find_chunks(whole).all()
        assert not find_chunks(never).any()
