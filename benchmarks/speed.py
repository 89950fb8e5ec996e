"""Time and memory of `erlif process`, beside a user's script and beside reading and writing alone.

    pip install -e ".[benchmark]"
    python benchmarks/speed.py                                   # the table of docs/performance.md
    python benchmarks/speed.py --sizes 1280x1024 --pairs 10,200 --whole
    python benchmarks/speed.py --growth                          # 20 to 5000 pairs of 320 x 256
    python benchmarks/speed.py --growth --fold 50 --pairs 50,500 # ten turns of the crank
    python benchmarks/speed.py --stages                          # where the time goes, by stage
    python benchmarks/speed.py --small                           # under a minute, for CI

The virtual rig makes about ten frame pairs of each size; longer runs repeat them by hard links.
With `--growth` and `--stages` it makes 400: among many triggers, fewer frames are a pattern that
stands still, an error which then is found and added to every map. They are uncompressed 12-bit TIFF
in 16 bits, as camera software writes them. Every pair is a trigger of its own and gives a map,
unless `--fold` has fewer triggers per turn of the crank.

The operating system counts time and peak memory of each whole process. Fixed cost and cost per pair
are the line through runs of different length. A first call that compiles is not counted. Linux and
macOS.
"""

import argparse
import csv
import json
import os
import platform
import re
import shutil
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import tifffile

HERE = Path(__file__).resolve().parent
CAMERAS = ("camera1", "camera2")
SPACING = 4.8  # rocker angle between triggers [degree]; one turn of the crank has ten of them
FINE_SPACING = 0.12  # four hundred of them, as many as are compared with one another in a long run
SCRIPT_PAIRS = 5  # pairs of the user's script, which needs seconds for each


@dataclass(frozen=True)
class Cost:
    """One process: seconds on the wall, processor seconds, peak memory [MB] and what it printed."""

    wall: float
    processor: float
    peak: float
    text: str

    def film(self) -> tuple[float, float, float]:
        """Start, duration and processor seconds of the stage "film", from the log under -v."""
        start = re.search(r"(\S+) s  .*film: started", self.text)
        end = re.search(r"film: finished after (\S+) s, processor (\S+) s", self.text)
        if start is None or end is None:
            raise SystemExit(f"Expected the stage film in the log; got:\n{self.text}")
        return float(start[1]), float(end[1]), float(end[2])

    def stages(self) -> dict[str, tuple[float, float]]:
        """Duration and processor seconds of each stage, from the log under -v, and of the rest."""
        start = re.search(r"(\S+) s  \S+: .*: started", self.text)
        ends = r"\S+: (.+): finished after (\S+) s, processor (\S+) s"
        found = {name: (float(a), float(b)) for name, a, b in re.findall(ends, self.text)}
        wall, processor = np.sum(list(found.values()), axis=0)
        opening = float(start[1]) if start else np.nan
        found = {"opening": (opening, np.nan), **found}
        return {**found, "rest": (self.wall - opening - wall, self.processor - processor)}


@dataclass(frozen=True)
class Line:
    """Seconds of any number of pairs: `fixed + pairs * each`."""

    each: float
    fixed: float

    @classmethod
    def through(cls, costs: dict[int, Cost], name: str) -> "Line":
        each, fixed = np.polyfit(list(costs), [getattr(cost, name) for cost in costs.values()], 1)
        return cls(float(each), float(fixed))

    def total(self, pairs: int) -> float:
        return self.fixed + pairs * self.each


# processes ----------------------------------------------------------------------------------------


def measure(command: list[str], repeats: int = 1) -> Cost:
    """Run a command; of several runs the one with the least processor time.

    Python keeps its bytecode, as it does for a user: without it erlif alone takes half a second.
    """
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"}
    costs = []
    for _ in range(repeats):
        with tempfile.TemporaryFile("w+") as output:
            start = time.perf_counter()
            process = subprocess.Popen(
                command, stdout=output, stderr=subprocess.STDOUT, env=environment
            )
            _, status, usage = os.wait4(process.pid, 0)
            wall = time.perf_counter() - start
            process.returncode = os.waitstatus_to_exitcode(status)
            output.seek(0)
            text = output.read()
        if process.returncode:
            raise SystemExit(f"{' '.join(command)} failed:\n{text}")

        # macOS counts bytes, Linux kibibytes
        peak = usage.ru_maxrss / (1e6 if sys.platform == "darwin" else 1e6 / 1024)
        costs.append(Cost(wall, usage.ru_utime + usage.ru_stime, peak, text))
    return min(costs, key=lambda cost: cost.processor)


def erlif(*arguments: object) -> list[str]:
    return [sys.executable, "-m", "erlif", *map(str, arguments)]


def here(call: str, *arguments: object) -> list[str]:
    """Command that calls a function of this folder."""
    module = call.split(".")[0]
    code = f"import sys; sys.path.insert(0, {str(HERE)!r}); import {module}; {call}(*sys.argv[1:])"
    return [sys.executable, "-c", code, *map(str, arguments)]


def process_run(
    run: Path, output: Path, workers: int, repeats: int = 1, kernels: str | None = None
) -> Cost:
    """One call of `erlif process`, with compiled kernels in another folder where one is given."""
    options = ("-v", "process", run, "-o", output, "--overwrite", "--workers", workers)
    place = ["env", f"NUMBA_CACHE_DIR={kernels}"] if kernels else []
    return measure([*place, *erlif(*options)], repeats)


# data ---------------------------------------------------------------------------------------------


def make_rig(scratch: Path, size: str, compression: str | None, spacing: float = SPACING) -> Path:
    """Simulate a run and a fixture, calibrate, and write the frames as camera software does."""
    rig = scratch / f"{size}-{compression or 'plain'}-{spacing}"
    if (rig / "ready").exists():
        return rig
    shutil.rmtree(rig, ignore_errors=True)
    print(f"making frames of {size}", file=sys.stderr, flush=True)
    options = ("--size", size, "--spacing", f"{spacing} deg", "--fixture-frames", 2, "--seed", 7)
    measure(erlif("simulate", rig, *options))
    measure(erlif("calibrate", rig / "fixture"))

    (rig / "truth.nc").unlink()
    for path in (rig / "run").rglob("*.tif"):
        pages = tifffile.imread(path)
        tifffile.imwrite(path, pages, photometric="minisblack", compression=compression)
    (rig / "ready").touch()
    return rig


def make_run(rig: Path, pairs: int, fold: int | None) -> Path:
    """A run of any number of pairs, from links to the frames of the rig."""
    source, run = rig / "run", rig / f"run-{pairs}-{fold or pairs}"
    if (run / "run.toml").exists():
        return run
    shutil.rmtree(run, ignore_errors=True)
    per_cycle = min(fold or pairs, pairs)
    phase = np.arange(pairs) % per_cycle / per_cycle

    for camera in CAMERAS:
        (run / camera).mkdir(parents=True)
        frames = sorted((source / camera).iterdir())
        for k, part in enumerate(phase):
            os.link(frames[int(part * len(frames))], run / camera / f"frame_{k:06d}.tif")
        for kind in ("dark", "flat"):
            os.link(source / f"{camera}_{kind}.tif", run / f"{camera}_{kind}.tif")

    # on the crank, any number of triggers divides a turn evenly
    with (run / "encoder.csv").open("w", newline="") as file:
        table = csv.writer(file)
        table.writerow(["frame", "time_s", "angle_deg", "load_N", "temperature_C"])
        table.writerows(
            [k, f"{k / 1000:.3f}", f"{360 * part:.6f}", 222.4, 25] for k, part in enumerate(phase)
        )
    changed = {
        "mounted_on": 'mounted_on = "crank"',
        "zero": "",
        "triggers_per_cycle": f"triggers_per_cycle = {per_cycle}",
    }
    lines = (source / "run.toml").read_text().splitlines()
    lines = [changed.get(line.split(" =")[0], line) for line in lines]
    (run / "run.toml").write_text("\n".join(lines) + "\n")
    return run


# tables -------------------------------------------------------------------------------------------


def show(*cells: object) -> None:
    print("| " + " | ".join(str(cell) for cell in cells) + " |", flush=True)


def figure(value: float) -> str:
    """Three significant digits; nothing where there is none."""
    if np.isnan(value):
        return ""
    return f"{value:.0f}" if abs(value) >= 100 else f"{value:.3g}"


def compare(rig: Path, options: argparse.Namespace) -> list[str]:
    """Rows of one size; returns what follows from them, in words."""
    size = rig.name.partition("-")[0].replace("x", " x ")
    runs = {pairs: make_run(rig, pairs, options.fold) for pairs in options.pairs}
    few, many, most = min(runs), max(runs), max(options.workers)
    output, other = rig / f"film.{options.format}", rig / f"alone.{options.format}"
    with tempfile.TemporaryDirectory() as kernels:
        if options.fresh:
            cost = process_run(runs[few], output, most, kernels=kernels)
            cells = map(figure, [cost.processor, cost.wall, cost.peak])
            show(size, "`erlif process`, first call", most, few, "", "", *cells)
    process_run(runs[few], output, most)  # compiles

    for workers in options.workers:
        costs = {n: process_run(run, output, workers, options.repeats) for n, run in runs.items()}
        wall, work = Line.through(costs, "wall"), Line.through(costs, "processor")
        cells = [work.each, wall.each, work.fixed, wall.fixed, costs[many].peak]
        show(size, "`erlif process`", workers, f"{few} to {many}", *map(figure, cells))
    film_size = size_of(output) / many

    field = json.loads(measure(here("speed_peers.register_each", make_run(rig, 4, None))).text)
    cells = [work.each + field[1], wall.each + field[0] / workers]
    show(size, "with `register` on every pair", workers, 4, *map(figure, cells), "", "", "")

    alone = measure(here("speed_peers.read_and_write", runs[many], output, other), options.repeats)
    floor = json.loads(alone.text.splitlines()[-1])
    show(size, "reading and writing alone", 1, many, *map(figure, floor[::-1]), "", "", "")
    ratio = work.each / floor[1]
    words = [f"{size}: {ratio:.1f} times the processor time of reading and writing alone"]

    if find_spec("openpiv"):
        words.append(beside_script(rig, size, options, wall, work))

    # frames of two cameras, two bytes for each pixel
    columns, rows = map(int, size.split(" x "))
    frames, film = 4 * columns * rows * options.plan / 1e9, film_size * options.plan / 1e9
    words.append(
        f"{size}: {options.plan} pairs are planned with {frames:.0f} GB of frames, {film:.0f} GB "
        f"of film, {wall.total(options.plan) / 3600:.1f} hours, {costs[many].peak:.0f} MB of memory"
    )
    remove(output)
    remove(other)
    return words


def beside_script(rig: Path, size: str, options: argparse.Namespace, wall: Line, work: Line) -> str:
    """Row of the user's script, whole command from files to maps; returns the ratio in words."""
    curve, target = rig / "curve.npz", options.target
    if not curve.exists():
        measure(here("user_script.write_curve", rig / "fixture", curve))
    pairs = target if options.whole else min(SCRIPT_PAIRS, target)
    run = make_run(rig, pairs, None)
    cost = measure(here("user_script.write_maps", run, curve, rig / "maps"))
    shutil.rmtree(rig / "maps")
    each = [value / pairs for value in json.loads(cost.text.splitlines()[-1])]
    its_wall = Line(each[0], cost.wall - pairs * each[0])
    its_work = Line(each[1], cost.processor - pairs * each[1])
    cells = [its_work.each, its_wall.each, its_work.fixed, its_wall.fixed, cost.peak]
    show(size, "user's script", 1, pairs, *map(figure, cells))
    return (
        f"{size}: {target} pairs in {its_wall.total(target) / wall.total(target):.1f} times less "
        f"time than the user's script, {its_work.total(target) / work.total(target):.1f} times "
        f"less processor time (whole commands, {max(options.workers)} worker(s), from fixed cost "
        f"and cost per pair)"
    )


def size_of(film: Path) -> int:
    """Size of a file, or of the files in a folder. [byte]"""
    return sum(file.stat().st_size for file in (film, *film.rglob("*")) if file.is_file())


def remove(film: Path) -> None:
    shutil.rmtree(film) if film.is_dir() else film.unlink()


def compare_sizes(scratch: Path, options: argparse.Namespace) -> None:
    columns = ["size", "", "workers", "pairs", "processor s per pair", "wall s per pair"]
    columns += ["processor s, fixed", "wall s, fixed", "peak MB"]
    show(*columns)
    show(*["---"] * len(columns))
    rigs = [make_rig(scratch, size, options.compression) for size in options.sizes]
    words = [text for rig in rigs for text in compare(rig, options)]
    print("\n" + "\n".join(f"- {text}" for text in words))


def grow(scratch: Path, options: argparse.Namespace) -> None:
    """Runs of growing length: time and memory must not grow with them."""
    rig = make_rig(scratch, options.sizes[0], options.compression, FINE_SPACING)
    output, workers = rig / f"film.{options.format}", max(options.workers)
    process_run(make_run(rig, 3, options.fold), output, workers)  # compiles
    columns = ["pairs", "processor ms per pair", "wall ms per pair", "processor s, all else"]
    columns += ["wall s before the first pair", "wall s after the last pair", "peak MB", "film, MB"]
    show(*columns)
    show(*["---"] * len(columns))

    for pairs in options.pairs:
        cost = process_run(make_run(rig, pairs, options.fold), output, workers, options.repeats)
        start, wall, work = cost.film()
        cells = [1e3 * work / pairs, 1e3 * wall / pairs, cost.processor - work, start]
        cells += [cost.wall - start - wall, cost.peak, size_of(output) / 1e6]
        show(pairs, *map(figure, cells))
    remove(output)


def show_stages(scratch: Path, options: argparse.Namespace) -> None:
    """Where the time of a short and of a long run goes; the rest has the processor of opening."""
    show("size", "pairs", "stage", "wall s", "processor s")
    show(*["---"] * 5)
    for size, pairs in zip(options.sizes, options.pairs, strict=True):
        spacing = FINE_SPACING if pairs > 400 else SPACING
        rig = make_rig(scratch, size, options.compression, spacing)
        output, workers = rig / f"film.{options.format}", max(options.workers)
        process_run(make_run(rig, 10, None), output, workers)  # compiles
        cost = process_run(make_run(rig, pairs, options.fold), output, workers, options.repeats)
        for stage, spent in cost.stages().items():
            show(size.replace("x", " x "), pairs, stage, *map(figure, spent))
        show(size.replace("x", " x "), pairs, "all", *map(figure, (cost.wall, cost.processor)))
        remove(output)


def describe_machine() -> str:
    model = platform.processor() or platform.machine()
    if Path("/proc/cpuinfo").exists():
        lines = Path("/proc/cpuinfo").read_text().splitlines()
        model = next((s.split(": ")[1] for s in lines if s.startswith("model name")), model)
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2**30
    return (
        f"{os.cpu_count()} cores of {model}, {memory:.0f} GiB, {platform.system()}, Python "
        f"{platform.python_version()}, load {os.getloadavg()[0]:.1f} at the start"
    )


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )

    def numbers(text: str) -> list[int]:
        return sorted(int(part) for part in text.split(","))

    parser.add_argument("--sizes", type=lambda text: text.split(","), help="columns x rows, by ,")
    parser.add_argument("--pairs", type=numbers, help="lengths of the runs; 10 to 1000")
    parser.add_argument("--workers", type=numbers, default=[1, 2])
    parser.add_argument("--repeats", type=int, default=1, help="the smallest of these counts")
    parser.add_argument("--fold", type=int, help="triggers of one turn of the crank")
    parser.add_argument("--format", choices=["nc", "zarr"], default="nc")
    parser.add_argument("--deflated", dest="compression", action="store_const", const="zlib")
    parser.add_argument("--target", type=int, default=200, help="pairs against the user's script")
    parser.add_argument("--whole", action="store_true", help="run the user's script on all of them")
    parser.add_argument("--plan", type=int, default=100_000, help="pairs of a run planned on paper")
    parser.add_argument("--growth", action="store_true", help="20 to 5000 pairs of one size")
    parser.add_argument("--stages", action="store_true", help="stages of 48 and of 5000 pairs")
    parser.add_argument("--fresh", action="store_true", help="a first call without kernels, too")
    parser.add_argument("--small", action="store_true", help="one small size, under a minute")
    parser.add_argument("--scratch", type=Path, help="where data are kept for the next call")
    options = parser.parse_args()

    sizes, pairs = ["640x480", "1280x1024", "2048x2048"], [10, 100]
    if options.growth:
        sizes, pairs = ["320x256"], [20, 200, 1000, 5000]
    if options.stages:
        sizes, pairs = ["1280x1024", "320x256"], [48, 5000]
    if options.small:
        sizes, pairs, options.workers = ["320x256"], [10, 100], [2]
    options.sizes, options.pairs = options.sizes or sizes, options.pairs or pairs

    if len(options.pairs) < 2:
        parser.error("--pairs needs at least two lengths, such as 10,200.")

    print(describe_machine() + "\n", flush=True)
    with tempfile.TemporaryDirectory(prefix="erlif-benchmark-") as new:
        scratch = (options.scratch or Path(new)).resolve()
        scratch.mkdir(parents=True, exist_ok=True)
        table = show_stages if options.stages else grow if options.growth else compare_sizes
        table(scratch, options)


if __name__ == "__main__":
    main()
