"""The start of a recording from frames of the virtual rig."""

import numpy as np
import pytest
import xarray as xr

from erlif.core.errors import ErlifError
from erlif.io.ingest import open_run
from erlif.pipeline.physics.clock import fit_start
from erlif.pipeline.physics.joint import locate_run
from erlif.rig import RigSettings, simulate

PERIOD = 60 / 114
RATE = 24.3 / PERIOD


def make_run(out, seed):
    """Three turns with a log in time; frames at an even rate, whose start is left to be found."""
    rig = RigSettings(
        width=96, height=64, fixture_frames=1, dark_pages=2, flat_pages=1, flat_levels=(0.5,),
        pulses_per_cycle=24.3, cycles=2, log="continuous",
    )  # fmt: skip
    simulate(out, seed=seed, rig=rig)
    settings = out / "run" / "run.toml"
    text = settings.read_text(encoding="utf-8")
    assert 'pulse = "Trigger"' in text
    fit = f'start = "fit"\nframe_rate = "{RATE:.9f} Hz"'
    settings.write_text(text.replace('pulse = "Trigger"', fit), encoding="utf-8")
    return out / "run"


@pytest.fixture(scope="module")
def run_dir(tmp_path_factory):
    return make_run(tmp_path_factory.mktemp("clock"), 5)


def test_the_start_is_found_with_its_standard_deviation(run_dir):
    """The rig logs 0.05 s before the first frame; the strokes of its linkage are nearly alike."""
    run = open_run(run_dir, find_start=fit_start)
    start, std = run.log["time"].attrs["start"], run.log["time"].attrs["start_std"]
    error = (start - 0.05 + PERIOD / 4) % (PERIOD / 2) - PERIOD / 4
    assert std < 0.01 * PERIOD
    assert abs(error) < 4 * std
    note = str(run.log_notes[-1])
    assert f"first frame at {start:.6f} ± {std:.6f} s" in note
    assert f"The crank turns by {360 * std / PERIOD:.2f} deg" in note
    with xr.open_dataset(run_dir.parent / "truth.nc", engine="h5netcdf") as truth:
        speed = np.abs(truth.rocker_speed.values)
    np.testing.assert_allclose(np.abs(locate_run(run).rocker_speed), speed, atol=0.1)


def test_a_fit_needs_a_linkage(run_dir, tmp_path):
    text = (run_dir / "run.toml").read_text(encoding="utf-8")
    head, _, rest = text.partition("[mechanism]")
    bare = head + "[thickness]" + rest.partition("[thickness]")[2]
    for path in run_dir.iterdir():
        if path.name != "run.toml":
            (tmp_path / path.name).symlink_to(path)
    (tmp_path / "run.toml").write_text(bare, encoding="utf-8")
    with pytest.raises(ErlifError, match="because start is to be fitted"):
        open_run(tmp_path, find_start=fit_start, allow_outside=True)
