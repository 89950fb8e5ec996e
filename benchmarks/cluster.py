"""Two workers of dask against one, on one machine: wall time of the stage that makes the maps.

    pip install -e ".[cluster]"
    python benchmarks/cluster.py                    # 1280 x 1024, 200 pairs, simulated first
    python benchmarks/cluster.py --run RUN_DIR      # frames of a run of one cycle, linked

Each worker has one thread. Workers are started and their kernels loaded before the clock starts;
sending the work to them is part of the time. Runs with one and with two workers alternate, and the
ratio of the medians is printed. Nothing else should run on the machine. The processor time of the
busiest worker depends less on what else runs; its ratio leaves out what workers wait for.
"""

import argparse
import csv
import logging
import os
import re
import shutil
import statistics
import tempfile
import time
from pathlib import Path

import erlif
from erlif.rig import RigSettings, simulate


class FilmTime(logging.Handler):
    """Keeps the duration of the stage "film" as erlif logs it."""

    seconds = float("nan")

    def emit(self, record: logging.LogRecord) -> None:
        found = re.match(r"film: finished after ([\d.]+) s", record.getMessage())
        if found:
            self.seconds = float(found[1])


def repeat_cycle(run: Path, out: Path, pairs: int) -> Path:
    """A run of many cycles from the frames of one, which are linked."""
    shutil.copytree(run, out, ignore=shutil.ignore_patterns("camera?", "*film*", "figures"))
    settings = out / "run.toml"
    text = settings.read_text(encoding="utf-8")
    calibration = re.search(r'^calibration = "(.*)"$', text, re.MULTILINE)[1]
    settings.write_text(
        text.replace(f'"{calibration}"', f'"{(run / calibration).resolve()}"'), encoding="utf-8"
    )

    with (run / "encoder.csv").open(newline="", encoding="utf-8") as file:
        header, *rows = csv.reader(file)
    step = float(rows[-1][1]) - 2 * float(rows[0][1]) + float(rows[1][1])
    with (out / "encoder.csv").open("w", newline="", encoding="utf-8") as file:
        log = csv.writer(file)
        log.writerow(header)
        for pair in range(pairs):
            cycle, row = divmod(pair, len(rows))
            seconds = float(rows[row][1]) + cycle * step
            log.writerow([pair, f"{seconds:.6f}", *rows[row][2:]])

    for camera in ("camera1", "camera2"):
        (out / camera).mkdir()
        frames = sorted((run / camera).iterdir())
        for pair in range(pairs):
            source = frames[pair % len(frames)]
            os.link(source.resolve(), out / camera / f"frame_{pair:06d}{source.suffix}")
    return out


def film_seconds(run: Path, output: Path, address: str) -> float:
    """Wall time of the stage "film" with the workers of a scheduler."""
    clock = FilmTime()
    logger = logging.getLogger("erlif")
    logger.addHandler(clock)
    logger.setLevel(logging.INFO)
    try:
        erlif.process(run, output=output, scheduler=address, overwrite=True).close()
    finally:
        logger.removeHandler(clock)
    return clock.seconds


def busiest(cluster, run: Path, output: Path) -> tuple[float, float]:
    """Wall time of the stage, and processor time of the worker that worked most."""
    from distributed import Client

    with Client(cluster, set_as_default=False) as client:
        before = client.run(time.process_time)
        seconds = film_seconds(run, output, cluster.scheduler_address)
        after = client.run(time.process_time)
    return seconds, max(after[worker] - before[worker] for worker in after)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--run", type=Path, help="run of one cycle with its calibration")
    parser.add_argument("--pairs", type=int, default=200)
    parser.add_argument("--size", default="1280x1024", help="of the simulated run")
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--suffix", choices=[".nc", ".zarr"], default=".zarr")
    options = parser.parse_args()

    with tempfile.TemporaryDirectory(prefix="erlif-cluster-") as scratch:
        compare(options, Path(scratch))


def compare(options: argparse.Namespace, scratch: Path) -> None:
    from distributed import LocalCluster

    source = options.run
    if source is None:
        width, height = map(int, options.size.split("x"))
        simulate(scratch / "rig", seed=7, rig=RigSettings(width=width, height=height))
        source = scratch / "rig" / "run"
    run = repeat_cycle(source.resolve(), scratch / "run", options.pairs)
    output = scratch / f"film{options.suffix}"

    times: dict[int, list[tuple[float, float]]] = {1: [], 2: []}
    clusters = {
        workers: LocalCluster(
            n_workers=workers,
            threads_per_worker=1,
            dashboard_address="127.0.0.1:0",
            memory_limit=0,
            local_directory=str(scratch),
            silence_logs=logging.CRITICAL,
        )
        for workers in times
    }
    try:
        # the first run of each worker loads the kernels, and compiles what no run has compiled yet
        for attempt in range(options.repeat + 1):
            for workers, cluster in clusters.items():
                wall, processor = busiest(cluster, run, output)
                if attempt:
                    times[workers].append((wall, processor))
                    load = os.getloadavg()[0] if hasattr(os, "getloadavg") else float("nan")
                    print(
                        f"{workers} worker(s): {wall:6.2f} s, processor of the busiest "
                        f"{processor:6.2f} s   (load {load:.1f})",
                        flush=True,
                    )
    finally:
        logging.disable(logging.CRITICAL)  # dask reports that its workers leave
        for cluster in clusters.values():
            cluster.close()

    for place, what in enumerate(("wall", "processor of the busiest worker")):
        one, two = (statistics.median(time[place] for time in times[n]) for n in (1, 2))
        print(
            f"{options.pairs} pairs, {output.name}, {what}: "
            f"one {one:.2f} s, two {two:.2f} s, ratio {one / two:.2f}"
        )


if __name__ == "__main__":
    main()
