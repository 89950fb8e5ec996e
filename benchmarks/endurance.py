"""False alarms, power and coverage of `erlif endurance` on simulated tests.

``python benchmarks/endurance.py --tests 1000 --workers 2`` prints the table of
docs/theory/endurance.md. Half of the tests gall with a rise of friction of 0.05, the others
survive. Each test has a schedule, friction and noise of its own, see `draw`.
"""

from __future__ import annotations

import argparse
import os
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
import xarray as xr

from erlif.joint.endurance import analyse_endurance
from erlif.joint.rig import EnduranceRig, simulate_endurance

RISE = 0.05
"""Rise of friction by galling. [1]"""

MEMORIES = (0.0, 0.5, 0.9)
"""Correlation of neighbouring samples of the noise. [1]"""

FORMS = (
    "student",
    "bursts",
    "spikes",
    "last spike",
    "transients",
    "oscillating",
    "random walk",
    "AR 0.95",
)
"""Kinds of noise that are not those of the model, see `EnduranceRig`, and a long memory."""

LEVEL = 1.96
"""Standard deviations on either side of a 95 % interval."""


@dataclass(frozen=True)
class Outcome:
    """What became of one test."""

    galls: bool
    memory: float
    stages: bool
    p_value: float
    found: bool
    covered: bool
    width: float
    load: bool


def draw(
    rng: np.random.Generator, *, galls: bool, form: str = "normal"
) -> tuple[EnduranceRig, float]:
    """Draw a test, and the correlation of neighbouring samples of its noise."""
    interval = float(rng.choice([1.0, 2.0]))
    memory = float(rng.choice(MEMORIES))
    if form == "AR 0.95":
        form, memory = "normal", 0.95
    duration = float(rng.uniform(300.0, 600.0))
    first, step = rng.uniform(20e3, 45e3), rng.uniform(10e3, 25e3)
    loads = tuple(first + step * k for k in range(rng.integers(3, 9)))
    rig = EnduranceRig(
        loads=loads,
        stage_duration=duration,
        idle_duration=float(rng.uniform(30.0, 60.0)),
        rest=float(rng.uniform(30.0, 90.0)),
        idle_load=float(rng.uniform(0.0, 0.6 * first)),
        interval=interval,
        relaxation=float(rng.uniform(0.0, 0.03)),
        friction=float(rng.uniform(0.12, 0.2)),
        stage_scatter=float(rng.uniform(0.0, 0.01)),
        load_effect=float(rng.uniform(-0.01, 0.02)),
        running_in=float(rng.uniform(0.0, 0.04)),
        running_in_time=float(rng.uniform(20.0, 200.0)),
        drift=float(rng.uniform(-0.08, 0.08)),
        drift_power=float(rng.choice([0.5, 1.0, 2.0])),
        noise=float(rng.uniform(0.003, 0.01)),
        correlation_time=-interval / np.log(memory) if memory else 0.0,
        white=float(rng.uniform(0.0, 0.3)),
        noise_form=form,
        galling_stage=int(rng.integers(1, len(loads) + 1)) if galls else None,
        galling_time=float(rng.uniform(30.0, duration - 30.0)),
        rise=RISE,
        rise_time=float(rng.uniform(0.0, 15.0)),
        rise_form=str(rng.choice(["exponential", "ramp"])),
        noise_growth=float(rng.uniform(1.0, 2.0)),
        stop_after=float(rng.uniform(30.0, 120.0)),
    )
    return rig, memory


def measure(seed: int, form: str = "normal", *, galls: bool | None = None) -> Outcome:
    """Simulate a test and compare what is found with its truth; every second one galls."""
    rng = np.random.default_rng([seed, 2002])
    galls = seed % 2 == 0 if galls is None else galls
    rig, memory = draw(rng, galls=galls, form=form)
    log, truth = simulate_endurance(rig, rng=rng)
    cells = log[["cell_1", "cell_2"]].to_dataarray("cell").drop_vars("cell")
    result = analyse_endurance(
        xr.Dataset({"cells": cells, "arm_force": log.arm}),
        pin_radius=rig.pin_radius,
        arm=rig.arm,
        calibration=rig.cell_error,
    )

    spans = [(stage.start, stage.end) for stage in result.loaded]
    near = 5 * rig.interval
    stages = len(spans) == len(truth.stages) and bool(
        np.all(np.abs(np.array(spans) - np.array(truth.stages)) <= near)
    )
    onset, failure = result.onset, result.failure
    return Outcome(
        galls=galls,
        memory=memory,
        stages=stages,
        p_value=result.search.p_value,
        found=onset is not None,
        covered=onset is not None and onset.earliest <= truth.onset <= onset.latest,
        width=onset.latest - onset.earliest if onset else np.nan,
        load=abs(failure.load - truth.load) <= LEVEL * failure.std,
    )


def report(outcomes: list[Outcome]) -> str:
    """Write the table."""
    lines = [
        "| noise | tests | stages right | false alarms | p below 0.05 | found | onset covered "
        "| width [s] | load covered |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    groups = [
        (f"AR {memory:g}", [o for o in outcomes if o.memory == memory]) for memory in MEMORIES
    ]
    for name, members in [*groups, ("all", outcomes)]:
        quiet = [one for one in members if not one.galls]
        galled = [one for one in members if one.galls]
        hits = [one for one in galled if one.found]
        cells = [
            name,
            str(len(members)),
            share([one.stages for one in members]),
            share([one.found for one in quiet]),
            share([one.p_value < 0.05 for one in quiet]),
            share([one.found for one in galled]),
            share([one.covered for one in hits]),
            f"{np.median([one.width for one in hits]):.1f}" if hits else "",
            share([one.load for one in hits]),
        ]
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def report_form(name: str, quiet: list[Outcome], galled: list[Outcome]) -> str:
    """Write the row of a kind of noise: outcomes without galling, and with it."""
    cells = [
        name,
        share([one.found for one in quiet]),
        share([one.p_value < 0.05 for one in quiet]),
        share([one.found for one in galled]),
    ]
    return f"| {' | '.join(cells)} |"


def share(held: list[bool]) -> str:
    """A share in per cent, with its count."""
    return f"{100 * np.mean(held):.1f} % ({sum(held)}/{len(held)})" if held else ""


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--tests", type=int, default=1000)
    parser.add_argument("--first", type=int, default=0, help="first seed")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument(
        "--forms", action="store_true", help="other kinds of noise, so many tests of each"
    )
    options = parser.parse_args()
    seeds = range(options.first, options.first + options.tests)
    if options.forms:
        print("| noise | false alarms | p below 0.05 | found |\n|---|---|---|---|")
        with ProcessPoolExecutor(options.workers) as pool:
            for form in FORMS:
                quiet = list(pool.map(partial(measure, form=form, galls=False), seeds))
                galled = list(pool.map(partial(measure, form=form, galls=True), seeds[::4]))
                print(report_form(form, quiet, galled), flush=True)
        return
    with ProcessPoolExecutor(options.workers) as pool:
        outcomes = list(pool.map(measure, seeds, chunksize=10))
    print(report(outcomes))
    for seed, one in zip(seeds, outcomes, strict=True):
        if one.galls != one.found or (one.found and not one.covered) or not one.stages:
            print(f"# seed {seed}: {one}")


if __name__ == "__main__":
    main()
