"""Lines of the commands, which fit a terminal of 80 columns."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

import click

from erlif.core.notes import Level, Note
from erlif.core.units import count_of

COLUMNS = 80

_FEW = 2  # files that one line names
_LEVEL = 8  # characters of the level before a note
_HANGING = 40  # column up to which a text stands under its beginning


def verbosity() -> int:
    """Number of times that ``-v`` was given."""
    return int(click.get_current_context().meta.get("erlif.verbose", 0))


def wrap(text: str) -> str:
    """Break the lines that are longer than the terminal.

    Parameters
    ----------
    text : str
        A row of a title and a text has two spaces between them, and its text stays in its column;
        a row with more of such gaps is one of a table, and is kept.

    Returns
    -------
    str

    Examples
    --------
    >>> print(wrap("  film  " + "thickness " * 8))
      film  thickness thickness thickness thickness thickness thickness thickness
            thickness
    """
    return "\n".join(_broken(line) for line in text.splitlines())


def wrap_note(note: Note) -> str:
    """Wrap a note to the width of the terminal: its level, then its indented text.

    Parameters
    ----------
    note : Note

    Returns
    -------
    str

    Examples
    --------
    >>> print(wrap_note(Note(Level.WARNING, "light", "dim " * 18)))
    warning light: dim dim dim dim dim dim dim dim dim dim dim dim dim dim dim dim
            dim dim
    """
    first, *others = f"{note.level:{_LEVEL}s}{note}".rstrip().splitlines()
    return "\n".join([_broken(first, below=_LEVEL), *map(_broken, others)])


def _broken(line: str, below: int = 0) -> str:
    """Break a long line, with its continuation indented."""
    gaps = list(re.finditer(r"(?<=\S) {2,}(?=\S)", line))
    if len(line) <= COLUMNS or len(gaps) > 1:
        return line
    if gaps and gaps[0].end() <= _HANGING:
        below = gaps[0].end()
    below = below or len(line) - len(line.lstrip()) + 2
    # a number keeps its per cent
    line = re.sub(r"(?<=\d) %", "\xa0%", line)
    filled = textwrap.fill(
        line,
        COLUMNS,
        subsequent_indent=" " * below,
        break_long_words=False,
        break_on_hyphens=False,
    )
    return filled.replace("\xa0%", " %")


def describe_written(paths: Sequence[Path]) -> str:
    """Describe the written files in one line: the first, and the number of further ones.

    With ``-v`` all of them.
    """
    if verbosity() or len(paths) <= _FEW:
        return f"written: {', '.join(map(str, paths))}"
    return f"written: {paths[0]} and {len(paths) - 1} more beside it"


def list_notes(notes: Iterable[Note], rest: str) -> Iterator[str]:
    """Lines of findings: warnings whole, the first note of each subject, and errors at the end.

    Parameters
    ----------
    notes : iterable of Note
    rest : str
        Where the notes stand that are left out.

    Yields
    ------
    str
        With ``-v`` all notes, whole.

    Returns
    -------
    iterator
    """
    seen: set[str] = set()
    errors, left = [], 0
    for note in notes:
        lines = wrap_note(note)
        if note.level is Level.ERROR:
            errors.append(lines)
        elif note.level is Level.WARNING or verbosity():
            yield lines
        elif note.subject in seen:
            left += 1
        else:
            seen.add(note.subject)
            yield lines
    if left:
        yield f"{'more':{_LEVEL}s}{count_of(left, 'note')}: {rest}"
    yield from errors
