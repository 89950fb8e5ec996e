"""Make the sample run and its fixture again: python data_samples/make.py

They are photographs of a known film by the virtual rig, so anybody can make the same images; the
bytes of their files depend on the release of zlib.
truth.nc, with the true film, is written beside this file and is not part of the repository.
"""

import shutil
import tempfile
from pathlib import Path

from erlif.rig import RigSettings, simulate

SEED = 2002
RIG = RigSettings(width=320, height=256, film="reynolds", tilt=0.0, fixture_frames=8)
"""Small pictures and few fixture frames keep the repository small."""

here = Path(__file__).parent
run, fixture = here / "straight_bushing", here.parent / "calibration" / "wedge"


def replace_data(source: Path, target: Path) -> None:
    """Copy all of `source` into `target`, whose other files are removed except its README."""
    for old in target.iterdir() if target.exists() else ():
        if old.name != "README.md":
            shutil.rmtree(old) if old.is_dir() else old.unlink()
    shutil.copytree(source, target, dirs_exist_ok=True)


def main() -> None:
    """Simulate, and move the written directories to their places."""
    with tempfile.TemporaryDirectory() as scratch:
        made = simulate(Path(scratch) / "made", seed=SEED, rig=RIG)

        # in the repository the fixture does not lie beside the run
        settings = made / "run" / "run.toml"
        text = settings.read_text().replace(
            "../fixture/calibration.nc", "../../calibration/wedge/calibration.nc"
        )
        settings.write_text(text)

        replace_data(made / "run", run)
        replace_data(made / "fixture", fixture)
        shutil.move(made / "truth.nc", here / "truth.nc")


if __name__ == "__main__":
    main()
