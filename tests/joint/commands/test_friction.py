"""``erlif friction``."""

import csv

import numpy as np
import pytest


@pytest.fixture(scope="module")
def log(tmp_path_factory):
    """0.12 about an offset, reversed each 10 s; two components of 400 N, 0.1 N m of offset."""
    path = tmp_path_factory.mktemp("friction") / "bushing.csv"
    time = np.arange(0.0, 120.0, 0.1)
    torque = 0.12 * 400 * 0.005 * np.where(time % 20 < 10, 1, -1) + 0.1
    torque += 0.002 * np.random.default_rng(0).normal(size=time.size)
    with path.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["Time [s]", "Fx [N]", "Fy [N]", "Torque [N m]"])
        writer.writerows(zip(time.round(3), 0 * time + 240, 0 * time + 320, torque, strict=True))
    return path


GIVEN = ("--radius", "5 mm", "--vector", "--column", "cells=Fx,Fy")


def test_a_log_gives_the_coefficient_its_budget_a_table_and_a_figure(
    log, tmp_path, command, refused
):
    given = (*GIVEN, "--speed", "10 mm/s", "--load-std", 0.01, "--torque-ratio", 1.25)
    words = ("friction", log, *given, "-o", tmp_path)
    shown = command(*words).stdout
    assert "apparent friction coefficient: 0.1200 ± 0.0012 (6 pairs" in shown
    assert "offset of the torque: 0.1 N m, 0.0500 of load times radius" in shown
    assert "torque ratio of 1.25: 0.0960 ± 0.0010" in shown
    assert {path.name for path in tmp_path.iterdir()} == {"bushing.csv", "bushing.png"}
    rows = (tmp_path / "bushing.csv").read_text().splitlines()
    assert rows[0].startswith("time [s],friction [1],friction_std [1]")
    assert rows[0].endswith("sliding_distance [m]")
    assert len(rows) == 7
    assert "exists already" in refused(*words)


def test_a_constant_load_and_a_diameter_give_the_same(log, tmp_path, command):
    """The cells have 240 N and 320 N, 400 N across the shaft."""
    given = ("--diameter", "10 mm", "--load", "400 N", "-o", tmp_path)
    shown = command("friction", log, *given).stdout
    assert float(shown.split("coefficient: ")[1].split()[0]) == pytest.approx(0.12, abs=2e-4)
    assert "load 400 N as given" in shown


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--vector",), "--radius"),
        ((*GIVEN, "--diameter", "10 mm"), "either the radius or the diameter"),
        (("--radius", "5"), "number with a unit"),
        ((*GIVEN, "--load-std", "3"), "0<=x<=1"),
    ],
)
def test_what_is_missing_or_wrong_is_stated(log, tmp_path, command, words, message):
    assert message in command("friction", log, *words, "-o", tmp_path / "out", status=2).stderr
    assert not (tmp_path / "out").exists()
