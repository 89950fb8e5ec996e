"""A command in a process of its own, by a function that another process can import."""

import contextlib
import os
from pathlib import Path

from erlif.commands.main import main


def run_command(log: Path, *arguments: object) -> None:
    """Run an erlif command and end as it does; its messages go to a file, its output nowhere."""
    with log.open("wb") as file:
        os.dup2(file.fileno(), 2)
    with contextlib.redirect_stdout(None):
        main([str(argument) for argument in arguments])
