"""Pulse energies of the log, and recordings whose cameras show different laser pulses."""

import shutil

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr
from scenes.measured import statistics_of

import erlif
from conftest import SMALL, Laboratory, reorder
from erlif.core.products import EncoderLog
from erlif.pipeline.recording.pulses import ENERGY_COLUMNS, PulseError, read_energies
from erlif.rig import RigSettings, simulate

pytestmark = pytest.mark.usefixtures("without_theory")


def test_copies_at_both_ends_are_not_those_of_all_pairs(lab):
    for k in (0, -1):
        shutil.copy(lab.frames(1)[k], lab.frames(2)[k])
    assert "both cameras show the same image in frame pairs 0, 5," in statistics_of(lab.run).notes


def test_a_stuck_pair_is_named_in_the_notes(lab):
    for camera in (1, 2):
        shutil.copy(lab.frames(camera)[2], lab.frames(camera)[3])
    film = statistics_of(lab.run)
    assert "frame pairs 2, 3: they show the same image to the last count" in film.notes


@pytest.fixture(scope="module")
def longer(tmp_path_factory):
    """The same rig with more pulses, of the run and of the fixture; never to be changed."""
    longer = Laboratory(tmp_path_factory.mktemp("longer"))
    more = {"cycles": 2, "fixture_frames": 6}
    simulate(longer.directory, seed=11, rig=RigSettings(**{**vars(SMALL), **more}))
    return longer


def test_an_image_of_a_pulse_that_camera_1_lacks_is_named_in_the_notes(lab, longer):
    """Camera 2 shows the same film in a later pulse."""
    shutil.copy(longer.frames(2)[10], lab.frames(2)[4])
    film = statistics_of(lab.run)
    assert "frame pairs 4: camera 2 shows another laser pulse than camera 1" in film.notes


def test_a_fixture_in_another_order_is_refused(longer, tmp_path, refused):
    fixture = tmp_path / "fixture"
    shutil.copytree(longer.fixture, fixture)
    reorder(sorted((fixture / "camera2").iterdir()), [0, 1, 2, 3, 5, 4])
    assert "images of camera 2 are exchanged" in refused("calibrate", fixture)


def test_a_wrong_order_is_found_among_the_first_triggers(lab, monkeypatch):
    """A long run is refused before its end."""
    from erlif.pipeline.engines import triggers

    reorder(lab.frames(2), [5, 4, 3, 2, 1, 0])
    seen = []
    monkeypatch.setattr(triggers, "EARLY", 5)
    with pytest.raises(PulseError):
        erlif.process(lab.run, workers=1, progress=lambda what, *rest: seen.append((what, *rest)))
    assert ("film", 5, 6) in seen
    assert ("film", 6, 6) not in seen


@pytest.mark.parametrize("cameras", [(1, 2), (2,)])
def test_a_camera_stuck_in_the_first_triggers_alone_is_not_refused(
    longer, small_rig, tmp_path, monkeypatch, cameras
):
    """The check of the first triggers has the verdict of that at the end: a warning."""
    from erlif.pipeline.engines import triggers

    lab = Laboratory(tmp_path)
    shutil.copytree(longer.run, lab.run)
    for camera in cameras:
        frames = lab.frames(camera)
        for k in (1, 6, 7):  # with frame 0 all of the first two triggers
            shutil.copy(frames[0], frames[k])
    monkeypatch.setattr(triggers, "EARLY", 2)
    calibration = small_rig.fixture / "calibration.nc"
    notes = statistics_of(lab.run, calibration=calibration).notes.split("\n")
    assert any(line.startswith("warning: ") and "stuck" in line for line in notes)


# energies


def log_with(**columns):
    return EncoderLog(xr.Dataset({name: ("frame", values) for name, values in columns.items()}))


@pytest.mark.parametrize("name", ENERGY_COLUMNS)
def test_energies_are_relative_to_their_mean(name):
    energies = read_energies(log_with(angle=[0.0, 1.0], **{name: [40.0, 60.0]}))
    npt.assert_allclose(energies, [0.8, 1.2])


@pytest.mark.parametrize("values", [["low", "high"], [-1.0, 2.0], [0.0, 0.0], [np.nan, 1.0]])
def test_a_column_that_holds_no_energies_is_not_used(values):
    assert read_energies(log_with(pulse_energy=values)) is None


def test_energies_of_the_rig_are_those_of_its_pulses(run, truth):
    """The energy meter of the rig is good to half a per cent."""
    energies = read_energies(run.log)
    npt.assert_allclose(energies, truth.pulse_energy / truth.pulse_energy.mean(), atol=0.025)
