"""Draw the ten virtual rigs of the ERLIF challenge, and their truth apart from them.

``python -m benchmarks.challenge.rigs OUT`` writes ``OUT/rigs/NAME`` with what a laboratory has, and
``OUT/truth/NAME.h5``; names after OUT draw those rigs alone. The frames are compared with
`hashes.txt`, which ``--write-hashes`` makes anew.

The rigs come from `erlif.rig`, which shares no code with the stages that measure.
"""

import argparse
import hashlib
import shutil
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import tifffile
import xarray as xr

from benchmarks.film import photon_limit
from benchmarks.real_rigs import region_of
from erlif.rig import RigSettings, simulate

HASHES = Path(__file__).with_name("hashes.txt")
PULSES = 24  # of most rigs: frame pairs over which the dyes bleach

COMMON: dict[str, Any] = {
    "width": 160,
    "height": 128,
    "spacing": 2.0,
    "fixture_frames": 8,
    # what every laboratory could have: entrants may use it or not
    "background_pages": 8,
    "fixture_after": True,
    "reference": 5.0,
    "write_systematics": False,
}

RIGS: dict[str, dict[str, Any]] = {
    "ideal": {"width": 224, "height": 176, "bubbles": 0, "hot_fraction": 0.0, "dead_pixels": 0},
    "thin": {"film_reference": 1.6, "exponent": 0.5, "tilt": 0.1},
    "dark": {"light": 0.1, "exponent": 0.7},
    "bubbles": {"bubbles": 100, "hot_fraction": 2e-3, "dust": 8, "blur": (0.5, 0.9)},
    "background": {"background": 0.02, "background_second": 1.2, "exponent": 0.55},
    "bleaching": {
        "bleaching": (1 - 0.975 ** (1 / PULSES), 1 - 0.95 ** (1 / PULSES)),
        "warming": 6.0,
        "exponent": 0.45,
    },
    "wall": {"wall": (0.1, 0.1), "wall_texture": (0.5, 1.0)},
    "window": {"shading": (0.009, 0, 0, 0, 0.018), "brightness": (1.0, 1.01), "exponent": 0.7},
    "disc": {
        "mechanism": "rotation",
        "contact": "ball",
        "ball_radius": 2000.0,
        "film_table": tuple(np.round(3.0 + 1.5 * np.sin(np.arange(24) / 24 * 2 * np.pi), 3)),
    },
    "long": {"width": 128, "height": 96, "spacing": 2.4, "cycles": 20, "exponent": 0.5},
}
"""What each rig has beside COMMON; all of it is in docs/challenge.md."""

BOTH = '"../fixture/calibration.nc", "../fixture_after/calibration.nc"'

LABORATORY = """
[systematics]
lag = "0.1 %"
batch = "0 %"
wall = "0.5 %"
linearity = "0.2 %"

[light]
ratio = "correct"
"""
"""What a laboratory states: widths of what it has measured, and that the patch is to be used."""


def draw_rig(name: str, out: Path) -> str:
    """Write one rig and its truth; the hash of its frames."""
    seed = 4300 + list(RIGS).index(name)
    rig = RigSettings(**COMMON | RIGS[name])
    home, truth = out / "rigs" / name, out / "truth" / f"{name}.h5"
    with tempfile.TemporaryDirectory() as scratch:
        made = simulate(Path(scratch), seed=seed, rig=rig)
        shutil.rmtree(home, ignore_errors=True)
        home.mkdir(parents=True)
        truth.parent.mkdir(exist_ok=True)
        with xr.open_dataset(made / "truth.nc", engine="h5netcdf") as true:
            write_truth(truth, true.load(), rig)
            write_motion(home / "motion.csv", true)
        for part in ("fixture", "fixture_after", "run"):
            shutil.move(made / part, home / part)
    split_settings(home)
    return hash_frames(home)


def write_truth(path: Path, true: xr.Dataset, rig: RigSettings) -> None:
    """Film, photon limit and minimum of each map, (map, y, x), and the region judged, (y, x).

    The limit is the standard deviation of a pixel by shot, read and rounding noise alone, of the
    frames of the map without a bubble there; NaN where there is none. [um]
    """
    clear = np.zeros(true.film.shape, np.int64)
    np.add.at(clear, true.frame_trigger.values.astype(int), true.bubble.values == 0)
    limit = photon_limit(true, wall=rig.wall[1]) / np.sqrt(np.where(clear > 0, clear, np.nan))
    region = np.broadcast_to(region_of(rig, true), true.film.shape[1:])
    with h5py.File(path, "w") as file:
        for key, values in (("film", true.film.values), ("limit", limit), ("region", region)):
            file.create_dataset(key, data=values, compression="gzip")
        file["minimum"] = true.film_min.values
        file.attrs["exponent"] = rig.exponent if rig.film_table is None else np.nan


def write_motion(path: Path, true: xr.Dataset) -> None:
    """Speed over load of each map, over its largest, for the exponent of the film."""
    speed = true["rocker_speed" if "rocker_speed" in true else "sliding_speed"]
    over_load = np.abs(speed.values) / true.joint_load.values
    rows = np.column_stack([np.arange(over_load.size), over_load / over_load.max()])
    np.savetxt(path, rows, "%d,%.6f", header="map,speed_over_load", comments="")


def split_settings(home: Path) -> None:
    """Settings of a user who states nothing in run/, of a laboratory in laboratory/.

    Both name the patch of known film: it is no part of the joint. The laboratory alone uses it.
    """
    run = home / "run" / "run.toml"
    whole = run.read_text(encoding="utf-8")
    plain = whole.replace(f"[{BOTH}]", BOTH.partition(",")[0])
    lines = [line for line in plain.splitlines() if not line.startswith("background =")]
    run.write_text("\n".join(lines) + "\n", encoding="utf-8")

    for part in ("camera1", "camera2"):
        whole = whole.replace(f'"{part}', f'"../run/{part}')
    whole = whole.replace('"encoder.csv"', '"../run/encoder.csv"')
    (home / "laboratory").mkdir()
    (home / "laboratory" / "run.toml").write_text(whole + LABORATORY, encoding="utf-8")


def hash_frames(home: Path) -> str:
    """SHA-256 of all counts of a rig, file after file by name."""
    digest = hashlib.sha256()
    for path in sorted(home.rglob("*.tif")):
        digest.update(path.relative_to(home).as_posix().encode())
        digest.update(tifffile.imread(path).astype("<u2").tobytes())
    return digest.hexdigest()


def read_hashes() -> dict[str, str]:
    """Hash of each rig by its name."""
    lines = HASHES.read_text(encoding="utf-8").splitlines()
    return {name: digest for digest, name in (line.split("  ", 1) for line in lines)}


def draw_rigs(out: Path, names: Sequence[str]) -> dict[str, str]:
    """Write rigs, and report those whose frames are not those of the list."""
    listed = read_hashes()
    found = {}
    for name in names:
        found[name] = draw_rig(name, out)
        same = found[name] == listed.get(name)
        print(f"{name}: frames {'as' if same else 'not as'} in hashes.txt", flush=True)
    return found


def main() -> None:
    """Draw the rigs that are named, else all."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out", type=Path)
    parser.add_argument("names", nargs="*", metavar="NAME", help=", ".join(RIGS))
    parser.add_argument("--write-hashes", action="store_true", help="renew hashes.txt")
    options = parser.parse_args()
    if unknown := set(options.names) - set(RIGS):
        parser.error(f"Expected names out of {', '.join(RIGS)}; got {', '.join(unknown)}.")
    found = draw_rigs(options.out, options.names or list(RIGS))
    if options.write_hashes:
        rows = read_hashes() | found
        HASHES.write_text("".join(f"{rows[name]}  {name}\n" for name in RIGS), encoding="utf-8")


if __name__ == "__main__":
    main()
