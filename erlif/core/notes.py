"""Notes for the user: what was found about an input or a result, with its level and its subject."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from enum import StrEnum


class Level(StrEnum):
    """Consequence of a finding."""

    NOTE = "note"  #: a measured value or a choice that was made
    WARNING = "warning"  #: a result is affected, or an input looks wrong
    ERROR = "error"  #: the input cannot be used


@dataclass(frozen=True)
class Note:
    """One finding about an input or a result.

    Attributes
    ----------
    level : Level
        Consequence of the finding.
    subject : str
        Camera, file, calibration or frame pair: "camera1", "frame pair 12"; empty for the run.
    text : str
        The finding, without its subject.

    Examples
    --------
    >>> str(Note(Level.WARNING, "camera2", "no flat"))
    'camera2: no flat'
    """

    level: Level
    subject: str
    text: str

    def __str__(self) -> str:
        return f"{self.subject}: {self.text}" if self.subject else self.text


def remark(subject: str, text: str, cure: str = "") -> Note:
    """A note; a warning that ends with its cure where there is one.

    Parameters
    ----------
    subject : str
    text : str
    cure : str
        What to do, without a full stop.

    Returns
    -------
    Note

    Examples
    --------
    >>> remark("load", "load 2 to 4 N").level, remark("load", "load 2 N", "Correct it").text
    (<Level.NOTE: 'note'>, 'load 2 N. Correct it')
    """
    return (
        Note(Level.WARNING, subject, f"{text}. {cure}") if cure else Note(Level.NOTE, subject, text)
    )


def warn(subject: str, text: str) -> Note:
    """A warning: what was found, and what to do."""
    return Note(Level.WARNING, subject, text)


def retitle(subject: str, notes: Iterable[Note]) -> Iterator[Note]:
    """Notes under another subject; their own stands before the text.

    Parameters
    ----------
    subject : str
    notes : iterable of Note

    Yields
    ------
    Note

    Examples
    --------
    >>> [str(note) for note in retitle("cameras", [remark("camera1", "dark 64.0 DN")])]
    ['cameras: camera1: dark 64.0 DN']
    """
    return (Note(note.level, subject, str(note)) for note in notes)


_ORDER = (Level.ERROR, Level.WARNING, Level.NOTE)


def rank_notes(notes: Iterable[Note]) -> list[Note]:
    """Notes with errors and warnings first; those of one level keep their order.

    Parameters
    ----------
    notes : iterable of Note

    Returns
    -------
    list of Note

    Examples
    --------
    >>> found = [Note(Level.NOTE, "camera1", "dark 64.0 DN"), Note(Level.WARNING, "", "no flat")]
    >>> str(rank_notes(found)[0])
    'no flat'
    """
    return sorted(notes, key=lambda note: _ORDER.index(note.level))


def join_notes(notes: Iterable[Note]) -> str:
    """Notes as the lines of a file attribute: warnings first, each marked as one.

    Parameters
    ----------
    notes : iterable of Note

    Returns
    -------
    str
        One line each; those of one level keep their order.

    Examples
    --------
    >>> join_notes([Note(Level.NOTE, "camera1", "dark 64.0 DN")])
    'camera1: dark 64.0 DN'
    """
    ordered = rank_notes(notes)
    return "\n".join(
        str(note) if note.level is Level.NOTE else f"{note.level}: {note}" for note in ordered
    )


def split_notes(text: str) -> list[tuple[Level, str]]:
    """Levels and texts of the lines that `join_notes` has written.

    Parameters
    ----------
    text : str

    Returns
    -------
    list of (Level, str)

    Examples
    --------
    >>> split_notes("warning: log: no load\\ncamera1: dark 64.0 DN")
    [(<Level.WARNING: 'warning'>, 'log: no load'), (<Level.NOTE: 'note'>, 'camera1: dark 64.0 DN')]
    """
    notes = []
    for line in filter(None, text.split("\n")):
        level, _, rest = line.partition(": ")
        serious = level in (Level.WARNING, Level.ERROR)
        notes.append((Level(level), rest) if serious else (Level.NOTE, line))
    return notes


def list_some(items: Iterable[object], *, most: int = 10) -> str:
    """Numbers or names for a sentence; those beyond the first ones are counted.

    Parameters
    ----------
    items : iterable
    most : int
        Items that are written.

    Returns
    -------
    str

    Examples
    --------
    >>> list_some([3, 5, 8], most=2)
    '3, 5 and 1 more'
    """
    words = [str(item) for item in items]
    more = f" and {len(words) - most} more" if len(words) > most else ""
    return ", ".join(words[:most]) + more
