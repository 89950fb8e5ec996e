"""End of a command: exit status, signals, and closed standard streams."""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

import click

from erlif.commands.lines import wrap
from erlif.core.errors import ErlifError

# Exit status where the input or the usage is at fault.
BAD_INPUT = 2

# Exit status where the input leaves nothing of what was asked for.
NO_RESULT = 3

# Exit status where erlif is at fault.
DEFECT = 1

# Exit status after a signal, as shells expect it, less the number of the signal.
BY_SIGNAL = 128

# Exit status after Ctrl-C.
INTERRUPTED = BY_SIGNAL + 2

# Signals that end a command as Ctrl-C does; a system may lack the second.
SIGNALS = ("SIGTERM", "SIGHUP")

# Standard streams in the order of their descriptors, and how each is opened.
STREAMS = (("stdin", "r"), ("stdout", "w"), ("stderr", "w"))

# Address space below which compiled libraries end the process without a message. [byte]
LEAST_MEMORY = 1_000_000_000


def refuse_little_memory() -> None:
    """Refuse a limit of memory under which numpy or the compiler of numba would abort.

    Raises
    ------
    ErlifError
    """
    try:
        import resource
    except ModuleNotFoundError:  # Windows has no such limit
        return
    limit = resource.getrlimit(resource.RLIMIT_AS)[0]
    if limit != resource.RLIM_INFINITY and limit < LEAST_MEMORY:
        raise ErlifError(
            f"Expected an address space of {LEAST_MEMORY / 1e9:g} GB or more; this shell limits it "
            f"to {limit / 1e9:.2f} GB. Raise the limit (ulimit -v), and start again."
        )


class EndedBySignal(KeyboardInterrupt):
    """A signal asked the process to end; its number is the argument."""


@contextmanager
def signals_interrupt() -> Iterator[None]:
    """Raise `EndedBySignal` where a signal would end the process at once.

    Work in progress then ends as after Ctrl-C: finished triggers are kept and the lock is released.
    A signal that the caller ignores, as under ``nohup``, stays ignored.
    """
    available = [getattr(signal, name) for name in SIGNALS if hasattr(signal, name)]
    taken = [one for one in available if signal.getsignal(one) is signal.SIG_DFL]
    if threading.current_thread() is not threading.main_thread():
        taken = []  # Python delivers signals to the main thread alone

    for one in taken:
        signal.signal(one, _raise)
    try:
        yield
    finally:
        for one in taken:
            signal.signal(one, signal.SIG_DFL)


def _raise(number: int, frame: FrameType | None) -> None:
    raise EndedBySignal(number)


def open_missing_streams() -> None:
    """Connect standard streams that are closed to the null device.

    The first file that a program opens takes the lowest free descriptor. With standard error
    closed, this would be the film, and every message of a library would be written into it.
    """
    for descriptor, (name, mode) in enumerate(STREAMS):
        try:
            os.fstat(descriptor)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # takes the lowest free descriptor, which is this one
        if getattr(sys, name) is None:
            setattr(sys, name, os.fdopen(descriptor, mode, encoding="utf-8", closefd=False))


def echo_aside(text: str) -> None:
    """Write a line to standard error, above a progress bar where there is one.

    Nothing happens where nobody can read it: the terminal of a long run may be closed before its
    end, and the run goes on.

    Parameters
    ----------
    text : str
        One line.
    """
    # the bar stands on the last line of the terminal; tqdm moves it down for the new line
    tqdm = sys.modules.get("tqdm")
    try:
        if tqdm is not None and sys.stderr.isatty():
            tqdm.tqdm.write(text, file=sys.stderr)
        else:
            click.echo(text, err=True)
    except OSError:
        silence("stderr")


def echo_refusal(text: str) -> None:
    """Write a message to standard error, on a terminal in lines of 80 columns.

    Parameters
    ----------
    text : str
    """
    echo_aside(wrap(text) if sys.stderr.isatty() else text)


def silence(name: str) -> None:
    """Connect a stream whose reader is gone to the null device.

    Parameters
    ----------
    name : str
        "stdout" or "stderr".
    """
    # Python writes what is left in the buffer of the old stream when the process ends; with its
    # descriptor on the null device this does not fail
    descriptor = [stream for stream, _ in STREAMS].index(name)
    null = os.open(os.devnull, os.O_WRONLY)
    os.dup2(null, descriptor)
    os.close(null)
