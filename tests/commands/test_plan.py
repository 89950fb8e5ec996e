"""``erlif plan`` and ``erlif simulate --parts``."""

import xarray as xr

from erlif.planning.plan import example_plan


def test_the_example_works_as_it_is_printed(tmp_path, command, refused):
    path = tmp_path / "plan.toml"
    path.write_text(command("plan", "--example").stdout, encoding="utf-8")
    shown = command("plan", path).stdout
    assert "Best concentrations" in shown
    assert "Target: 5 % of 4.47 um, the middle of the wanted range: 224 nm" in shown
    assert f"--parts {tmp_path / 'plan' / 'optimum.toml'}" in shown
    assert "exists already" in refused("plan", path)


def test_without_a_plan_the_example_is_named(command):
    assert "erlif plan --example > plan.toml" in command("plan", status=2).stderr


def test_simulate_takes_a_plan_and_options_before_it(tmp_path, command):
    path, out = tmp_path / "plan.toml", tmp_path / "out"
    path.write_text(example_plan(), encoding="utf-8")
    words = ("--size", "64x48", "--fixture-frames", "1", "--light", "0.5")
    command("simulate", out, "--parts", path, *words)
    with xr.open_dataset(out / "truth.nc", engine="h5netcdf") as truth:
        assert truth.attrs["rig_light"] == 0.5
        assert truth.attrs["rig_mechanism"] == "static"
        assert truth.attrs["rig_width"] == 64
        assert truth.attrs["source"].endswith("the dyes' spectra are those of a plan")
        assert truth.film.min() < 2 < 10 < truth.film.max()
    assert 'band = "580 nm"' in (out / "run" / "run.toml").read_text(encoding="utf-8")
