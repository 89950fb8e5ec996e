"""Notes on what a film lacks, for each table that run.toml or the log lacks."""

import tomllib

import pytest
import xarray as xr
from scenes.film import RUN_TOML

from erlif.core.notes import Level
from erlif.io.settings import RunSettings
from erlif.pipeline.recording.omissions import note_omissions

MOTION = ("encoder_angle", "stroke", "crank_angle", "rocker_speed", "joint_load", "sliding_speed")
STEEL = {"youngs_modulus": "206 GPa", "poissons_ratio": 0.3}
BALL = {"body": {**STEEL, "radius": "9 mm"}, "counterbody": STEEL}
DISC = {"kind": "rotation", "radius": "20 mm", "speed": "60 rpm"}


def note(variables, *, without=(), **tables):
    """Subjects and texts of the notes of a run that lacks some tables."""
    raw = tomllib.loads(RUN_TOML) | tables
    settings = RunSettings.model_validate({key: raw[key] for key in raw if key not in without})
    triggers = xr.Dataset({name: ("trigger", [1.0, 2.0]) for name in variables})
    notes = note_omissions(settings, triggers)
    assert all(one.level is Level.NOTE for one in notes)
    return {one.subject: one.text for one in notes}


STILL = ("encoder", "mechanism", "joint", "oil")
RESULTS = "film_hamrock_dowson, film_theory"


@pytest.mark.parametrize(
    ("variables", "without", "tables", "expected"),
    [
        (MOTION, (), {}, {}),
        (
            (),
            STILL,
            {},
            {
                "[mechanism]": "crank_angle, sliding_speed, speed_exponent",
                "[joint]": "left out: film_parameter, pin_displacement, pin_tilt, ",
            },
        ),
        (
            ("sliding_speed",),
            ("encoder", "joint", "oil"),
            {"mechanism": DISC},
            {
                "column angle_deg": "",
                "column load_N": "there is no log; left out: joint_load, speed_exponent",
                "[joint]": "film_theory",
            },
        ),
        (MOTION[:5], ("joint", "oil"), {}, {"[joint]": f"left out: sliding_speed, {RESULTS}"}),
        (
            MOTION[:5],
            ("joint",),
            {"contact": BALL},
            {"column of the sliding speed": f"left out: sliding_speed, {RESULTS}. Log the speed"},
        ),
        (
            ("sliding_speed",),
            ("encoder", "mechanism", "joint"),
            {"contact": BALL},
            {"column angle_deg": "", "column load_N": 'load = "20 N" to [contact]'},
        ),
        (MOTION, ("oil",), {}, {"[oil]": f"left out: {RESULTS}. Add [oil]"}),
    ],
)
def test_what_a_film_lacks_is_named_with_its_reason(variables, without, tables, expected):
    found = note(variables, without=without, **tables)
    assert list(found) == list(expected)
    assert all(words in found[subject] for subject, words in expected.items())


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
