"""The methods entered in the ERLIF challenge by its makers: two scripts, and erlif twice.

``python -m benchmarks.challenge.methods METHOD OUT [NAME...]`` measures the rigs in ``OUT/rigs``
and writes ``OUT/submissions/METHOD/NAME.h5``.
"""

import argparse
import os
import tomllib
from dataclasses import dataclass
from pathlib import Path
from pkgutil import resolve_name

import h5py
import numpy as np

import erlif

Array = np.ndarray


@dataclass(frozen=True)
class Rig:
    """What a method is given of a rig.

    Attributes
    ----------
    home : Path
        Its directory: fixture, fixture_after, run and laboratory.
    speed_over_load : Array
        Of each map, over the largest, (map,). [1]
    region : tuple[slice, slice]
        Rows and columns of the region of interest.
    """

    home: Path
    speed_over_load: Array
    region: tuple[slice, slice]


def open_rig(home: Path) -> Rig:
    """Read motion and region of a rig."""
    settings = tomllib.loads((home / "run" / "run.toml").read_text(encoding="utf-8"))
    pitch = float(settings["optics"]["pixel_pitch"].split()[0]) / 1e3
    roi = settings["thickness"]["roi"]
    rows, columns = (
        slice(int(np.ceil(roi[axis][0] / pitch)), int(roi[axis][1] / pitch) + 1) for axis in "yx"
    )
    motion = np.loadtxt(home / "motion.csv", delimiter=",", skiprows=1)
    return Rig(home, motion[:, 1], (rows, columns))


def measure_erlif(rig: Rig, *, settings: str = "run") -> dict[str, Array | float]:
    """erlif with run.toml as it is, which states nothing."""
    for old in rig.home.glob("fixture*/calibration.nc"):
        old.unlink()
    film = erlif.process(rig.home / settings, allow_outside=settings != "run")
    std = np.hypot(film.thickness_std, film.thickness_std_shared)
    found = {"thickness": film.thickness.values, "std": std.values, "minimum": film.film_min.values}
    if np.ptp(rig.speed_over_load) > 0.1:
        found["exponent"] = float(film.speed_exponent)
    return found


def measure_erlif_laboratory(rig: Rig) -> dict[str, Array | float]:
    """erlif with dry frames, stated widths, a fixture after the run and a patch of known film."""
    return measure_erlif(rig, settings="laboratory")


METHODS = {
    "script": "benchmarks.challenge.scripts:measure_script",
    "openpiv": "benchmarks.challenge.scripts:measure_openpiv",
    "erlif": "benchmarks.challenge.methods:measure_erlif",
    "erlif_laboratory": "benchmarks.challenge.methods:measure_erlif_laboratory",
}
"""Where each method is; those of OpenPIV need ``pip install -e ".[benchmark]"``."""


def submit(method: str, out: Path, name: str) -> None:
    """Measure one rig and write the submission."""
    rig, measure = open_rig(out / "rigs" / name), resolve_name(METHODS[method])
    start = sum(os.times()[:4])  # processor time, of child processes too
    found = measure(rig)
    seconds = sum(os.times()[:4]) - start
    folder = out / "submissions" / method
    folder.mkdir(parents=True, exist_ok=True)
    with h5py.File(folder / f"{name}.h5", "w") as file:
        for key, values in found.items():
            if np.ndim(values):
                file.create_dataset(key, data=np.asarray(values, "f4"), compression="gzip")
            else:
                file.attrs[key] = values
        file.attrs["seconds"] = seconds


def main() -> None:
    """Measure the rigs that are named, else all."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("method", choices=METHODS)
    parser.add_argument("out", type=Path)
    parser.add_argument("names", nargs="*", metavar="NAME")
    options = parser.parse_args()
    names = options.names or sorted(home.name for home in (options.out / "rigs").iterdir())
    # the first rig loads and compiles; it is measured again in its turn
    submit(options.method, options.out, names[0])
    for name in names:
        submit(options.method, options.out, name)
        print(f"{options.method}, {name}", flush=True)


if __name__ == "__main__":
    main()
