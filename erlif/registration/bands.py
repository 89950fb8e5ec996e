"""Threads over bands of rows: compiled kernels release the interpreter, so plain threads are enough."""

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from itertools import pairwise


@cache
def _pool(threads: int) -> ThreadPoolExecutor:
    return ThreadPoolExecutor(threads, thread_name_prefix="registration")


# a forked child has the pool but not its threads, and would wait for them for ever
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_pool.cache_clear)


def in_bands(kernel: Callable[[int, int], object], size: int, threads: int) -> None:
    """Call ``kernel(start, stop)`` on contiguous parts of ``range(size)``, one for each thread.

    The kernel must give the same result for every row whatever band it falls into, so that the number of threads
    changes nothing but the time. A kernel must not call this function again.
    """
    threads = min(threads, size // 16)
    if threads < 2:
        kernel(0, size)
        return
    edges = [size * i // threads for i in range(threads + 1)]
    bands = list(pairwise(edges))
    rest = [_pool(threads - 1).submit(kernel, a, b) for a, b in bands[1:]]
    kernel(*bands[0])
    for future in rest:
        future.result()
