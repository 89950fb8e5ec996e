"""Whether the errors that ``erlif compare`` states cover the differences of known runs.

    python benchmarks/compare.py SCRATCH --runs 12      # photographed runs, all pairs of them
    python benchmarks/compare.py SCRATCH --drawn 400    # films drawn from the error model

One virtual rig of 160 x 128 pixels photographs runs of one film law, and as many of films 5 %
thicker. Cameras and fixture stay; surfaces, pulses, flats, darks and noise are new in every run.
All are measured with one calibration. The truth is the difference of the true films of the rigs.
"""

from __future__ import annotations

import argparse
import warnings
from dataclasses import replace
from itertools import combinations
from pathlib import Path
from unittest import mock

import numpy as np
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

    spread = np.linalg.cholesky(record.calibration.full_covariance)
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
        runs.append(replace(record, value=value, calibration_key=key))
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
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    options.scratch.mkdir(parents=True, exist_ok=True)
    if options.drawn:
        drawn(options.scratch, options.drawn)
    if options.runs:
        photographed(options.scratch, options.runs)


if __name__ == "__main__":
    main()
