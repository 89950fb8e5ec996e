"""Notes on darks, flats and cameras; their texts are in ``notes.toml`` beside this module."""

from __future__ import annotations

from erlif.core.notes import Level, Note
from erlif.core.tables import read_table

_TEXTS = read_table("erlif.correction", "notes.toml")


def find(subject: str, key: str, *, level: Level = Level.WARNING, **numbers: float | str) -> Note:
    """The note of a key of the table about a camera, with its numbers filled in."""
    return Note(level, subject, _TEXTS[level][key].format(**numbers))
