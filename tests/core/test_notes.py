"""Notes for the user."""

from erlif.core.notes import Level, Note, join_notes, remark, warn


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


def test_a_note_with_a_cure_is_a_warning():
    cured = remark("load", "load 2 N", "Correct it")
    assert cured == warn("load", "load 2 N. Correct it")
    assert remark("load", "load 2 N").level is Level.NOTE
