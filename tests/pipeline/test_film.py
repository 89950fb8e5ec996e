"""The film beside its maps: triggers, statistics, exponents, frames and notes."""

import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr
from scenes.film import RUN_TOML
from scenes.results import make_result

from erlif.core.errors import ConfigError
from erlif.core.notes import Level, Note
from erlif.io.ingest import FramePairs, open_run
from erlif.io.ingest.images import Page
from erlif.io.settings import RunSettings
from erlif.pipeline.film import (
    _note_moved_mean,
    _trigger_mean,
    assemble_film,
    assemble_frames,
    describe_exponents,
    describe_statistics,
    describe_triggers,
    group_frames,
)
from erlif.pipeline.physics.joint import locate_run
from erlif.pipeline.physics.prediction import NO_PREDICTION
from erlif.pipeline.plane import ObjectPlane

SETTINGS = RunSettings.model_validate(tomllib.loads(RUN_TOML))


def pairs_of(count, skipped=()):
    pages = tuple(Page(Path(f"frame_{k}.tif"), 0) for k in range(count))
    reasons = dict.fromkeys(skipped, "damaged")
    return FramePairs(Path(), (pages, pages), (64, 80), (12, 12), reasons)


def cycle_of(*triggers):
    return xr.Dataset({"trigger": ("frame", np.array(triggers))})


def test_frames_that_were_left_out_belong_to_no_trigger():
    """Trigger 1 has lost both its frames and keeps its place."""
    frames = group_frames(cycle_of(0, 1, 2, 0, 1, 2), pairs_of(6, skipped=(1, 3, 4)))
    assert frames == [[0], [], [2, 5]]


# triggers of two cycles


@pytest.fixture(scope="module")
def cycles(two_cycles):
    run = open_run(two_cycles.run)
    return run, locate_run(run)


@pytest.fixture(scope="module")
def logged(two_cycles):
    """Columns of the encoder log, read as text."""
    lines = (two_cycles.run / "encoder.csv").read_text().splitlines()
    rows = np.array([[float(cell) for cell in line.split(",")] for line in lines[1:]])
    return dict(zip(lines[0].split(","), rows.T, strict=True))


@pytest.mark.parametrize(
    ("name", "column"),
    [("joint_load", "load_N"), ("temperature", "temperature_C"), ("encoder_angle", "angle_deg")],
)
def test_triggers_of_two_cycles_have_the_means_of_the_log(cycles, logged, name, column):
    triggers = describe_triggers(*cycles)
    expected = (logged[column][:6] + logged[column][6:]) / 2
    npt.assert_allclose(triggers[name], expected)


def test_trigger_has_the_mean_of_the_frames_that_are_left(cycles, logged):
    """Frame 7 belongs to trigger 1; both frames of trigger 2 are lost, and their log remains."""
    run, cycle = cycles
    pairs = replace(run.pairs, skipped=dict.fromkeys((7, 2, 8), "damaged"))
    load = describe_triggers(replace(run, pairs=pairs), cycle)["joint_load"].values
    npt.assert_allclose(load[1], logged["load_N"][1])
    npt.assert_allclose(load[2], (logged["load_N"][2] + logged["load_N"][8]) / 2)


def test_triggers_that_do_not_repeat_have_their_times(cycles, logged):
    """Frames that are averaged over cycles have none; frames of several cycles, each for itself."""
    run, cycle = cycles
    assert "time" not in describe_triggers(run, cycle)
    each = cycle.assign(trigger=cycle.trigger.copy(data=np.arange(12)))
    npt.assert_allclose(describe_triggers(run, each).time, logged["time_s"])


def test_mean_crank_angle_passes_through_zero(cycles):
    """359 and 3 degree have a mean of 1 degree."""
    run, cycle = cycles
    angle = cycle.crank_angle.values.copy()
    angle[[0, 6]] = 359.0, 3.0
    triggers = describe_triggers(run, cycle.assign(crank_angle=cycle.crank_angle.copy(data=angle)))
    npt.assert_allclose(triggers.crank_angle[0], 1.0)


def test_load_of_the_settings_serves_where_the_log_has_none(cycles):
    run, cycle = cycles
    log = run.log.drop_vars("joint_load")
    npt.assert_allclose(describe_triggers(replace(run, log=log), cycle)["joint_load"], 222.411)
    joint = run.settings.joint.model_copy(update={"load": None})
    settings = run.settings.model_copy(update={"joint": joint})
    with pytest.raises(ConfigError, match="no load_N and"):
        describe_triggers(replace(run, log=log, settings=settings), cycle)


# statistics and exponents


@pytest.fixture
def power_law():
    """Triggers whose minimum follows the power 0.62 and whose mean follows 0.4."""
    speed, load = np.linspace(0.5, 2.5, 12), np.full(12, 222.0)
    film = xr.Dataset({"rocker_speed": ("trigger", speed), "joint_load": ("trigger", load)})
    nothing = np.zeros(3)
    results = [
        make_result(
            minimum=3 * value**0.62,
            mean=6 * value**0.4,
            minimum_random_std=0.01,
            mean_random_std=0.01,
            minimum_surface_std=0.0,
            minimum_gradient=nothing,
            mean_gradient=nothing,
        )
        for value in speed
    ]
    return film, results


def test_exponents_are_those_of_minimum_and_mean(power_law, calibration):
    found = xr.Dataset(describe_exponents(*power_law, calibration))
    npt.assert_allclose([found.speed_exponent, found.speed_exponent_mean], [0.62, 0.4], rtol=1e-6)
    assert found.speed_exponent.attrs["triggers_used"] == 12


def test_exponents_follow_the_logged_speed_where_there_is_one(power_law, calibration):
    """A logged speed with the power m of the computed one: film ~ v^0.62 = (v^m)^(0.62/m)."""
    film, results = power_law
    load = film["joint_load"].values
    logged = load * (np.abs(film.rocker_speed.values) / load) ** 1.25
    known = film.assign(sliding_speed=("trigger", logged, {"source": "log"}))
    found = xr.Dataset(describe_exponents(known, results, calibration))
    npt.assert_allclose(found.speed_exponent, 0.62 / 1.25, rtol=1e-6)
    assert found.speed_exponent.attrs["speed"] == "sliding_speed"


@pytest.mark.parametrize(
    ("beyond", "whole", "power"), [(0.019, 0, 0.4), (0.3, 5, 0.4), (0.3, 4, None)]
)
def test_a_mean_of_a_part_of_the_region_has_no_exponent(
    power_law, calibration, beyond, whole, power
):
    """Triggers beyond the range by more than 2 % have no part in it, as in `erlif compare`."""
    film, results = power_law
    parts = [
        replace(one, statistics=replace(one.statistics, beyond_range=beyond if k >= whole else 0.0))
        for k, one in enumerate(results)
    ]
    found = xr.Dataset(describe_exponents(film, parts, calibration))
    npt.assert_allclose(found.speed_exponent, 0.62, rtol=1e-6)
    if power is None:
        assert np.isnan(found.speed_exponent_mean)
        assert found.speed_exponent_mean.attrs["triggers_used"] == whole
    else:
        npt.assert_allclose(found.speed_exponent_mean, power, rtol=1e-6)
        assert found.speed_exponent_mean.attrs["triggers_used"] == (whole or 12)


@pytest.mark.parametrize(("swing", "moves"), [(0.02, False), (4.0, True)])
def test_a_mean_that_follows_the_place_of_the_minimum_has_no_exponent(calibration, swing, moves):
    """A minimum of 5 um at every speed, which moves by a swing [mm] as the speed rises."""
    speed = np.linspace(0.4, 2.5, 12)
    side = swing * (speed / 2.5) / np.sqrt(33.36 * 33.59)
    raw = tomllib.loads(RUN_TOML)
    plane = ObjectPlane(RunSettings.model_validate(raw), (64, 80))
    line = plane.view.load_line
    angle = (plane.along[plane.within] - line) / plane.view.radius
    films = 230 - 225 * np.cos(angle - side[:, np.newaxis]).mean(axis=1)
    nothing = {"mean_gradient": np.zeros(3), "minimum_gradient": np.zeros(3)}
    results = [make_result(mean=one, mean_random_std=0.005, **nothing) for one in films]
    place = 225 * np.stack([np.cos(side), np.sin(side)], axis=1)
    columns = {"rocker_speed": speed, "joint_load": np.full(12, 222.0)}
    film = xr.Dataset({name: ("trigger", one) for name, one in columns.items()})
    film["pin_displacement"] = ("trigger", "axis"), place, {"load_line": line}

    found = xr.Dataset(describe_exponents(film, results, calibration, plane=plane))
    assert np.isnan(found.speed_exponent_mean) == moves
    assert ("geometry" in found.speed_exponent_mean.attrs) == moves
    assert [note.subject for note in _note_moved_mean(found)] == ["film_mean"] * moves
    if moves:  # the minimum is constant: all of the exponent is that of its place
        attrs = found.speed_exponent_mean.attrs
        npt.assert_allclose(attrs["geometry"], attrs["fitted"], rtol=1e-3)


def test_marks_of_the_surfaces_widen_the_exponent_of_the_minimum_alone(power_law, calibration):
    film, results = power_law
    plain = xr.Dataset(describe_exponents(film, results, calibration))
    marked = [
        replace(one, statistics=replace(one.statistics, minimum_surface_std=0.2)) for one in results
    ]
    found = xr.Dataset(describe_exponents(film, marked, calibration))
    assert found.speed_exponent_std > 2 * plain.speed_exponent_std
    assert found.speed_exponent_mean_std == plain.speed_exponent_mean_std


# the film and its groups


def make_film(cycles, calibration, *, notes=(), **changes):
    run, cycle = cycles
    results = [make_result(k, k + 6, **changes) for k in range(6)]
    return assemble_film(
        run,
        describe_triggers(run, cycle),
        results,
        calibration,
        measured=describe_statistics(results, calibration),
        prediction=NO_PREDICTION,
        hashes={"run.toml": "ab" * 32},
        notes=[*notes, Note(Level.WARNING, "camera1", "a note of the cameras")],
    )


def test_warnings_come_first_and_gains_once(cycles, calibration):
    """The gains of the fixture's recording are in the notes of the calibration itself."""
    gains = Note(Level.NOTE, "cameras", "camera1 gain 4.4; camera2 gain 4.4")
    again = Note(Level.NOTE, "cameras", "camera1 gain 4.3; camera2 gain 4.5")
    fitted = replace(
        calibration, notes=(again, Note(Level.WARNING, "darks", "dark pages are missing"))
    )
    lines = make_film(cycles, fitted, notes=[gains]).attrs["notes"].split("\n")
    assert lines[:2] == [
        "warning: camera1: a note of the cameras",
        "warning: calibration: darks: dark pages are missing",
    ]
    assert not any(line.startswith("warning") for line in lines[2:])
    assert [line for line in lines if "gain" in line] == [str(gains)]


def test_share_beyond_the_range_has_a_note_from_one_per_cent_on(cycles, calibration):
    assert "film_mean lacks" not in make_film(cycles, calibration).attrs["notes"]
    notes = make_film(cycles, calibration, beyond_range=0.12).attrs["notes"]
    assert "film_mean lacks up to 12% of the region (trigger 0)" in notes


@pytest.mark.parametrize("mounted", [{"mounted_on": "crank"}, {}])
def test_the_mean_angle_of_a_turning_encoder_passes_over_zero(mounted):
    """350, 359 and 6 degrees, the last one as 726 two turns later."""
    angles = xr.DataArray([350.0, 359.0, 726.0], dims="frame", name="encoder_angle")
    assert _trigger_mean(angles.assign_attrs(mounted), [0, 1, 2]) == pytest.approx(358 + 1 / 3)
    assert _trigger_mean(angles.assign_attrs(mounted_on="rocker"), [0, 1]) == 354.5


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
