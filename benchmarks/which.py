"""Does the sentence on what carries a film say the truth? Films of twelve kinds, of known truth.

    pip install -e .
    python benchmarks/which.py               # all kinds, five seeds
    python benchmarks/which.py --constant    # 300 films at rest, neighbours correlated
    python benchmarks/which.py --photographs # by the virtual rig, with a pin that rocks

A sentence is right if it names what carries the film, or that no model fits.
"""

import argparse
import sys
import tempfile
import time
import warnings
from pathlib import Path

import numpy as np

import erlif
from erlif.pipeline.physics.fit import state_physics
from erlif.pipeline.physics.predict import read_film
from erlif.rig import RigSettings, simulate

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
from scenes.carried import FORMULA, KINDS, compare, pulls

SEEDS = 5
FILMS, CORRELATIONS = 100, (0.0, 0.5, 0.9)

TOP = 1e6 * float(FORMULA.max())
LAW = {"film_floor": 1e-3, "tilt": 0.0, "load_swing": 0.0}
SAW = tuple(5 + (7 * np.arange(50) / 50) % 1)
PHOTOGRAPHS = {
    "formula": {**LAW, "film_reference": TOP, "exponent": 0.7},
    "formula x 5": {**LAW, "film_reference": 5.03 * TOP, "exponent": 0.7},
    "power": {**LAW, "film_reference": 9.0, "exponent": 0.4},
    "constant": {**LAW, "film_table": (6.0,) * 50},
    "stick-slip": {**LAW, "film_table": SAW},
    "free pin": {"film": "reynolds", "tilt": 0.0},
    "other oil": {
        "film": "reynolds",
        "tilt": 0.0,
        "viscosity": 0.3,
        "stated_viscosity": 0.12,
        "elapsed": 60.0,
    },
    "guided pin": {
        "film": "reynolds",
        "tilt": 0.0,
        "sideways": "guided",
        "load": 2000.0,
        "elapsed": 6.0,
    },
}
"""Changes of the rig."""
ROCKS = 0.06  # half the range of the tilt that is added to the film at rest [um/mm]


def run_kinds(seeds, names):
    every = []
    for name in names:
        right, took = 0, []
        for seed in range(seeds):
            begun = time.process_time()
            found, truth = compare(name, seed)
            took.append(time.process_time() - begun)
            first = found.verdict.partition(". ")[0]
            good = found.verdict.startswith((KINDS[name].right, "No model fits"))
            right += good
            off = pulls(found, truth)
            every += off.values()
            if seed == 0 or not good:
                print(f"  {len(first)}: {found.verdict}")
            print("  ", {key: f"{one:+.2f}" for key, one in off.items()}, flush=True)
        print(f"{name}: {right} of {seeds} right, {np.median(took):.2f} s")
    near = [f"{np.mean(np.abs(every) < k):.1%}" for k in (1, 2)]
    print(f"{len(every)} numbers, within 1 and 2 std: {near}")


def run_constant(films):
    for correlation in CORRELATIONS:
        said = [compare("constant", seed, correlation)[0] for seed in range(films)]
        still = sum(one.verdict.startswith(KINDS["constant"].right) for one in said)
        squeezed = sum("squeeze" in one.verdict.partition(". ")[0].lower() for one in said)
        print(f"{correlation}: {still} of {films} constant, {squeezed} squeeze", flush=True)
        for one in said:
            if not one.verdict.startswith(KINDS["constant"].right):
                print("  ", one.verdict)


def run_photographs(seed=3):
    for name, changes in PHOTOGRAPHS.items():
        with tempfile.TemporaryDirectory() as folder:
            place = Path(folder)
            rig = RigSettings(width=128, height=96, fixture_frames=6, bubbles=0, **changes)
            simulate(place, seed=seed, rig=rig)
            calibration = erlif.calibrate(place / "fixture")
            output = place / "film.nc"
            erlif.process(place / "run", calibration=calibration, output=output, workers=1).close()
            with erlif.open_film(output) as film:
                print(f"{name}: {film.attrs.get('physics')}", flush=True)
                if name.startswith("formula"):
                    top = changes["film_reference"] / float(film.film_hamrock_dowson.max())
                    print(f"true factor {top:.4f}, at the highest speed of a trigger")
                if name == "constant":
                    source, tilt = read_film(output), film.pin_tilt.load().copy()
                    tilt[:, 0] += ROCKS * np.sin(2 * np.pi * np.arange(len(tilt)) / len(tilt))
                    rocking = film.load().assign(pin_tilt=tilt)
                    print("rocking:", state_physics(rocking, source.settings, source.frames))


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--constant", action="store_true")
    parser.add_argument("--photographs", action="store_true")
    parser.add_argument("--seeds", type=int, default=SEEDS)
    parser.add_argument("--films", type=int, default=FILMS)
    parser.add_argument("kinds", nargs="*", default=list(KINDS))
    chosen = parser.parse_args()
    warnings.simplefilter("ignore")
    if chosen.constant:
        run_constant(chosen.films)
    elif chosen.photographs:
        run_photographs()
    else:
        run_kinds(chosen.seeds, chosen.kinds)
