"""Are the error bars true? Virtual rigs of known film, at several levels of light and contrasts.

    pip install -e .
    python benchmarks/uncertainty.py maps      # five seeds, three levels of light, two contrasts
    python benchmarks/uncertainty.py fixtures  # film statistics of one run under 200 fixtures
    python benchmarks/uncertainty.py pins --rigs 20  # position of the pin, films of load and motion

Coverage is the share of errors within one and two stated standard deviations, 68.3 and 95.4 %
where the error bars are true.
"""

import argparse
import itertools
import shutil
import tempfile
import tomllib
import warnings
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np
import xarray as xr
from film import photon_limit

FILMS = {701: (0.62, 6.0), 702: (0.40, 4.0), 703: (0.62, 3.0), 704: (0.50, 5.0), 705: (0.70, 8.0)}
"""Seed: exponent and minimum film thickness at top speed [um]."""
LIGHTS = (1.0, 0.3, 0.1)
TEXTURES = (0.08, 0.03)
OCTAVES = ((1, 2), (2, 4), (4, 8), (8, 10))
PIN = ("displacement_load", "displacement_side", "tilt_load", "tilt_side")
BORDER = 8  # pixels left out at the edge of the image


def photograph(out: Path, seed: int, light: float, texture: float, **settings) -> Path:
    from erlif.rig import RigSettings, simulate

    exponent, top = FILMS[seed]
    rig = RigSettings(
        exponent=exponent,
        film_reference=top,
        light=light,
        speckle_fixed=texture,
        speckle_new=texture,
        spacing=3.0,
        **settings,
    )
    return out if (out / "truth.nc").exists() else simulate(out, seed=seed, rig=rig)


def exactly_known(fixture: Path, seed: int) -> Path:
    """The same fixture, measured by a coordinate measuring machine without error."""
    from erlif.rig import RigSettings
    from erlif.rig.directory import write_profile
    from erlif.rig.film import Wedge
    from erlif.rig.setup import random_stream

    copy = shutil.copytree(fixture, fixture.with_name("fixture_exact"), dirs_exist_ok=True)
    write_profile(
        copy / "profile.csv", Wedge(RigSettings(cmm_noise=0.0)), random_stream(seed, "fixture")
    )
    return copy


def examine(case: tuple[Path, int, float, float, bool]) -> dict:
    """Process one rig and set every stated standard deviation against the error made."""
    import erlif

    warnings.simplefilter("ignore")
    scratch, seed, light, texture, exact = case
    made = photograph(scratch / f"{seed}_{light}_{texture}", seed, light, texture)
    calibration = erlif.calibrate(
        exactly_known(made / "fixture", seed) if exact else made / "fixture"
    )
    output = made / "film.nc"
    film = erlif.process(
        made / "run", calibration=calibration, output=output, overwrite=True, workers=1
    ).load()
    film.close()
    drift, found_map = (
        erlif.open_film(output, group=name).load() for name in ("frames", "registration")
    )
    with xr.open_dataset(made / "truth.nc", engine="h5netcdf") as truth:
        truth.load()
    known = truth.film.values
    wanted = (known >= 1) & (known <= 10) & (truth.bubble.values == 0)
    wanted[:, :BORDER] = wanted[:, -BORDER:] = wanted[..., :BORDER] = wanted[..., -BORDER:] = False
    valid = film.flags.values == 0
    good = wanted & valid
    error = film.thickness.values - known
    total = np.hypot(film.thickness_std.values, film.thickness_std_shared.values)
    scatter = (error / photon_limit(truth))[good]
    found = {
        "light": light,
        "texture": texture,
        "answered": good.sum() / wanted.sum(),
        "scatter": 1.4826 * np.median(np.abs(scatter - np.median(scatter))),
        "medians": [
            np.median((error / known)[k][good[k]])
            for k in range(len(known))
            if good[k].sum() > 0.2 * wanted[k].size
        ],
        "medians_std": [
            np.median((film.thickness_std_shared.values / known)[k][good[k]])
            for k in range(len(known))
            if good[k].sum() > 0.2 * wanted[k].size
        ],
        "beyond5": (np.abs(error) > 5 * total)[valid & (known >= 1) & (known <= 10)].mean(),
    }
    for low, high in ((1, 10), *OCTAVES):
        here = good & (known >= low) & (known < high)
        pull = (error / total)[here]
        found[low, high] = (
            here.sum(),
            (np.abs(pull) < 1).sum(),
            (np.abs(pull) < 2).sum(),
            (wanted & (known >= low) & (known < high)).sum(),
            np.mean(error[here]) / np.mean(film.thickness_std.values[here])
            if here.any()
            else np.nan,
        )
    inner = (slice(BORDER, -BORDER), slice(BORDER, -BORDER))
    for name, group in (("displacement", found_map), ("drift", drift)):
        square = sum(
            (group[f"{name}_{axis}"] - truth[f"{name}_{axis}"]).values ** 2 for axis in "xy"
        )
        found[name] = np.sqrt(np.nanmean(square[inner] if square.ndim == 2 else square))
    mean = region_mean(film, truth)
    found["film_mean"] = (film.film_mean.values - mean) / film.film_mean_std.values
    found["film_min"] = ((film.film_min - truth.film_min) / film.film_min_std).values
    found["film_mean_rel"] = film.film_mean.values / mean - 1
    found["film_min_err"] = (film.film_min - truth.film_min).values
    return found


def region_mean(film: xr.Dataset, truth: xr.Dataset):
    """True mean film over the valid pixels of the region and on its bounds, by trigger. [um]"""
    roi = tomllib.loads(film.settings)["thickness"]["roi"]
    inside = [
        (axis > low - 1e-6) & (axis < high + 1e-6)
        for axis, (low, high) in ((film.x, roi["x"]), (film.y, roi["y"]))
    ]
    use = (film.flags.values == 0) & inside[1].values[:, None] & inside[0].values
    return np.array(
        [
            known[good].mean() if good.any() else np.nan
            for known, good in zip(truth.film.values, use, strict=True)
        ]
    )


def weigh_fixture(case: tuple[Path, int]) -> dict:
    """A rig of its own, fixture, CMM, cameras, surfaces and run all drawn anew.

    Returns the pulls of the film statistics.
    """
    import erlif
    from erlif.rig import RigSettings, simulate

    warnings.simplefilter("ignore")
    scratch, seed = case
    rig = RigSettings(spacing=7.0, fixture_frames=6)
    made = simulate(scratch / f"rig{seed}", seed=seed, rig=rig)
    film = erlif.process(made / "run", calibration=erlif.calibrate(made / "fixture"), workers=1)
    with xr.open_dataset(made / "truth.nc", engine="h5netcdf") as truth:
        truth.load()
    shutil.rmtree(made)
    return {
        "film_mean": (film.film_mean.values - region_mean(film, truth)) / film.film_mean_std.values,
        "film_min": ((film.film_min - truth.film_min) / film.film_min_std).values,
        "exponent": np.array(
            [(float(film.speed_exponent) - rig.exponent) / float(film.speed_exponent_std)]
        ),
    }


def fixtures(scratch: Path, processes: int, rigs: int) -> None:
    with ProcessPoolExecutor(processes) as pool:
        results = list(pool.map(weigh_fixture, [(scratch, 5000 + n) for n in range(rigs)]))
    print(
        f"{rigs} rigs of 320 x 256 pixels, each with its own cameras, surfaces, fixture and profile"
    )
    for name in ("film_mean", "film_min", "exponent"):
        pulls = np.array([r[name] for r in results])
        known = np.isfinite(pulls)
        within = [np.mean(np.abs(pulls[known]) < width) for width in (1, 2)]
        print(
            f"{name:10s}{within[0]:7.1%} within one, {within[1]:6.1%} within two standard "
            f"deviations; mean pull {pulls[known].mean():+.2f}, "
            f"rms {np.sqrt(np.mean(pulls[known] ** 2)):.2f}"
        )


def weigh_pin(case: tuple[Path, int]) -> dict:
    """A rig of its own with the film that load and motion produce.

    Returns the pulls of displacements and tilts, of the curvature beyond that of circles, and the
    random standard deviations of both displacements [um].
    """
    import erlif
    from erlif.rig import RigSettings, simulate

    warnings.simplefilter("ignore")
    scratch, seed = case
    elapsed = float(np.random.default_rng(seed).uniform(20, 40))
    rig = RigSettings(spacing=7.0, fixture_frames=6, film="reynolds", tilt=0.0, elapsed=elapsed)
    made = simulate(scratch / f"rig{seed}", seed=seed, rig=rig)
    with xr.open_dataset(made / "truth.nc", engine="h5netcdf") as truth:
        truth.load()
    film = erlif.process(made / "run", calibration=erlif.calibrate(made / "fixture"), workers=1)
    shutil.rmtree(made)

    known = np.stack([truth.pin_displacement_load, truth.pin_displacement_side], axis=1)
    error = np.hstack([film.pin_displacement.values - known, film.pin_tilt.values])
    std = np.sqrt(np.diagonal(film.pin_position_cov.values, axis1=1, axis2=2))
    random = np.sqrt(np.diagonal(film.pin_position_cov_random.values, axis1=1, axis2=2))
    excess = film.film_curvature.values - film.film_curvature_expected.values
    return {
        **dict(zip(PIN, (error / std).T, strict=True)),
        "curvature": excess / film.film_curvature_std.values,
        "bend": (film.film_curvature_axial / film.film_curvature_axial_std).values,
        "random": random[:, :2],
        "std": std[:, :2],
    }


def pins(scratch: Path, processes: int, rigs: int) -> None:
    with ProcessPoolExecutor(processes) as pool:
        results = list(pool.map(weigh_pin, [(scratch, 6000 + n) for n in range(rigs)]))
    print(f"{rigs} rigs of 320 x 256 pixels with a sinking pin, each drawn anew")
    for name in (*PIN, "curvature", "bend"):
        pulls = np.concatenate([r[name] for r in results])
        within = [np.mean(np.abs(pulls) < width) for width in (1, 2)]
        print(
            f"{name:18s}{pulls.size:5d} values {within[0]:7.1%} within one, {within[1]:6.1%} "
            f"within two standard deviations; mean pull {pulls.mean():+.2f}, "
            f"rms {np.sqrt(np.mean(pulls**2)):.2f}"
        )
    for name in ("random", "std"):
        load, side = 1e3 * np.sqrt(np.mean(np.concatenate([r[name] for r in results]) ** 2, axis=0))
        print(f"{name} standard deviation: {load:.1f} nm towards the load, {side:.1f} nm sideways")


def maps(scratch: Path, processes: int, *, exact: bool) -> None:
    cases = [(scratch, *case, exact) for case in itertools.product(FILMS, LIGHTS, TEXTURES)]
    with ProcessPoolExecutor(processes) as pool:
        results = list(pool.map(examine, cases))
    print(
        "light contrast | scatter/limit | medians rms % (shared std %) | > 5 std | "
        "film from: share valid, within 1, within 2, bias/std"
    )
    for light, texture in itertools.product(LIGHTS, TEXTURES):
        chosen = [r for r in results if (r["light"], r["texture"]) == (light, texture)]
        worst = max(r["scatter"] for r in chosen)
        medians = 100 * np.sqrt([np.mean(np.square(r["medians"])) for r in chosen])
        shared = 100 * np.array([np.median(r["medians_std"]) for r in chosen])
        line = f"{light:5.1f} {texture:5.2f} | {worst:.3f} | " + " ".join(
            f"{a:.2f}({b:.2f})" for a, b in zip(medians, shared, strict=True)
        )
        print(line + f" | {max(r['beyond5'] for r in chosen):.5f}")
        for span in ((1, 10), *OCTAVES):
            count, one, two = (sum(r[span][n] for r in chosen) for n in range(3))
            share = count / max(sum(r[span][3] for r in chosen), 1)
            bias = [r[span][4] for r in chosen]
            print(
                f"      {span[0]:2d}-{span[1]:2d} um {share:6.1%} {one / max(count, 1):7.1%} "
                f"{two / max(count, 1):6.1%}  " + " ".join(f"{b:+.2f}" for b in bias)
            )
        for name in ("film_mean", "film_min"):
            pulls = np.concatenate([r[name] for r in chosen])
            pulls = pulls[np.isfinite(pulls)]
            print(
                f"      {name}: {pulls.size} values, {np.mean(np.abs(pulls) < 1):.1%} "
                f"{np.mean(np.abs(pulls) < 2):.1%}, mean pull by seed "
                + " ".join(f"{np.nanmean(r[name]):+.2f}({np.nanstd(r[name]):.2f})" for r in chosen)
            )
        print(
            "      map, drift px "
            + " ".join(f"{r['displacement']:.4f},{r['drift']:.4f}" for r in chosen)
        )
        print(
            "      film_mean rel err % "
            + " ".join(f"{100 * np.nanmean(r['film_mean_rel']):+.2f}" for r in chosen)
            + "  film_min err um "
            + " ".join(f"{np.nanmean(r['film_min_err']):+.3f}" for r in chosen),
            flush=True,
        )


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("what", choices=["maps", "fixtures", "pins"])
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--exact", action="store_true", help="a profile without error")
    parser.add_argument("--rigs", type=int, default=200)
    parser.add_argument("--keep", type=Path, help="directory of the virtual rigs, for another run")
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    with tempfile.TemporaryDirectory(prefix="erlif-benchmark-") as scratch:
        if options.what == "maps":
            maps(options.keep or Path(scratch), options.processes, exact=options.exact)
        elif options.what == "pins":
            pins(Path(scratch), options.processes, options.rigs)
        else:
            fixtures(Path(scratch), options.processes, options.rigs)


if __name__ == "__main__":
    main()
