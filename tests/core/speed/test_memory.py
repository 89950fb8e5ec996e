import os
import platform
import subprocess
import sys

import pytest

# the last image keeps the freed ones before it from the end of the heap
FREED = """
import numpy as np
from erlif.core.speed.memory import release_memory


def resident():
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * 4096


del_first = np.ones(30_000_000, np.uint8)
del del_first  # arrays up to this size now lie on the heap
images = [np.ones(1_000_000, np.uint8) for _ in range(100)]
kept = images[-1]
del images
before = resident()
release_memory()
print(before - resident())
"""


# images are freed and made again, as each frame of a stage does it
REPEATED = """
import resource
import sys
import numpy as np
from erlif.core.speed.memory import keep_memory


def faults():
    return resource.getrusage(resource.RUSAGE_SELF).ru_minflt


if sys.argv[1] == "keep":
    keep_memory()
for turn in range(4):
    before = faults()
    images = [np.ones(3_000_000, np.uint8) for _ in range(10)]
    del images
print(faults() - before)
"""

glibc = pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="another C library")


def run(code, *arguments, **setting):
    # a setting of malloc, which workers of dask leave behind, has it return large arrays at once
    plain = {name: value for name, value in os.environ.items() if not name.startswith("MALLOC_")}
    command = [sys.executable, "-c", code, *arguments]
    done = subprocess.run(command, env=plain | setting, capture_output=True, text=True, check=True)
    return int(done.stdout)


@glibc
def test_freed_images_are_returned_to_the_system():
    assert run(FREED) > 90_000_000


@glibc
def test_images_that_are_made_again_find_the_pages_of_the_last_ones():
    assert run(REPEATED, "keep") < 200 < 3_000 < run(REPEATED, "return")


@glibc
def test_workers_of_dask_find_them_as_well():
    setting = {"MALLOC_TRIM_THRESHOLD_": "65536"}  # as dask starts them
    assert run(REPEATED, "keep", **setting) < 200 < 3_000 < run(REPEATED, "return", **setting)
