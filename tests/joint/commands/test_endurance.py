"""``erlif endurance``."""

import numpy as np
import pytest

import erlif.joint.plots
from erlif.joint.rig import EnduranceRig, simulate_endurance, write_endurance_log

GIVEN = ("--radius", "33.36 mm", "--arm", "30 cm")


@pytest.fixture(scope="module")
def log(tmp_path_factory):
    path = tmp_path_factory.mktemp("endurance") / "run_1.csv"
    rig = EnduranceRig(interval=5.0, stage_duration=300.0, galling_time=200.0)
    return write_endurance_log(simulate_endurance(rig, rng=np.random.default_rng(1))[0], path)


def test_a_log_gives_text_table_and_figure(log, tmp_path, command, refused):
    words = ("endurance", log, *GIVEN, "-o", tmp_path)
    assert "galling in stage 6" in command(*words).stdout
    kinds = ("", "_load", "_friction", "_temperature", "_failure")
    figures = {f"run_1{kind}.png" for kind in kinds}
    assert {path.name for path in tmp_path.iterdir()} == {"endurance.csv", *figures}
    assert "exists already" in refused(*words)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--arm", "30 cm"), "--radius"),
        ((*GIVEN, "--column", "load=Cell 1"), "expected one of time, cells"),
        ((*GIVEN, "--column", "time=a,b"), "expected one column for time"),
        ((*GIVEN, "--unit", "cells"), "QUANTITY=NAME"),
        ((*GIVEN, "--group", "uncut=run_*"), "at least two logs of design uncut"),
        (("--settings", "none.toml"), "no such file"),
    ],
)
def test_what_is_missing_or_wrong_is_stated(log, tmp_path, command, words, message):
    assert message in command("endurance", log, *words, "-o", tmp_path / "out", status=2).stderr
    assert not (tmp_path / "out").exists()


def test_settings_and_designs(tmp_path, monkeypatch, command):
    """Figures of single tests are drawn above; here only their names count."""
    drawn = []
    monkeypatch.setattr(
        erlif.joint.plots,
        "write_endurance_figures",
        lambda result, folder, overview: drawn.append((result.name, overview)) or [],
    )
    rig = EnduranceRig(
        loads=(36e3, 54e3), interval=5.0, stage_duration=200.0, galling_stage=2, galling_time=120.0
    )
    test, _ = simulate_endurance(rig, rng=np.random.default_rng(1))
    names = ("uncut_1", "uncut_1_load", "undercut_1", "undercut_2")
    logs = [write_endurance_log(test, tmp_path / f"{name}.csv") for name in names]
    settings = tmp_path / "endurance.toml"
    settings.write_text(
        '[machine]\npin_radius = "33.36 mm"\narm = "30 cm"\n[galling]\nsignificance = 0.001\n'
        '[designs]\nuncut = ["uncut_*.csv"]\nundercut = ["undercut_*.csv"]\n',
        encoding="utf-8",
    )
    shown = command("endurance", *logs, "--settings", settings, "-o", tmp_path / "out").stdout
    assert "load at failure of undercut over uncut: 1.00" in shown
    assert "so few runs give 1 at least" in shown
    assert len((tmp_path / "out" / "endurance.csv").read_text().splitlines()) == 5
    assert (tmp_path / "out" / "designs.png").exists()
    assert dict(drawn) == {
        "uncut_1": "uncut_1.png",
        "uncut_1_load": "uncut_1_load_all.png",  # uncut_1_load.png is the load of uncut_1
        "undercut_1": "undercut_1.png",
        "undercut_2": "undercut_2.png",
    }
