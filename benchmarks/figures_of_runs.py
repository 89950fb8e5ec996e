"""Every figure of seven runs, to be looked at before a release.

    python benchmarks/figures_of_runs.py OUT                  # two minutes, 150 MB
    python benchmarks/figures_of_runs.py OUT --only one_stroke,static
    python benchmarks/figures_of_runs.py OUT --draw           # films are there; draw again

The runs are the sample, a film that follows a power law, a ball on a disc, one stroke, a static
film, a cycle of two hundred triggers, and three turns whose triggers do not repeat. Each is
processed, and its figures and its report are written into OUT/NAME; OUT/compare has comparisons.
The lines of the summary of `process` are counted as a terminal of 80 columns shows them.
OUT/sheet_NAME.png holds all figures of a run.
"""

import argparse
import shutil
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from click.testing import CliRunner
from matplotlib.figure import Figure
from matplotlib.image import imread

from erlif.commands.main import main as erlif
from erlif.rig import RigSettings, simulate

HERE = Path(__file__).resolve().parents[1]
SEED = 26
SMALL = {"width": 192, "height": 128, "fixture_frames": 4, "dark_pages": 4, "flat_pages": 3}
TURN = 2 * np.pi * np.arange(12) / 12
RUNS = {
    "power_law": RigSettings(**SMALL, spacing=1.5, marks=0.02),
    "pin_on_disc": RigSettings(
        **SMALL,
        mechanism="rotation",
        contact="ball",
        pictures=TURN.size,
        film_table=tuple(1.6 + 0.5 * np.cos(TURN)),
        field_width=3.0,
        thin_line=0.1,
    ),
    "one_stroke": RigSettings(**SMALL, film="reynolds", tilt=0.0),
    "static": RigSettings(**SMALL, mechanism="static", pictures=8),
    "two_hundred": RigSettings(**SMALL | {"width": 128, "height": 96}, spacing=0.24),
    "turns": RigSettings(**SMALL, film="reynolds", tilt=0.0, pulses_per_cycle=7.3, cycles=3),
}
"""The virtual rig of each run but the sample, by its name."""

COLUMNS = 80  # of a terminal
SHEET = 3  # figures in a row of a sheet


@dataclass(frozen=True)
class Run:
    """A run directory, and the folder of what is made from it."""

    directory: Path
    out: Path

    @property
    def film(self) -> Path:
        return self.directory / "film.nc"


def call(*arguments: object) -> str:
    """Call a command of erlif and return what it prints."""
    done = CliRunner().invoke(erlif, [str(one) for one in arguments], catch_exceptions=False)
    if done.exit_code:
        raise SystemExit(f"erlif {' '.join(map(str, arguments))}\n{done.output}")
    return done.stdout


def make_run(name: str, out: Path) -> Run:
    """Photograph the film of a run, and calibrate its fixture."""
    folder = out / name
    if name == "sample":
        if not folder.exists():
            made: dict[str, Any] = {"ignore": shutil.ignore_patterns("*.nc")}
            run = HERE / "data_samples" / "straight_bushing"
            shutil.copytree(run, folder / "runs" / "run", **made)
            shutil.copytree(HERE / "calibration", folder / "calibration", **made)
            for fixture in sorted((folder / "calibration").iterdir()):
                call("calibrate", fixture)
        return Run(folder / "runs" / "run", folder)

    if not folder.exists():
        made = simulate(folder, seed=SEED, rig=RUNS[name])
        call("calibrate", made / "fixture")
        if name == "one_stroke":
            leave_one_stroke(made / "run")
    return Run(folder / "run", folder)


def leave_one_stroke(directory: Path) -> None:
    """Remove the frames of the return stroke, and their rows of the log."""
    log = directory / "encoder.csv"
    head, *rows = log.read_text(encoding="utf-8").splitlines()
    kept = rows[: len(rows) // 2]
    log.write_text("\n".join([head, *kept]) + "\n", encoding="utf-8")
    for camera in ("camera1", "camera2"):
        for frame in sorted((directory / camera).iterdir())[len(kept) :]:
            frame.unlink()


def process(run: Run) -> str:
    """Process a run, and return the summary."""
    return call("process", run.directory, "--overwrite")


def draw(run: Run) -> list[Path]:
    """Draw all figures of a run, and write its report."""
    figures = run.out / "figures"
    shutil.rmtree(figures, ignore_errors=True)
    options = ["--format", "png", "--dpi", 150, "--overwrite"]
    call("figures", run.film, "-o", figures, *options)
    call("report", run.film, "-o", run.out / "report.html", "--overwrite")
    return sorted(figures.glob("*.png"))


def write_sheet(pictures: Sequence[Path], path: Path) -> None:
    """Write pictures beside each other, with their names."""
    rows = -(-len(pictures) // SHEET)
    figure = Figure(figsize=(6 * SHEET, 4 * rows), layout="constrained", dpi=100)
    panels = figure.subplots(rows, SHEET, squeeze=False)
    for ax, picture in zip(panels.flat, pictures, strict=False):
        ax.imshow(imread(picture))
        ax.set_title(picture.stem)
    for ax in figure.axes:
        ax.set_axis_off()
    figure.savefig(path)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out", type=Path)
    parser.add_argument("--only", default=",".join(["sample", *RUNS]), help="names of the runs")
    parser.add_argument("--draw", action="store_true", help="draw the films that are there")
    options = parser.parse_args()

    print(f"{'run':12} {'lines':>5} {'wrapped':>7} {'widest':>6}")
    films = {}
    for name in options.only.split(","):
        run = make_run(name, options.out)
        if not (options.draw and run.film.exists()):
            lines = process(run).splitlines()
            wrapped = sum(max(1, -(-len(line) // COLUMNS)) for line in lines)
            print(f"{name:12} {len(lines):5} {wrapped:7} {max(map(len, lines)):6}", flush=True)
        write_sheet(draw(run), options.out / f"sheet_{name}.png")
        films[name] = run.film

    for one, other in (("sample", "one_stroke"), ("power_law", "two_hundred")):
        if {one, other} <= set(films):
            folder = options.out / "compare" / f"{one}_{other}"
            folder.parent.mkdir(exist_ok=True)
            call("compare", films[one], films[other], "-o", folder, "--overwrite")


if __name__ == "__main__":
    main()
