"""Runs whose cameras are exchanged, and runs whose ratio is wrong by another cause."""

import shutil
from dataclasses import replace

import pytest
from scenes.preparing import prepare

import erlif
from conftest import FULL
from erlif.core.errors import CalibrationError
from erlif.core.notes import Level
from erlif.rig import RigSettings, simulate

pytestmark = pytest.mark.usefixtures("without_theory")

NEAR_ONE = {"film_reference": 9.5, "film_floor": 8.0}
"""Films of 9 to 11 um: ratio and inverse both lie in the calibrated range."""

SMALL = {
    "width": 160,
    "height": 128,
    "spacing": 8.0,
    "fixture_frames": 4,
    "dark_pages": 8,
    "flat_pages": 4,
}


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


@pytest.fixture(scope="module")
def sound(tmp_path_factory):
    """A rig and its calibration; never to be changed."""
    out = simulate(tmp_path_factory.mktemp("sound"), seed=3, rig=RigSettings(**SMALL))
    return out, erlif.calibrate(out / "fixture")


def notes_on_ratio(directory, calibration):
    prepared = prepare(directory / "run", calibration)
    return [note for note in prepared.notes if note.subject == "ratio"]


def order_of(note, *causes):
    """Places of words in the text of a note."""
    places = [note.text.find(cause) for cause in causes]
    assert min(places) > 0, note.text
    return places


@pytest.mark.parametrize("seed", [20, 22, 24] if FULL else [20, 24])
def test_cameras_in_order_are_never_taken_for_exchanged(tmp_path, seed):
    """The later rigs vibrate."""
    rig = RigSettings(**SMALL, **NEAR_ONE, vibration=0.2 * (seed - 20))
    simulate(tmp_path, seed=seed, rig=rig)
    assert notes_on_ratio(tmp_path, erlif.calibrate(tmp_path / "fixture")) == []


@pytest.mark.parametrize(
    "damage",
    [
        {"brightness": (1.0, 1.25)},
        {"brightness": (1.0, 0.75), "film_reference": 3.0},  # below the ratio of no film
        {"wall": (0.1, 0.3)},
    ],
)
def test_wrong_ratio_is_a_warning_and_the_map_excludes_exchanged_cameras(sound, tmp_path, damage):
    """Light, filter or gain of one camera, and a wall of another reflectance.

    The limits are two errors of the fixture wide, 4 % of this one: 10 % are found or not by chance.
    """
    before_wall = "wall" in damage  # the fixture has one too
    frames = {} if before_wall else {"fixture_frames": 1}
    simulate(tmp_path, seed=3, rig=RigSettings(**(SMALL | frames | damage)))
    calibration = erlif.calibrate(tmp_path / "fixture") if before_wall else sound[1]
    (note,) = notes_on_ratio(tmp_path, calibration)
    assert note.level is Level.WARNING
    light, wall, fixture = order_of(note, "exposure, filter or gain", "the wall", "the profile")
    assert light < wall < fixture
    assert "The cameras are not exchanged" in note.text


def test_exchanged_cameras_without_a_map_are_one_cause_among_others(sound, tmp_path):
    out, calibration = sound
    shutil.copytree(out / "run", tmp_path / "run")
    exchange_cameras(tmp_path / "run")
    (note,) = notes_on_ratio(tmp_path, replace(calibration, camera_map=None))
    light, exchanged = order_of(note, "exposure, filter or gain", "the cameras are exchanged")
    assert light < exchanged
