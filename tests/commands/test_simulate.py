"""``erlif simulate``."""

import pytest
import xarray as xr

SMALL = ["--size", "64x48", "--spacing", "8 deg", "--fixture-frames", "1"]


def test_a_film_of_theory_is_photographed_with_the_stated_viscosity(tmp_path, command):
    out = tmp_path / "out"
    options = ["--film", "reynolds", "--elapsed", "20", "--stated-viscosity", "0.1 Pa s"]
    shown = command("simulate", out, *SMALL, *options).stdout
    assert "run frames written: 6" in shown
    with xr.open_dataset(out / "truth.nc", engine="h5netcdf") as truth:
        # 8.0 um after 21 cycles, less than 10 % thicker a cycle before
        assert 8.0 < float(truth.film_min[0]) < 8.8
        assert float(truth.viscosity[0]) == 0.12
    assert 'viscosity = "0.1 Pa s"' in (out / "run" / "run.toml").read_text()


def test_a_film_beyond_the_wedge_is_named(tmp_path, command):
    """The wedge ends at 18 um, and 20 um plus marks of 0.2 um are above it everywhere."""
    words = ("simulate", tmp_path / "out", *SMALL, "--overwrite", "--exponent", "0")
    beyond = command(*words, "--film", "20 um", "--cycles", "2").stderr
    assert "Note: 100 % of the true film" in beyond
    assert "(0.1 to 18 um)" in beyond
    assert "Note" not in command(*words, "--film", "5 um").stderr


@pytest.mark.parametrize("precious", ["run/thesis.txt", "fixture/camera1/my.tif", "truth.nc"])
def test_overwriting_spares_what_the_rig_has_not_written(tmp_path, command, refused, precious):
    out = tmp_path / "out"
    command("simulate", out, *SMALL)
    (out / precious).write_text("years of work")
    assert precious in refused("simulate", out, *SMALL, "--overwrite")


def test_a_file_of_settings_has_what_no_option_has(tmp_path, command):
    out, stated = tmp_path / "out", tmp_path / "rig.toml"
    stated.write_text("wall = [0.2, 0.3]\nload = 100.0\ncycles = 2\n", encoding="utf-8")
    command("simulate", out, *SMALL, "--settings", stated, "--cycles", "1")
    text = (out / "run" / "run.toml").read_text()
    assert 'load = "100 N"' in text
    assert "wall" not in text
    with xr.open_dataset(out / "truth.nc", engine="h5netcdf") as truth:
        assert truth.sizes["frame"] == 6
