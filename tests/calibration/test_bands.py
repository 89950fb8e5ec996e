"""Filter bands of a calibration against those of a run."""

from erlif.calibration import note_pitch, share_bands


def test_bands_agree_to_one_nanometre_in_both_cameras():
    assert share_bands((580.0, 610.0), (580.9, 609.1))
    assert not share_bands((580.0, 610.0), (581.1, 610.0))
    assert not share_bands((580.0, 610.0), (580.0, 608.9))


def test_another_pitch_of_the_fixture_is_a_warning_with_both_numbers():
    (note,) = note_pitch(0.06, 0.009375)
    assert note.level == "warning"
    assert "60 um in fixture.toml of the calibration, 9.375 um in run.toml" in note.text
    assert not [*note_pitch(0.06, 0.0612), *note_pitch(None, 0.06)]
