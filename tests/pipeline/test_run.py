"""A run to its film: what -v shows, and inputs that change."""

import importlib
import re
from dataclasses import replace

import pytest

from erlif.calibration import RunCurve
from erlif.commands.main import show_log
from erlif.pipeline.run import FilmWork

STAGES = ("darks and flats", "registration", "sharpness and noise", "film", "writing")


def test_v_shows_each_stage_once_in_order_with_its_duration(small_rig, tmp_path, command):
    result = command("-v", "process", small_rig.run, "-o", tmp_path / "film.nc")
    show_log(0)
    places = [result.stderr.index(f": {name}: started") for name in STAGES]
    assert places == sorted(places)
    for name in STAGES:
        done = rf": {name}: finished after \d+\.\d\d s, processor \d+\.\d\d s"
        assert len(re.findall(done, result.stderr)) == 1, name


@pytest.mark.parametrize("name", ["camera2/frame_0001.tif", "encoder.csv"])
def test_an_input_replaced_while_it_is_processed_is_refused(lab, monkeypatch, command, name):
    """The frame is replaced between the camera map and its film."""
    module = importlib.import_module("erlif.pipeline.run")
    measure_run = module.measure_run

    def replace_and_run(*arguments, **options):
        path = lab.run / name
        path.write_bytes(path.read_bytes())
        return measure_run(*arguments, **options)

    monkeypatch.setattr(module, "measure_run", replace_and_run)
    assert f"{name} was changed or replaced" in command("process", lab.run, status=2).stderr
    assert not list(lab.run.glob("film.nc*"))


def change_settings(work):
    joint = work.run.settings.joint.model_copy(update={"load": 200.0})
    settings = work.run.settings.model_copy(update={"joint": joint})
    return replace(work, run=replace(work.run, settings=settings))


def change_pairs(work):
    pairs = replace(work.run.pairs, skipped={3: "damaged"})
    return replace(work, run=replace(work.run, pairs=pairs))


def change_calibration(work):
    fixture = work.curve.calibration
    other = replace(fixture, ratio_at_zero=1.001 * fixture.ratio_at_zero)
    return replace(work, curve=replace(work.curve, calibration=other))


def test_work_is_known_by_its_inputs(run, calibration, tmp_path):
    work = FilmWork.of(run, RunCurve.of(calibration), tmp_path / "film.nc")
    known = work.identify("inputs")
    assert replace(work, run=replace(run)).identify("inputs") == known
    assert work.identify("other inputs") != known
    for change in (change_settings, change_pairs, change_calibration):
        assert change(work).identify("inputs") != known
