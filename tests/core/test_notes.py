"""Notes for the user."""

from dataclasses import FrozenInstanceError

import pytest

from erlif.core.notes import Level, Note, join_notes


def test_a_note_stands_behind_its_subject():
    assert str(Note(Level.WARNING, "camera2", "no flat")) == "camera2: no flat"


def test_a_note_on_the_whole_run_has_no_subject():
    assert str(Note(Level.NOTE, "", "12 frame pairs")) == "12 frame pairs"


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


def test_a_note_cannot_be_changed():
    note = Note(Level.NOTE, "camera1", "dark 64.0 DN")
    with pytest.raises(FrozenInstanceError):
        note.text = "dark 65.0 DN"


@pytest.mark.parametrize("level", Level)
def test_a_level_is_written_as_its_word(level):
    """Files and the command line keep the level as text."""
    assert f"{level}" == level.value == level.name.lower()
    assert Level(str(level)) is level
