"""erlif beside the script a user would write today, on the same files in the same run.

Accuracy, time and memory are compared.

    pip install -e ".[benchmark]"
    python benchmarks/film.py accuracy            # three seeds, 320 x 256, a full cycle each
    python benchmarks/film.py speed               # 1280 x 1024
    python benchmarks/film.py memory              # 50 against 500 frames

Times are wall-clock of whole calls after one warm-up; ratios between the two are what to quote.
"""

import argparse
import os
import subprocess
import sys
import tempfile
import time
import warnings
from pathlib import Path

import numpy as np
import xarray as xr

BORDER = 16  # pixels of the border left out for both, the reach of the user script's windows


def simulate(out: Path, *, seed: int, **settings) -> Path:
    from erlif.rig import RigSettings
    from erlif.rig import simulate as photograph

    return photograph(out, seed=seed, rig=RigSettings(**settings), overwrite=True)


def score(maps, truth: xr.Dataset, limit) -> dict[str, float]:
    """Scatter over the photon limit, error of each map's median, and share of valid
    pixels, for films of 1 to 10 um."""
    scatter, medians, share = [], [], []
    for k, found in enumerate(maps):
        film = truth.film.values[k % truth.sizes["trigger"]]
        wanted = (film >= 1) & (film <= 10) & (truth.bubble.values[k] == 0)
        wanted[:BORDER] = wanted[-BORDER:] = wanted[:, :BORDER] = wanted[:, -BORDER:] = False
        good = wanted & np.isfinite(found)
        error = (found - film)[good]
        scatter.append(error / limit[k % len(limit)][good])
        medians.append(np.median(error / film[good]))
        share.append(good.sum() / wanted.sum())
    pooled = np.concatenate(scatter)
    return {
        "scatter / photon limit": 1.4826 * np.median(np.abs(pooled - np.median(pooled))),
        "median error rms, %": 100 * np.sqrt(np.mean(np.square(medians))),
        "answered, %": 100 * np.mean(share),
    }


def photon_limit(truth: xr.Dataset):
    from erlif.rig.dyes import BANDS, tabulate_signal

    electrons = truth.expected_electrons.values
    variance = ((electrons + 81 + 4.4**2 / 12) / electrons**2).sum(axis=0)
    grid = np.linspace(0.02, 40, 8000)
    one, two = (tabulate_signal(band)(grid) for band in BANDS)
    slope = np.gradient(np.log(two / one), grid)
    return np.sqrt(variance) / np.interp(truth.film.values, grid, slope)


def accuracy(scratch: Path) -> None:
    import user_script

    import erlif

    print(
        "seed  exponent in  exponent out       coverage  | erlif: scatter, median %, valid % | "
        "script: the same"
    )
    for seed, exponent, top in ((601, 0.62, 6.0), (602, 0.40, 4.0), (603, 0.62, 3.0)):
        made = simulate(scratch / str(seed), seed=seed, exponent=exponent, film_reference=top)
        calibration = erlif.calibrate(made / "fixture")
        film = erlif.process(made / "run", calibration=calibration)
        with xr.open_dataset(made / "truth.nc", engine="h5netcdf") as truth:
            truth.load()
        limit = photon_limit(truth)
        ours = score(film.thickness.values, truth, limit)
        peers = score(
            user_script.process(made / "run", user_script.calibrate(made / "fixture")), truth, limit
        )
        inside = (truth.film.values >= 1) & (truth.film.values <= 10) & (film.flags.values == 0)
        error = np.abs(film.thickness.values - truth.film.values)
        coverage = np.mean((error < film.thickness_std.values)[inside])
        print(
            f"{seed:5d} {exponent:8.2f} {float(film.speed_exponent):11.3f} ± "
            f"{float(film.speed_exponent_std):.3f} {coverage:14.3f}    | "
            + ", ".join(f"{value:.3f}" for value in ours.values())
            + " | "
            + ", ".join(f"{value:.3f}" for value in peers.values()),
            flush=True,
        )


def speed(scratch: Path) -> None:
    import user_script

    import erlif

    made = simulate(scratch / "speed", seed=7, width=1280, height=1024, fixture_frames=4)
    calibration = erlif.calibrate(made / "fixture")
    times = []
    for _ in range(3):
        start = time.perf_counter()
        erlif.process(
            made / "run", calibration=calibration, output=scratch / "film.nc", overwrite=True
        ).close()
        times.append(time.perf_counter() - start)
    pairs = len(list((made / "run" / "camera1").iterdir()))
    curve = user_script.calibrate(made / "fixture")
    frames = zip(
        user_script.corrected(made / "run", 1), user_script.corrected(made / "run", 2), strict=True
    )
    images = [pair for pair, _ in zip(frames, range(4), strict=False)]
    peer = []
    for one, two in images:
        start = time.perf_counter()
        np.interp(user_script.ratio(one, two), *curve)
        peer.append(time.perf_counter() - start)
    ours = [t / pairs for t in times]
    print(f"{pairs} pairs of 1280 x 1024 on {os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}")
    print(
        f"erlif process   {min(ours):.3f} {np.median(ours):.3f} {max(ours):.3f} s per pair "
        "(min, median, max of 3; first compiles)"
    )
    print(
        f"user script     {min(peer):.3f} {np.median(peer):.3f} {max(peer):.3f} s per pair, "
        "reading not counted"
    )
    print(f"ratio of medians {np.median(peer) / np.median(ours):.1f}")


def memory(scratch: Path) -> None:
    peaks = {}
    for cycles in (1, 10):
        made = simulate(scratch / f"memory{cycles}", seed=8, cycles=cycles, fixture_frames=4)
        command = [sys.executable, "-m", "erlif", "process", str(made / "run"), "--overwrite"]
        for _ in range(2):  # the first call compiles
            process = subprocess.Popen(
                command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
            )
            _, status, usage = os.wait4(process.pid, 0)
            if status:
                raise SystemExit(f"{' '.join(command)} failed")
            peaks[50 * cycles] = usage.ru_maxrss / 1024
    (few, small), (many, large) = peaks.items()
    print(
        f"peak memory of the whole process: {few} frames {small:.0f} MB, {many} frames "
        f"{large:.0f} MB, {large / small - 1:+.1%}"
    )


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("what", choices=["accuracy", "speed", "memory"])
    chosen = {"accuracy": accuracy, "speed": speed, "memory": memory}[parser.parse_args().what]
    warnings.simplefilter("ignore")
    with tempfile.TemporaryDirectory(prefix="erlif-benchmark-") as scratch:
        chosen(Path(scratch))


if __name__ == "__main__":
    main()
