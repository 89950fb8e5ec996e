"""What the commands of the pages write is no change of the repository."""

import re
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SAMPLE = "data_samples/straight_bushing"
WRITTEN = [
    *(f"{SAMPLE}/{name}" for name in ("film.nc", "film.zarr/zarr.json", ".film.nc.unfinished")),
    *(f"{SAMPLE}/film.{suffix}" for suffix in ("csv", "mat", "tif")),
    *(f"{SAMPLE}/{name}" for name in ("film_vtk/film.pvd", "film_trigger13.csv", "figures/a.png")),
    *(f"{SAMPLE}/{name}" for name in ("report.html", "prediction.nc", "pressure.nc")),
    f"{SAMPLE}/pressure.png",
    "calibration/wedge/calibration.nc",
    *("calibration/wedge/calibration.png", "scheduler.json"),
]


def test_outputs_of_the_commands_are_ignored():
    named = re.findall(r"-o ([\w./]+)", (ROOT / "README.md").read_text("utf-8"))
    assert named
    command = ["git", "check-ignore", "--no-index", *WRITTEN, *named]
    found = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    if found.returncode > 1:
        pytest.skip("no checkout")
    assert set(found.stdout.split()) == {*WRITTEN, *named}
