"""Runs whose cameras are exchanged in run.toml, with films whose ratio lies near 1."""

import pytest

import erlif
from erlif.core.errors import CalibrationError
from erlif.core.progress import silent
from erlif.io.ingest import open_run
from erlif.pipeline.physics.joint import locate_run
from erlif.pipeline.recording.prepare import prepare_run
from erlif.pipeline.recording.register import FixtureMap
from erlif.rig import RigSettings, simulate

NEAR_ONE = {"film_reference": 9.5, "film_floor": 8.0}
"""Films of 9 to 11 um: ratio and inverse both lie in the calibrated range."""

SMALL = {"width": 160, "height": 128, "spacing": 8.0, "fixture_frames": 4}


def exchange_cameras(run):
    """Exchange frames, darks and flats of the two cameras; the bands stay."""
    path = run / "run.toml"
    text = path.read_text(encoding="utf-8")
    for name in ("/", "_dark", "_flat"):
        one, two, other = f'"camera1{name}', f'"camera2{name}', f'"other{name}'
        text = text.replace(one, other).replace(two, one).replace(other, two)
    path.write_text(text, encoding="utf-8")


@pytest.fixture(scope="module")
def rehearsal(tmp_path_factory):
    out = tmp_path_factory.mktemp("near-one")
    return simulate(out, seed=3, rig=RigSettings(**SMALL, **NEAR_ONE))


def test_exchanged_cameras_are_recognised_by_their_map(rehearsal):
    calibration = erlif.calibrate(rehearsal / "fixture")
    assert erlif.process(rehearsal / "run", calibration=calibration).film_mean.mean() > 9
    exchange_cameras(rehearsal / "run")
    with pytest.raises(CalibrationError, match="look swapped: exchange the files"):
        erlif.process(rehearsal / "run", calibration=calibration)


@pytest.mark.parametrize("seed", [20, 22, 24])
def test_cameras_in_order_are_never_taken_for_exchanged(tmp_path, seed):
    """The way to a film as far as exchanged cameras are refused; two of the rigs vibrate."""
    rig = RigSettings(**SMALL, **NEAR_ONE, vibration=0.2 * (seed - 20))
    simulate(tmp_path, seed=seed, rig=rig)
    run, calibration = open_run(tmp_path / "run"), erlif.calibrate(tmp_path / "fixture")
    known = FixtureMap.of(calibration, run.settings)
    prepare_run(run, locate_run(run), calibration, known, silent)
