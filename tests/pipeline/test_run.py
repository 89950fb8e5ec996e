"""A run to its film: what is returned, what identifies the work, what -v shows."""

import importlib
import logging
import re

import pytest
import xarray as xr
from click.testing import CliRunner

import erlif
from erlif.commands.log import show_log
from erlif.commands.main import main

STAGES = ("darks and flats", "registration", "sharpness and noise", "film", "writing")

DECISIONS = {
    "frame pairs": r"6 frame pairs of 128 x 96 pixels, 0 left out",
    "triggers and cycles": r"6 triggers in 1 cycle, joint speed up to 2\.\d+ rad/s",
    "gain of camera 1": r"camera1 gain 4\.\d+ ± 0\.\d+ electron/DN",
    "gain of camera 2": r"camera2 gain 4\.\d+ ± 0\.\d+ electron/DN",
    "camera map": r"rms displacement \d+\.\d+ px, correlation of the textures 0\.\d+",
    "blur difference": r"difference of blur variance \S+ px2 along x, \S+ px2 along y",
    "calibration and range": r"calibration '.+' of .+, calibrated range \d+\.\d+ to \d+\.\d+ um",
    "exponent": r"minimum film thickness \d+\.\d+ to \d+\.\d+ um, speed exponent \S+ ± \S+",
    "file": r"film\.nc written, \d+\.\d+ MB",
}


@pytest.fixture(scope="module")
def lines(small_rig, tmp_path_factory):
    """Lines on standard error of `erlif process`, with -v and without."""
    out, shown = tmp_path_factory.mktemp("log"), {}
    for name, options in (("-v", ["-v"]), ("plain", [])):
        target = out / name / "film.nc"
        target.parent.mkdir()
        result = CliRunner().invoke(
            main, [*options, "process", str(small_rig.run), "-o", str(target)]
        )
        assert result.exit_code == 0, result.output
        shown[name] = result.stderr.splitlines()
    show_log(0)
    return shown


def test_stages_and_decisions_are_shown_with_v_and_not_without(lines):
    """Each stage once, in order, with its duration."""
    text = "\n".join(lines["-v"])
    places = [text.index(f": {name}: started") for name in STAGES]
    assert places == sorted(places)
    for name in STAGES:
        done = rf": {name}: finished after \d+\.\d\d s, processor \d+\.\d\d s"
        assert len(re.findall(done, text)) == 1, name
    for decision in DECISIONS.values():
        assert re.search(decision, text), decision
        assert not re.search(decision, "\n".join(lines["plain"]))
    assert not any("started" in line or "finished after" in line for line in lines["plain"])
    assert logging.getLogger("erlif").getEffectiveLevel() >= logging.WARNING


# results


def test_film_without_an_output_is_the_one_that_is_written(small_rig, film):
    with erlif.open_film(film) as written:
        xr.testing.assert_identical(erlif.process(small_rig.run), written.load())


# inputs that change


@pytest.mark.parametrize("name", ["camera2/frame_0001.tif", "encoder.csv"])
def test_an_input_replaced_while_it_is_processed_is_refused(lab, monkeypatch, name):
    """The frame is replaced between the camera map and its film."""
    module = importlib.import_module("erlif.pipeline.run")
    measure_run = module.measure_run

    def replace_and_run(*arguments, **options):
        path = lab.run / name
        path.write_bytes(path.read_bytes())
        return measure_run(*arguments, **options)

    monkeypatch.setattr(module, "measure_run", replace_and_run)
    result = CliRunner().invoke(main, ["process", str(lab.run)])
    assert result.exit_code == 2
    assert f"{name} was changed or replaced" in result.stderr
    assert not list(lab.run.glob("film.nc*"))
