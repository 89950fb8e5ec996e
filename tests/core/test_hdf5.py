"""Which chunks of a dataset a file holds."""

import errno

import h5py
import numpy as np
import pytest

from erlif.core.hdf5 import chunk_count, find_chunks, open_hdf5


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


@pytest.mark.parametrize("code", [errno.ENOLCK, errno.EOPNOTSUPP])
def test_a_drive_without_locks_is_read(tmp_path, monkeypatch, code):
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["a"] = 2.5
    whole = h5py.File

    def refuse_locks(path, mode, *, locking=True):
        if locking:
            raise OSError(code, "unable to lock file")
        return whole(path, mode, locking=locking)

    monkeypatch.setattr(h5py, "File", refuse_locks)
    # open twice: the flags of both must agree
    with open_hdf5(tmp_path / "a.h5") as file, open_hdf5(tmp_path / "a.h5") as again:
        assert file["a"][()] == again["a"][()] == 2.5


def test_a_file_that_another_program_locks_is_refused(tmp_path):
    fcntl = pytest.importorskip("fcntl")
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["a"] = 2.5
    with (tmp_path / "a.h5").open("rb+") as holder:
        fcntl.flock(holder, fcntl.LOCK_EX)
        with pytest.raises(OSError, match="lock"):
            open_hdf5(tmp_path / "a.h5")
