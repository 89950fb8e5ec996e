"""What `erlif process` prints after a mistake of the laboratory, beside the true errors.

``python benchmarks/mistakes.py`` makes each mistake of tests/damages/mistakes.py on a copy of a
small rig and prints whether it was refused or warned of, the largest error of the minimum film and
of the speed exponent in stated standard deviations, the largest error of the speed, and the first
warning; then tables by kinds of mistakes and of rigs. ``--only late`` chooses mistakes by a pattern
in their names; ``--sound 200 --first 100`` processes 200 sound rigs of all kinds, from number 100
on, and prints a line of JSON for each: its settings and the warnings of the audits.
"""

from __future__ import annotations

import argparse
import json
import re
import shutil
import sys
import tempfile
from collections import Counter
from dataclasses import asdict
from pathlib import Path
from typing import NamedTuple

import numpy as np
import xarray as xr

import erlif
from erlif.core.errors import ErlifError, ModelError
from erlif.core.notes import Level, split_notes
from erlif.core.progress import silent
from erlif.io.ingest import open_run
from erlif.pipeline.audit.audits import audit_run
from erlif.pipeline.audit.evidence import Evidence
from erlif.pipeline.chain import one_thread_per_frame
from erlif.pipeline.cycle import group_frames
from erlif.pipeline.engines.results import frames_in
from erlif.pipeline.engines.triggers import TriggerTask
from erlif.pipeline.fixture import find_calibration
from erlif.pipeline.physics.clock import fit_start
from erlif.pipeline.physics.joint import locate_run
from erlif.pipeline.recording.prepare import prepare_run
from erlif.rig import RigSettings, simulate

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
from damages.mistakes import KINDS, MISTAKES, RIGS, SEEDS, SMALL, Mistake
from damages.sound import draw_sound, use_instruments

LARGE = 3.0
"""Stated standard deviations from which a film is wrong."""

FAST = 0.02
"""Error of the speed, of its highest value, from which it is wrong; it has no stated error."""


class Outcome(NamedTuple):
    """What a run gave."""

    refused: bool
    film: float
    exponent: float
    speed: float
    warnings: list[str]

    @property
    def wrong(self) -> bool:
        return not self.refused and (
            self.film > 1.5 * LARGE or self.exponent > LARGE or self.speed > FAST
        )

    def named(self, cause: str) -> bool:
        return bool(self.warnings) and bool(re.search(cause, self.warnings[0]))


USUAL = re.compile("the course of the minimum film is not that of a|^film_mean lacks up to")
"""Warnings of sound rigs: their film is a formula, or too thin at the ends of a stroke."""


def judge(rig: Path) -> Outcome:
    """Process a run and compare it with the truth."""
    try:
        film = erlif.process(rig / "run", workers=1)
    except ErlifError as error:
        return Outcome(True, np.nan, np.nan, np.nan, [str(error)])
    with xr.open_dataset(rig / "truth.nc", engine="h5netcdf") as truth:
        truth.load()
    notes = split_notes(film.attrs["notes"])
    warnings = [text for level, text in notes if level is not Level.NOTE and not USUAL.search(text)]
    count = min(film.sizes["trigger"], truth.sizes["trigger"])
    pull = (film.film_min.values - truth.film_min.values[:count])[:count]
    pull = np.abs(pull / film.film_min_std.values[:count])
    # the largest of fifty sound pulls is about 3
    exponent = np.nan  # of a film that is no formula
    if "rig_exponent" in truth.attrs and "speed_exponent" in film:
        exponent = abs(float(film.speed_exponent) - float(truth.attrs["rig_exponent"]))
        exponent /= max(float(film.speed_exponent_std), 1e-9)
    speed = 0.0  # of a film at rest
    moved = "rocker_speed" if "rocker_speed" in truth else "sliding_speed"
    if moved in truth and moved in film:
        true = np.abs(truth[moved].values[:count])
        speed = np.abs(np.abs(film[moved].values[:count]) - true).max() / true.max()
    return Outcome(False, float(np.nanmax(pull)), exponent, float(speed), warnings)


def make_rigs(directory: Path) -> None:
    """Simulate the sound rigs that are not there yet."""
    for name, rig in RIGS.items():
        out = directory / name
        if not out.exists():
            simulate(out, seed=SEEDS[name], rig=rig)
            calibration = erlif.calibrate(out / "fixture")
            erlif.save_calibration(calibration, out / "fixture" / "calibration.nc")


def try_mistake(mistake: Mistake, rigs: Path, scratch: Path) -> Outcome:
    """The outcome of one mistake on a copy of its rig."""
    for name in RIGS:
        if not (scratch / name).exists():
            (scratch / name).symlink_to(rigs / name)
    copy = scratch / "copy"
    shutil.copytree(rigs / mistake.rig, copy)
    try:
        mistake.change(copy)
        return judge(copy)
    finally:
        shutil.rmtree(copy)


COLUMNS = ("tried", "wrong", "refused", "warned", "named first", "wrong in silence")
"""What is counted of each kind of mistake."""


def print_mistakes(rigs: Path, only: str) -> None:
    """A row for each mistake, the sums of each kind, and those wrong in silence on each rig."""
    counts = {kind: dict.fromkeys(COLUMNS, 0) for kind in (*KINDS, "all")}
    tried, unseen = Counter[tuple[str, str]](), Counter[tuple[str, str]]()
    with tempfile.TemporaryDirectory() as scratch:
        for mistake in MISTAKES:
            if not re.search(only, mistake.name):
                continue
            one = try_mistake(mistake, rigs, Path(scratch))
            known = one.refused or bool(one.warnings)
            named = one.named(mistake.cause)
            silent = one.wrong and not known
            told = "refused" if one.refused else "named" if named else "warned" if known else "-"
            found = (True, one.wrong, one.refused, known and not one.refused, named, silent)
            for kind in (mistake.kind, "all"):
                for column, one_more in zip(COLUMNS, found, strict=True):
                    counts[kind][column] += one_more
                for name in (mistake.rig, "all"):
                    tried[kind, name] += 1
                    unseen[kind, name] += silent
            first = one.warnings[0][:150] if one.warnings else ""
            numbers = f"{one.film:9.1f} {one.exponent:7.1f} {100 * one.speed:7.1f}"
            mark = "SILENT" if silent else "other " if known and not named else "      "
            print(f"{mistake.name:60s} {told:8s}{mark} {numbers}  {first}", flush=True)
    print(f"\n| mistake | {' | '.join(COLUMNS)} |\n|---|{'---:|' * len(COLUMNS)}")
    for kind, row in counts.items():
        if row["tried"]:
            print(f"| {kind} | {' | '.join(str(row[column]) for column in COLUMNS)} |")
    names = [name for name in (*RIGS, "all") if tried["all", name]]
    print(f"\n| wrong in silence / tried | {' | '.join(names)} |\n|---|{'---:|' * len(names)}")
    for kind, row in counts.items():
        if row["tried"]:
            cells = (
                f"{unseen[kind, name]}/{tried[kind, name]}" if tried[kind, name] else ""
                for name in names
            )
            print(f"| {kind} | {' | '.join(cells)} |")


def print_alarms(first: int, count: int) -> None:
    """Warnings of the audits of sound rigs of all kinds."""
    plain, tried, alarms = asdict(RigSettings(**SMALL)), 0, 0
    for seed in range(first, first + count):
        with tempfile.TemporaryDirectory() as scratch:
            rig = Path(scratch) / "rig"
            settings, instruments = draw_sound(seed)
            try:
                simulate(rig, seed=700 + seed, rig=settings)
            except ModelError:  # the load closes the film
                continue
            use_instruments(rig / "run", instruments)
            try:
                found = [str(note) for note in audit_run(measure(rig / "run"))]
            except ErlifError as error:
                found = [f"refused: {error}"]
        tried, alarms = tried + 1, alarms + bool(found)
        drawn = {name: value for name, value in asdict(settings).items() if value != plain[name]}
        line = {"seed": seed, "rig": drawn, "log": list(instruments), "warnings": found}
        print(json.dumps(line), flush=True)
    print(f"{alarms} of {tried} sound rigs with a warning of an audit")


def measure(run_dir: Path) -> Evidence:
    """What the audits of a run look at."""
    run = open_run(run_dir, find_start=fit_start)
    located = locate_run(run)
    calibration, known = find_calibration(run, None)
    ready = prepare_run(run, located, calibration, known, silent)
    task = TriggerTask.of(ready)
    with one_thread_per_frame():
        results = [task(frames)[1] for frames in group_frames(located, run.pairs)]
    return Evidence(run, located, frames_in(results), ready.faults)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rigs", type=Path, default=Path(tempfile.gettempdir()) / "erlif-rigs")
    parser.add_argument("--only", default="", help="a pattern in the names of mistakes")
    parser.add_argument("--sound", type=int)
    parser.add_argument("--first", type=int, default=0, help="number of the first sound rig")
    options = parser.parse_args()
    options.rigs.mkdir(exist_ok=True)
    if options.sound:
        print_alarms(options.first, options.sound)
        return
    make_rigs(options.rigs)
    print_mistakes(options.rigs, options.only)


if __name__ == "__main__":
    main()
