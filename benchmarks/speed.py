"""Time and memory of `erlif process`, beside a user's script and beside reading and writing alone.

    pip install -e ".[benchmark]"
    python benchmarks/speed.py                                   # the table of docs/performance.md
    python benchmarks/speed.py --sizes 1280x1024 --pairs 10,200 --whole
    python benchmarks/speed.py --growth                          # 20 to 5000 pairs of 320 x 256
    python benchmarks/speed.py --growth --fold 50 --pairs 50,500 # ten turns of the crank
    python benchmarks/speed.py --small                           # under a minute, for CI

The virtual rig makes about ten frame pairs of each size; longer runs repeat them by hard links.
They are uncompressed 12-bit TIFF in 16 bits, as camera software writes them. Every pair is a
trigger of its own and gives a map, unless `--fold` has fewer triggers per turn of the crank.

The operating system counts time and peak memory of each whole process. The cost of the pairs is
that of the stages "film" and "writing" in the log under -v; the rest is fixed. A first call that
compiles is not counted. Linux and macOS.
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
from contextlib import ExitStack
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import tifffile

HERE = Path(__file__).resolve().parent
CAMERAS = ("camera1", "camera2")
SPACING = 4.8  # rocker angle between triggers [degree]; one turn of the crank has ten of them
SCRIPT_PAIRS = 5  # pairs of the user's script, which needs seconds for each


@dataclass(frozen=True)
class Cost:
    """One process: seconds on the wall, processor seconds, peak memory [MB] and what it printed."""

    wall: float
    processor: float
    peak: float
    text: str

    def at(self, event: str) -> float:
        """Seconds from the start to a line of the log under -v."""
        line = next(line for line in self.text.splitlines() if event in line)
        return float(line.split()[0])

    def stages(self, *names: str) -> tuple[float, float]:
        """Seconds and processor seconds of these stages, from the log under -v."""
        pattern = rf" (?:{'|'.join(names)}): finished after (\S+) s, processor (\S+) s"
        found = re.findall(pattern, self.text)
        return sum(float(wall) for wall, _ in found), sum(float(work) for _, work in found)


# processes ----------------------------------------------------------------------------------------


def measure(command: list[str], repeats: int = 1) -> Cost:
    """Run a command; of several runs the one with the least processor time."""
    costs = []
    for _ in range(repeats):
        with tempfile.TemporaryFile("w+") as output:
            start = time.perf_counter()
            process = subprocess.Popen(command, stdout=output, stderr=subprocess.STDOUT)
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


def make_rig(scratch: Path, size: str, compression: str | None) -> Path:
    """Simulate a run and a fixture, calibrate, and write the frames as camera software does."""
    rig = scratch / f"{size}-{compression or 'plain'}"
    if (rig / "ready").exists():
        return rig
    shutil.rmtree(rig, ignore_errors=True)
    print(f"making frames of {size}", file=sys.stderr, flush=True)
    options = ("--size", size, "--spacing", SPACING, "--fixture-frames", 2, "--seed", 7)
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
    """Three significant digits."""
    return f"{value:.0f}" if abs(value) >= 100 else f"{value:.3g}"


def compare(rig: Path, options: argparse.Namespace) -> list[str]:
    """Rows of one size; returns what follows from them, in words."""
    size = rig.name.partition("-")[0].replace("x", " x ")
    runs = {pairs: make_run(rig, pairs, options.fold) for pairs in options.pairs}
    output, other = rig / f"film.{options.format}", rig / f"alone.{options.format}"
    with tempfile.TemporaryDirectory() as kernels:
        if options.fresh:
            cost = process_run(runs[min(runs)], output, max(options.workers), kernels=kernels)
            cells = [cost.processor, cost.at("film: started"), cost.wall, cost.peak]
            words = ["`erlif process`, first call", max(options.workers), min(runs), "", ""]
            show(size, *words, *map(figure, cells))
    process_run(runs[min(runs)], output, max(options.workers))  # compiles

    for workers in options.workers:
        for pairs, run in runs.items():
            cost = process_run(run, output, workers, options.repeats)
            each = tuple(value / pairs for value in cost.stages("film", "writing"))
            before = [cost.processor - pairs * each[1], cost.at("film: started")]
            cells = [each[1], each[0], *before, cost.wall, cost.peak]
            show(size, "`erlif process`", workers, pairs, *map(figure, cells))
    film_size = size_of(output) / pairs

    field = json.loads(measure(here("speed_peers.register_each", make_run(rig, 4, None))).text)
    cells = [each[1] + field[1], each[0] + field[0] / workers]
    show(size, "with `register` on every pair", workers, 4, *map(figure, cells), *[""] * 4)

    alone = measure(here("speed_peers.read_and_write", runs[pairs], output, other), options.repeats)
    floor = json.loads(alone.text.splitlines()[-1])
    show(size, "reading and writing alone", 1, pairs, *map(figure, floor[::-1]), *[""] * 4)
    ratio = each[1] / floor[1]
    words = [f"{size}: {ratio:.1f} times the processor time of reading and writing alone"]

    if find_spec("openpiv"):
        words.append(beside_script(rig, size, options, cost, each))

    # frames of two cameras, two bytes for each pixel
    columns, rows = map(int, size.split(" x "))
    frames, film = 4 * columns * rows * options.plan / 1e9, film_size * options.plan / 1e9
    hours = (before[1] + options.plan * each[0]) / 3600
    words.append(
        f"{size}: {options.plan} pairs are planned with {frames:.0f} GB of frames, {film:.0f} GB "
        f"of film, {hours:.1f} hours, {cost.peak:.0f} MB of memory"
    )
    remove(output)
    remove(other)
    return words


def beside_script(
    rig: Path, size: str, options: argparse.Namespace, ours: Cost, each: tuple[float, ...]
) -> str:
    """Row of the user's script, whole command from files to maps; returns the ratio in words."""
    curve, target = rig / "curve.npz", options.target
    if not curve.exists():
        measure(here("user_script.write_curve", rig / "fixture", curve))
    pairs = target if options.whole else min(SCRIPT_PAIRS, target)
    run = make_run(rig, pairs, None)
    cost = measure(here("user_script.write_maps", run, curve, rig / "maps"))
    shutil.rmtree(rig / "maps")
    peer = [value / pairs for value in json.loads(cost.text.splitlines()[-1])]
    fixed = [cost.processor - pairs * peer[1], cost.wall - pairs * peer[0]]
    cells = [peer[1], peer[0], *fixed, cost.wall, cost.peak]
    show(size, "user's script", 1, pairs, *map(figure, cells))

    # fixed cost and cost per pair of both, so that neither needs a run of this length
    longest = max(options.pairs)
    wall = (fixed[1] + target * peer[0]) / (ours.wall + (target - longest) * each[0])
    work = (fixed[0] + target * peer[1]) / (ours.processor + (target - longest) * each[1])
    return (
        f"{size}: {target} pairs in {wall:.1f} times less time than the user's script, "
        f"{work:.1f} times less processor time (whole commands, {max(options.workers)} worker(s); "
        f"computed from {longest} pairs, and {pairs} of the script)"
    )


def size_of(film: Path) -> int:
    """Size of a file, or of the files in a folder. [byte]"""
    return sum(file.stat().st_size for file in (film, *film.rglob("*")) if file.is_file())


def remove(film: Path) -> None:
    shutil.rmtree(film) if film.is_dir() else film.unlink()


def compare_sizes(scratch: Path, options: argparse.Namespace) -> None:
    columns = ["size", "", "workers", "pairs", "processor s per pair", "wall s per pair"]
    columns += ["fixed processor s", "wall s before the first pair", "whole, wall s", "peak MB"]
    show(*columns)
    show(*["---"] * len(columns))
    rigs = [make_rig(scratch, size, options.compression) for size in options.sizes]
    words = [text for rig in rigs for text in compare(rig, options)]
    print("\n" + "\n".join(f"- {text}" for text in words))


def grow(scratch: Path, options: argparse.Namespace) -> None:
    """Runs of growing length: time and memory must not grow with them."""
    rig = make_rig(scratch, options.sizes[0], options.compression)
    output, workers = rig / f"film.{options.format}", max(options.workers)
    process_run(make_run(rig, 3, options.fold), output, workers)  # compiles
    columns = ["pairs", "processor ms per pair", "wall ms per pair", "peak MB"]
    columns += ["wall s before the first pair", "wall s after the last pair"]
    columns += ["processor s of writing", "film, MB"]
    show(*columns)
    show(*["---"] * len(columns))

    for pairs in options.pairs:
        cost = process_run(make_run(rig, pairs, options.fold), output, workers, options.repeats)
        wall, work = (1e3 * value / pairs for value in cost.stages("film"))
        start, end = cost.at("film: started"), cost.at("film: finished")
        writing = cost.stages("writing")[1]
        cells = [work, wall, cost.peak, start, cost.wall - end, writing, size_of(output) / 1e6]
        show(pairs, *map(figure, cells))
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
    parser.add_argument("--fresh", action="store_true", help="a first call without kernels, too")
    parser.add_argument("--small", action="store_true", help="one small size, under a minute")
    parser.add_argument("--scratch", type=Path, help="where data are kept for the next call")
    options = parser.parse_args()

    sizes, pairs = ["640x480", "1280x1024", "2048x2048"], [10, 100]
    if options.growth:
        sizes, pairs = ["320x256"], [20, 200, 1000, 5000]
    if options.small:
        sizes, pairs, options.workers = ["320x256"], [10, 40], [2]
    options.sizes, options.pairs = options.sizes or sizes, options.pairs or pairs

    print(describe_machine() + "\n", flush=True)
    with ExitStack() as stack:
        new = tempfile.TemporaryDirectory(prefix="erlif-benchmark-")
        scratch = options.scratch or Path(stack.enter_context(new))
        scratch.mkdir(parents=True, exist_ok=True)
        (grow if options.growth else compare_sizes)(scratch.resolve(), options)


if __name__ == "__main__":
    main()
