"""Notes on darks, flats and cameras; their texts are in ``notes.toml`` beside this module."""

from __future__ import annotations

import tomllib
from importlib.resources import files
from typing import Any

from erlif.core.notes import Level, Note


def read_table(name: str) -> dict[str, Any]:
    """A table of this folder."""
    return tomllib.loads((files("erlif.correction") / name).read_text(encoding="utf-8"))


_TEXTS = read_table("notes.toml")


def find(subject: str, key: str, *, level: Level = Level.WARNING, **numbers: float | str) -> Note:
    """The note of a key of the table about a camera, with its numbers filled in."""
    return Note(level, subject, _TEXTS[level][key].format(**numbers))
