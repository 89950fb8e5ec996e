"""A run to its film: what -v shows, and inputs that change."""

import importlib
import re

import pytest

from erlif.commands.main import show_log

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
