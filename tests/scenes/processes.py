"""A command in a process of its own, by functions that another process can import."""

import contextlib
import multiprocessing
import os
import resource
import signal
import sys
from collections.abc import Callable
from multiprocessing.process import BaseProcess
from pathlib import Path

from erlif.commands.main import main
from erlif.io.files import netcdf_maps
from erlif.pipeline import run

# a server that has loaded erlif starts a process in a tenth of the time
_SERVER = "forkserver"
_METHOD = _SERVER if _SERVER in multiprocessing.get_all_start_methods() else "spawn"


def start_command(
    log: Path, *arguments: object, before: Callable[[], None] | None = None
) -> BaseProcess:
    """Start an erlif command; its messages go to a file, its output nowhere."""
    context = multiprocessing.get_context(_METHOD)
    if _METHOD == _SERVER:
        context.set_forkserver_preload(["scenes.processes", "erlif.pipeline.run"])
    process = context.Process(target=_run_command, args=(log, before, *arguments))
    process.start()
    return process


def end_command(
    log: Path, *arguments: object, before: Callable[[], None] | None = None
) -> tuple[int | None, str]:
    """Exit status and messages of a command that runs to its end."""
    process = start_command(log, *arguments, before=before)
    process.join()
    return process.exitcode, log.read_text(encoding="utf-8")


def _run_command(log: Path, before: Callable[[], None] | None, *arguments: object) -> None:
    with log.open("wb") as file:
        os.dup2(file.fileno(), 2)
    if before is not None:
        before()
    with contextlib.redirect_stdout(None):
        main([str(argument) for argument in arguments])


# what may happen to the process


def lose_the_reader_of_messages() -> None:
    """Standard error is a pipe whose other end is closed."""
    reader, writer = os.pipe()
    os.close(reader)
    os.dup2(writer, 2)
    sys.stderr = os.fdopen(2, "w", encoding="utf-8", closefd=False)  # the old one may be a file


def leave_theory_out() -> None:
    """As `maps_alone` of the tests in one process."""
    run.with_theory = lambda draft: draft


def limit_the_size_of_files() -> None:
    """To one that the film of the small rig exceeds and two triggers do not."""
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (2**20 + 90_000, 2**20 + 90_000))


def signal_at_the_third_trigger() -> None:
    """The process is asked to end."""
    write, calls = netcdf_maps.write_record, []

    def write_and_receive(*arguments):
        calls.append(arguments)
        if len(calls) == 3:
            os.kill(os.getpid(), signal.SIGTERM)
        return write(*arguments)

    netcdf_maps.write_record = write_and_receive
