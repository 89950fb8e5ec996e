"""Both cameras with the same files."""

from erlif.pipeline.audit.files import note_copied_cameras
from erlif.pipeline.engines.results import FrameResult


def pair(number, one, two):
    return FrameResult(number, (0.0, 0.0), (0, 0), digests=(one, two))


def test_pairs_of_one_file_are_named():
    (note,) = note_copied_cameras([pair(0, "a", "b"), pair(1, "c", "c"), pair(2, "", "")])
    assert note.level == "warning"
    assert "both cameras show the same image in frame pairs 1, whose films" in note.text
    assert list(note_copied_cameras([pair(0, "a", "b"), pair(2, "", "")])) == []
