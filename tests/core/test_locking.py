"""Locks that the environment demands of HDF5, on a drive that has none."""

import os
import subprocess
import sys

import pytest

from erlif.core.locking import take_demand

# what a drive without locks does: the call of the system fails
OPEN = """
import logging, sys
from pathlib import Path
import erlif, h5py
logging.basicConfig()
from erlif.core.hdf5 import with_locks
def opening(path, **options):
    if "locking" not in options:
        raise OSError(37, "No locks available")
    return h5py.File(path, "r", **options)
for _ in range(2):
    print(list(with_locks(opening, Path(sys.argv[1]))))
"""


@pytest.mark.parametrize(("value", "notes"), [("TRUE", 1), ("best_effort", 1), ("FALSE", 0)])
def test_a_drive_without_locks_is_read_with_one_note(tmp_path, value, notes):
    import h5py

    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["a"] = 1
    done = subprocess.run(
        [sys.executable, "-c", OPEN, tmp_path / "a.h5"],
        env={**os.environ, "HDF5_USE_FILE_LOCKING": value},
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.splitlines() == ["['a']"] * 2
    assert done.stderr.count("this drive has no locks") == notes


def test_the_demand_is_taken_from_the_environment(monkeypatch):
    monkeypatch.setenv("HDF5_USE_FILE_LOCKING", "true")
    take_demand.cache_clear()
    assert take_demand()
    assert "HDF5_USE_FILE_LOCKING" not in os.environ
    take_demand.cache_clear()
    assert not take_demand()
