"""Reports of progress from long computations."""

from __future__ import annotations

from collections.abc import Callable

Progress = Callable[[str, int, int], None]
"""Called with the name of a step, the number of items that are finished, and their total."""


def silent(what: str, done: int, total: int) -> None:
    """Report nothing.

    Parameters
    ----------
    what : str
        Name of the step.
    done, total : int
        Finished items, and all of them.

    Examples
    --------
    >>> silent("frames", 3, 12)
    """
