"""Is the friction of the measured film that of the true film? Runs of the virtual rig.

    pip install -e .
    python benchmarks/friction_of_film.py                 # 20 rigs of 160 x 128 pixels, 10 minutes
    python benchmarks/friction_of_film.py --rigs 4 --size 96x64

The truth is the sum of eta U / h over the true gap all round and over the whole length, tilt
included, and the moment of the load from the true place of the pin (tests/scenes/friction.py). That
of the region is the sum over the true map, marks included; the mean of the gap over the region is
beside it, as its errors are the same. Clearance, viscosity and load are stated with errors drawn
from the standard deviations beside them; --digits states them exactly, and the clearance by the
digits of the radii. Errors are given in stated standard deviations: the mean and the root mean
square over the triggers of each rig, and the shares within 1 and 2. What repeats at every trigger
of a rig (calibration, marks, what is stated) is in its mean.
"""

import argparse
import re
import sys
import tempfile
from pathlib import Path

import numpy as np
import xarray as xr

import erlif
from erlif.rig import simulate
from erlif.rig.settings import RigSettings

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
from scenes.friction import true_friction

NUMBERS = {
    "torque": "friction_torque",
    "region": "film_drag",
    "mean gap": "film_gap_mean",
    "coefficient": "friction_coefficient",
    "power": "friction_power",
}
"""What is compared, and its variable."""

CLEARANCE_STD, VISCOSITY_STD, LOAD_STD = 2.0, 0.005, 0.005  # um, and relative


def draw_rig(seed: int, size: tuple[int, int]) -> RigSettings:
    """Draw one of the rigs: film of theory or of a law, load, oil, clearance, tilt and marks."""
    rng = np.random.default_rng(seed)
    viscosity, load = float(rng.uniform(0.06, 0.2)), float(rng.uniform(180, 260))
    clearance, theory = float(rng.uniform(0.18, 0.28)), seed % 2 == 0
    # the joint sinks to a film of some um in a time in proportion to this
    slow = viscosity / 0.12 * 222 / load * (0.23 / clearance) ** 2
    return RigSettings(
        width=size[0],
        height=size[1],
        spacing=float(rng.uniform(1.8, 2.4)),
        fixture_frames=6,
        film="reynolds" if theory else "law",
        elapsed=float(rng.uniform(20, 30)) * slow,
        film_reference=float(rng.uniform(4, 8)),
        viscosity=viscosity,
        load=load,
        bushing_radius=33.36 + clearance,
        # half of what closes the gap of the thinnest films at the end of the joint
        tilt=0.0 if theory else float(rng.uniform(-0.25, 0.25)),
        marks=float(rng.uniform(0.03, 0.1)),
        write_mount=True,
    )


def state_with_errors(settings: Path, rig: RigSettings, seed: int) -> None:
    """State clearance, viscosity and load of a rig with errors of their standard deviations."""
    off = np.random.default_rng([seed, 1]).normal(size=3)
    radius = rig.bushing_radius + 1e-3 * CLEARANCE_STD * off[0]
    viscosity, load = (
        rig.viscosity * (1 + VISCOSITY_STD * off[1]),
        rig.load * (1 + LOAD_STD * off[2]),
    )
    stated = {
        "bushing_radius": f'"{radius:.5f} mm"\nclearance_std = "{CLEARANCE_STD} um"',
        "viscosity": f'"{viscosity:.5f} Pa s"\n'
        f'viscosity_std = "{VISCOSITY_STD * viscosity:.5f} Pa s"',
        "load": f'"{load:.3f} N"',
    }
    text = settings.read_text(encoding="utf-8")
    for key, value in stated.items():
        text, found = re.subn(rf"^{key} = .*$", f"{key} = {value}", text, flags=re.MULTILINE)
        if found != 1:
            raise ValueError(f"expected one {key} in {settings}, found {found}")
    head, table, rest = text.partition("[prediction]\n")
    table = table or "[prediction]\n"
    text = f'{head}{table}load_std = "{100 * LOAD_STD:g} %"\n{rest}'
    settings.write_text(text, encoding="utf-8")


def run_rig(seed: int, size: tuple[int, int], folder: Path, *, digits: bool) -> xr.Dataset:
    """Errors of one rig over their standard deviations, and of the region where all is valid."""
    rig = draw_rig(seed, size)
    simulate(folder, rig=rig, seed=seed)
    if not digits:
        state_with_errors(folder / "run" / "run.toml", rig, seed)
    erlif.calibrate(folder / "fixture")
    film = erlif.process(folder / "run", progress=False)
    with xr.open_dataset(folder / "truth.nc") as truth:
        torque, *others = true_friction(truth.load(), rig)
        rate, load = np.abs(truth.rocker_speed.values), truth["joint_load"].values
    true = (torque, *others, 1e3 * torque / (rig.journal_radius * load), torque * rate)
    columns = {}
    for name, key, expected in zip(NUMBERS, NUMBERS.values(), true, strict=True):
        columns[name] = ("trigger", film[key].values / expected - 1)
        columns[f"{name}_std"] = ("trigger", film[f"{key}_std"].values / expected)
    beyond = ("trigger", film.share_beyond_range.values)
    return xr.Dataset({**columns, "beyond": beyond}, attrs={"film": rig.film, "tilt": rig.tilt})


def main() -> None:
    """Print a row for each rig, then the whole."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--rigs", type=int, default=20)
    parser.add_argument("--size", default="160x128")
    parser.add_argument("--digits", action="store_true")
    options = parser.parse_args()
    size = tuple(map(int, options.size.split("x")))
    pulls: dict[str, list[np.ndarray]] = {name: [] for name in NUMBERS}
    print("std, and mean and rms of the errors in std, of", ", ".join(NUMBERS))
    print("rig film      tilt")
    for seed in range(options.rigs):
        with tempfile.TemporaryDirectory() as folder:
            found = run_rig(seed, size, Path(folder) / "rig", digits=options.digits)
        row = f"{seed:3d} {found.attrs['film']:9s} {found.attrs['tilt']:.1f}"
        for name, every in pulls.items():
            std = found[f"{name}_std"].values
            pull = found[name].values / std
            pull = pull[np.isfinite(pull)]
            every.append(pull)
            rms = np.sqrt((pull**2).mean())
            row += f"  {100 * np.nanmedian(std):5.2f} % {pull.mean():+5.2f} {rms:5.2f}"
        print(row, f"  beyond the range {float(found.beyond.max()):.0%}", flush=True)
    for name, every in pulls.items():
        means = np.array([one.mean() for one in every])
        both = np.concatenate(every)
        print(
            f"{name}: mean {means.mean():+.2f}, rms {np.sqrt((both**2).mean()):.2f}; "
            f"{np.mean(np.abs(both) < 1):.1%} and {np.mean(np.abs(both) < 2):.1%} of {both.size} "
            f"triggers within 1 and 2 std, means of {int((np.abs(means) < 1).sum())} and "
            f"{int((np.abs(means) < 2).sum())} of {means.size} rigs"
        )


if __name__ == "__main__":
    main()
