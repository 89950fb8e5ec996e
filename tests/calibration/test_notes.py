"""Notes of a calibration: every text of the table is in use and takes its numbers."""

import re
from pathlib import Path

import pytest

import erlif.calibration
from erlif.calibration.notes import _NOTES, make_note
from erlif.core.notes import Level

SOURCE = "".join(
    path.read_text(encoding="utf-8")
    for path in Path(erlif.calibration.__file__).parent.glob("*.py")
)


@pytest.mark.parametrize("name", _NOTES)
def test_a_note_of_the_table_is_made_somewhere(name):
    assert re.search(rf'make_note\(\s*"{name}"', SOURCE)


def test_a_note_has_level_subject_and_numbers():
    note = make_note("repeated", subject="wedge.csv", count=3)
    assert (note.level, note.subject) == (Level.WARNING, "wedge.csv")
    assert note.text.startswith("3 points repeat a position")
    assert make_note("no_uncertainty").level is Level.NOTE
