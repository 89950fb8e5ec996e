"""Notes on what a film lacks, for each table that run.toml or the log lacks."""

import tomllib

import pytest
import xarray as xr
from scenes.film import RUN_TOML

from erlif.core.notes import Level
from erlif.io.settings import RunSettings
from erlif.pipeline.recording.omissions import note_omissions

MOTION = ("encoder_angle", "stroke", "crank_angle", "rocker_speed", "sliding_speed", "load")
DISC = {"kind": "rotation", "radius": "20 mm", "speed": "60 rpm"}


def note(variables, *, without=(), **tables):
    """Subjects and texts of the notes of a run that lacks some tables."""
    raw = tomllib.loads(RUN_TOML) | tables
    settings = RunSettings.model_validate({key: raw[key] for key in raw if key not in without})
    triggers = xr.Dataset({name: ("trigger", [1.0, 2.0]) for name in variables})
    notes = note_omissions(settings, triggers)
    assert all(one.level is Level.NOTE for one in notes)
    return {one.subject: one.text for one in notes}


def test_a_complete_run_lacks_nothing():
    assert note(MOTION) == {}


def test_a_static_film_names_motion_and_joint():
    found = note((), without=("encoder", "mechanism", "joint", "oil"))
    assert list(found) == ["[mechanism]", "[joint]"]
    assert "crank_angle, sliding_speed, speed_exponent" in found["[mechanism]"]
    assert "A static film needs none" in found["[mechanism]"]
    assert "left out: film_parameter, pin_displacement, pin_tilt, " in found["[joint]"]


def test_a_disc_without_angle_and_load_names_both_columns():
    tables = ("encoder", "joint", "oil")
    found = note(("sliding_speed",), without=tables, mechanism=DISC)
    assert list(found) == ["column angle_deg", "column load_N", "[joint]"]
    assert "there is no log; left out: load, speed_exponent" in found["column load_N"]
    assert 'load = "20 N" to [mechanism]' in found["column load_N"]
    assert "film_theory" in found["[joint]"]


def test_a_linkage_without_a_joint_lacks_the_sliding_speed():
    variables = [name for name in MOTION if name != "sliding_speed"]
    found = note(variables, without=("joint", "oil"))
    assert list(found) == ["[joint]"]
    assert (
        "left out: sliding_speed, film_hamrock_dowson, film_theory, film_regime_map"
        in found["[joint]"]
    )


def test_a_joint_without_an_oil_lacks_the_theory_alone():
    found = note(MOTION, without=("oil",))
    assert found == {
        "[oil]": "run.toml has no such table; left out: film_hamrock_dowson, film_theory, "
        "film_regime_map. Add [oil] for the theory."
    }


@pytest.mark.parametrize(
    ("without", "tables", "words"),
    [
        (("encoder",), {}, '"crank-rocker" needs the log of its encoder'),
        ((), {"encoder": {"mounted_on": "rocker"}}, '"crank-rocker" needs the log of its encoder'),
        ((), {"mechanism": {**DISC, "load": "20 N"}}, "give the load once"),
        (("mechanism",), {"encoder": {"bins": 20}}, r"add \[mechanism\], or remove bins"),
    ],
)
def test_tables_that_contradict_each_other_are_refused(without, tables, words):
    with pytest.raises(ValueError, match=words):
        note((), without=without, **tables)
