"""``erlif simulate``."""

import pytest
import xarray as xr
from click.testing import CliRunner

from conftest import snapshot
from erlif.commands.main import main

SMALL = ["--size", "64x48", "--spacing", "8", "--fixture-frames", "1"]


def test_a_rehearsal_is_written_with_its_truth(tmp_path):
    result = CliRunner().invoke(main, ["simulate", str(tmp_path / "out"), *SMALL])
    assert result.exit_code == 0, result.output
    assert "run frames written: 6" in result.output
    assert (tmp_path / "out" / "truth.nc").is_file()


@pytest.mark.parametrize(
    ("option", "value", "words"),
    [
        ("--cycles", "1000000000", "at most 1000000 frame pairs"),
        ("--film", "nan", "Expected film_reference"),
        ("--film", "thick", "the words reynolds"),
        ("--sideways", "loose", "a stiffness in N/m"),
        ("--size", "²x²", "is not a picture size"),
        ("--size", "0x0", "Expected width"),
        ("--size", "99999999x5", "is not a picture size"),
        ("--spacing", "1e-9", "at most 1000000 frame pairs"),
        ("--seed", "-1", "Invalid value"),
    ],
)
def test_a_rig_that_cannot_be_is_refused_and_nothing_is_written(tmp_path, option, value, words):
    result = CliRunner().invoke(main, ["simulate", str(tmp_path / "out"), option, value])
    assert result.exit_code == 2
    assert words in result.stderr
    assert "Traceback" not in result.output
    assert not (tmp_path / "out").exists()


def test_a_film_of_theory_is_photographed_with_the_stated_viscosity(tmp_path):
    out = tmp_path / "out"
    options = ["--film", "reynolds", "--elapsed", "20", "--stated-viscosity", "0.1"]
    result = CliRunner().invoke(main, ["simulate", str(out), *SMALL, *options])
    assert result.exit_code == 0, result.output
    with xr.open_dataset(out / "truth.nc", engine="h5netcdf") as truth:
        # 8.0 um after 21 cycles, less than 10 % thicker a cycle before
        assert 8.0 < float(truth.film_min[0]) < 8.8
        assert float(truth.viscosity[0]) == 0.12
    assert 'viscosity = "0.1 Pa s"' in (out / "run" / "run.toml").read_text()


def test_a_film_beyond_the_wedge_is_named(tmp_path):
    """The wedge ends at 18 um, and 20 um plus marks of 0.2 um are above it everywhere."""
    films = [str(tmp_path / "out"), *SMALL, "--overwrite", "--exponent", "0"]
    beyond = CliRunner().invoke(main, ["simulate", *films, "--film", "20", "--cycles", "2"])
    assert "Note: 100 % of the true film" in beyond.stderr
    assert "(0.1 to 18 um)" in beyond.stderr
    inside = CliRunner().invoke(main, ["simulate", *films, "--film", "5"])
    assert inside.exit_code == 0, inside.output
    assert "Note" not in inside.stderr


@pytest.mark.parametrize("precious", ["run/thesis.txt", "fixture/camera1/my.tif", "truth.nc"])
def test_overwriting_spares_what_the_rig_has_not_written(tmp_path, precious):
    out = tmp_path / "out"
    assert CliRunner().invoke(main, ["simulate", str(out), *SMALL]).exit_code == 0
    (out / precious).write_text("years of work")
    before = snapshot(out)
    result = CliRunner().invoke(main, ["simulate", str(out), *SMALL, "--overwrite"])
    assert result.exit_code == 2
    assert precious in result.stderr
    assert snapshot(out) == before
