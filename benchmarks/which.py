"""Does the sentence on what carries a film say the truth? Films of twelve kinds, of known truth.

    pip install -e .
    python benchmarks/which.py               # all kinds, five seeds
    python benchmarks/which.py --constant    # 300 films at rest, neighbours correlated

A sentence is right if it names what carries the film, or that no model fits.
"""

import argparse
import sys
import time
import warnings
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
from scenes.carried import KINDS, compare, pulls

SEEDS = 5
FILMS, CORRELATIONS = 100, (0.0, 0.5, 0.9)


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


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--constant", action="store_true")
    parser.add_argument("--seeds", type=int, default=SEEDS)
    parser.add_argument("--films", type=int, default=FILMS)
    parser.add_argument("kinds", nargs="*", default=list(KINDS))
    chosen = parser.parse_args()
    warnings.simplefilter("ignore")
    if chosen.constant:
        run_constant(chosen.films)
    else:
        run_kinds(chosen.seeds, chosen.kinds)
