"""``erlif process``: outputs, inputs of the theory, several cycles."""

import importlib
import os
import re
import shutil

import numpy as np
import pytest
import xarray as xr
from scenes.terminal import unwrapped

from conftest import read_film


def test_a_run_is_checked_and_processed(lab, film, command, monkeypatch):
    checked = command("check", lab.run)
    assert "error" not in checked.stdout
    assert checked.stderr.splitlines()[-1] == f"next: erlif process {lab.run}"
    assert "error" not in command("check", lab.fixture).stdout
    result = command("process", lab.run)
    assert "6 triggers from 6 frame pairs of 128 x 96 pixels" in result.stdout
    assert f"written: {lab.film}" in result.stdout
    assert len(result.stdout.splitlines()) <= 12
    assert result.stdout.splitlines()[-1] == f"next: erlif figures {lab.film}"
    assert "film: 6 done" in result.stderr
    assert lab.film.read_bytes() == film.read_bytes()
    monkeypatch.setattr("erlif.pipeline.run.with_theory", lambda draft: draft)
    verbose = command("-v", "process", lab.run, "--overwrite").stdout
    assert f"used: {lab.fixture / 'calibration.nc'}" in verbose
    assert "largest error" in verbose


def test_output_may_lie_elsewhere_and_the_run_be_read_only(
    lab, film, command, monkeypatch, tmp_path
):
    for directory in (lab.run, lab.fixture):
        directory.chmod(0o555)
    try:
        monkeypatch.chdir(tmp_path)
        (tmp_path / "résultats µm").mkdir()
        result = command("process", os.path.relpath(lab.run), "-o", "résultats µm/film 1.nc")
    finally:
        for directory in (lab.run, lab.fixture):
            directory.chmod(0o755)
    assert "résultats µm/film 1.nc" in result.stdout
    assert (tmp_path / "résultats µm" / "film 1.nc").read_bytes() == film.read_bytes()
    assert not list(lab.run.glob("film*"))


@pytest.mark.usefixtures("maps_alone")
def test_a_slider_crank_is_processed(lab, command):
    lab.edit(
        "run/run.toml",
        ('kind = "crank-rocker"', 'kind = "slider-crank"'),
        ('rocker = "26 cm"', ""),
        ('ground = "51 cm"', ""),
        ('mounted_on = "rocker"', 'mounted_on = "crank"'),
    )
    log = lab.run / "encoder.csv"
    rows = [row.split(",") for row in log.read_text().splitlines()]
    for k, row in enumerate(rows[1:]):
        row[2] = str(60 * k)
    log.write_text("\n".join(map(",".join, rows)))
    text = (lab.run / "run.toml").read_text()
    (lab.run / "run.toml").write_text(re.sub(r"zero = .*\n", "", text))
    command("process", lab.run)
    film = read_film(lab.film)
    np.testing.assert_allclose(film.crank_angle, np.arange(6) * 60.0, atol=1e-9)
    omega = 114 * 2 * np.pi / 60
    # at the dead centres the rod turns against the crank at crank/rod of its speed: 5.5/44
    assert float(film.rocker_speed[0]) == pytest.approx(omega * (1 + 5.5 / 44))


@pytest.fixture
def cycles(two_cycles, small_rig, tmp_path):
    shutil.copytree(two_cycles.run, tmp_path / "run")
    return tmp_path / "run", small_rig.fixture / "calibration.nc"


@pytest.mark.usefixtures("maps_alone")
def test_several_cycles_fold_onto_one(cycles, command):
    run, calibration = cycles
    command("process", run, "--calibration", calibration)
    toml = run / "run.toml"
    toml.write_text(re.sub(r"triggers_per_cycle = .*", "", toml.read_text()))
    command("process", run, "--calibration", calibration, "-o", run / "found.nc")
    given, found = read_film(run / "film.nc"), read_film(run / "found.nc")
    assert given.frames_used.values.tolist() == [2] * 6
    xr.testing.assert_identical(given.drop_attrs(), found.drop_attrs())
    frames = read_film(run / "film.nc", "frames")
    assert frames.cycle.values.tolist() == [0] * 6 + [1] * 6
    assert frames.trigger.values.tolist() == [*range(6)] * 2


def test_the_scheduler_of_workers_reaches_the_pipeline(lab, refused):
    """Their film is that of threads: tests/pipeline/engines/test_cluster.py."""
    pytest.importorskip("distributed")
    assert "local:N" in refused("process", lab.run, "--scheduler", "local:0")


MODULE = importlib.import_module("erlif.pipeline.batch")
"""The module; the package has the function under the same name."""


def test_each_run_has_one_line_and_failures_stand_at_the_end(series, film, command):
    result = command("process", series / "tuesday", series / "monday", status=2)
    failed, finished = unwrapped(result.stdout).splitlines()
    assert failed == f"{series / 'tuesday'}: failed, see below"
    assert finished.startswith(f"{series / 'monday'}: min ")
    assert "6 triggers from 6 frame pairs" in finished
    listed = result.stderr.partition("erlif: ")[2]
    assert listed.startswith("1 of 2 runs failed:\n")
    assert f"  {series / 'tuesday'}: " in listed
    assert "frame_0002.tif" in listed
    assert "Traceback" not in result.output
    assert (series / "monday" / "film.nc").read_bytes() == film.read_bytes()


def test_resume_shows_the_films_that_are_kept(series, film, command):
    shutil.copy(film, series / "monday" / "film.nc")
    line = unwrapped(command("process", series / "monday", "--resume").stdout)
    assert line.rstrip().endswith("; finished before")


@pytest.mark.parametrize(
    ("error", "status", "words"),
    [
        (ZeroDivisionError("a slip"), 1, ("a slip", "report")),
        (KeyboardInterrupt(), 130, ("--resume",)),
    ],
)
def test_a_defect_shows_its_trace_and_an_interruption_the_way_to_go_on(
    series, monkeypatch, command, error, status, words
):
    def fail(*arguments, **options):
        raise error

    monkeypatch.setattr(MODULE, "process_run", fail)
    message = command("process", series / "monday", "--resume", status=status).stderr
    assert all(word in message for word in words)
