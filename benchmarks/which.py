"""Does the sentence on what carries a film say the truth? Films of twelve kinds, of known truth.

    pip install -e .
    python benchmarks/which.py               # all kinds, five seeds
    python benchmarks/which.py --constant    # 300 films at rest, neighbours correlated
    python benchmarks/which.py --photographs # by the virtual rig, with a pin that rocks
    python benchmarks/which.py --contacts    # by the virtual rig, of a slider without a pin

A sentence is right if it names what carries the film, or that no model fits.
"""

import argparse
import re
import sys
import tempfile
import time
import warnings
from pathlib import Path

import numpy as np
import xarray as xr

import erlif
from erlif.pipeline.physics.fit import state_physics
from erlif.pipeline.physics.predict import read_film
from erlif.rig import RigSettings, simulate
from erlif.rig.film import list_triggers

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
from scenes.carried import FORMULA, KINDS, compare, pulls

SEEDS = 5
FILMS, CORRELATIONS = 100, (0.0, 0.5, 0.9)

TOP = 1e6 * float(FORMULA.max())
TRIGGERS = np.arange(50) / 50
SPEED = np.abs(list_triggers(RigSettings()).speed)
LAW = {"film_floor": 1e-3, "tilt": 0.0, "load_swing": 0.0}
FREE = {"film": "reynolds", "tilt": 0.0}
HELD = {**FREE, "sideways": "guided", "load": 2000.0, "elapsed": 6.0}


def table(film, rng, **changes):
    """Rig of a film that is given at each trigger, or as a function of the shares of the speed."""
    if callable(film):
        film = film(SPEED / SPEED.max(), rng)
    return {**LAW, "film_table": tuple(np.asarray(film, float)), **changes}


_SHAPE = "The shape is that of Hamrock-Dowson, line contact (2.65)"
RIGHT = {"rocking": "The pin rocks", "formula": _SHAPE, "formula x 5": _SHAPE}
"""Sentences of photographed films that are not those of `KINDS`: the acrylic joint of the rig is
isoviscous-rigid, where 2.65 is a shape and no theory."""

_NUMBER = r"([0-9.]+) ± ([0-9.]+)"
PATTERN = {
    "formula": re.compile(f"{_NUMBER} times"),
    "formula x 5": re.compile(f"{_NUMBER} times"),
    "power": re.compile(f"power {_NUMBER}"),
    "power above an offset": re.compile(f"power {_NUMBER}"),
    "free pin": re.compile(f"{_NUMBER} Pa s"),
    "other oil": re.compile(f"{_NUMBER} Pa s"),
    "guided pin": re.compile(f"{_NUMBER} Pa s"),
}
"""The number of a sentence with its standard deviation."""


def draw_photographs(rng):
    """Kinds of films, each with the changes of the rig and the true number of the verdict."""
    factor, power, oil = rng.uniform(0.7, 1.2), rng.uniform(0.35, 0.55), rng.uniform(0.1, 0.14)
    wander = np.zeros(50)
    for k in range(1, 50):
        wander[k] = 0.8 * wander[k - 1] + 0.6 * rng.normal()
    return {
        "formula": ({**LAW, "film_reference": factor * TOP, "exponent": 0.7}, factor),
        "formula x 5": ({**LAW, "film_reference": 5.03 * TOP, "exponent": 0.7}, 5.03),
        "power": ({**LAW, "film_reference": 9.0, "exponent": power}, power),
        "power above an offset": (table(lambda v, _: 3 + 6 * v**power, rng), power),
        "constant": (table(np.full(50, rng.uniform(3, 8)), rng), None),
        "correlated constant": (table(rng.uniform(4, 7) + 0.03 * wander, rng), None),
        "stick-slip": (table(5 + (7 * TRIGGERS + rng.uniform()) % 1, rng), None),
        "free pin": ({**FREE, "viscosity": oil, "stated_viscosity": 0.12}, oil),
        "other oil": ({**FREE, "viscosity": 0.3, "stated_viscosity": 0.12, "elapsed": 60.0}, 0.3),
        "guided pin": ({**HELD, "viscosity": oil, "stated_viscosity": 0.12}, oil),
        "warming": (table(lambda v, _: 7 * v**0.7 * np.exp(-0.084 * TRIGGERS), rng), None),
    }


# A slider on a bar of the curvature of the gap of the rig: its films are those of Martin (1916),
# 4.9 R eta u / q, hard and far from contact.
OIL, WEIGHT, WIDTH, CURVED, STROKE, FREQUENCY = 0.004, 222.4, 0.237, 4.872, 0.01, 5.0
MARTIN = 1e6 * 4.9 * CURVED * OIL * 0.5 * np.pi * STROKE * FREQUENCY / (WEIGHT / WIDTH)
STEEL = 'youngs_modulus = "206 GPa", poissons_ratio = 0.3'
CONTACT = f"""
[contact]
length = "{1e3 * WIDTH:g} mm"
body = {{ radius_along = "{1e3 * CURVED:g} mm", {STEEL} }}
counterbody = {{ {STEEL} }}

[oil]
viscosity = "{OIL} Pa s"
pressure_viscosity = "20 1/GPa"
"""
SLIDER = {"mechanism": "sinusoidal", "pictures": 50, "load_swing": 0.1, "tilt": 0.0}
CARRIED = {
    "formula": "The film follows the steady f",
    "formula x 5": "The shape is that of the steady film of the regime map, the viscosity not",
}
"""Sentences of sliders that are not those of `KINDS`."""


def draw_contacts(rng):
    """Kinds of films of a slider, as `draw_photographs` returns those of a pin."""
    factor, power = rng.uniform(0.8, 1.2), rng.uniform(0.35, 0.55)
    law = {**SLIDER, "film_floor": 0.2, "film_reference": factor * MARTIN, "exponent": 1.0}
    five = {**law, "viscosity": OIL / 5, "stated_viscosity": OIL / 5}
    still, slips = np.full(50, rng.uniform(2, 7)), 4 + (7 * TRIGGERS + rng.uniform()) % 1
    return {
        "formula": (law, factor),
        "formula x 5": (five, 5 * factor),
        "power": ({**law, "film_reference": 8.0, "exponent": power}, power),
        "constant": ({**SLIDER, "film_table": tuple(still)}, None),
        "stick-slip": ({**SLIDER, "film_table": tuple(slips)}, None),
    }


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


def photograph(place, seed, changes):
    """Film and truth of a rig."""
    rig = RigSettings(width=128, height=96, fixture_frames=6, bubbles=0, **changes)
    simulate(place, seed=seed, rig=rig)
    if "mechanism" in changes:
        stated = CONTACT.replace(f'"{OIL} Pa s"', f'"{rig.stated_viscosity or OIL} Pa s"')
        with (place / "run" / "run.toml").open("a", encoding="utf-8") as settings:
            settings.write(stated)
    calibration, output = erlif.calibrate(place / "fixture"), place / "film.nc"
    erlif.process(place / "run", calibration=calibration, output=output, workers=1).close()
    with erlif.open_film(output) as film, xr.open_dataset(place / "truth.nc") as truth:
        return film.load(), truth.load()


def run_photographs(seeds, draw, sentences):
    right, pulls_of_numbers = {}, []
    for seed in range(seeds):
        for name, (changes, number) in draw(np.random.default_rng(seed)).items():
            with tempfile.TemporaryDirectory() as folder:
                film, truth = photograph(Path(folder), seed, changes)
                said = {name: film.attrs["physics"]}
                if name == "constant" and draw is draw_photographs:
                    source = read_film(Path(folder) / "film.nc")
                    tilt = film.pin_tilt.copy()
                    tilt[:, 0] += ROCKS * np.sin(2 * np.pi * TRIGGERS)
                    tilted = film.assign(pin_tilt=tilt)
                    said["rocking"], _ = state_physics(tilted, source.settings, source.frames)
            if name.startswith("formula"):
                theory = "film_theory" if draw is draw_contacts else "film_hamrock_dowson"
                number = float((truth.film_min / film[theory].values).median())
            for kind, sentence in said.items():
                begins = sentences.get(kind) or KINDS[kind].right
                good = sentence.startswith((begins, "No model fits"))
                decided = not sentence.startswith("No model fits")
                right.setdefault(kind, []).append((good, decided))
                off = ""
                found = PATTERN[kind].search(sentence) if kind in PATTERN and decided else None
                if found and number is not None:
                    value, std = map(float, found.groups())
                    pulls_of_numbers.append((value - number) / std)
                    off = f"{value:g} ± {std:g}, true {number:.4g}"
                print(f"{kind} {seed}: {'' if good else 'WRONG '}{off or sentence}", flush=True)
    for kind, each in right.items():
        good, decided = np.sum(each, axis=0)
        print(f"{kind}: {good} of {len(each)} right, {decided} decided")
    near = [f"{np.mean(np.abs(pulls_of_numbers) < k):.1%}" for k in (1, 2)]
    print(f"{len(pulls_of_numbers)} numbers, within 1 and 2 std: {near}")


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--constant", action="store_true")
    parser.add_argument("--photographs", action="store_true")
    parser.add_argument("--contacts", action="store_true")
    parser.add_argument("--seeds", type=int, default=SEEDS)
    parser.add_argument("--films", type=int, default=FILMS)
    parser.add_argument("kinds", nargs="*", default=list(KINDS))
    chosen = parser.parse_args()
    warnings.simplefilter("ignore")
    if chosen.constant:
        run_constant(chosen.films)
    elif chosen.photographs:
        run_photographs(chosen.seeds, draw_photographs, RIGHT)
    elif chosen.contacts:
        run_photographs(chosen.seeds, draw_contacts, CARRIED)
    else:
        run_kinds(chosen.seeds, chosen.kinds)
