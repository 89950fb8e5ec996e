"""Whether the errors that ``erlif compare`` states cover the differences of known runs.

    python benchmarks/compare.py SCRATCH --runs 12      # photographed runs, all pairs of them
    python benchmarks/compare.py SCRATCH --drawn 400    # films drawn from the error model
    python benchmarks/compare.py SCRATCH --rigs 10      # real rigs that state nothing, 7 minutes

One virtual rig of 160 x 128 pixels photographs runs of one film law, and as many of films 5 %
thicker. Cameras and fixture stay; surfaces, pulses, flats, darks and noise are new in every run.
All are measured with one calibration. The truth is the difference of the true films of the rigs.

Real rigs have the faults of ``real_rigs.py``, drawn from the default widths of [systematics]. Their
runs are 0, 2, 5 and 24 % thicker than the first, and what changes from run to run is drawn anew.
"""

from __future__ import annotations

import argparse
import warnings
from dataclasses import replace
from itertools import combinations
from pathlib import Path
from unittest import mock

import numpy as np
import real_rigs
import xarray as xr

SEED = 901
THICKER = 1.05
NEW = ("run", "run frame", "run pages", "marks")
"""Random numbers that are new in every run."""


def make(scratch: Path, number: int, factor: float) -> Path:
    """Photograph a run and measure it with the calibration of the first."""
    import erlif
    from erlif.rig import RigSettings, setup, simulate
    from erlif.rig import directory as run

    out = scratch / f"rig_{number}"
    rig = RigSettings(
        width=160,
        height=128,
        spacing=3.0,
        film_reference=5.0 * factor,
        film_floor=0.6 * factor,
        bubbles=0,
        fixture_frames=1 if number else 8,
    )

    def stream(seed: int, name: str, number_of: int = 0) -> np.random.Generator:
        return setup.random_stream(seed + (1000 * number if name in NEW else 0), name, number_of)

    if not (out / "truth.nc").exists():
        with mock.patch.object(run, "random_stream", stream):
            simulate(out, seed=SEED, rig=rig)
    calibration = scratch / "calibration.nc"
    if not calibration.exists():
        erlif.save_calibration(erlif.calibrate(out / "fixture"), calibration)
    film = out / "film.nc"
    if not film.exists():
        erlif.process(out / "run", calibration=calibration, output=film, workers=1).close()
    return out


def read(out: Path):
    """The record of a run, and its true film statistics by name. [um]"""
    import erlif
    from erlif.io.files import region_of
    from erlif.review.comparison import read_run

    with xr.open_dataset(out / "truth.nc", engine="h5netcdf") as opened:
        truth = opened.load()
    with erlif.open_film(out / "film.nc") as opened:
        film = opened.load()
    region, record = region_of(film), read_run(film)
    rows = (film.y.values >= region.y[0]) & (film.y.values <= region.y[1])
    columns = (film.x.values >= region.x[0]) & (film.x.values <= region.x[1])
    use = (film.flags.values == 0) & rows[:, None] & columns
    mean = [known[good].mean() for known, good in zip(truth.film.values, use, strict=True)]
    return film, truth, record, {"film_mean": np.array(mean), "film_min": truth.film_min.values}


def photographed(scratch: Path, runs: int) -> None:
    """Pulls of the differences of all pairs of photographed runs, statistics and cells."""
    from erlif.review.comparison import average_difference, difference_map
    from erlif.review.comparison.difference import common_angles

    made = [make(scratch, k, 1.0 if k < runs // 2 else THICKER) for k in range(runs)]
    found = [read(out) for out in made]
    angle = common_angles([record for _, _, record, _ in found])
    for kind, chosen in (("equal laws", True), ("5 % thicker", False)):
        pairs = [
            (i, j)
            for i, j in combinations(range(runs), 2)
            if ((i < runs // 2) == (j < runs // 2)) == chosen
        ]
        for name in ("film_min", "film_mean"):
            pull, sizes = [], []
            for i, j in pairs:
                one = average_difference(found[i][2], found[j][2], name, angle=angle)
                known = np.isfinite(one.at)
                true = float((found[j][3][name] - found[i][3][name])[known].mean())
                pull.append((one.value - true) / one.std)
                sizes.append((one.value, one.std, true))
            show(f"{kind}, {name}", np.array(pull))
            print("   value, std, truth of the first:", np.round(sizes[0], 4))
        cells, alarms, tests = [], 0, 0
        for i, j in pairs:
            (film, truth, _, _), (other, other_truth, _, _) = found[i], found[j]
            trigger = 4
            mapped = difference_map(film, other, triggers=(trigger, trigger))
            true = cell_truth(truth.film.values[trigger], film.flags.values[trigger], mapped)
            later = cell_truth(
                other_truth.film.values[trigger], other.flags.values[trigger], mapped
            )
            pulls = (mapped.difference.values - (later - true)) / mapped.difference_std.values
            cells.append(pulls[np.isfinite(pulls)])
            alarms += int(mapped.differs.values.sum())
            tests += cells[-1].size
        show(f"{kind}, cells of maps", np.concatenate(cells))
        print(f"   cells stated to differ: {alarms / tests:.1%}")


TIMES = (1.0, 1.02, 1.05, 1.24)
"""Films of the later runs of a real rig over those of the first."""


def change_rig(rig, rng):
    """The same rig in a later run: scale of the ratio, wall and background move a little.

    Temperature and bleaching are new, so that the scale moves by both temperatures.
    """
    one = rng.multivariate_normal([0, 0], 0.003**2 * np.array([[1, 0.9], [0.9, 1]]))
    before = rig.background, rig.background * rig.background_second
    first, second = np.abs(np.add(before, one))
    fixture, joint = rig.wall
    new, *_ = real_rigs.draw_rig(rng)
    return replace(
        rig,
        brightness=(1.0, rig.brightness[1] + rng.normal(0, np.hypot(0.003, np.sqrt(2) * 0.005))),
        wall=(fixture, abs(joint + rng.normal(0, 0.002))),
        background=float(first),
        background_second=float(second / first),
        glow_per_kelvin=new.glow_per_kelvin,
        bleaching=new.bleaching,
    )


def real(scratch: Path, count: int) -> None:
    """Differences of the runs of real rigs, their coverage and verdicts."""
    import erlif
    from erlif.review.comparison import compare
    from erlif.rig import directory as run
    from erlif.rig import setup, simulate

    number = 0

    def stream(seed: int, name: str, number_of: int = 0) -> np.random.Generator:
        return setup.random_stream(seed + (1000 * number if name in NEW else 0), name, number_of)

    rows = []
    for seed in range(count):
        rng = np.random.default_rng([78, seed])
        first, *_ = real_rigs.draw_rig(np.random.default_rng([77, seed]))
        first, films, truths = replace(first, film_reference=5.0, film_floor=0.6), [], []
        for number, times in enumerate((1.0, *TIMES)):
            out = scratch / f"real_{seed}_{number}"
            rig = change_rig(first, rng) if number else first
            film = {"film_reference": 5.0 * times, "film_floor": 0.6 * times}
            if not (out / "film.nc").exists():
                with mock.patch.object(run, "random_stream", stream):
                    simulate(out, seed=SEED + seed, rig=replace(rig, **film))
                calibration = scratch / f"real_{seed}_0" / "fixture"
                made = erlif.calibrate(calibration)
                erlif.process(
                    out / "run", calibration=made, output=out / "film.nc", workers=1
                ).close()
            films.append(out / "film.nc")
            truths.append(read(out)[3])
        for later, times in enumerate(TIMES, 1):
            found = compare([films[0], films[later]])
            for name in ("film_min", "film_mean"):
                one = found.isel(pair=0).sel(statistic=name)
                known = np.isfinite(one.difference_at.values)
                true = float((truths[later][name] - truths[0][name])[known].mean())
                value, std = float(one.difference), float(one.difference_std)
                rows.append((times, name, (value - true) / std, std, bool(one.differs), true))
        print(seed, [f"{pull:+.2f}" for _, _, pull, *_ in rows[-8:]], flush=True)
    for times in TIMES:
        for name in ("film_min", "film_mean"):
            own = [row for row in rows if row[:2] == (times, name)]
            show(f"real rigs, {times - 1:.0%} thicker, {name}", np.array([row[2] for row in own]))
            std, differ, true = (np.array([row[k] for row in own]) for k in (3, 4, 5))
            print(
                f"   std {np.median(std):.3f} um, true difference {true.mean():.3f} um, stated to "
                f"differ: {differ.sum()} of {differ.size}"
            )


def cell_truth(film, flags, mapped):
    """Mean of a true map over the valid pixels of each cell of 8 x 8."""
    rows, columns = mapped.difference.shape
    cut = (slice(0, 8 * rows), slice(0, 8 * columns))
    valid = (flags[cut] == 0).reshape(rows, 8, columns, 8)
    values = film[cut].reshape(rows, 8, columns, 8)
    with np.errstate(invalid="ignore"):
        return (values * valid).sum(axis=(1, 3)) / valid.sum(axis=(1, 3))


def drawn(scratch: Path, count: int) -> None:
    """Coverage and false alarms of three runs drawn from the error model of one of them."""
    from erlif.review.comparison import average_difference, correct_for_many
    from erlif.review.comparison.difference import common_angles

    _, _, record, _ = read(make(scratch, 0, 1.0))
    rng = np.random.default_rng(1)
    angle = common_angles([record])
    for true in (0.0, 0.1):
        for shared in (True, False):
            pulls, alarms = [], 0
            for _ in range(count):
                runs = draw(record, rng, true=true, shared=shared)
                found = [
                    average_difference(one, other, name, angle=angle)
                    for one, other in combinations(runs, 2)
                    for name in ("film_min", "film_mean")
                ]
                pulls += [(found[0].value - true) / found[0].std]
                corrected = correct_for_many(np.array([each.probability for each in found]))
                alarms += bool((corrected < 0.05).any())
            kind = "one calibration" if shared else "three calibrations"
            show(f"drawn, {true:g} um, {kind}", np.array(pulls))
            if not true:
                print(f"   comparisons of three runs with a false alarm: {alarms / count:.1%}")


def draw(record, rng, *, true: float, shared: bool):
    """Three runs whose errors follow the model; the second and third are thicker by `true`."""
    from erlif.review.comparison.records import REPEATING

    spread = np.linalg.cholesky(record.errors.curve.full_covariance)
    common = spread @ rng.standard_normal(len(spread))
    runs = []
    for k in range(3):
        error = common if shared else spread @ rng.standard_normal(len(spread))
        value = {}
        for name, film in record.value.items():
            share, own = REPEATING[name], record.own_std[name]
            noise = np.sqrt(1 - share) * rng.standard_normal(own.size)
            noise = noise + np.sqrt(share) * rng.standard_normal()
            value[name] = film + true * (k > 0) + own * noise + record.gradient[name] @ error
        key = "shared" if shared else str(k)
        errors = replace(record.errors, fixture=key, rig={"calibration": key})
        runs.append(replace(record, value=value, errors=errors))
    return runs


def show(what: str, pull: np.ndarray) -> None:
    one, two = (np.abs(pull) < 1).mean(), (np.abs(pull) < 1.96).mean()
    print(
        f"{what}: {pull.size}, within 1 std {one:.1%}, within 1.96 {two:.1%}, "
        f"mean {pull.mean():+.2f}, rms {np.sqrt((pull**2).mean()):.2f}",
        flush=True,
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scratch", type=Path)
    parser.add_argument("--runs", type=int, default=0)
    parser.add_argument("--drawn", type=int, default=0)
    parser.add_argument("--rigs", type=int, default=0)
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    options.scratch.mkdir(parents=True, exist_ok=True)
    if options.drawn:
        drawn(options.scratch, options.drawn)
    if options.rigs:
        real(options.scratch, options.rigs)
    if options.runs:
        photographed(options.scratch, options.runs)


if __name__ == "__main__":
    main()
