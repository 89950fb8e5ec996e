"""``erlif plan`` and ``erlif simulate --plan``."""

import pytest
import xarray as xr
from click.testing import CliRunner

from erlif.commands.main import main
from erlif.planning.plan import example_plan


@pytest.fixture
def path(tmp_path):
    path = tmp_path / "plan.toml"
    path.write_text(example_plan(), encoding="utf-8")
    return path


def run(*words):
    return CliRunner().invoke(main, [str(word) for word in words])


def test_the_example_works_as_it_is_printed(tmp_path):
    text = run("plan", "--example").stdout
    path = tmp_path / "plan.toml"
    path.write_text(text, encoding="utf-8")
    result = run("plan", path)
    assert result.exit_code == 0, result.output
    assert "Best concentrations" in result.stdout
    assert f"written: {tmp_path / 'plan' / 'optimum.toml'}" in result.stdout
    assert "exists already" in run("plan", path).stderr


def test_without_a_plan_the_example_is_named():
    result = run("plan")
    assert result.exit_code == 2
    assert "erlif plan --example > plan.toml" in result.stderr


def test_simulate_takes_a_plan_and_options_before_it(path):
    out = path.parent / "out"
    words = ("--size", "64x48", "--fixture-frames", "1", "--light", "0.5")
    result = run("simulate", out, "--plan", path, *words)
    assert result.exit_code == 0, result.output
    with xr.open_dataset(out / "truth.nc", engine="h5netcdf") as truth:
        assert truth.attrs["rig_light"] == 0.5
        assert truth.attrs["rig_mechanism"] == "static"
        assert truth.attrs["rig_width"] == 64
        assert truth.attrs["source"].endswith("the dyes' spectra are those of a plan")
        assert truth.film.min() < 2 < 10 < truth.film.max()
    assert 'band = "580 nm"' in (out / "run" / "run.toml").read_text(encoding="utf-8")
