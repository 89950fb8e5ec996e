"""A run to its film: what is returned, what identifies the work, what -v shows."""

import importlib
import re

import pytest
import xarray as xr
from click.testing import CliRunner

import erlif
from erlif.commands.main import main, show_log

STAGES = ("darks and flats", "registration", "sharpness and noise", "film", "writing")


def test_v_shows_each_stage_once_in_order_with_its_duration(small_rig, tmp_path):
    target = tmp_path / "film.nc"
    result = CliRunner().invoke(main, ["-v", "process", str(small_rig.run), "-o", str(target)])
    show_log(0)
    assert result.exit_code == 0, result.output
    places = [result.stderr.index(f": {name}: started") for name in STAGES]
    assert places == sorted(places)
    for name in STAGES:
        done = rf": {name}: finished after \d+\.\d\d s, processor \d+\.\d\d s"
        assert len(re.findall(done, result.stderr)) == 1, name


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
