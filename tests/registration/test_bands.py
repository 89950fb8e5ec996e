"""Rows shared out among threads: each row once, and nothing but the time depends on the threads."""

import os
import subprocess
import sys
import threading

import numpy as np
import numpy.testing as npt
import pytest

from erlif.registration.bands import ROWS_PER_THREAD, in_bands


def bands_of(size, threads):
    """The bands on which a kernel is called, ascending."""
    called = []
    in_bands(lambda start, stop: called.append((start, stop)), size, threads)
    return sorted(called)


@pytest.mark.parametrize("size", [1, 15, 31, 32, 33, 100, 1024])
@pytest.mark.parametrize("threads", [1, 2, 3, 8])
def test_every_row_belongs_to_exactly_one_band(size, threads):
    times = np.zeros(size, int)
    for start, stop in bands_of(size, threads):
        times[start:stop] += 1
    npt.assert_array_equal(times, 1)


def test_bands_are_of_equal_size_within_a_row():
    sizes = np.array([stop - start for start, stop in bands_of(101, 4)])
    assert len(sizes) == 4
    assert sizes.max() - sizes.min() <= 1


def test_short_ranges_are_not_shared_out():
    """Each thread gets at least 16 rows."""
    assert ROWS_PER_THREAD == 16
    assert len(bands_of(31, 8)) == 1
    assert len(bands_of(32, 8)) == 2
    assert len(bands_of(80, 8)) == 5
    assert len(bands_of(80, 3)) == 3


def test_an_empty_range_calls_the_kernel_once_with_nothing_to_do():
    assert bands_of(0, 4) == [(0, 0)]


def test_bands_run_at_the_same_time():
    """Each of three kernels waits until all three have started."""
    together = threading.Barrier(3, timeout=20)
    in_bands(lambda start, stop: together.wait(), 3 * ROWS_PER_THREAD, 3)
    assert not together.broken


def test_the_calling_thread_takes_the_first_band():
    workers = {}

    def kernel(start, stop):
        workers[start] = threading.current_thread().name

    in_bands(kernel, 2 * ROWS_PER_THREAD, 2)
    assert workers[0] == threading.current_thread().name
    assert workers[ROWS_PER_THREAD].startswith("registration")


def test_all_bands_are_finished_on_return():
    done = np.zeros(400, bool)

    def slow(start, stop):
        if start:
            threading.Event().wait(0.02)
        done[start:stop] = True

    in_bands(slow, 400, 4)
    assert done.all()


@pytest.mark.parametrize("failing", [0, 50])
def test_an_error_in_any_band_reaches_the_caller(failing):
    def kernel(start, stop):
        if start == failing:
            raise ValueError(f"band at {start}")

    with pytest.raises(ValueError, match=f"band at {failing}"):
        in_bands(kernel, 100, 2)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="the system has no fork")
def test_a_forked_process_gets_threads_of_its_own():
    """The child inherits the pool without its threads, and would wait for them forever."""
    script = """
import os, signal
from erlif.registration.bands import in_bands
in_bands(lambda a, b: None, 64, 2)
child = os.fork()
if child == 0:
    signal.alarm(20)
    called = []
    in_bands(lambda a, b: called.append(a), 64, 2)
    os._exit(0 if sorted(called) == [0, 32] else 1)
print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
"""
    result = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", script], capture_output=True, text=True, timeout=60
    )
    assert result.stdout.strip() == "0", result.stderr
