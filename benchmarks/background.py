"""Light that is not film on virtual rigs: how well it is found, and what its correction leaves.

    python benchmarks/background.py [--rigs 20] [--film 3.0] [--size 128x96] [--figure FILE]

Each rig has its own cameras, surfaces, fixture and run of fifty triggers; its background is 0, 1
and 3 % of the median light of each camera. docs/uncertainty.md holds the results.
"""

from __future__ import annotations

import argparse
import shutil
import tempfile
from pathlib import Path
from typing import NamedTuple

import numpy as np
import xarray as xr

import erlif
from erlif.rig import RigSettings, simulate

LEVELS = (0.0, 0.01, 0.03)
"""Backgrounds over the median light of the film."""

FILMS = (3.0, 4.0)
"""Films whose mean error is looked at. [um]"""


class Outcome(NamedTuple):
    """One run."""

    share: np.ndarray
    """Estimate less truth of both cameras. [1]"""
    share_std: np.ndarray
    """[1]"""
    significant: bool
    """Whether the run reports a background."""
    detectable: float
    """[1]"""
    before: float
    """Mean error of the films as measured. [um]"""
    after: float
    """The same with the background subtracted. [um]"""
    shared_before: float
    """Shared standard deviation of the films. [um]"""
    shared_after: float
    """The same with the background subtracted. [um]"""


def measure(directory: Path, seed: int, rig: RigSettings) -> Outcome:
    """Simulate and process one run, as it is and with its background subtracted."""
    out = simulate(directory / "rig", seed=seed, rig=rig)
    calibration = erlif.calibrate(out / "fixture")
    with xr.open_dataset(out / "truth.nc", engine="h5netcdf") as file:
        true = file.film.values

    films = {}
    for name in ("report", "correct"):
        run = shutil.copytree(out / "run", out / name)
        with (run / "run.toml").open("a") as settings:
            settings.write(f'\n[light]\nbackground = "{name}"\n')
        films[name] = erlif.process(run, calibration=calibration)

    errors, shared = {}, {}
    for name, film in films.items():
        inside = (film["flags"].values == 0) & (true > FILMS[0]) & (true < FILMS[1])
        errors[name] = float((film.thickness.values - true)[inside].mean())
        shared[name] = float(film.thickness_std_shared.values[inside].mean())
    shutil.rmtree(out)

    # the unit is the median of all light, of which the background is a part
    found = films["report"]
    if "background" not in found:
        nothing = np.full(2, np.nan)
        return Outcome(nothing, nothing, False, np.nan, *errors.values(), *shared.values())
    return Outcome(
        found.background.values - rig.background / (1 + rig.background),
        found.background_std.values,
        found.background.attrs["chi_square"] > 11.83,
        float(found.background.attrs["detectable"]),
        *errors.values(),
        *shared.values(),
    )


def describe(level: float, outcomes: list[Outcome]) -> str:
    """One row of the table."""
    share = np.array([one.share for one in outcomes])
    std = np.array([one.share_std for one in outcomes])
    known = np.isfinite(share[:, 0])
    pulls = np.abs(share / std)[known]
    before, after, shared_before, shared_after = (
        np.array([getattr(one, name) for one in outcomes])
        for name in ("before", "after", "shared_before", "shared_after")
    )
    within = [
        100 * np.mean(np.abs(after[known]) < sigmas * shared_after[known]) for sigmas in (1, 2)
    ]
    cells = [
        f"{100 * level:.0f} %",
        f"{known.sum()}",
        f"{100 * std[known].mean():.1f} %",
        f"{100 * (pulls < 1).mean():.0f}, {100 * (pulls < 2).mean():.0f} %",
        f"{sum(one.significant for one in outcomes)}",
        f"{100 * np.nanmean([one.detectable for one in outcomes]):.1f} %",
        f"{_nanometres(before)}, {1e3 * shared_before.mean():.0f}",
        f"{_nanometres(after[known])}, {1e3 * shared_after[known].mean():.0f}",
        f"{within[0]:.0f}, {within[1]:.0f} %",
    ]
    return f"| {' | '.join(cells)} |"


def _nanometres(errors: np.ndarray) -> str:
    """Mean and scatter over the runs."""
    return f"{1e3 * errors.mean():+.0f} ± {1e3 * errors.std():.0f} nm"


def plot(outcomes: dict[float, list[Outcome]], path: Path) -> None:
    """Mean error of the films before and after, run by run."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6.4, 3.2), layout="constrained")
    axes = figure.subplots()
    for n, runs in enumerate(outcomes.values()):
        place = n + 0.6 * (np.arange(len(runs)) / max(len(runs) - 1, 1) - 0.5)
        axes.plot(place, [1e3 * one.before for one in runs], "o", mfc="none", color="C1")
        axes.errorbar(
            place,
            [1e3 * one.after for one in runs],
            [1e3 * one.shared_after for one in runs],
            fmt=".",
            color="C0",
            lw=0.8,
        )
    axes.plot([], [], "o", mfc="none", color="C1", label="as measured")
    axes.errorbar([], [], [], fmt=".", color="C0", label="background subtracted, shared std")
    axes.axhline(0, color="0.6", lw=0.8, zorder=0)
    axes.set_xticks(range(len(outcomes)), [f"{100 * level:.0f} %" for level in outcomes])
    axes.set(xlabel="background over median light", ylabel="mean error of 3 to 4 µm [nm]")
    axes.legend(frameon=False, fontsize="small", loc="upper left")
    figure.savefig(path, dpi=120)


def main() -> None:
    """Print the table row by row."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rigs", type=int, default=20)
    parser.add_argument("--film", type=float, default=3.0)
    parser.add_argument("--size", default="128x96")
    parser.add_argument("--figure", type=Path)
    arguments = parser.parse_args()
    width, height = map(int, arguments.size.split("x"))

    print("| background | determined | std | within 1, 2 std | reported | detectable ", end="")
    print("| error before, shared std | after, shared std | within 1, 2 shared std |")
    print("|---" * 9 + "|")
    outcomes: dict[float, list[Outcome]] = {}
    for level in LEVELS:
        rig = RigSettings(
            width=width,
            height=height,
            fixture_frames=6,
            film_reference=arguments.film,
            background=level,
        )
        with tempfile.TemporaryDirectory() as directory:
            outcomes[level] = [
                measure(Path(directory), seed, rig) for seed in range(800, 800 + arguments.rigs)
            ]
        print(describe(level, outcomes[level]), flush=True)
    if arguments.figure is not None:
        plot(outcomes, arguments.figure)


if __name__ == "__main__":
    main()
