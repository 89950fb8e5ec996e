"""``erlif process`` of many runs: one line of result each, failures at the end, exit status."""

import importlib
import shutil

from click.testing import CliRunner
from scenes.terminal import unwrapped

from erlif.commands.main import main

MODULE = importlib.import_module("erlif.pipeline.batch")
"""The module; the package has the function under the same name."""


def run_series(*arguments):
    return CliRunner().invoke(main, ["process", *map(str, arguments)])


def test_each_run_has_one_line_and_failures_stand_at_the_end(series, film):
    result = run_series(series / "tuesday", series / "monday")
    assert result.exit_code == 2
    failed, finished = unwrapped(result.stdout).splitlines()
    assert failed == f"{series / 'tuesday'}: failed, see below"
    assert finished.startswith(f"{series / 'monday'}: minimum film thickness ")
    assert "6 triggers from 6 frame pairs" in finished
    listed = result.stderr.partition("erlif: ")[2]
    assert listed.startswith("1 of 2 runs failed:\n")
    assert f"  {series / 'tuesday'}: " in listed
    assert "frame_0002.tif" in listed
    assert "Traceback" not in result.output
    assert (series / "monday" / "film.nc").read_bytes() == film.read_bytes()


def test_resume_shows_the_films_that_are_kept(series, film):
    shutil.copy(film, series / "monday" / "film.nc")
    result = run_series(series / "monday", "--resume")
    assert result.exit_code == 0
    line = unwrapped(result.stdout)
    assert "; finished before; 1 warning, see erlif report" in line


def test_a_defect_ends_with_status_1_and_its_trace(series, monkeypatch):
    def fail(*arguments, **options):
        raise ZeroDivisionError("a slip")

    monkeypatch.setattr(MODULE, "process_run", fail)
    result = run_series(series / "monday", "--resume")
    assert result.exit_code == 1
    assert "a slip" in result.stderr
    assert "report" in result.stderr


def test_an_interruption_names_the_way_to_go_on(series, monkeypatch):
    def interrupt(*arguments, **options):
        raise KeyboardInterrupt

    monkeypatch.setattr(MODULE, "process_run", interrupt)
    result = run_series(series / "monday", "--resume")
    assert result.exit_code == 130
    assert "--resume" in result.stderr
