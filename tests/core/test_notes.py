"""Notes for the user."""

import re
from importlib.resources import files

import pytest

from erlif.core.notes import Level, Note, join_notes, note_writer
from erlif.core.tables import read_table

TABLES = (
    ("erlif.calibration", "notes.toml"),
    ("erlif.pipeline.audit", "notes.toml"),
    ("erlif.prediction", "notes.toml"),
    ("erlif.review", "init.toml"),
    ("erlif.review.check", "notes.toml"),
)


def test_notes_are_joined_as_lines_with_warnings_first():
    notes = [
        Note(Level.NOTE, "camera1", "a"),
        Note(Level.WARNING, "camera2", "b"),
        Note(Level.ERROR, "", "c"),
        Note(Level.WARNING, "", "d"),
        Note(Level.NOTE, "e", ""),
    ]
    expected = ["error: c", "warning: camera2: b", "warning: d", "camera1: a", "e: "]
    assert join_notes(iter(notes)).splitlines() == expected
    assert join_notes([]) == ""


@pytest.mark.parametrize(("package", "name"), TABLES)
def test_every_note_of_a_table_is_made_somewhere(package, name):
    source = "".join(path.read_text("utf-8") for path in files(package).glob("*.py"))
    unused = [key for key in read_table(package, name) if not re.search(rf'[("]{key}"', source)]
    assert not unused


def test_a_note_with_a_cure_is_a_warning_where_the_cure_is_needed():
    write = note_writer("erlif.review.check")
    assert write("overlap", overlap=0.4).level is Level.WARNING
    assert write("overlap", overlap=0.4).text.endswith(
        ". Turn the cameras until both show the same part of the joint"
    )
    assert write("overlap", wrong=False, overlap=0.9).level is Level.NOTE
