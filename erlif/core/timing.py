"""Start and duration of a stage, as log lines."""

from __future__ import annotations

import logging
import time
from collections.abc import Iterator
from contextlib import contextmanager

_logger = logging.getLogger("erlif")
"""Stages are logged for the program as a whole, unless a module names its own logger."""


@contextmanager
def stage(name: str, logger: logging.Logger = _logger) -> Iterator[None]:
    """Log the start and the duration of a stage at level INFO.

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
    registration: finished after 0.0... s
    """
    started = time.perf_counter()
    logger.info("%s: started", name)
    try:
        yield
    except BaseException:
        logger.info("%s: stopped after %.2f s", name, time.perf_counter() - started)
        raise
    logger.info("%s: finished after %.2f s", name, time.perf_counter() - started)
