"""Check, calibration and processing in a thread: progress, cancelling, and what came of it."""

from __future__ import annotations

import logging
from collections.abc import Callable
from threading import Lock, Thread
from typing import Any

from erlif.core.errors import ErlifError
from erlif.core.notes import Level, Note
from erlif.core.progress import Progress

_logger = logging.getLogger(__name__)

# A piece of work: it reports its progress, and returns what came of it.
Task = Callable[[Progress], list[Note]]


class Work:
    """One piece of work at a time.

    Examples
    --------
    >>> from erlif.core.notes import remark
    >>> def count(progress):
    ...     progress("frames", 2, 2)
    ...     return [remark("frames", "2 counted")]
    >>> work = Work()
    >>> work.start("count", count)
    >>> work.wait()
    >>> work.describe()["notes"]
    [{'level': 'note', 'text': 'frames: 2 counted'}]
    """

    def __init__(self) -> None:
        self._lock = Lock()
        self._thread: Thread | None = None
        self._cancelled = False
        self._state: dict[str, Any] = {"name": "", "running": False, "failed": False, "notes": []}

    def start(self, name: str, task: Task) -> None:
        """Start a task in a thread.

        Parameters
        ----------
        name : str
            Name on the page.
        task : callable

        Raises
        ------
        ErlifError
            If another one is running.
        """
        with self._lock:
            if self._state["running"]:
                raise ErlifError(
                    f"Expected no other work; {self._state['name']} is running. Wait for its end, "
                    "or cancel it."
                )
            self._cancelled = False
            self._state = {"name": name, "running": True, "failed": False, "notes": []}
            self._state |= {"step": "", "done": 0, "total": 0}
        self._thread = Thread(target=self._run, args=(task,), name=name, daemon=True)
        self._thread.start()

    def cancel(self) -> None:
        """Cancel the task; it ends at its next report of progress."""
        self._cancelled = True

    def wait(self) -> None:
        """Wait for the end of the task."""
        if self._thread is not None:
            self._thread.join()

    def describe(self) -> dict[str, Any]:
        """Name of the task, whether it is running or has failed, its progress and its notes."""
        with self._lock:
            return dict(self._state)

    def _report(self, step: str, done: int, total: int) -> None:
        if self._cancelled:
            raise ErlifError("Cancelled. Earlier results are as they were.")
        with self._lock:
            self._state |= {"step": step, "done": done, "total": total}

    def _run(self, task: Task) -> None:
        try:
            notes = task(self._report)
        except ErlifError as error:
            notes = [Note(Level.ERROR, "", str(error))]
        except Exception as error:  # the page states it, the terminal has the details
            _logger.error("the page has a defect", exc_info=error)
            text = f"this is a defect of erlif, {error!r}; the terminal has the details"
            notes = [Note(Level.ERROR, "", text)]
        failed = any(note.level is Level.ERROR for note in notes)
        listed = [{"level": str(note.level), "text": str(note)} for note in notes]
        with self._lock:
            self._state |= {"running": False, "failed": failed, "notes": listed}
