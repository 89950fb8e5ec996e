"""The texts of notes on cameras, filled in."""

import pytest

from erlif.core.notes import Level
from erlif.correction.findings import find


def test_a_note_names_the_camera_and_its_numbers():
    note = find("camera2", "light_in_dark", share=0.031)
    assert (note.level, note.subject) == (Level.WARNING, "camera2")
    assert "3.1% of the light" in note.text


def test_a_note_without_its_numbers_is_a_mistake():
    with pytest.raises(KeyError):
        find("camera1", "pile_up")
