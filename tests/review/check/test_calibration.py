"""Calibrations that do not fit the run, or are older than their fixture."""

import numpy as np
import pytest

import erlif
from erlif.review.check.calibration import note_age, note_range


@pytest.mark.parametrize(("shift", "level"), [(0.0, "note"), (0.5, "warning"), (-0.8, "warning")])
def test_ratios_are_compared_with_the_calibrated_range(calibration, shift, level):
    low, high = calibration.predict_log(calibration.thickness_range)
    ratios = np.linspace(low, high, 1000) + shift
    (note,) = note_range(calibration, ratios)
    assert note.level == level
    assert ("Calibrate again" in note.text) == (level == "warning")


def test_shares_beyond_the_range_are_those_that_a_map_flags(calibration):
    low, high = calibration.predict_log(calibration.thickness_range)
    beyond = high + 0.01 * (high - low)
    ratios = np.append(np.linspace(low, high, 800)[1:-1], np.full(200, beyond))
    (note,) = note_range(calibration, ratios)
    assert "0% lie below and 20% above" in note.text


def test_a_run_without_ratios_is_a_warning(calibration):
    (note,) = note_range(calibration, np.array([]))
    assert note.level == "warning"


def test_another_pitch_than_that_of_the_fixture_is_a_warning_of_check_and_process(lab):
    lab.edit("run/run.toml", ('pixel_pitch = "150 um"', 'pixel_pitch = "160 um"'))
    texts = [str(note) for note in erlif.check(lab.run) if note.level == "warning"]
    texts.append(erlif.process(lab.run, workers=1).attrs["notes"])
    assert len([text for text in texts if "150 um in fixture.toml" in text]) == 2


def test_a_fixture_that_cannot_be_read_is_a_warning(lab, calibration):
    lab.edit("fixture/fixture.toml", ("12", "twelve"))
    (note,) = note_age(calibration, lab.fixture / "calibration.nc", allow_outside=False)
    assert "the fixture beside it cannot be read" in note.text
