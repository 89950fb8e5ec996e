"""Speed, convergence and reference values of the transient Reynolds solver.

    python benchmarks/reynolds.py speed          # seconds a cycle, cost of a step over the cells
    python benchmarks/reynolds.py convergence    # orders in cells and time steps
    python benchmarks/reynolds.py rig            # the acrylic joint over many cycles
    python benchmarks/reynolds.py frames         # half-angle frame beside laboratory frame

The tables of docs/theory/reynolds.md are its output.
"""

import argparse
import time

import numpy as np

from erlif.models.mechanism import CrankRocker
from erlif.models.reynolds import Journal, crank_motion, solve_journal, steady_journal

RIG = CrankRocker(crank=0.055, coupler=0.44, rocker=0.26, ground=0.51)
LOAD = 50 * 4.4482216152605  # N
SPEED = 114 * 2 * np.pi / 60  # rad/s
GUIDED = {"sideways": "guided", "start": (2e-4, 0.0)}


def joint(**changes) -> Journal:
    """The acrylic joint; the mean radius is 33.36 mm, as the reference values assume."""
    radii = 0.03336 - 1.15e-4, 0.03336 + 1.15e-4
    return Journal(*radii, length=0.237, **{"viscosity": 0.12, **changes})


def run(journal: Journal, cycles: float, steps: int = 100, **options):
    """Film over some cycles."""
    motion = crank_motion(RIG, crank_speed=SPEED, load=LOAD, cycles=cycles, steps_per_cycle=steps)
    return solve_journal(journal, motion, **options)


def clock(journal: Journal, cycles: float, **options) -> tuple[float, float]:
    """Processor time a cycle, the best of three, and Newton steps a time step."""
    best, found = np.inf, None
    for _ in range(3):
        start = time.process_time()
        found = run(journal, cycles, **options)
        best = min(best, (time.process_time() - start) / cycles)
    return best, float(found.iterations.mean())


def speed() -> None:
    run(joint(), 0.1, compiled=True)
    print("100 steps a cycle             plain [s]  compiled [s]  Newton steps")
    for name, journal, options in (
        ("long, free, 256", joint(long=True), {"cells": (256, 1)}),
        ("long, guided, 256", joint(long=True), {"cells": (256, 1), **GUIDED}),
        ("with ends, free, 256 x 8", joint(), {}),
        ("with ends, guided, 256 x 8", joint(), GUIDED),
        ("with ends, vented, 256 x 8", joint(cavitation_pressure=0.0), {}),
    ):
        plain, newton = clock(journal, 2, compiled=False, **options)
        quick, _ = clock(journal, 5, compiled=True, **options)
        print(f"{name:28s} {plain:10.3f} {quick:13.4f} {newton:13.2f}")
    print("cells round the joint, long, guided: microseconds a step and cell")
    for cells in (256, 512, 1024, 2048, 4096):
        times = [
            clock(joint(long=True), 1, compiled=choice, cells=(cells, 1), **GUIDED)[0]
            for choice in (False, True)
        ]
        print(f"{cells:6d} {times[0] * 1e4 / cells:10.3f} {times[1] * 1e4 / cells:10.4f}")


def convergence() -> None:
    print("guided, long: film_min at the end of cycle 3 [um] and difference to the finest")
    films = {
        n: float(run(joint(long=True), 3, 400, compiled=True, cells=(n, 1), **GUIDED).film_min[-1])
        * 1e6
        for n in (64, 128, 256, 512, 1024, 2048)
    }
    finest = films[1024] + (films[2048] - films[1024]) * 4 / 3
    for n, film in films.items():
        print(f"{n:6d} cells {film:10.5f} {film - finest:10.5f}")
    films = {
        n: float(run(joint(long=True), 3, n, compiled=True, cells=(512, 1), **GUIDED).film_min[-1])
        * 1e6
        for n in (25, 50, 100, 200, 400, 800, 1600)
    }
    finest = 2 * films[1600] - films[800]
    for n, film in films.items():
        print(f"{n:6d} steps {film:10.5f} {film - finest:10.5f}")
    print("constant rotation with ends: film_min [um] over cells along half of the length")
    vented = joint(cavitation_pressure=0.0)
    for n in (4, 8, 16, 32):
        film = steady_journal(vented, speed=2.54, load=LOAD, cells=(256, n)).film_min
        print(f"{n:6d} {float(film) * 1e6:10.4f}")


def rig() -> None:
    ends = np.array([1, 2, 4, 6, 11, 16, 21, 24]) * 100
    for cells in ((256, 8), (512, 16)):
        found = run(joint(), 24, cells=cells)
        print("free", cells, np.round(found.film_min.values[ends] * 1e6, 2))
        last = run(joint(), 24, cells=cells).isel(time=slice(-100, None))
        print("  correlation with |speed|", round(correlation(last), 2))
    found = run(joint(viscosity=0.31), 60)
    print(
        "free, 0.31 Pa s, cycles 11, 31, 60",
        np.round(found.film_min.values[[1100, 3100, 6000]] * 1e6, 2),
    )
    for name, journal, cells, cycles in (
        ("-100 kPa", joint(), (256, 8), 80),
        ("-100 kPa", joint(), (512, 16), 80),
        ("-30 kPa", joint(cavitation_pressure=-3e4), (256, 8), 80),
        ("0.31 Pa s", joint(viscosity=0.31), (256, 8), 80),
        ("long", joint(long=True), (256, 1), 80),
        ("long, -30 kPa", joint(long=True, cavitation_pressure=-3e4), (256, 1), 80),
        ("long, vented", joint(long=True, cavitation_pressure=0.0), (256, 1), 100),
        ("vented", joint(cavitation_pressure=0.0), (256, 8), 100),
    ):
        last = run(journal, cycles, cells=cells, **GUIDED).isel(time=slice(-100, None))
        thin, thick = float(last.film_min.min()) * 1e6, float(last.film_min.max()) * 1e6
        angle = np.arange(1, 101) * 3.6
        print(
            f"guided {name} {cells}: {thin:.2f} to {thick:.2f} um, "
            f"side {float(last.reaction_side.min()) / LOAD:.2f} to "
            f"{float(last.reaction_side.max()) / LOAD:.2f} W, "
            f"peak {float(last.peak_pressure.max()) / 1e6:.3f} MPa, "
            f"thinnest at crank {angle[int(last.film_min.values.argmin())]:.0f}, "
            f"correlation {correlation(last):.2f}"
        )


def correlation(cycle) -> float:
    """Correlation of the film with the speed of the rocker over a cycle."""
    crank = SPEED * cycle.time.values
    speed = np.abs(RIG.rocker_speed(crank, crank_speed=SPEED))
    return float(np.corrcoef(cycle.film_min.values, speed)[0, 1])


def frames() -> None:
    long = joint(long=True)
    case = {"cells": (128, 1)}
    for steps in (50, 100, 200):
        found = run(long, 100, steps, compiled=True, **case)
        print(f"half-angle, {steps} steps: {float(found.film_min[-1]) * 1e6:.4f} um")
    for steps in (100, 200, 400):
        found = run(long, 100, steps, frame="laboratory", **case)
        print(f"laboratory, {steps} steps: {float(found.film_min[-1]) * 1e6:.4f} um")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("what", choices=("speed", "convergence", "rig", "frames"))
    globals()[parser.parse_args().what]()
