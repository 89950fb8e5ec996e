"""Known faults before the message of an error that may follow from them."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from erlif.core.errors import ClusterError, ErlifError, OutputError
from erlif.core.notes import Note


@contextmanager
def naming(causes: tuple[Note, ...]) -> Iterator[None]:
    """Put known faults before the message of an error that may follow from them.

    Parameters
    ----------
    causes : tuple of Note

    Yields
    ------
    None

    Raises
    ------
    ErlifError
        The same that was raised, with the faults before its message; without them where the output
        or a cluster is the cause.

    Examples
    --------
    >>> from erlif.core.notes import remark
    >>> with naming((remark("bits", "camera1: bit 5 is never set", "Check the camera"),)):
    ...     raise ErlifError("No common texture.")
    Traceback (most recent call last):
        ...
    erlif.core.errors.ErlifError: bits: camera1: bit 5 is never set. Check the camera. \
It may be the cause of what follows. No common texture.
    """
    try:
        yield
    except (OutputError, ClusterError):
        raise
    except ErlifError as error:
        if causes and error.args:
            listed = ". ".join(str(note).rstrip(".") for note in causes)
            follows = f"{listed}. It may be the cause of what follows. {error.args[0]}"
            error.args = (follows, *error.args[1:])
        raise
