"""Make the sample runs and their fixture again: python data_samples/make.py

They are photographs of known films by the virtual rig, so anybody can make the same images; the
bytes of their files depend on the release of zlib.
truth.nc and truth_thick_oil.nc, with the true films, are written beside this file and are not part
of the repository.
"""

import shutil
import tempfile
from dataclasses import replace
from pathlib import Path

from erlif.rig.sample import SAMPLE, write_sample

THICK_OIL = replace(
    SAMPLE,
    film="law",
    film_reference=3.66,
    exponent=0.7,
    film_floor=0.3,
    viscosity=0.3,
    spacing=1.92,
    fixture_after=False,
)
"""A film that grows with the speed to the power of 0.7, 3.66 um at the highest."""

here = Path(__file__).parent
calibration = here.parent / "calibration"


def replace_data(source: Path, target: Path) -> None:
    """Copy all of `source` into `target`, whose other files are removed except its README."""
    for old in target.iterdir() if target.exists() else ():
        if old.name != "README.md":
            shutil.rmtree(old) if old.is_dir() else old.unlink()
    shutil.copytree(source, target, dirs_exist_ok=True)


def finish(directory: Path, name: str) -> None:
    """State the name, and where the fixtures lie in the repository."""
    (path,) = directory.glob("*.toml")
    text = path.read_text()
    text = text.replace("../fixture/", "../../calibration/wedge/")
    text = text.replace("../fixture_after/", "../../calibration/wedge_after/")
    path.write_text(text.replace("virtual straight bushing", name))


def main() -> None:
    """Simulate, and move the written directories to their places."""
    with tempfile.TemporaryDirectory() as scratch:
        for rig, name in ((SAMPLE, "straight_bushing"), (THICK_OIL, "thick_oil")):
            made = write_sample(Path(scratch) / name, rig=rig)
            finish(made / "run", f"virtual {name.replace('_', ' ')}")
            replace_data(made / "run", here / name)
            truth = "truth.nc" if rig is SAMPLE else f"truth_{name}.nc"
            shutil.move(made / "truth.nc", here / truth)
            for fixture in ("fixture", "fixture_after") if rig is SAMPLE else ():
                finish(made / fixture, "")
                replace_data(made / fixture, calibration / fixture.replace("fixture", "wedge"))


if __name__ == "__main__":
    main()
