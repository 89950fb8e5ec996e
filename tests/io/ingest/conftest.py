"""A small run and a small fixture, written by tifffile and as text."""

import shutil
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
import tifffile

SHAPE = (64, 80)

CAMERAS = """
[camera1]
files = "camera1/*.tif"
band = "580 nm"
dark = "camera1_dark.tif"
flat = "camera1_flat.tif"

[camera2]
files = "camera2/*.tif"
band = "610 nm"
dark = "camera2_dark.tif"
flat = "camera2_flat.tif"

[optics]
pixel_pitch = "60 um"
"""

RUN = """
[run]
name = "small run"
{cameras}
[encoder]
file = "encoder.csv"

[mechanism]
kind = "crank-rocker"
crank = "5.5 cm"
coupler = "44 cm"
rocker = "26 cm"
ground = "51 cm"
crank_speed = "114 rpm"

[joint]
pin_radius = "33.36 mm"
bushing_radius = "33.59 mm"
length = "237 mm"
load = "50 lbf"
pin = {{ youngs_modulus = "2.7 GPa", poissons_ratio = 0.37 }}
bushing = {{ youngs_modulus = "2.7 GPa", poissons_ratio = 0.37 }}

[oil]
name = "80W-90"
viscosity = "0.12 Pa s"
pressure_viscosity = "12.4 1/GPa"
"""

FIXTURE = """
[fixture]
name = "small wedge"
profile = "profile.csv"
{cameras}
"""


@dataclass(frozen=True)
class Recorded:
    """A directory with frames, darks and flats of two cameras."""

    directory: Path
    counts: np.ndarray
    """What was written, (camera, frame, y, x). [DN]"""

    def frames(self, camera: int) -> list[Path]:
        return sorted((self.directory / f"camera{camera}").iterdir())

    def edit(self, file: str, *changes: tuple[str, str]) -> None:
        """Replace text in a file, each piece once."""
        path = self.directory / file
        text = path.read_text(encoding="utf-8")
        for old, new in changes:
            assert old in text
            text = text.replace(old, new, 1)
        path.write_text(text, encoding="utf-8")


def write_pages(path: Path, pages) -> None:
    with tifffile.TiffWriter(path) as file:
        for page in pages:
            file.write(page, contiguous=False, metadata=None, photometric="minisblack")


def record(directory: Path, frames: int, seed: int) -> Recorded:
    """Images of random counts; 12 bits, so that each pixel of each frame is its own."""
    rng = np.random.default_rng(seed)
    counts = rng.integers(100, 4000, (2, frames, *SHAPE), dtype=np.uint16)
    for camera in (1, 2):
        (directory / f"camera{camera}").mkdir(parents=True)
        for k, image in enumerate(counts[camera - 1]):
            write_pages(directory / f"camera{camera}" / f"frame_{k:04d}.tif", [image])
        for kind, level in (("dark", 64), ("flat", 2000)):
            pages = rng.integers(level, level + 20, (3, *SHAPE), dtype=np.uint16)
            write_pages(directory / f"camera{camera}_{kind}.tif", pages)
    return Recorded(directory, counts)


@pytest.fixture(scope="session")
def written(tmp_path_factory) -> dict[str, Recorded]:
    """Run and fixture as they were written; never to be changed."""
    top = tmp_path_factory.mktemp("recorded")
    run, fixture = record(top / "run", 6, seed=1), record(top / "fixture", 3, seed=2)
    rows = "".join(f"{k},{0.01 * k:g},{50 + k},222,25\n" for k in range(6))
    log = "frame,time_s,angle_deg,load_N,temperature_C\n" + rows
    (run.directory / "encoder.csv").write_text(log)
    (run.directory / "run.toml").write_text(RUN.format(cameras=CAMERAS))
    (fixture.directory / "profile.csv").write_text("x_mm,thickness_um\n0,0\n10,50\n")
    (fixture.directory / "fixture.toml").write_text(FIXTURE.format(cameras=CAMERAS))
    return {"run": run, "fixture": fixture}


@pytest.fixture
def run(written, tmp_path) -> Recorded:
    """A run of six frame pairs that a test may damage."""
    shutil.copytree(written["run"].directory, tmp_path / "run")
    return Recorded(tmp_path / "run", written["run"].counts)


@pytest.fixture
def fixture(written, tmp_path) -> Recorded:
    """A fixture of three frame pairs that a test may damage."""
    shutil.copytree(written["fixture"].directory, tmp_path / "fixture")
    return Recorded(tmp_path / "fixture", written["fixture"].counts)


@pytest.fixture
def save_pages():
    """Write images as the pages of one TIFF file."""
    return write_pages
