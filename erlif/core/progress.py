"""Reports of progress from long computations."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any, Literal

from erlif.core.errors import ErlifError

# Called with the name of a step, the number of items that are finished, and their total.
Progress = Callable[[str, int, int], None]

# What long functions take: a `Progress`, "bar" or True for bars, None or False for nothing.
ShowProgress = Progress | bool | Literal["bar"] | None


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


def choose_progress(progress: ShowProgress) -> Progress:
    """The function to report to.

    Parameters
    ----------
    progress : callable, bool, "bar" or None
        "bar" or True shows bars, in a notebook as widgets where those are installed.

    Returns
    -------
    callable
        With the name of a step, the number of items that are finished, and their total.

    Raises
    ------
    ErlifError
        If it is something else.

    Examples
    --------
    >>> choose_progress(None) is silent
    True
    >>> choose_progress("dots")
    Traceback (most recent call last):
        ...
    erlif.core.errors.ErlifError: Expected progress to be "bar", True, False or a function of the \
step, the finished items and their total; got 'dots'. Use progress="bar".
    """
    if progress is None or progress is False:
        return silent
    if progress is True or progress == "bar":
        return _Bars()
    if callable(progress):
        return progress
    raise ErlifError(
        'Expected progress to be "bar", True, False or a function of the step, the finished items '
        f'and their total; got {progress!r}. Use progress="bar".'
    )


class _Bars:
    """One bar for each step; it closes with its last item, or when the next step begins."""

    def __init__(self) -> None:
        self._name = ""
        self._bar: Any = None

    def __call__(self, what: str, done: int, total: int) -> None:
        if self._bar is None or what != self._name:
            self._close()
            # without widgets tqdm warns, and shows the bar of a terminal
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                from tqdm.auto import tqdm
            self._name, self._bar = what, tqdm(total=total, desc=what)
        self._bar.n = min(done, total)
        self._bar.refresh()
        if done >= total:
            self._close()

    def _close(self) -> None:
        if self._bar is not None:
            self._bar.close()
            self._bar = None
