"""Log lines of erlif on the terminal: ``-v`` shows decisions and times, ``-vv`` details."""

from __future__ import annotations

import logging

from erlif.commands.ending import echo_aside

# Level for no `-v`, one and two.
LEVELS = (logging.WARNING, logging.INFO, logging.DEBUG)


class TerminalHandler(logging.Handler):
    """Writes log lines to standard error, above a progress bar where there is one."""

    def emit(self, record: logging.LogRecord) -> None:
        """Write one line."""
        echo_aside(self.format(record))


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
    for handler in logger.handlers:
        if isinstance(handler, TerminalHandler):
            logger.removeHandler(handler)
            break

    handler = TerminalHandler()
    handler.setFormatter(_ElapsedFormatter() if verbosity else logging.Formatter())
    logger.addHandler(handler)
    logger.setLevel(LEVELS[min(verbosity, len(LEVELS) - 1)])

    # erlif reports damaged TIFF files itself, in one message
    logging.getLogger("tifffile").setLevel(logging.CRITICAL)
