"""The command ``erlif``: the group of all commands, and the exit status of each kind of failure.

Log lines go to the terminal: ``-v`` shows decisions and times, ``-vv`` details.
"""

from __future__ import annotations

import io
import logging
import os
import signal
import sys
import traceback
import warnings
from collections.abc import Callable
from importlib import import_module
from itertools import chain
from typing import Any

import click

from erlif.commands import ending
from erlif.commands.lines import verbosity
from erlif.core.errors import ErlifError, RangeWarning, UnitWarning
from erlif.core.version import version_and_sources

# The commands in the order of their use, by what they serve.
COMMANDS = {
    "Measure": ("sample", "start", "init", "check", "calibrate", "watch", "process"),
    "Look": ("view", "figures", "report", "movie", "export", "compare"),
    "Explain": ("budget", "predict", "pressure"),
    "Plan a rig": ("simulate", "plan"),
    "Joint": ("design", "linkage", "endurance", "friction"),
}

# Warnings of models about their arguments: each text is shown once.
_OF_MODELS = (UnitWarning, RangeWarning)

# Folder of the commands of the joint, which nothing else of erlif names.
_JOINT = "erlif.joint.commands"

# Characters of the longest name of a command, and of the line beside it, at 80 columns.
_NAME, _WIDTH = 9, 67


class _Commands(click.Group):
    """Bad input ends with one message and status 2, a defect of erlif with status 1."""

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        formatter.write_paragraph()
        for group, names in COMMANDS.items():
            rows = [(name, self.commands[name].get_short_help_str(_WIDTH)) for name in names]
            formatter.write(f"{group}:\n")
            with formatter.indentation():
                formatter.write_dl(rows, col_spacing=_NAME + 2 - max(map(len, names)))

    def invoke(self, ctx: click.Context) -> Any:
        # numpy and scipy are not loaded yet; the matrices are small, so that threads of linear
        # algebra mostly wait for each other, and erlif has its own
        os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
        # figures are files: the backend of a notebook or of a display may not be installed here
        os.environ["MPLBACKEND"] = "agg"
        ending.open_missing_streams()
        try:
            ending.refuse_little_memory()
            with ending.signals_interrupt(), warnings.catch_warnings():
                for kind in _OF_MODELS:
                    warnings.filterwarnings("always", category=kind)
                warnings.showwarning = _show_once()
                return super().invoke(ctx)

        # click reports wrong usage itself, with status 2
        except (click.ClickException, click.exceptions.Exit, click.Abort):
            raise
        except ErlifError as error:
            ending.echo_refusal(f"erlif: {error}")
            ctx.exit(ending.BAD_INPUT)
        except ending.EndedBySignal as error:
            name = signal.Signals(error.args[0]).name
            ending.echo_aside(
                f"erlif: ended by {name}. The previous output is intact; the same command resumes."
            )
            ctx.exit(ending.BY_SIGNAL + error.args[0])
        except KeyboardInterrupt:
            ending.echo_aside(
                "erlif: interrupted. The previous output is intact; the same command resumes."
            )
            ctx.exit(ending.INTERRUPTED)

        # a reader such as `head` has closed the pipe; nobody reads a message
        except BrokenPipeError:
            ending.silence("stdout")
            ctx.exit(1)
        except OSError as error:
            reason = f"{error.strerror or error}: {error.filename or ''}"
            ending.echo_aside(
                f"erlif: {reason}. The previous output is intact. Check that the file may be read "
                "and written and that the disk has room, and start again."
            )
            ctx.exit(ending.BAD_INPUT)
        except MemoryError:
            ending.echo_aside(
                "erlif: there is not enough memory. The previous output is intact. Raise the limit "
                "(ulimit -v), use fewer workers, or a machine with more, and start again."
            )
            ctx.exit(ending.BAD_INPUT)
        except Exception:
            ending.echo_aside(traceback.format_exc())
            ending.echo_aside(
                "erlif: this is a defect of erlif; please report it with the lines above."
            )
            ctx.exit(ending.DEFECT)


def _show_once() -> Callable[..., None]:
    """Writes each warning of a model as one line, without the place in erlif where it arose."""
    shown = set()

    def show(
        message: Warning | str, category: type[Warning], filename: str, lineno: int, *_: Any
    ) -> None:
        place = "" if issubclass(category, _OF_MODELS) else f" ({filename}:{lineno})"
        line = f"  warning: {message}{place}"
        if line not in shown:
            shown.add(line)
            ending.echo_aside(line)

    return show


def _show_more(ctx: click.Context, option: click.Parameter, value: int) -> None:
    """Raise the verbosity by ``-v`` given before or after the name of a command."""
    if value:
        ctx.meta["erlif.verbose"] = verbosity() + value
        show_log(verbosity())


def _show_version(ctx: click.Context, _: click.Parameter, asked: bool) -> None:
    if asked and not ctx.resilient_parsing:
        click.echo(f"erlif, version {version_and_sources()}")
        ctx.exit()


_VERBOSE = click.option(
    "-v",
    "--verbose",
    count=True,
    expose_value=False,
    callback=_show_more,
    help="All notes, times and memory; -vv details.",
)


@click.group(cls=_Commands, context_settings={"help_option_names": ["-h", "--help"]})
@click.option(
    "--version",
    is_flag=True,
    expose_value=False,
    is_eager=True,
    callback=_show_version,
    help="Show the version and exit.",
)
@_VERBOSE
def main() -> None:
    """Oil-film thickness maps with error bars from two-camera fluorescence.

    \b
    Example:
      erlif sample first
      erlif process first/run
    """
    show_log(verbosity())

    # a terminal that lacks a character, such as the micro sign, shows a replacement for it
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")


# each module has the name of its command; what is heavy loads when a command runs
for name in chain.from_iterable(COMMANDS.values()):
    folder = _JOINT if name in COMMANDS["Joint"] else "erlif.commands"
    command = getattr(import_module(f"{folder}.{name}"), name)
    main.add_command(_VERBOSE(command))


# Level for no `-v`, one and two.
LEVELS = (logging.WARNING, logging.INFO, logging.DEBUG)


class TerminalHandler(logging.Handler):
    """Writes log lines to standard error, above a progress bar where there is one."""

    def emit(self, record: logging.LogRecord) -> None:
        """Write one line."""
        ending.echo_aside(self.format(record))


class _ElapsedFormatter(logging.Formatter):
    """Seconds since the start of the program, stage and text."""

    def format(self, record: logging.LogRecord) -> str:
        # the stages themselves are logged by "erlif", their decisions by their modules
        module = record.name.removeprefix("erlif").removeprefix(".")
        place = f"{module}: " if module else ""
        text = f"{record.relativeCreated / 1e3:8.2f} s  {place}{record.getMessage()}"
        if record.exc_info:
            text = f"{text}\n{self.formatException(record.exc_info)}"
        return text


def show_log(verbosity: int) -> None:
    """Send the log lines of erlif to the terminal.

    Parameters
    ----------
    verbosity : int
        0 for warnings only, 1 for decisions and times of the stages, 2 for details.
    """
    logger = logging.getLogger("erlif")
    for earlier in [one for one in logger.handlers if isinstance(one, TerminalHandler)]:
        logger.removeHandler(earlier)

    handler = TerminalHandler()
    handler.setFormatter(_ElapsedFormatter() if verbosity else logging.Formatter())
    logger.addHandler(handler)
    logger.setLevel(LEVELS[min(verbosity, len(LEVELS) - 1)])

    # erlif reports damaged TIFF files itself; without a cache of matplotlib figures are the same
    for package in ("tifffile", "matplotlib"):
        logging.getLogger(package).setLevel(logging.CRITICAL)
