"""What `erlif plan` predicts against what a rehearsal of the same plan finds.

``python benchmarks/plan.py`` photographs seven plans with the virtual rig, calibrates and processes
them, and compares standard deviation and measurable range. The virtual rig shares no code with the
prediction; the spectra are the only common input. ``--seed`` and ``--size`` change the rehearsal.
"""

from __future__ import annotations

import argparse
import tempfile
import tomllib
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import xarray as xr

import erlif
from erlif.core.flags import Flag
from erlif.io.settings import PlanSettings
from erlif.planning import measurable_range, thickness_std
from erlif.planning.plan import design_of, example_plan, film_of, rig_of
from erlif.rig import simulate

POINTS: dict[str, tuple[tuple[str, str], ...]] = {
    "thesis, full light": (),
    "a third of the light": (
        ('thick_film = "11000 electron"', 'thick_film = "3700 electron"'),
        ('thick_film = "11500 electron"', 'thick_film = "3800 electron"'),
    ),
    "best for 2 to 10 um": (
        ('"0.008 mol/L"', '"0.00517 mol/L"'),
        ('"0.024 mol/L"', '"0.0476 mol/L"'),
        ('thick_film = "11000 electron"', 'thick_film = "5100 electron"'),
        ('thick_film = "11500 electron"', 'thick_film = "13300 electron"'),
    ),
    "2 to 30 um, four frames": (
        ('"0.008 mol/L"', '"0.0023 mol/L"'),
        ('"0.024 mol/L"', '"0.0235 mol/L"'),
        ('thickest = "10 um"', 'thickest = "30 um"'),
        ('thickest = "18 um"', 'thickest = "45 um"'),
        ("# frames = 1", "frames = 4"),
    ),
    "5 to 100 um, nine frames": (
        ('"0.008 mol/L"', '"0.0010 mol/L"'),
        ('"0.024 mol/L"', '"0.0080 mol/L"'),
        ('thinnest = "2 um"', 'thinnest = "5 um"'),
        ('thickest = "10 um"', 'thickest = "100 um"'),
        ('thickest = "18 um"', 'thickest = "150 um"'),
        ("# frames = 1", "frames = 9"),
    ),
    "5 to 400 um, five frames": (
        ('"0.008 mol/L"', '"0.000274 mol/L"'),
        ('"0.024 mol/L"', '"0.00274 mol/L"'),
        ('thick_film = "11000 electron"', 'thick_film = "4725.6 electron"'),
        ('thick_film = "11500 electron"', 'thick_film = "13449 electron"'),
        ('thinnest = "2 um"', 'thinnest = "5 um"'),
        ('thickest = "10 um"', 'thickest = "400 um"'),
        ('thickest = "18 um"', 'thickest = "600 um"'),
        ("# frames = 1", "frames = 5"),
        ("# flat_pages = 12", "flat_pages = 60"),
    ),
    "gain 2, full well 7000 electrons": (
        ('gain = "4.4 electron/DN"', 'gain = "2 electron/DN"'),
        ('read_noise = "9 electron"', 'read_noise = "5 electron"'),
        ('# full_well = "18000 electron"', 'full_well = "7000 electron"'),
        ('thick_film = "11000 electron"', 'thick_film = "5000 electron"'),
        ('thick_film = "11500 electron"', 'thick_film = "4800 electron"'),
    ),
}
"""Changes of the example plan; each is made wherever its text stands."""

_CLASSES = 12  # of thickness
_FEWEST = 200  # pixels of a class


Run = tuple[xr.Dataset, np.ndarray]
"""A film and the true thickness, (y, x). [um]"""


def settings_of(changes: tuple[tuple[str, str], ...]) -> PlanSettings:
    """The example plan with changes of its text."""
    text = example_plan()
    for old, new in changes:
        if old not in text:
            raise ValueError(f"{old} is not in the example plan")
        text = text.replace(old, new)
    return PlanSettings.model_validate(tomllib.loads(text))


def rehearse(
    settings: PlanSettings, folder: Path, *, seed: int, size: tuple[int, int]
) -> tuple[Run, Run, tuple[float, float]]:
    """Films with their truth, over the whole range and at its thin end; films of the fixture [um].

    The light is as even as the plan states, the pulse has its mean energy, and there are neither
    dust nor turning marks.
    """
    rig = replace(
        rig_of(settings),
        width=size[0],
        height=size[1],
        dust=0,
        marks=0.0,
        pulse_jitter=0.0,
    )
    simulate(folder / "wide", seed=seed, rig=rig)
    calibration = erlif.calibrate(folder / "wide" / "fixture")

    # the thin end has a run of its own, whose film is nearly even around each pixel
    design = design_of(settings, Path())
    covered = calibration.covered_range
    low, _ = measurable_range(design, replace(film_of(settings), covered=covered))
    thin = replace(
        rig,
        film_reference=0.4 * low,
        film_floor=0.1 * low,
        tilt=2.6 * low,
        bushing_radius=rig.pin_radius * (1 + 1e-4),
        fixture_frames=1,
    )
    simulate(folder / "thin", seed=seed, rig=thin)
    films = [process(folder / name, calibration) for name in ("wide", "thin")]
    return films[0], films[1], covered


def process(folder: Path, calibration: erlif.Calibration) -> tuple[xr.Dataset, np.ndarray]:
    """Film of a run and the true one, (y, x). [um]"""
    film = erlif.process(folder / "run", calibration=calibration)
    with xr.open_dataset(folder / "truth.nc", engine="h5netcdf") as truth:
        return film.load(), truth.film.values.mean(axis=0)


def compare(
    settings: PlanSettings, wide: Run, thin: Run, covered: tuple[float, float]
) -> dict[str, float]:
    """Standard deviations and range, found over predicted."""
    design, films = design_of(settings, Path()), replace(film_of(settings), covered=covered)
    low, high = measurable_range(design, films)
    film, true = wide
    valid = film.flags.values[0] == 0

    # the classes lie within the measurable range, so that no error is cut off
    edges = np.geomspace(
        max(low * 1.15, films.thinnest), min(high / 1.15, films.thickest), _CLASSES
    )
    scatter, stated = [], []
    for a, b in pairwise(edges):
        chosen = valid & (true >= a) & (true < b)
        if chosen.sum() < _FEWEST:
            continue
        predicted = thickness_std(design, true[chosen], frames=films.frames)
        error = film.thickness.values[0][chosen] - true[chosen]
        middle = np.sqrt(np.mean(predicted**2))
        scatter.append(1.4826 * np.median(np.abs(error - np.median(error))) / middle)
        stated.append(np.sqrt(np.mean(film.thickness_std.values[0][chosen] ** 2)) / middle)

    return {
        "low": low,
        "high": high,
        "found_low": end_of(*thin, low),
        "found_high": end_of(*wide, high),
        "scatter": float(np.mean(scatter)),
        "scatter_worst": float(np.max(np.abs(np.array(scatter) - 1))),
        "stated": float(np.mean(stated)),
        "stated_worst": float(np.max(np.abs(np.array(stated) - 1))),
    }


def end_of(film: xr.Dataset, true: np.ndarray, expected: float) -> float:
    """Thickness at which half of the pixels are flagged for their range, near `expected`. [um]"""
    flags = film.flags.values[0]
    outside = (flags & (Flag.BELOW_RANGE | Flag.ABOVE_RANGE)) != 0
    other = (flags & ~np.uint8(Flag.BELOW_RANGE | Flag.ABOVE_RANGE)) != 0
    middle, share = [], []
    for a, b in pairwise(np.geomspace(expected / 1.8, expected * 1.8, 40)):
        chosen = ~other & (true >= a) & (true < b)
        if chosen.sum() >= _FEWEST:
            middle.append(float(np.sqrt(a * b)))
            share.append(float(outside[chosen].mean()))
    across = np.flatnonzero(np.diff(np.array(share) > 0.5))
    k = across[np.argmin(np.abs(np.log(np.array(middle)[across] / expected)))]
    pair = slice(k, k + 2)
    order = np.argsort(share[pair])
    return float(np.interp(0.5, np.array(share[pair])[order], np.array(middle[pair])[order]))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--size", default="320x256")
    parser.add_argument("--only", type=int, help="number of a plan, from 1")
    chosen = parser.parse_args()
    size = tuple(int(side) for side in chosen.size.split("x"))

    print("| plan | scatter / predicted | stated / predicted | predicted range | found range |")
    print("|---|---|---|---|---|")
    for number, (name, changes) in enumerate(POINTS.items(), start=1):
        if chosen.only not in (None, number):
            continue
        settings = settings_of(changes)
        with tempfile.TemporaryDirectory() as directory:
            wide, thin, covered = rehearse(
                settings, Path(directory), seed=chosen.seed, size=(size[0], size[1])
            )
        found = compare(settings, wide, thin, covered)
        print(
            f"| {name} | {found['scatter']:.3f} (worst class {found['scatter_worst']:.1%}) "
            f"| {found['stated']:.3f} ({found['stated_worst']:.1%}) "
            f"| {found['low']:.2f} to {found['high']:.1f} um "
            f"| {found['found_low']:.2f} to {found['found_high']:.1f} um |",
            flush=True,
        )


if __name__ == "__main__":
    main()
