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


@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="another C library")
def test_freed_images_are_returned_to_the_system():
    # a setting of malloc, which workers of dask leave behind, has it return large arrays at once
    plain = {name: value for name, value in os.environ.items() if not name.startswith("MALLOC_")}
    command = [sys.executable, "-c", FREED]
    done = subprocess.run(command, env=plain, capture_output=True, text=True, check=True)
    assert int(done.stdout) > 90_000_000
