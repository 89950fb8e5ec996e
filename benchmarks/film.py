"""erlif beside the script a user would write today, on the same files in the same run.

Accuracy is compared; benchmarks/speed.py compares time and memory.

    pip install -e ".[benchmark]"
    python benchmarks/film.py                     # three seeds, 320 x 256, a full cycle each
"""

import argparse
import tempfile
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


def photon_limit(truth: xr.Dataset, *, wall: float = 0.0):
    """Standard deviation of a pixel by shot, read and rounding noise of one pair alone. [um]

    `wall` is the reflectance behind the film, of the curve.
    """
    from erlif.rig.dyes import BANDS, DyedOil, tabulate_signal

    electrons = truth.expected_electrons.values
    variance = ((electrons + 81 + 4.4**2 / 12) / electrons**2).sum(axis=0)
    grid = np.linspace(0.02, 40, 8000)
    one, two = (tabulate_signal(band, oil=DyedOil(reflectance=wall))(grid) for band in BANDS)
    slope = np.abs(np.gradient(np.log(two / one), grid))
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


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.parse_args()
    warnings.simplefilter("ignore")
    with tempfile.TemporaryDirectory(prefix="erlif-benchmark-") as scratch:
        accuracy(Path(scratch))


if __name__ == "__main__":
    main()
