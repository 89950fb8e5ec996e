"""Steps of a log against the mechanism; temperature, load and pulse energy."""

from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr

from erlif.pipeline.audit.log import note_conditions, note_energy, note_motion, note_mounting

RPM = 114.0


def settings(*, linkage=True, load=222.0):
    links = SimpleNamespace(crank_speed=RPM * 2 * np.pi / 60)
    return SimpleNamespace(
        linkage=links if linkage else None, joint=SimpleNamespace(load=load) if load else None
    )


def disc(frames=24, *, rpm=RPM):
    """An encoder on the crank, read every 15 degrees."""
    crank = 15.0 * np.arange(frames)
    log = xr.Dataset({"angle": ("frame", crank % 360), "time": ("frame", crank / (6 * rpm))})
    return log, xr.Dataset({"crank_angle": ("frame", crank % 360)})


def motion(log, located, **options):
    return list(note_motion(log, located, settings(**options)))


def warnings(notes):
    return [note.text for note in notes if note.level == "warning"]


def stay(log):
    log.angle.values[10:14] = log.angle.values[10]


def pause(log):
    log["time"] = ("frame", log["time"].values + 2.0 * (np.arange(24) > 7))


@pytest.mark.parametrize(
    ("change", "options", "words"),
    [
        (lambda log: None, {"rpm": 100.0}, "the crank turns at 100 rpm by angles and times, 114"),
        (stay, {}, "the angle stays at 150 deg in frames 10 to 12"),
        (pause, {}, "pauses between frames 7 and 8"),
    ],
)
def test_a_turn_that_is_not_even_is_reported(change, options, words):
    log, located = disc(**options)
    change(log)
    assert any(words in text for text in warnings(motion(log, located)))


def test_an_even_turn_has_no_warning_and_its_speed():
    notes = motion(*disc())
    assert warnings(notes) == []
    assert "the crank turns at 114 rpm by angles and times, 114 rpm in run.toml" in notes[-1].text


@pytest.mark.parametrize("frame", [5, 17])
def test_a_missed_trigger_is_found_between_its_neighbours(frame):
    log, located = disc(25)
    kept = np.delete(np.arange(25), frame)
    texts = warnings(motion(log.isel(frame=kept), located.isel(frame=kept)))
    assert any(f"jumps between frames {frame - 1} and {frame} (30 deg)" in text for text in texts)


def test_triggers_of_the_rocker_are_uneven_on_the_crank():
    """Even steps of a swing to and fro: at its ends the crank turns by far more."""
    swing = np.concatenate([np.linspace(-0.95, 0.95, 12), np.linspace(0.95, -0.95, 12)])
    rising = np.arange(24) < 12
    crank = np.degrees(np.where(rising, np.arcsin(swing), np.pi - np.arcsin(swing)))
    log = xr.Dataset({"angle": ("frame", crank % 360), "time": ("frame", crank / (6 * RPM))})
    assert warnings(motion(log, xr.Dataset(), linkage=False)) == []


@pytest.mark.parametrize(
    ("column", "values", "words"),
    [
        ("temperature", [25.0, 25.2], None),
        ("temperature", [298.0, 298.2], "no oil of a rig has that"),
        ("temperature", [25.0, 60.0], "it changes by 35.0 K from frame 0 to 1"),
        ("joint_load", [220.0, 225.0], None),
        ("joint_load", [50.0, 51.0], "0.23 times the load in [joint]"),
    ],
)
def test_conditions_are_compared_with_what_a_rig_has(column, values, words):
    (note,) = note_conditions(xr.Dataset({column: ("frame", values)}), settings())
    assert (note.level == "warning") == (words is not None)
    assert words is None or words in note.text


@pytest.mark.parametrize("shift", [0, 1])
def test_energies_of_other_pulses_are_recognised_by_the_light(shift):
    rng = np.random.default_rng(3)
    energy = 50 * (1 + 0.03 * rng.normal(size=30))
    film = 1 + 0.3 * np.sin(np.linspace(0, 6, 30))
    light = 1000 * film * np.roll(energy, shift) / 50
    log = xr.Dataset({"laser_mJ": ("frame", energy)})
    (note,) = note_energy(log, range(30), np.stack([light, light], axis=1))
    assert note.level == ("warning" if shift else "note")
    assert note.subject == "conditions"
    assert list(note_energy(xr.Dataset(), [], np.zeros((0, 2)))) == []


def test_a_camera_slower_than_the_crank_shows_its_speed_by_the_rest_of_a_turn():
    time = np.arange(40) * 1.03 / 1.9  # a turn takes 1/1.9 s at 114 rpm
    crank = 360.0 * 1.9 * time
    log = xr.Dataset({"angle": ("frame", crank % 360), "time": ("frame", time)})
    located = xr.Dataset({"crank_angle": ("frame", crank % 360)})
    assert warnings(motion(log, located)) == []
    assert warnings(motion(log.assign(time=log.time * 0.7), located))


@pytest.mark.parametrize(
    ("newtons", "unit"),
    [(9.80665, "kgf"), (4.44822, "lbf"), (1000.0, "kN"), (1e-3, "mN"), (9.80665e-3, "gf")],
)
def test_the_unit_that_fits_is_named(newtons, unit):
    log = xr.Dataset({"joint_load": ("frame", np.linspace(215, 230, 20) / newtons)})
    (note,) = note_conditions(log, settings())
    assert f'units = {{ load = "{unit}" }}' in note.text


def test_a_rocker_that_is_stated_as_the_crank_is_named():
    turn = np.arange(50) * 2 * np.pi / 50
    rocker, crank = 60 + 12 * np.sin(turn), np.degrees(turn + 0.7) % 360

    def notes_on(angle, mounted):
        stated = SimpleNamespace(linkage=object(), encoder=SimpleNamespace(mounted_on=mounted))
        return list(note_mounting(xr.Dataset({"angle": ("frame", angle)}), stated))

    (note,) = notes_on(rocker, "crank")
    assert 'Set mounted_on = "rocker"' in note.text
    assert (
        notes_on(rocker, "rocker")
        == notes_on(crank, "crank")
        == notes_on(crank[:20], "crank")
        == []
    )
