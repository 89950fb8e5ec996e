"""Notes of a calibration, from one table of texts."""

from __future__ import annotations

import tomllib
from importlib.resources import files
from typing import Any

from erlif.core.notes import Level, Note

_NOTES = tomllib.loads((files("erlif.calibration") / "notes.toml").read_text(encoding="utf-8"))


def make_note(name: str, *, subject: str = "", **numbers: Any) -> Note:
    """A note of ``notes.toml`` with its numbers.

    Parameters
    ----------
    name : str
        Key of the note.
    subject : str
        What it is about; empty for the calibration itself.
    **numbers
        What its text names.

    Returns
    -------
    Note
    """
    entry = _NOTES[name]
    text = str(entry["text"]).format(**numbers)
    return Note(Level(entry.get("level", Level.NOTE)), subject, text)
