"""Threads over bands of rows.

Compiled kernels release the interpreter lock, so ordinary threads are enough.
"""

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from itertools import pairwise
from typing import Final

# Below this many rows for each thread, handing over the work costs more than it saves.
ROWS_PER_THREAD: Final = 16


@cache
def _pool(threads: int) -> ThreadPoolExecutor:
    return ThreadPoolExecutor(threads, thread_name_prefix="registration")


# a forked child inherits the pool but not its threads, and would wait for them forever
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_pool.cache_clear)


def in_bands(kernel: Callable[[int, int], object], size: int, threads: int) -> None:
    """Call ``kernel(start, stop)`` on contiguous parts of ``range(size)``, one for each thread.

    Parameters
    ----------
    kernel : callable
        Works on the rows ``start`` to ``stop``. It must give the same result for a row whatever
        band the row falls into, so that the number of threads changes only the time. It must not
        call this function again: the inner call could wait for a thread that the outer one holds.
    size : int
        Number of rows.
    threads : int
        Largest number of threads; short ranges get fewer.

    Examples
    --------
    >>> bands = []
    >>> in_bands(lambda start, stop: bands.append((start, stop)), 40, threads=2)
    >>> sorted(bands)
    [(0, 20), (20, 40)]
    """
    threads = min(threads, size // ROWS_PER_THREAD)
    if threads < 2:
        kernel(0, size)
        return

    edges = [size * i // threads for i in range(threads + 1)]
    bands = list(pairwise(edges))

    # the calling thread takes the first band itself; result() passes on errors of the others
    rest = [_pool(threads - 1).submit(kernel, a, b) for a, b in bands[1:]]
    kernel(*bands[0])
    for future in rest:
        future.result()
