"""The errors and warnings of erlif.

Each message states what was expected, what was found and what to do next.
"""

from __future__ import annotations

import re

# Characters of one line of a message above which its middle is left out, and what stays.
_LONGEST = 5000
_QUOTED = 500


class ErlifError(Exception):
    """Base of all errors caused by the input and not by erlif.

    The commands end with exit status 2 after it. Of an input that a message quotes, the first
    characters serve.
    """

    def __str__(self) -> str:
        text = super().__str__()
        if len(text) <= _LONGEST:
            return text
        # lists of many faults stay, a line without end does not
        return "\n".join(
            line if len(line) <= _LONGEST else f"{line[:_QUOTED]} ... {line[-_QUOTED:]}"
            for line in text.split("\n")
        )


class ConfigError(ErlifError):
    """A settings file (run.toml, fixture.toml) that cannot be used."""


class FrameError(ErlifError):
    """Frames that are missing, damaged, of another size, or in conflict with their settings."""


class EncoderError(ErlifError):
    """An encoder log that does not belong to the frames or to the mechanism."""


class RegistrationError(ErlifError):
    """Two cameras whose images could not be brought onto one pixel grid."""


class CalibrationError(ErlifError):
    """A calibration that could not be made, or that does not belong to the run."""


class EnduranceError(ErlifError):
    """The log of an endurance test that cannot be read or analysed."""


class OutputError(ErlifError):
    """An output that exists already or could not be written."""


class ClusterError(ErlifError):
    """A scheduler or workers that cannot be used."""


class ModelError(ErlifError, ValueError):
    """An argument outside the range in which a model of the joint is defined."""


class UnitWarning(UserWarning):
    """An argument of a model that is probably given in another unit than the SI unit expected."""


class RangeWarning(UserWarning):
    """A fitted equation used beyond the range over which its source fitted it."""


# Length of a foreign text in a message; one of a damaged file may have megabytes. [character]
LONGEST_REASON = 200

# Texts of the HDF5 library, and what they mean.
_PLAIN = (
    (r".*file signature not found.*", "it is no HDF5 file"),
    (r".*truncated file: eof = (\d+).*stored_eof = (\d+).*", r"\1 of its \2 bytes are there"),
    (r"Unable to synchronously open file \((unable to lock.*)\)", r"it cannot be opened: \1"),
    (r"Unable to synchronously open file.*", "its header is damaged"),
    (r"(?:Unable to|Can't) synchronously read data(.*)", r"its values cannot be read\1"),
    (r".*object '(.+)' doesn't exist.*", r"its part \1 is missing"),
    (r".*group not found: ([^\s\]]+).*", r"its part \1 is missing"),
    (r".*Unable to synchronously open object.*|.*group not found.*", "a part of it is missing"),
)


def reason_of(error: BaseException) -> str:
    """Shorten the text of an exception to a reason that fits into a message.

    Parameters
    ----------
    error : BaseException

    Returns
    -------
    str
        The first line of its text, cut to a length that can be read, or its class.

    Examples
    --------
    >>> reason_of(OSError("bad symbol\\nat 0x10.")), reason_of(MemoryError())
    ('bad symbol', 'MemoryError')
    >>> reason_of(OSError("Unable to synchronously open file (file signature not found)"))
    'it is no HDF5 file'
    """
    first = str(error).strip().partition("\n")[0].rstrip(".")
    for text, meaning in _PLAIN:
        match = re.fullmatch(text, first[: 5 * LONGEST_REASON])
        if match is not None:
            first = match.expand(meaning)
            break
    return first[:LONGEST_REASON] or type(error).__name__
