"""Coverage of the intervals of `erlif friction` and of `fit_clearances`.

``python benchmarks/friction.py`` prints the tables of docs/friction.md: shares in per cent of 300
draws in which one standard deviation and the interval of 95 % hold the true value.
"""

from __future__ import annotations

import argparse
import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
from scipy.signal import lfilter

from erlif.joint.friction.reversals import spread_of_line
from erlif.joint.models.clearance_fit import fit_clearances
from erlif.models.contact import winkler_contact

PAIR = 20
"""Duration of a pair of stretches. [s]"""

WALL = {"load_per_length": 4e4, "shaft_radius": 5e-3, "thickness": 3e-3}
CLEARANCE = np.array([200e-6, 100e-6, 50e-6, 25e-6, 15e-6])
FRICTION, MODULUS = 0.12, 1e9


def cover_log(duration: int, memory: float, draws: int, rng: np.random.Generator) -> str:
    """Mean and change of friction that wanders by 0.004, with noise of 0.01 in 10 samples/s."""
    kept = np.exp(-1 / memory) if memory else 0.0
    start = kept * rng.normal(size=(draws, 1))
    steps = np.sqrt(1 - kept**2) * rng.normal(size=(draws, duration))
    wander = 0.004 * lfilter([1], [1, -kept], steps, axis=1, zi=start)[0] * bool(memory)
    pairs = wander.reshape(draws, -1, PAIR).mean(axis=2)
    pairs += 0.01 / np.sqrt(160) * rng.normal(size=pairs.shape)
    time = PAIR * np.arange(pairs.shape[1])
    away = (time - time.mean()) / time[-1]
    inside, few = [], []
    for values in pairs:
        mean, change = spread_of_line(time, values)
        errors = np.abs([values.mean()] * 2 + [away @ values / (away @ away)] * 2)
        inside.append(errors < [mean.std, mean.wide, change.std, change.wide])
        few.append(mean.independent < 4)
    shares = 100 * np.mean(inside, axis=0)
    return (
        f"| {duration} s | {memory:g} s | {shares[0]:.0f}, {shares[1]:.0f} "
        f"| {shares[2]:.0f}, {shares[3]:.0f} | {100 * np.mean(few):.0f} |"
    )


def cover_clearances(
    torque: float, place: float, known: float | None, draws: int, rng: np.random.Generator
) -> str:
    """Friction from five bushings; errors of torques and clearances, the exact wall as truth."""
    # far enough from zero that no error makes an interference, which the exact wall lacks
    clearance = CLEARANCE + 4 * max(place - 3e-6, 0.0)
    moved = clearance + place * rng.normal(size=(draws, CLEARANCE.size))
    contact = winkler_contact(
        4e4, shaft_radius=5e-3, bushing_radius=5e-3 + moved, thickness=3e-3, modulus=MODULUS
    )
    series = FRICTION * contact.torque_ratio * (1 + torque * rng.normal(size=moved.shape))
    inside, pulls = [], []
    for measured in series:
        guess = None if known is None else (MODULUS * float(np.exp(known * rng.normal())), known)
        found = fit_clearances(
            clearance,
            friction=measured,
            friction_std=torque * measured,
            clearance_std=place,
            known_modulus=guess,
            **WALL,
        )
        low, high = found.friction_interval
        pulls.append((found.friction - FRICTION) / found.friction_std)
        inside.append([abs(pulls[-1]) < 1, low < FRICTION < high])
    one, two = 100 * np.mean(inside, axis=0)
    told = "unknown" if known is None else f"{100 * known:g} %"
    return (
        f"| {100 * torque:g} % | {1e6 * place:g} um | {told} | {one:.0f}, {two:.0f} "
        f"| {np.mean(pulls):+.1f} |"
    )


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--draws", type=int, default=300)
    draws = parser.parse_args().draws
    rng = np.random.default_rng(21)
    print("| log | correlation | mean, 68 and 95 % | change, 68 and 95 % | warned |")
    print("|---|---|---|---|---|")
    for duration, memories in ((600, (0, 1, 3, 10, 30, 50, 100)), (1200, (0, 10, 30, 100))):
        for memory in memories:
            print(cover_log(duration, memory, draws, rng), flush=True)
    print("\n| torque | clearance | modulus | friction, 68 and 95 % | mean error in stds |")
    print("|---|---|---|---|---|")
    for place in (1e-6, 3e-6, 10e-6):
        for torque, known in ((0.002, None), (0.02, 0.1), (0.02, None)):
            print(cover_clearances(torque, place, known, draws, rng), flush=True)


if __name__ == "__main__":
    main()
