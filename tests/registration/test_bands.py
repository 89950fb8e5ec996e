"""Rows shared out among threads: each row once, and nothing but the time depends on the threads."""

import os
import subprocess
import sys
import threading

import numpy as np
import numpy.testing as npt
import pytest

from erlif.registration.bands import ROWS_PER_THREAD, in_bands


@pytest.mark.parametrize("size", [1, 15, 31, 32, 33, 100, 1024])
@pytest.mark.parametrize("threads", [1, 2, 3, 8])
def test_every_row_belongs_to_exactly_one_band(size, threads):
    times = np.zeros(size, int)
    in_bands(lambda start, stop: np.add.at(times, np.arange(start, stop), 1), size, threads)
    npt.assert_array_equal(times, 1)


def test_bands_run_at_the_same_time():
    """Each of three kernels waits until all three have started."""
    together = threading.Barrier(3, timeout=20)
    in_bands(lambda start, stop: together.wait(), 3 * ROWS_PER_THREAD, 3)
    assert not together.broken


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
