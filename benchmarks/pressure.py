"""Are the error bars of the pressure true? Pins of the virtual rig, with the noise of the sample.

    pip install -e .
    python benchmarks/pressure.py                       # all mounts, six seeds, 50 triggers
    python benchmarks/pressure.py --cases free --seeds 12
    python benchmarks/pressure.py --cases "2 kN" --marks    # triggers at marks of the rocker

Coverage is the share of errors within one and 1.96 stated standard deviations, 68.3 and 95 % where
the error bars are true; the ends are the first two and the last two triggers.
"""

import argparse
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray as xr
from scipy.interpolate import CubicSpline

from erlif.models.mechanism import CrankRocker
from erlif.models.reynolds import Journal
from erlif.prediction import follow_motion
from erlif.prediction.gaps import find_motion_in_gaps
from erlif.prediction.pin_motion import find_pin_motion
from erlif.prediction.pressure import find_pressures
from erlif.rig import cavitation
from erlif.rig.film import crank_at, cycle_time, rocker_angle, rocker_range, rocker_speed
from erlif.rig.journal import follow_pin
from erlif.rig.orbit import RigidBearing

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
from scenes.pin import RIG, follow_true_pin, replace

CASES = {
    "free": {},
    "2 kN": {"sideways": "guided", "load": 2000.0, "elapsed": 6.0},
    "1 kN": {"sideways": "guided", "load": 1000.0, "elapsed": 8.0},
    "loading": {"sideways": "guided", "load": 2000.0, "elapsed": 1.5},
}
"""Changes of the rig; `loading` is recorded in the second turn after the load is put on."""

RANDOM = np.array([3.8e-9, 4.5e-8, 1.3e-6, 1.4e-5])
"""Standard deviations of a position by noise, films up to 6 um; in proportion to thicker films.
[m, m/m]"""
SURFACE = np.array([1.5e-8, 5e-8, 2.2e-6, 1.3e-5])
"""By marks of the surfaces, the same at all triggers."""
LINKS = CrankRocker(crank=0.055, coupler=0.44, rocker=0.26, ground=0.51)
PLACE = np.linspace(-0.0095, 0.0095, 39)
STEPS = 100  # of the rig in a turn, of which the triggers are some
RESULTS = {
    "peak": "peak_pressure",
    "place": "peak_place",
    "load": "load_from_pressure",
    "side": "side_from_pressure",
}


@dataclass(frozen=True)
class Truth:
    """Motion and pressure of a pin at its triggers, in SI."""

    time: np.ndarray
    angle: np.ndarray
    turning: np.ndarray
    position: np.ndarray
    results: dict[str, np.ndarray]


def choose_steps(count: int, rig, marks: bool) -> np.ndarray:
    """Steps of the turn with a trigger: evenly spaced, or nearest to marks of the rocker.

    The rocker rests at its dead points, so that its marks leave gaps of 0.1 of a turn there.
    """
    if not marks:
        return np.arange(0, STEPS, STEPS // count)
    fine = np.linspace(0.0, 1.0, 20001)
    angle = np.asarray(rocker_angle(crank_at(cycle_time(rig) * fine, rig), rig))
    spacing = 2 * np.ptp(angle) / (count + 1)
    mark = np.floor((angle - angle.min()) / spacing + 0.37)
    return np.unique(np.rint(STEPS * fine[np.flatnonzero(np.diff(mark))]).astype(int) % STEPS)


def follow(changes: dict, count: int, marks: bool = False) -> Truth:
    """What the rig knows of a pin and its film."""
    rig = replace(RIG, **changes)
    if rig.sideways != "guided":
        pin = follow_true_pin(count, **changes)
        load = np.full(count, rig.load)
        results = {"peak": pin.peak, "place": pin.place, "load": load, "side": 0 * load}
        return Truth(pin.time, pin.angle, pin.turning, pin.position[:, :2], results)

    steps = cycle_time(rig) / STEPS * np.arange(STEPS)
    films, rows = [], []

    class Watched(cavitation._Film):
        """The film of the rig, which keeps what it found in every step."""

        def __init__(self, *arguments):
            super().__init__(*arguments)
            films.append(self)

        def carry(self, place, turn):
            self.turn, self.forces = turn, super().carry(place, turn)
            return self.forces

        def advance(self):
            pressure = self.unit * self.pressure[:, 0]
            rows.append((*peak(self.grid.angle + self.turn, pressure, rig), *self.forces))
            super().advance()

    plain, cavitation._Film = cavitation._Film, Watched
    try:
        position = follow_pin(steps, rig)
    finally:
        cavitation._Film = plain
    first = round(rig.elapsed * STEPS) - 1  # the first row is that of the first step
    some = choose_steps(count, rig, marks)
    found = np.array(rows[first : first + STEPS])[some].T
    crank = crank_at(steps[some], rig)
    return Truth(
        steps[some],
        np.asarray(rocker_angle(crank, rig)) - np.mean(rocker_range(rig)),
        np.asarray(rocker_speed(crank, rig)),
        position[some],
        dict(zip(RESULTS, found, strict=True)),
    )


def peak(angle: np.ndarray, pressure: np.ndarray, rig) -> tuple[float, float]:
    """Highest pressure in the image and its place, between the nodes of the rig."""
    order = np.argsort(angle)
    order = order[np.abs(angle[order]) < 2 * PLACE[-1] / (1e-3 * rig.journal_radius)]
    near = np.linspace(PLACE[0], PLACE[-1], 3801)
    curve = CubicSpline(angle[order], pressure[order])(near / (1e-3 * rig.journal_radius))
    return curve.max(), near[curve.argmax()]


def measure(truth: Truth, rig, seed: int, cells: tuple[int, int]):
    """Pressure from positions with the noise of one seed."""
    rng, count = np.random.default_rng(seed), truth.time.size
    position = np.concatenate([truth.position, np.zeros((count, 2))], axis=1)
    film = 1e-6 * rig.clearance - np.median(np.hypot(*truth.position.T))
    random, surface = (np.diag(RANDOM * max(1.0, film / 6e-6)) ** 2, np.diag(SURFACE) ** 2)
    position = position + rng.multivariate_normal(np.zeros(4), random, count)
    position += rng.multivariate_normal(np.zeros(4), surface)
    errors = {
        "random_cov": np.tile(random, (count, 1, 1)),
        "surface_cov": np.tile(surface, (count, 1, 1)),
    }
    motion = find_pin_motion(
        truth.time, truth.angle, truth.turning, position, period=cycle_time(rig), **errors
    )
    bearing = RigidBearing(
        1e-3 * rig.journal_radius, 1e-6 * rig.clearance, 1e-3 * rig.length, rig.viscosity
    )
    joint = Journal(
        bearing.radius,
        bearing.radius + bearing.clearance,
        length=bearing.length,
        viscosity=rig.viscosity,
        cavitation_pressure=1e3 * rig.cavitation_pressure,
    )

    def fill():
        """Through the gaps, by the transient film."""
        time = np.append(truth.time, truth.time[0] + cycle_time(rig))
        columns = {
            "time": time,
            "crank_angle": np.degrees(crank_at(time, rig)) % 360,
            "cycle": np.zeros(time.size, int),
            "joint_load": np.full(time.size, rig.load),
        }
        return find_motion_in_gaps(
            joint,
            follow_motion(
                xr.Dataset({name: ("frame", values) for name, values in columns.items()}),
                LINKS,
                crank_speed=2 * np.pi / cycle_time(rig),
                viscosity=rig.viscosity,
            ),
            time=time,
            turning=truth.turning,
            position=position,
            gradient=np.zeros((count, 4, 1)),
            calibration_cov=np.zeros((1, 1)),
            load_line_std=0.0,
            **errors,
        )

    return find_pressures(
        joint,
        motion,
        fill=fill,
        viscosity=np.full(count, rig.viscosity),
        place=PLACE,
        axial=np.zeros(1),
        cells=cells,
    )


def weigh(name: str, seeds: range, count: int, cells: tuple[int, int], marks: bool) -> None:
    """Print the coverage of one case."""
    rig, truth = replace(RIG, **CASES[name]), follow(CASES[name], count, marks)
    count = truth.time.size
    thin = rig.clearance - 1e6 * np.hypot(*truth.position.T)
    runs = [measure(truth, rig, seed, cells) for seed in seeds]
    share = np.mean([run.pressure_measured.values for run in runs])
    print(
        f"{name}: films of {thin.min():.1f} to {thin.max():.1f} um, {len(seeds)} runs of {count} "
        f"triggers, a pressure at {share:.0%}"
    )
    ends = np.isin(np.arange(count), [0, 1, count - 2, count - 1])
    for result, variable in RESULTS.items():
        pull = np.array(
            [(run[variable] - truth.results[result]) / run[f"{variable}_std"] for run in runs]
        )
        text = f"  {result:6s}"
        for where, chosen in (("inside", ~ends), ("ends", ends)):
            known = pull[:, chosen][np.isfinite(pull[:, chosen])]
            if known.size:
                within = [np.mean(np.abs(known) < width) for width in (1, 1.96)]
                text += (
                    f"  {where} {known.size:4d}: {within[0]:4.0%} {within[1]:4.0%}, "
                    f"rms {np.sqrt(np.mean(known**2)):.2f}, mean {known.mean():+.2f}, "
                    f"most {np.abs(known).max():.1f}"
                )
        print(text, flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--cases", nargs="+", choices=CASES, default=list(CASES)[:3])
    parser.add_argument("--seeds", type=int, default=6)
    parser.add_argument("--first", type=int, default=1000, help="first seed")
    parser.add_argument("--triggers", type=int, choices=[25, 50], default=50)
    parser.add_argument("--cells", type=int, nargs=2, default=[384, 24])
    parser.add_argument("--marks", action="store_true")
    options = parser.parse_args()
    seeds = range(options.first, options.first + options.seeds)
    for name in options.cases:
        weigh(name, seeds, options.triggers, tuple(options.cells), options.marks)


if __name__ == "__main__":
    main()
