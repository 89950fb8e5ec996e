"""Files with the damages that the library of HDF5 and the reader of scipy do not survive.

The bytes are edited by the specification of the format; the damaged places were found at random.
"""

import contextlib
import os
import random
import resource
import signal
import threading
import time
from concurrent.futures import ThreadPoolExecutor

import h5py
import numpy as np
import pytest
from scipy.io import loadmat, savemat

from erlif.core import guarded
from erlif.core.guarded import check_hdf5, mark_written, read_matlab


def write(path, **options):
    """A file with text of variable length."""
    with h5py.File(path, "w", **options) as file:
        file.attrs["unit"] = "degree"
        file["vector"] = np.arange(5.0)
    return path


@pytest.mark.parametrize("options", [{}, {"libver": "latest"}, {"userblock_size": 512}])
def test_a_whole_file_is_accepted(tmp_path, options):
    check_hdf5(write(tmp_path / "a.h5", **options))


def test_a_file_that_this_process_has_written_is_checked_after_a_change_alone(
    tmp_path, monkeypatch
):
    asked = []
    monkeypatch.setattr(guarded._child, "ask", lambda *wanted: asked.append(wanted))
    path = write(tmp_path / "a.h5")
    mark_written(path)
    check_hdf5(path)
    assert asked == []
    os.utime(path, (1.0, 1.0))
    check_hdf5(path)
    assert asked == [("hdf5", str(path))]


def test_a_length_that_ends_the_process_ends_that_of_the_child_alone(tmp_path):
    """Class and kind of types of variable length in version 1 (section IV.A.2.d)."""
    path = tmp_path / "a.h5"
    with h5py.File(path, "w") as file:
        space = h5py.h5s.create_simple((1,))
        kind = h5py.h5t.py_create(h5py.vlen_dtype("i4"), logical=True)
        h5py.h5a.create(file.id, b"a", kind, space)
    content = bytearray(path.read_bytes())
    content[content.index(b"\x19\x00\0\0\x10") + 1] |= 8
    path.write_bytes(content)
    with pytest.raises(ValueError, match="crashed or took too much memory"):
        check_hdf5(path)
    check_hdf5(write(tmp_path / "b.h5"))


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no forks on this system")
@pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning")  # threads of other tests
def test_a_forked_process_with_a_bound_of_its_own_has_a_child_of_its_own(tmp_path):
    check_hdf5(write(tmp_path / "a.h5"))
    other = write(tmp_path / "b.h5")
    forked = os.fork()
    if forked == 0:
        resource.setrlimit(resource.RLIMIT_AS, (2**34, 2**34))
        try:
            check_hdf5(other)
        except BaseException:
            os._exit(1)
        os._exit(0)
    assert os.waitstatus_to_exitcode(os.waitpid(forked, 0)[1]) == 0
    check_hdf5(write(tmp_path / "c.h5"))


def test_threads_wait_for_each_other(tmp_path):
    paths = [write(tmp_path / f"{n}.h5") for n in range(6)]
    with ThreadPoolExecutor(len(paths)) as threads:
        assert len(list(threads.map(check_hdf5, paths))) == len(paths)


@pytest.fixture
def child(tmp_path, monkeypatch):
    """A child with tasks that loop, wait, end or name the signals it is reached by."""
    program = tmp_path / "program.py"
    program.write_text(
        "import os, runpy, sys, time\n"
        f"child = runpy.run_path({guarded.__file__!r})\n"
        "child['_TASKS'] |= {\n"
        "    'loop': lambda path: [None for _ in iter(int, 1)],\n"
        "    'wait': lambda path: time.sleep(60),\n"
        "    'crash': lambda path: os.abort(),\n"
        "    'pid': lambda path: os.getpid(),\n"
        "    'session': lambda path: os.getsid(0),\n"
        "}\n"
        "child['_serve'](sys.stdin.buffer, sys.stdout.buffer)\n"
    )
    monkeypatch.setattr(guarded, "__file__", str(program))
    monkeypatch.setattr(guarded, "LONGEST", 1.0)
    child = guarded._Child()
    yield child
    child.end()


def test_a_file_is_bounded_by_processor_time_and_the_message_states_the_end(child, monkeypatch):
    began = time.monotonic()
    with pytest.raises(ValueError, match="more than 1 s of processor time"):
        child.ask("loop", "")
    with pytest.raises(ValueError, match=r"crashed or took too much memory \(SIGABRT\)"):
        child.ask("crash", "")
    monkeypatch.setattr(guarded, "PATIENCE", 1.5)
    with pytest.raises(ValueError, match=r"did not end within 1\.5 s"):
        child.ask("wait", "")
    assert time.monotonic() - began < 30


def test_a_child_that_gets_no_time_from_the_machine_keeps_its_file(child):
    """Stopped for three times the processor time that it may take."""
    running = child.ask("pid", "")
    os.kill(running, signal.SIGSTOP)
    threading.Timer(3.0, os.kill, (running, signal.SIGCONT)).start()
    began = time.monotonic()
    assert child.ask("pid", "") == running
    assert time.monotonic() - began > 2


def test_a_child_that_ended_between_two_files_is_replaced_and_ctrl_c_does_not_reach_it(child):
    running = child.ask("pid", "")
    assert child.ask("session", "") == running != os.getsid(0)
    os.kill(running, signal.SIGKILL)
    child.process.wait()
    assert child.ask("pid", "") != running


# MATLAB 5

RNG = np.random.default_rng(4)
VARIABLES = {
    "angle": RNG.normal(size=(7, 1)),
    "n": np.arange(5, dtype=np.uint8)[None],
    "k": np.array([[-3, 2**31 - 1]], np.int32),
    "m": RNG.normal(size=(4, 3)).astype(np.float32),
    "one": np.array([[2.5]]),
    "text": "abc",
    "cells": np.array([[1.0, "x"]], object),
    "z": np.array([[1 + 2j]]),
    "log": {"angle": [1.0, 2.0], "inner": {"load": [3.0, 4.0]}, "a": "x"},
}


@pytest.mark.parametrize("compressed", [False, True])
def test_numbers_and_fields_of_structures_are_read(tmp_path, compressed):
    path = tmp_path / "a.mat"
    savemat(path, VARIABLES, do_compression=compressed)
    found, expected = dict(read_matlab(path)), loadmat(path)
    assert set(found) == {"angle", "n", "k", "m", "one", "log/angle", "log/inner/load"}
    for name in ("angle", "n", "k", "m", "one"):
        np.testing.assert_array_equal(found[name], expected[name])
    assert found["log/inner/load"].ravel().tolist() == [3, 4]


def test_variables_that_are_too_large_are_refused_by_their_headers(tmp_path, monkeypatch):
    path = tmp_path / "a.mat"
    savemat(path, {f"v{n}": np.zeros(4_000_001) for n in range(8)}, do_compression=True)
    with pytest.raises(ValueError, match="states 32000008 numbers"):
        read_matlab(path)


def test_damaged_files_raise_no_other_error(tmp_path):
    """The reader of scipy ends the process on some of them."""
    path = tmp_path / "a.mat"
    savemat(path, {name: VARIABLES[name] for name in ("angle", "n", "m", "log")})
    content = path.read_bytes()
    rng = random.Random(8)
    for _ in range(60):
        damaged = bytearray(content)
        for _ in range(rng.randint(1, 5)):
            damaged[rng.randrange(126, len(damaged))] = rng.choice([0, 255, rng.randrange(256)])
        if rng.random() < 0.3:
            del damaged[rng.randrange(len(damaged)) :]
        path.write_bytes(damaged)
        with contextlib.suppress(ValueError, OSError):
            read_matlab(path)
