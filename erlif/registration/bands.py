"""Threads over bands of rows: compiled kernels release the interpreter, so plain threads are enough."""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from itertools import pairwise


def in_bands(kernel: Callable[[int, int], object], size: int, threads: int) -> None:
    """Call ``kernel(start, stop)`` on contiguous parts of ``range(size)``, one for each thread.

    The kernel must give the same result for every row whatever band it falls into, so that the number of threads
    changes nothing but the time.
    """
    threads = min(threads, size // 16)
    if threads < 2:
        kernel(0, size)
        return
    edges = [size * i // threads for i in range(threads + 1)]
    with ThreadPoolExecutor(threads) as pool:
        for future in [pool.submit(kernel, a, b) for a, b in pairwise(edges)]:
            future.result()
