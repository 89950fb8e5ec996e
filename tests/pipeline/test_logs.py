"""Runs with other encoders and logs give the film of the same rig, within its error bars."""

import shutil

import numpy as np
import pytest
import xarray as xr
from scenes.linkage import apart
from scenes.measured import statistics_of

from conftest import SMALL
from erlif.io.ingest import open_run
from erlif.pipeline.physics.joint import locate_run
from erlif.rig import RigSettings, simulate

FEW = {**vars(SMALL), "fixture_frames": 1, "dark_pages": 2, "flat_pages": 2, "flat_levels": (0.5,)}


def make_run(out, seed=11, **changes):
    simulate(out, seed=seed, rig=RigSettings(**{**FEW, **changes}))
    with xr.open_dataset(out / "truth.nc", engine="h5netcdf") as truth:
        return open_run(out / "run"), truth.load()


@pytest.mark.parametrize(
    ("changes", "tolerance"),
    [
        ({"encoder": "crank"}, 0.1),
        ({"encoder": "coupler", "reading": "wrapped"}, 0.1),
        ({"reading": "ticks"}, 1.0),  # 0.005 degree of the rocker, five degrees off a dead point
        ({"log": "continuous", "encoder": "coupler", "reading": "ticks"}, 1.5),
        # half a row of the log is 0.03 degree of the crank
        ({"log": "continuous", "encoder": "crank", "pulses_per_cycle": 7.3}, 0.5),
    ],
    ids=str,
)
def test_the_crank_angle_is_that_of_the_rig(tmp_path, changes, tolerance):
    run, truth = make_run(tmp_path, **changes)
    located = locate_run(run)
    assert apart(located.crank_angle, truth.crank_angle).max() < tolerance
    np.testing.assert_array_equal(located.stroke, np.sign(truth.rocker_speed))
    np.testing.assert_allclose(located.rocker_speed, truth.rocker_speed, atol=0.03)
    np.testing.assert_allclose(run.log["joint_load"], truth["joint_load"], rtol=1e-4)


def test_pulses_that_do_not_repeat_are_averaged_by_bins_of_one_stroke(small_rig, tmp_path):
    changes = {"pulses_per_cycle": 6.4, "cycles": 4, "bubbles": 0}
    run, truth = make_run(tmp_path, **changes)
    assert locate_run(run).trigger.values.tolist() == list(range(25))
    settings = run.directory / "run.toml"
    text = settings.read_text(encoding="utf-8")
    settings.write_text(text.replace("[encoder]", "[encoder]\nbins = 6"), encoding="utf-8")
    located = locate_run(open_run(run.directory))
    assert int(located.trigger.max()) == 5
    for trigger in range(6):
        members = located.trigger.values == trigger
        assert abs(np.sign(truth.rocker_speed.values[members]).sum()) == members.sum()

    shutil.copy(small_rig.fixture / "calibration.nc", tmp_path / "fixture" / "calibration.nc")
    film = statistics_of(run.directory)
    assert film.frames_used.sum() == 25
    assert set(film.stroke.values.tolist()) == {-1, 1}
