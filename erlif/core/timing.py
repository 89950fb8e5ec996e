"""Start and end of a stage, as log lines: its duration, its work and the memory of the program."""

from __future__ import annotations

import logging
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager

# Stages are logged for the program as a whole, unless a module names its own logger.
_logger = logging.getLogger("erlif")


@contextmanager
def stage(name: str, logger: logging.Logger = _logger) -> Iterator[None]:
    """Log the start and the end of a stage at level INFO.

    The last line gives the duration, the processor time of all threads in it, and the largest
    memory of the program up to then.

    Parameters
    ----------
    name : str
        Name of the stage as the user reads it.
    logger : logging.Logger, optional
        Logger of the calling module.

    Returns
    -------
    context manager
        The block inside is the stage. A block that ends with an exception is logged as stopped.

    Examples
    --------
    >>> import logging, sys
    >>> logger = logging.getLogger("erlif.example")
    >>> logger.addHandler(logging.StreamHandler(sys.stdout)); logger.setLevel(logging.INFO)
    >>> with stage("registration", logger):
    ...     logger.info("surface of 5 x 4 nodes")  # doctest: +ELLIPSIS
    registration: started
    surface of 5 x 4 nodes
    registration: finished after 0.0... s, processor 0.0... s...
    """
    started, worked = time.perf_counter(), time.process_time()
    logger.info("%s: started", name)
    end = "stopped"
    try:
        yield
        end = "finished"
    finally:
        duration, work = time.perf_counter() - started, time.process_time() - worked
        peak = peak_memory()
        memory = "" if peak is None else f", peak memory {peak / 1e6:.0f} MB"
        logger.info("%s: %s after %.2f s, processor %.2f s%s", name, end, duration, work, memory)


def peak_memory() -> int | None:
    """Largest memory that the program has held since its start.

    Returns
    -------
    int or None
        Resident memory, shared libraries included; None on Windows, which does not count it this
        way. [byte]

    Examples
    --------
    >>> held = peak_memory()
    >>> held is None or held > 1_000_000
    True
    """
    try:
        import resource
    except ImportError:
        return None
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss

    # macOS counts bytes, other systems kibibytes
    return peak if sys.platform == "darwin" else 1024 * peak
