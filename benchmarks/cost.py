"""What a pair costs today, beside the commits at which that changed: a table for CI.

    python benchmarks/cost.py            # the last ten rows of cost.csv, and today's
    python benchmarks/cost.py --record   # adds today's where a figure has changed by 5 %

Runs of 640 x 480 pixels with one worker, measured as in speed.py. The time of a pair is given over
that of reading and writing alone, measured in turn on the same machine, so that rows of different
machines compare; each figure is the median of three. The status is 1 where this ratio is 1.3 times
that of the last row.
"""

import argparse
import csv
import json
import subprocess
import sys
import tempfile
from datetime import date
from pathlib import Path
from statistics import median

from speed import figure, here, make_rig, make_run, measure, process_run, show

TABLE = Path(__file__).parent / "cost.csv"
COLUMNS = ("date", "commit", "over reading and writing", "ms a pair", "s for the rest", "peak MB")
FIGURES = COLUMNS[2:]

PAIRS = (10, 60)  # lengths of the runs
REPEATS = 3  # in turn, of which the medians count
ROWS = 10  # of the table that are shown
CHANGED, DEAR = 1.05, 1.3  # ratios of a figure to the last row


def measure_today() -> dict[str, str]:
    """A row of the table, of the code as it is."""
    with tempfile.TemporaryDirectory(prefix="erlif-cost-") as scratch:
        rig = make_rig(Path(scratch), "640x480", None)
        runs = {pairs: make_run(rig, pairs, None) for pairs in PAIRS}
        output, other = rig / "film.nc", rig / "alone.nc"
        process_run(runs[PAIRS[0]], output, 1)  # compiles
        alone = here("speed_peers.read_and_write", runs[PAIRS[1]], output, other)
        few = process_run(runs[PAIRS[0]], output, 1)  # its error counts for a fiftieth
        found = []
        for _ in range(REPEATS):
            many = process_run(runs[PAIRS[1]], output, 1)
            # of the stage of the pairs alone: what follows the last pair is no cost of a pair
            each = (many.film()[2] - few.film()[2]) / (PAIRS[1] - PAIRS[0])
            floor = json.loads(measure(alone).text.splitlines()[-1])[1]
            rest = many.processor - PAIRS[1] * each
            found.append((each / floor, 1e3 * each, rest, many.peak))
    git = ["git", "log", "-1", "--format=%h %s"]
    commit = subprocess.run(git, capture_output=True, text=True, check=False).stdout.strip()
    medians = map(median, zip(*found, strict=True))
    return dict(
        zip(COLUMNS, (date.today().isoformat(), commit, *map(figure, medians)), strict=True)
    )


def has_changed(today: dict[str, str], last: dict[str, str]) -> bool:
    """Whether a figure differs from the last row by more than 5 %."""
    ratios = [float(today[name]) / float(last[name]) for name in FIGURES]
    return any(not 1 / CHANGED < ratio < CHANGED for ratio in ratios)


def main() -> None:
    """Print the table, and add a row where that is asked for."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--record", action="store_true", help="add today's row to cost.csv")
    options = parser.parse_args()

    rows = list(csv.DictReader(TABLE.open(encoding="utf-8"))) if TABLE.exists() else []
    today = measure_today()
    show(*COLUMNS)
    show(*["---"] * len(COLUMNS))
    for row in (*rows[-ROWS:], {**today, "commit": f"now: {today['commit']}"}):
        show(*row.values())
    if options.record and (not rows or has_changed(today, rows[-1])):
        with TABLE.open("w", newline="", encoding="utf-8") as file:
            table = csv.DictWriter(file, COLUMNS, lineterminator="\n")
            table.writeheader()
            table.writerows([*rows, today])
    first = FIGURES[0]
    if rows and float(today[first]) > DEAR * float(rows[-1][first]):
        sys.exit(f"A pair costs {float(today[first]) / float(rows[-1][first]):.2f} times as much.")


if __name__ == "__main__":
    main()
