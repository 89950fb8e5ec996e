"""The film beside its maps: statistics, frames and notes."""

from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr
from scenes.results import make_result

from erlif.calibration import RunCurve
from erlif.core.notes import Level, Note
from erlif.pipeline.cycle import describe_triggers
from erlif.pipeline.film import FilmDraft, assemble_frames, describe_statistics, with_record
from erlif.pipeline.physics.findings import LightFindings
from erlif.pipeline.recording.prepare import PreparedRun


@pytest.fixture
def make_film(cycles, prepared):
    """The root group of a film, by its last step."""

    def make(calibration, *, notes=(), **changes):
        run, cycle = cycles
        results = [make_result(k, k + 6, **changes) for k in range(6)]
        film = describe_triggers(run, cycle).assign(describe_statistics(results, calibration))
        notes = *notes, Note(Level.WARNING, "camera1", "a note of the cameras")
        curve = RunCurve.of(calibration)
        ready = PreparedRun(run, cycle, prepared.chain, curve, LightFindings(), (), ())
        draft = FilmDraft(ready, results, curve, film, xr.Dataset(), notes)
        return with_record(draft, {"run.toml": "ab" * 32})[0]

    return make


def test_warnings_come_first_and_gains_once(make_film, calibration):
    """The gains of the fixture's recording are in the notes of the calibration itself."""
    gains = Note(Level.NOTE, "cameras", "camera1 gain 4.4; camera2 gain 4.4")
    again = Note(Level.NOTE, "cameras", "camera1 gain 4.3; camera2 gain 4.5")
    fitted = replace(
        calibration, notes=(again, Note(Level.WARNING, "darks", "dark pages are missing"))
    )
    lines = make_film(fitted, notes=[gains]).attrs["notes"].split("\n")
    assert lines[:2] == [
        "warning: camera1: a note of the cameras",
        "warning: calibration: darks: dark pages are missing",
    ]
    assert not any(line.startswith("warning") for line in lines[2:])
    assert [line for line in lines if "gain" in line] == [str(gains)]


def test_share_beyond_the_range_has_a_note_from_one_per_cent_on(make_film, calibration):
    assert "film_mean lacks" not in make_film(calibration).attrs["notes"]
    notes = make_film(calibration, beyond_range=0.12).attrs["notes"]
    assert "film_mean lacks up to 12% of the region (trigger 0)" in notes


def test_a_warning_of_the_calibration_stands_before_what_follows_from_it(make_film, calibration):
    off = replace(calibration, notes=(Note(Level.WARNING, "profile.csv", "all films are off"),))
    notes = make_film(off, beyond_range=0.12).attrs["notes"]
    assert notes.index("all films are off") < notes.index("film_mean lacks")


def test_frames_have_their_drift_about_the_mean_and_relative_pulse_energy(cycles):
    """Drifts 0.1 k and -0.2 k px less the mean; energies 100 + k over their mean 105.5."""
    run, cycle = cycles
    results = [make_result(k, k + 6) for k in range(6)]
    frames = assemble_frames(run, cycle, results, np.array([0.55, -1.1]))
    number = np.arange(12)
    npt.assert_allclose(frames.drift_x, 0.1 * number - 0.55, atol=1e-12)
    npt.assert_allclose(frames.drift_y, -0.2 * number + 1.1, atol=1e-12)
    npt.assert_allclose(frames.pulse_energy, (100 + number) / 105.5)
    assert str(frames.file_camera2.values[3]) == "frame_0003.tif"


def test_frames_that_were_left_out_have_no_drift(cycles):
    run, cycle = cycles
    run = replace(run, pairs=replace(run.pairs, skipped={7: "damaged"}))
    results = [make_result(*([k, k + 6] if k != 1 else [k])) for k in range(6)]
    frames = assemble_frames(run, cycle, results, np.zeros(2))
    assert np.flatnonzero(np.isnan(frames.drift_x)).tolist() == [7]
    assert "damaged" in frames.attrs["skipped_frames"]
