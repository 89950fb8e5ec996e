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

from erlif.rig import RigSettings, simulate

SEED = 2002
RIG = RigSettings(
    width=256,
    height=208,
    film="reynolds",
    tilt=0.0,
    elapsed=40.0,
    thin_line=0.0,
    fixture_frames=8,
    fixture_after=True,
    dark_pages=6,
    flat_pages=3,
    # what a rig has and its laboratory measures or states
    background=0.01,
    background_pages=4,
    bleaching=(2e-5, 1e-5),
    brightness=(1.0, 1.002),
    wall=(0.0, 0.002),
    write_systematics=False,
)
"""Small pictures and few reference pages keep the repository small."""

THICK_OIL = replace(
    RIG,
    film="law",
    film_reference=3.66,
    exponent=0.7,
    film_floor=0.3,
    viscosity=0.3,
    spacing=1.92,
    fixture_after=False,
)
"""A film that grows with the speed to the power of 0.7, 3.66 um at the highest."""

WIDTHS = {
    "run.toml": """
[systematics]
ratio = "0.3 %"
background = "0.2 %"
energy = "1 %"
bleaching = "0.2 %"
temperature = "0.2 %"
wall = "0.5 %"
field = "0.1 %"
linearity = "0.1 %"
lag = "0.1 %"
batch = "0 %"
""",
    "fixture.toml": """
[systematics]
position = "0.01 mm"
size = "0.05 %"
""",
}
"""What a laboratory states that has photographed the dry joint, and the fixture twice."""

here = Path(__file__).parent
calibration = here.parent / "calibration"


def replace_data(source: Path, target: Path) -> None:
    """Copy all of `source` into `target`, whose other files are removed except its README."""
    for old in target.iterdir() if target.exists() else ():
        if old.name != "README.md":
            shutil.rmtree(old) if old.is_dir() else old.unlink()
    shutil.copytree(source, target, dirs_exist_ok=True)


def finish(directory: Path, name: str) -> None:
    """State material and widths, and where the fixtures lie in the repository."""
    (path,) = directory.glob("*.toml")
    text = path.read_text()
    diamond = 'youngs_modulus = "1000 GPa", poissons_ratio = 0.1'
    text = text.replace(diamond, 'youngs_modulus = "2.7 GPa", poissons_ratio = 0.37')
    text = text.replace("../fixture/", "../../calibration/wedge/")
    text = text.replace("../fixture_after/", "../../calibration/wedge_after/")
    text = text.replace("virtual straight bushing", name)
    path.write_text(f"{text.rstrip()}\n{WIDTHS[path.name]}")


def main() -> None:
    """Simulate, and move the written directories to their places."""
    with tempfile.TemporaryDirectory() as scratch:
        for rig, name in ((RIG, "straight_bushing"), (THICK_OIL, "thick_oil")):
            made = simulate(Path(scratch) / name, seed=SEED, rig=rig)
            finish(made / "run", f"virtual {name.replace('_', ' ')}")
            replace_data(made / "run", here / name)
            truth = "truth.nc" if rig is RIG else f"truth_{name}.nc"
            shutil.move(made / "truth.nc", here / truth)
            for fixture in ("fixture", "fixture_after") if rig is RIG else ():
                finish(made / fixture, "")
                replace_data(made / fixture, calibration / fixture.replace("fixture", "wedge"))


if __name__ == "__main__":
    main()
