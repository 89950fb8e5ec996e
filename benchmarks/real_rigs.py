"""Films of rigs that have what every laboratory has, against their truth and their error bars.

``python benchmarks/real_rigs.py`` prints a row for each fault on three seeds: the median error of
the pixels and their stated shared standard deviation, in nm, for films of 3 to 5 and of 8 to 11 um;
the largest error of film_min and film_mean over its standard deviation, and the share of triggers
that have one.
The rig states nothing in [systematics], so the default widths hold. What changes during the run is
judged over its last ten frames.

``python benchmarks/real_rigs.py --coverage 200`` draws rigs from the default widths and prints the
shares of errors within one and two standard deviations, and the scatter of the errors. Their gaps
depart from circles by what erlif takes as known of them. With ``--report`` what the gap of the
joint shows of the errors stays in the films, with ``--remedies patch`` the rigs have a patch of
6 um, with ``--textured`` walls of 10 % with a texture of 50 % of it over 1 or 3 mm. The run divides
its work among processes.

``--sound 50`` photographs rigs without faults that state nothing: gaps of exact circles, seen
along parallel lines too, cosines and parabolas, clearances off by what the radii state. Each has a
line of JSON: errors over their standard deviations, and the warnings.

``--beyond`` photographs pins and balls before walls of 30 and 60 %, even and textured ones, with
films far beyond the maximum of the ratio. A row has the shares of the pixels beyond the
calibrated range that have a value, and one that is off by more than two standard deviations; and
that of the pixels below 0.7 of its end that have none.

With ``--plateau`` rigs without these faults photograph a ball that its load flattens, one frame
pair each: radius of 38 to 50 pixels, minimum film of 0.8 to 2.5 um, central film of 1.1 to 2 times
that, marks up to 0.04 um.

``python benchmarks/real_rigs.py --target "1 %"`` draws ten such rigs (``--rigs``). Each is
photographed, `erlif.budget` gives the shortest list of remedies for the target, and the rig is
photographed again with them: frames of the dry joint, a patch whose film is off by 0.02 um, a
fixture after the run, and other errors drawn from the widths that the remedies leave and state.
A row has the list, the stated standard deviation of films near the median film in the middle third
of the run, and their error; the last line counts the rigs. ``--without patch`` looks for lists
without a patch.
"""

from __future__ import annotations

import argparse
import csv
import itertools
import json
import tempfile
from collections.abc import Callable, Mapping
from concurrent.futures import Executor, ProcessPoolExecutor
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple
from unittest.mock import patch

import numpy as np
import xarray as xr

import erlif
from erlif.core.errors import ErlifError
from erlif.core.flags import Flag
from erlif.core.notes import Level, split_notes
from erlif.core.remedies import REMEDIES
from erlif.core.terms import TERMS
from erlif.rig import RigSettings, simulate
from erlif.rig.film import Gap

PULSES = 50


def per_pulse(share: float) -> float:
    """Share that each pulse destroys where so much is lost at the last one."""
    return float(1 - (1 - share) ** (1 / (PULSES - 1)))


LABORATORY: dict[str, Any] = {"reference": 6.0, "background_pages": 8}
"""A patch of known film and frames of the dry joint; widths are stated (`WIDTHS_STATED`), that of
the field where flats are not off."""

FAULTS: dict[str, dict[str, Any]] = {
    "nothing": {},
    "background of 1 % of the light": {"background": 0.01},
    "background of 3 %": {"background": 0.03},
    "3 %, with 16 frames of the dry joint": {"background": 0.03, "background_pages": 16},
    "dye 2 bleaches by 5 %, dye 1 by 2.5 %": {"bleaching": (per_pulse(0.025), per_pulse(0.05))},
    "oil 10 K warmer at the end": {"warming": 10.0},
    "oil 10 K warmer, log and coefficients stated": {"warming": 10.0},
    "walls of fixture and joint reflect 30 %": {"wall": (0.3, 0.3)},
    "walls reflect 60 %": {"wall": (0.6, 0.6)},
    "wall of the joint 30 %, of the fixture 10 %": {"wall": (0.1, 0.3)},
    "wall of the joint alone reflects 5 %": {"wall": (0.0, 0.05)},
    "wall of the joint 30 %, of the fixture 10 %, stated": {"wall": (0.1, 0.3)},
    "wall of the joint alone reflects 5 %, stated": {"wall": (0.0, 0.05)},
    "walls reflect 10 %, texture of 50 % over 1 mm": {
        "wall": (0.1, 0.1),
        "wall_texture": (0.5, 1.0),
    },
    "walls reflect 10 %, texture of 50 % over 3 mm": {
        "wall": (0.1, 0.1),
        "wall_texture": (0.5, 3.0),
    },
    "camera 2 2 % brighter than at calibration": {"brightness": (1.0, 1.02)},
    "camera 2 2 % brighter, patch of 6 um": {"brightness": (1.0, 1.02), "reference": 6.0},
    "dyes bleach, patch of 6 um": {
        "bleaching": (per_pulse(0.025), per_pulse(0.05)),
        "reference": 6.0,
    },
    "gain of camera 2 up by 5 % from frame 25 on": {"gain_step": (25, 1.05)},
    "dye 2 5 % weaker than in the fixture": {"batch": (1.0, 0.95)},
    "camera 2 keeps 3 % of its last light": {"lag": (0.0, 0.03)},
    "camera 2 loses 5 % at full scale": {"compression": (0.0, 0.05)},
    "dark of camera 2 up by 20 DN": {"dark_drift": (0.0, 20.0)},
    "the same, with dark corners and glare of 0.3 %": {
        "dark_drift": (0.0, 20.0),
        "iris": 0.9,
        "glare": 0.003,
    },
    "dark of camera 2 up by 20 DN from frame 25 on": {"dark_step": (25, 20.0), "iris": 0.9},
    "camera 2 bumped by 6 px at frame 25": {"bump": (25, 6.0, 0.0)},
    "walls reflect 30 %, texture of 30 % over 1 mm": {
        "wall": (0.3, 0.3),
        "wall_texture": (0.3, 1.0),
    },
    "walls reflect 60 %, texture of 20 % over 1 mm": {
        "wall": (0.6, 0.6),
        "wall_texture": (0.2, 1.0),
    },
    "bubbles, background of 1.5 %, focus 0.5, 0.9 px": {
        "bubbles": 8,
        "background": 0.015,
        "blur": (0.5, 0.9),
    },
    "laboratory": LABORATORY,
    "laboratory, flats off by a slope of 0.5 % rms": LABORATORY | {"shading": (0.0087, 0, 0, 0, 0)},
    "laboratory, window of 1 % rms over camera 2": LABORATORY
    | {"shading": (0.0122, 0, 0, 0, 0.0237)},
    "laboratory, walls 10 %, texture of 50 % over 1 mm": LABORATORY
    | {"wall": (0.1, 0.1), "wall_texture": (0.5, 1.0)},
}

OCTAVES = ((1, 2), (2, 4), (4, 8), (8, 11))  # of the true film, for medians of the map [um]

WIDTHS_STATED = (
    '[systematics]\nratio = "0.3 %"\nlag = "0.1 %"\ntemperature = "0.1 %"\nbleaching = "0.2 %"\n'
    'batch = "0 %"\nwall = "0.5 %"\nlinearity = "0.2 %"\n'
)

STATED: dict[str, dict[str, str]] = {
    "oil 10 K warmer, log and coefficients stated": {
        "fixture/fixture.toml": '[fixture]\ntemperature = "25 degC"\n',
        "run/run.toml": '[temperature]\ncamera1 = "-0.199 %/K"\ncamera2 = "-0.150 %/K"\n'
        'std = "0.01 %/K"\n',
    },
    "wall of the joint 30 %, of the fixture 10 %, stated": {
        "fixture/fixture.toml": '[optics]\nwall = "10 %"\n',
        "run/run.toml": '[optics]\nwall = "30 %"\n',
    },
    "camera 2 2 % brighter, patch of 6 um": {"run/run.toml": '[light]\nratio = "correct"\n'},
    "dyes bleach, patch of 6 um": {"run/run.toml": '[light]\nratio = "correct"\n'},
    "wall of the joint alone reflects 5 %, stated": {"run/run.toml": '[optics]\nwall = "5 %"\n'},
}
"""What a laboratory states of a fault, by file: a heading of its table and further lines."""

REPORT = '[light]\nerrors = "report"\n'

DURING = ("bleaching", "warming", "gain_step", "dark_step", "bump")
"""Settings that act at the end of the run."""


def state(file: Path, lines: str) -> None:
    """Add lines to a settings file, below the heading in the first of them if it is there."""
    text, heading = file.read_text(encoding="utf-8"), lines.partition("\n")[0]
    whole = text.replace(heading, lines.rstrip(), 1) if heading in text else f"{text}\n{lines}"
    file.write_text(whole, encoding="utf-8")


def state_laboratory(out: Path, rig: RigSettings, *, field: bool) -> None:
    """State the widths of a laboratory with a patch, that of the field where its flats hold."""
    run = out / "run" / "run.toml"
    state(run, WIDTHS_STATED)
    if field:
        state(run, '[systematics]\nfield = "0.1 %"\n')
    state(run, '[light]\nratio = "correct"\n')
    lines = f'[systematics]\nposition = "{0.2 * rig.pitch:.5f} mm"\nsize = "0.1 %"\n'
    state(out / "fixture" / "fixture.toml", lines)


def judge_fault(job: tuple[str, int], *, report: bool = False) -> str:
    """One row of the table."""
    name, seed = job
    changes = FAULTS[name]
    with tempfile.TemporaryDirectory() as scratch:
        out = Path(scratch) / "rig"
        rig = RigSettings(write_systematics=False, **changes)
        simulate(out, seed=seed, rig=rig)
        for file, lines in STATED.get(name, {}).items():
            state(out / file, lines)
        if name.startswith("laboratory"):
            state_laboratory(out, rig, field="shading" not in changes)
        if report:
            state(out / "run" / "run.toml", REPORT)
        try:
            film = erlif.process(out / "run")
        except ErlifError as error:
            return f"{name:44s} {seed}  refused: {error}"
        with xr.open_dataset(out / "truth.nc", engine="h5netcdf") as truth:
            true, true_min = truth.film.values, truth.film_min.values
        inside = region_of(rig, film)
    chosen = slice(-10, None) if set(DURING) & set(changes) else slice(None)
    error, std = (film.thickness.values - true)[chosen], film.thickness_std_shared.values[chosen]
    valid, true = film["flags"].values[chosen] == 0, true[chosen]
    parts = []
    for low, high in ((3, 5), (8, 11)):
        of = valid & (true > low) & (true < high)
        if of.sum() < PULSES:
            parts.append("   none      ")
            continue
        parts.append(f"{1e3 * np.median(error[of]):+6.0f} / {1e3 * np.median(std[of]):4.0f}")
    mean = np.mean(true, axis=(1, 2), where=valid & inside)
    for variable, truth_of in (("film_min", true_min[chosen]), ("film_mean", mean)):
        pulls = (film[variable].values[chosen] - truth_of) / film[f"{variable}_std"].values[chosen]
        parts.append(
            f"{variable} {np.nanmax(np.abs(pulls)):.1f}, {np.mean(np.isfinite(pulls)):3.0%}"
        )
    return f"{name:50s} {seed}  {'   '.join(parts)}"


def region_of(rig: RigSettings, film: xr.Dataset) -> np.ndarray:
    """Where the region of interest of a rig is, with the pixels on its bounds, (y, x)."""
    inside = [
        (axis.values > low - 1e-6) & (axis.values < high + 1e-6)
        for axis, (low, high) in zip((film.x, film.y), rig.region, strict=True)
    ]
    return inside[1][:, None] & inside[0]


_BAND_PER_DYE = 0.484
"""Change of the ratio by that of the light of dye 2 over dye 1, of the rig's invented spectra."""


DIGITS = 10 / 6**0.5  # um: radial clearance of two radii that end in 0.01 mm
CLEARANCE = float(np.hypot(DIGITS, 0.01 * RigSettings().clearance))
ROUNDNESS = 0.5  # um: smooth departure of pin and bore from circles, at the edge of the picture
FLATTENING = 0.19  # um: by the load, from frame to frame

Smooth = Callable[[Gap, np.ndarray, np.ndarray], np.ndarray]
"""`Gap.smooth`: film of a gap without marks at object points [pixel]. [um]"""


def draw_form(rng: np.random.Generator) -> Smooth:
    """Gaps as a rig has them, out of round and bent by the load as docs/limits.md says."""
    powers = ((2, 0), (0, 2), (3, 0), (2, 1), (1, 2), (0, 3), (4, 0))
    heights, smooth = np.hypot(ROUNDNESS, FLATTENING) * rng.standard_normal(len(powers)), Gap.smooth
    frames = int(rng.integers(2**32))

    def film(gap: Gap, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        u, v = (at / middle - 1 for at, middle in zip((x, y), gap.rig.centre, strict=True))
        frame = np.random.default_rng([frames, round(1e9 * gap.film_min)])
        form = frame.normal(0.0, FLATTENING) * u**2
        for height, (along, across) in zip(heights, powers, strict=True):
            form = form + height * u**along * v**across
        return smooth(gap, x, y) + form

    return film


class Drawn(NamedTuple):
    """A drawn rig, the error of its origin [px], the scale of its profile, and its gaps."""

    rig: RigSettings
    origin: float
    size: float
    smooth: Smooth


WIDTHS = {key: (source.width or 0.0) / 100 for key, source in TERMS.items()} | {"position": 1.0}
"""Default widths as shares; that of the position in pixels."""


def draw_rig(
    rng: np.random.Generator, widths: Mapping[str, float] = WIDTHS, *, between: bool = False
) -> Drawn:
    """A rig of given widths.

    The widths are those of the bands. The background of camera 2 has a correlation of 0.9 with that
    of camera 1; what rises during the run is the temperature and the bleaching of the brightness as
    one, and the bleaching of both dyes alike. Of the walls that of the joint or of the fixture
    reflects more. With a fixture directly before the run and another after it, what lies `between`
    fixture and run comes during the run. A frame has none to six bubbles; the point spreads of the
    cameras are 0.4 to 1 px. The radius of the bore is off by the clearance that the digits of both
    radii allow, and by 1 % of it.
    """
    draw = partial(rng.normal, 0.0)
    wall = float(draw(widths["wall"]))
    # over the field, in equal parts x, y, x^2 - 1/3, x y, y^2 - 1/3 by their rms
    rms = np.array([3**-0.5, 3**-0.5, (4 / 45) ** 0.5, 1 / 3, (4 / 45) ** 0.5])
    shading = draw(widths["field"] / 5**0.5 / rms)
    rises = float(np.hypot(widths["temperature"], widths["bleaching"]) * draw()) / _BAND_PER_DYE
    bleached = per_pulse(abs(float(draw(widths["bleaching"]))))
    light = rng.multivariate_normal([0, 0], [[1, 0.9], [0.9, 1]])
    one, two = np.abs(widths["background"] * light)
    ratio, lag, warmer = (float(draw(widths[key])) for key in ("ratio", "lag", "temperature"))
    scale = lag if between else ratio + lag + warmer
    rises += (ratio + warmer) / _BAND_PER_DYE if between else 0.0
    both = float(draw(widths["batch"]))
    rig = RigSettings(
        width=160,
        height=128,
        spacing=2.0,
        fixture_frames=6,
        dark_pages=4,
        flat_pages=3,
        write_systematics=False,
        # scale of the ratio, lag, and the temperature between fixture and run
        brightness=(1.0, 1 + scale - (shading[2] + shading[4]) / 3),
        shading=tuple(shading.tolist()),
        warming=1.0,
        glow_per_kelvin=(-rises / 2, rises / 2),
        bleaching=(bleached, bleached),
        background=float(one),
        background_second=float(two / one),
        wall=(max(-wall, 0.0), max(wall, 0.0)),
        compression=(float(draw(widths["linearity"])), float(draw(widths["linearity"]))),
        batch=(1 + both, (1 + both) * (1 + float(draw(widths["batch"])))),
    )
    rig = replace(
        rig,
        bubbles=int(rng.integers(0, 25)),  # in 320 x 256 pixels: a quarter of it here
        blur=(float(rng.uniform(0.4, 0.8)), float(rng.uniform(0.4, 1.0))),
        bushing_radius=rig.bushing_radius + 1e-3 * float(draw(CLEARANCE)),
    )
    origin, size = float(draw(widths["position"])), 1 + float(draw(widths["size"]))
    return Drawn(rig, origin, size, draw_form(rng))


def photograph(out: Path, seed: int, drawn: Drawn) -> None:
    """Make the directories of a drawn rig, whose radii are the stated ones by their digits."""
    rig, origin, size, smooth = drawn
    with patch.object(Gap, "smooth", smooth):
        simulate(out, seed=1000 + seed, rig=rig)
    run, stated = out / "run" / "run.toml", RigSettings().bushing_radius
    text = run.read_text(encoding="utf-8")
    run.write_text(text.replace(f"{rig.bushing_radius:g} mm", f"{stated:g} mm"), encoding="utf-8")
    for fixture in out.glob("fixture*"):
        settings, profile = fixture / "fixture.toml", fixture / "profile.csv"
        text = settings.read_text(encoding="utf-8")
        settings.write_text(text.replace("[0.0, 0.0]", f"[{origin:.3f}, 0.0]"), encoding="utf-8")
        with profile.open(encoding="utf-8") as file:
            head, *rows = csv.reader(file)
        with profile.open("w", encoding="utf-8", newline="") as file:
            table = [[x, f"{size * float(h):.5f}", std] for x, h, std in rows]
            csv.writer(file).writerows([head, *table])


def photograph_with_remedies(out: Path, seed: int, keys: list[str], median: float) -> Drawn:
    """Photograph a rig once more with some remedies."""
    rng = np.random.default_rng([77, seed])
    leaves = {term: left for key in keys for term, left in REMEDIES[key].leaves.items()}
    stated = {term: left for term, left in leaves.items() if not isinstance(left, str)}
    widths = WIDTHS | {term: left / 100 for term, left in stated.items()}
    if "mark" in keys:
        widths["position"] *= 0.2
    drawn = draw_rig(rng, widths, between="fixture_after" in keys)
    known = round(median, 3) if "patch" in keys else 0.0
    pages = 8 if "dry_frames" in keys else 0
    rig = replace(
        drawn.rig, reference=known, background_pages=pages, fixture_after="fixture_after" in keys
    )
    photograph(out, seed, drawn._replace(rig=rig))
    run, heading = out / "run" / "run.toml", "[systematics]\n"
    for key, width in stated.items():
        files = [run] if TERMS[key].file == "run" else list(out.glob("fixture*/fixture.toml"))
        for file in files:
            state(file, f'{heading}{key} = "{width} %"\n')
    if "mark" in keys:
        for file in out.glob("fixture*/fixture.toml"):
            state(file, f'{heading}position = "{0.2 * rig.pitch:.5f} mm"\n')
    if known:
        text = run.read_text(encoding="utf-8")
        off = f"{known + rng.normal(0.0, 0.02):.4f}"
        run.write_text(text.replace(f'thickness = "{known:g} um"', f'thickness = "{off} um"'))
        state(run, '[light]\nratio = "correct"\n')
    return drawn


def reach_target(seed: int, *, target: str) -> tuple[str, float, float, float, float]:
    """The remedies of a drawn rig; film, wanted and stated standard deviation, and error. [um]"""
    with tempfile.TemporaryDirectory() as scratch:
        bare, better = Path(scratch) / "bare", Path(scratch) / "better"
        photograph(bare, seed, draw_rig(np.random.default_rng([77, seed])))
        table = erlif.budget(bare / "run", target=target).target_std
        keys, median = table["remedy"].values[1:].tolist(), float(table.target_film[-1])
        photograph_with_remedies(better, seed, keys, median)
        film = erlif.process(better / "run")
        with xr.open_dataset(better / "truth.nc", engine="h5netcdf") as truth:
            true = truth.film.values
    third = film.sizes["trigger"] // 3
    middle = slice(third, 2 * third + 1)
    valid, true = film["flags"].values[middle] == 0, true[middle]
    near = valid & (np.abs(true / median - 1) < 0.05)
    error = (film.thickness.values[middle] - true)[near]
    stated = float(table[-1, -1])
    return (
        ", ".join(keys),
        median,
        float(table.attrs["target"][-1]),
        stated,
        float(np.median(error)),
    )


def pull_rig(
    seed: int, *, report: bool = False, remedies: tuple[str, ...] = (), textured: bool = False
) -> dict[str, tuple[float, float]]:
    """Errors of one drawn rig and their standard deviations."""
    drawn = draw_rig(np.random.default_rng([77, seed]))
    if textured:
        walls = [reflected + 0.1 for reflected in drawn.rig.wall]
        texture = 0.5, (1.0, 3.0)[seed % 2]
        drawn = drawn._replace(rig=replace(drawn.rig, wall=tuple(walls), wall_texture=texture))
    with tempfile.TemporaryDirectory() as scratch:
        out = Path(scratch) / "rig"
        if remedies:
            drawn = photograph_with_remedies(out, seed, list(remedies), 6.0)
        else:
            photograph(out, seed, drawn)
        if report:
            state(out / "run" / "run.toml", REPORT)
        return pull_numbers(erlif.process(out / "run"), out, drawn)


def true_minima(drawn: Drawn, truth: xr.Dataset) -> np.ndarray:
    """Minimum of the smooth gap in the region of interest, two places a pixel. [um]"""
    rig = drawn.rig
    x, y = (
        np.linspace(*ends, 2 * size) / rig.pitch
        for ends, size in zip(rig.region, (rig.width, rig.height), strict=True)
    )
    gaps = [Gap(rig, float(lowest), np.zeros_like) for lowest in truth.film_min]
    return np.array([drawn.smooth(gap, x, y[:, None]).min() for gap in gaps])


def pull_numbers(film: xr.Dataset, out: Path, drawn: Drawn) -> dict[str, tuple[float, float]]:
    """Errors of the numbers of a film and their standard deviations, by their names."""
    with xr.open_dataset(out / "truth.nc", engine="h5netcdf") as truth:
        truth.load()
    minima, region, found = true_minima(drawn, truth), region_of(drawn.rig, film), {}
    last = film.sizes["trigger"] - 1
    for k, when in ((2, "first"), (last // 2, "middle"), (last - 2, "last")):
        valid = film["flags"].values[k] == 0
        true = truth.film.values[k]
        error, std = film.thickness.values[k] - true, film.thickness_std_shared.values[k]
        for low, high in OCTAVES if when == "middle" else ():
            of = valid & (true > low) & (true <= high)
            if of.sum() >= PULSES:
                median = float(np.median(error[of])), float(np.median(std[of]))
                found[f"map, {low} to {high} um"] = median
        for variable, where in (
            ("film_mean", region & valid),
            ("film_gap_mean", region),
            ("film_min", None),
        ):
            number = minima[k] if where is None else true[where].mean()
            miss = float(film[variable][k] - number)
            found[f"{variable}, {when}"] = miss, float(film[f"{variable}_std"][k])
    speed = np.abs(truth.rocker_speed.values)
    fast = speed > 0.1 * speed.max()
    drive = np.log(speed / truth.joint_load.values)[fast]
    power = float(np.polyfit(drive, np.log(minima[fast]), 1)[0])
    found["exponent"] = float(film.speed_exponent) - power, float(film.speed_exponent_std)
    return found


THICK: dict[str, dict[str, Any]] = {
    "pin": {"spacing": 1.92},
    "ball": {
        "contact": "ball",
        "mechanism": "rotation",
        "field_width": 2.0,
        "ball_radius": 15.0,
        "thin_line": 0.1,
        "film_table": tuple(np.linspace(1, 6, 24).round(3).tolist()),
    },
}
"""Joints whose pictures hold films far beyond the maximum of the ratio: to 17 and 130 um."""

WALLS = ((0.3, 0.0), (0.6, 0.0), (0.3, 0.3), (0.6, 0.2))
"""Reflectance, and its texture over it, correlated over 1/20 of the width of the picture."""


def judge_beyond(job: tuple[str, tuple[float, float]]) -> str:
    """Films beyond the calibrated range of one joint before one wall, as a row."""
    joint, (wall, share) = job
    rig = RigSettings(write_systematics=False, fixture_frames=6, **THICK[joint])
    rig = replace(rig, wall=(wall, wall), wall_texture=(share, rig.field_width / 20))
    with tempfile.TemporaryDirectory() as scratch:
        out = Path(scratch) / "rig"
        simulate(out, seed=1, rig=rig)
        end = erlif.calibrate(out / "fixture").thickness_range[1]
        film = erlif.process(out / "run").load()
        with xr.open_dataset(out / "truth.nc", engine="h5netcdf") as truth:
            true = truth.film.values
    flags = film["flags"].values
    lit = flags & ~np.uint16(Flag.ABOVE_RANGE | Flag.BELOW_RANGE) == 0
    valid, error = flags == 0, np.abs(film.thickness.values - true)
    off = error > 2 * np.hypot(film.thickness_std, film.thickness_std_shared).values
    beyond, thin = lit & (true > end), lit & (true < 0.7 * end)
    parts = f"{valid[beyond].mean():.2%} valid, {(off & valid)[beyond].mean():.2%} off"
    row = f"{joint:5s} wall {wall:.0%}, texture {share:.0%}: beyond {end:.1f} um {parts}"
    row = f"{row}; of thinner ones {1 - valid[thin].mean():.2%} flagged; within two"
    for low, high in (*OCTAVES, (0.9 * end, end)):
        of = valid & (true > low) & (true < min(high, end))
        row += f" {1 - off[of].mean():.0%}" if of.sum() >= PULSES else " -"
    return row


FORMS = ("cosine", "circles", "projection", "parabola")
"""Of the gap: that of the rig, exact circles, seen along parallel lines too, and a parabola."""


def gap_of_form(form: str, gap: Gap, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Film of a smooth gap of some form at object points [pixel]. [um]"""
    rig = gap.rig
    along = (x - rig.centre[0]) * rig.pitch - rig.thin_line
    rise = rig.tilt / (rig.height * rig.pitch) * (y * rig.pitch - rig.region[1][0])
    lowest, bore = gap.film_min + rise, 1e3 * rig.bushing_radius
    if form == "parabola":
        return lowest + 1e3 * along**2 / 2 * (1 / rig.pin_radius - 1 / rig.bushing_radius)
    phi = along / rig.journal_radius
    phi = np.arcsin(phi) if form == "projection" else phi
    apart = rig.clearance - lowest
    if form == "cosine":
        return rig.clearance - apart * np.cos(phi)
    across = np.sqrt(bore**2 - (apart * np.sin(phi)) ** 2)
    return across - apart * np.cos(phi) - 1e3 * rig.pin_radius


def judge_sound(seed: int) -> dict[str, Any]:
    """Errors of a rig that states nothing, over their standard deviations, and its warnings.

    It has no faults (1e-9 of the widths), but its bore is off by what the digits of both radii
    allow and 1 % of the clearance.
    """
    drawn = draw_rig(np.random.default_rng([78, seed]), dict.fromkeys(WIDTHS, 1e-9))
    form = FORMS[seed % len(FORMS)]
    drawn = drawn._replace(smooth=lambda gap, x, y: gap_of_form(form, gap, x, y))
    with tempfile.TemporaryDirectory() as scratch:
        out = Path(scratch) / "rig"
        photograph(out, seed, drawn)
        film = erlif.process(out / "run").load()
        found = pull_numbers(film, out, drawn)
    notes = split_notes(film.attrs["notes"])
    return {
        "seed": seed,
        "form": form,
        "clearance": round(drawn.rig.clearance - RigSettings().clearance, 2),
        "pulls": {name: round(error / std, 2) for name, (error, std) in found.items()},
        "warnings": [text for level, text in notes if level is not Level.NOTE],
    }


def pull_plateau(seed: int) -> dict[str, tuple[float, float]]:
    """Errors of the film of one drawn contact and their standard deviations; NaN for no film."""
    rng = np.random.default_rng([77, seed])
    width, pixels, over = 256, rng.uniform(38, 50), rng.uniform(1.1, 2.0)
    low, high = np.log([15.0, 250.0])
    rig = RigSettings(
        fixture_frames=6,
        bubbles=0,
        width=width,
        height=224,
        field_width=1.5 * width / pixels,
        mechanism="static",
        contact="ball",
        pictures=1,
        plateau=(1.5, over),
        ball_radius=float(np.exp(rng.uniform(low, high))),
        film_table=(rng.uniform(0.8, 2.5),),
        marks=rng.uniform(0, 0.04),
        thin_line=rng.uniform(-0.2, 0.2),
    )
    with tempfile.TemporaryDirectory() as scratch:
        simulate(Path(scratch), seed=1000 + seed, rig=rig)
        film = erlif.process(Path(scratch) / "run").load()
    if film.attrs["contact"] != "plateau":
        return {"film_min": (np.nan, np.nan), "film_central": (np.nan, np.nan)}
    true = {"film_min": rig.film_table[0], "film_central": over * rig.film_table[0]}
    return {
        name: (float(film[name][0]) - one, float(film[f"{name}_std"][0]))
        for name, one in true.items()
    }


def print_faults(pool: Executor, options: argparse.Namespace) -> None:
    """A row for each fault and seed."""
    names = [name for name in FAULTS if (options.only or "") in name]
    jobs = [(name, n) for name in names for n in options.seeds]
    for row in pool.map(partial(judge_fault, report=options.report), jobs):
        print(row, flush=True)


def print_targets(pool: Executor, options: argparse.Namespace) -> None:
    """A row for each drawn rig with its remedies, and how many reach the target."""
    rigs, reached = range(options.first, options.first + options.rigs), []
    rows = pool.map(partial(reach_target, target=options.target), rigs)
    for seed, (keys, median, wanted, std, error) in zip(rigs, rows, strict=True):
        reached.append((abs(error) <= 2 * std, abs(error) <= wanted))
        print(
            f"{seed:4d}  {median:.2f} um, target {1e3 * wanted:.0f}, stated "
            f"{1e3 * std:.0f}, error {1e3 * error:+.0f} nm: {keys}",
            flush=True,
        )
    two, within = np.sum(reached, axis=0)
    print(f"{two} of {len(reached)} within 2 standard deviations, {within} within the target")


def print_coverage(pool: Executor, options: argparse.Namespace) -> None:
    """A row for each number of the film: its errors over all drawn rigs."""
    rigs = range(options.first, options.first + options.coverage)
    given = {"report": options.report, "remedies": tuple(options.remedies)}
    given["textured"] = options.textured
    pull = pull_plateau if options.plateau else partial(pull_rig, **given)
    drawn = list(pool.map(pull, rigs))
    for name in dict.fromkeys(name for each in drawn for name in each):
        every = np.array([each[name] for each in drawn if name in each])
        error, std = every[np.isfinite(every).all(axis=1)].T
        pulls = np.abs(error / std)
        one, two = (100 * np.mean(pulls < width) for width in (1, 2))
        print(
            f"{name:22s} {len(error):4d} {one:5.1f} % {two:5.1f} %   largest {pulls.max():.2f}   "
            f"rms error {np.sqrt(np.mean(error**2)):.3f}, median std {np.median(std):.3f}"
        )


def print_beyond(pool: Executor) -> None:
    """A row for each joint and wall."""
    for row in pool.map(judge_beyond, itertools.product(THICK, WALLS)):
        print(row, flush=True)


def print_sound(pool: Executor, options: argparse.Namespace) -> None:
    """A line of JSON for each sound rig, then the shares of all errors and the warnings."""
    rigs, drawn = range(options.first, options.first + options.sound), []
    for found in pool.map(judge_sound, rigs):
        drawn.append(found)
        print(json.dumps(found), flush=True)
    pulls = np.abs([pull for found in drawn for pull in found["pulls"].values()])
    one, two = (100 * np.mean(pulls < width) for width in (1, 2))
    print(f"{len(pulls)} numbers: {one:.0f} % {two:.0f} %, largest {pulls.max():.2f}")
    print(f"{sum(bool(found['warnings']) for found in drawn)} of {len(drawn)} rigs have a warning")


def main() -> None:
    """Print the table of faults, the coverage of drawn rigs, or their remedies for a target."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--coverage", type=int, help="rigs drawn from the default widths")
    parser.add_argument(
        "--sound", type=int, help="rigs without faults, by exact circles and others"
    )
    parser.add_argument(
        "--beyond", action="store_true", help="films beyond the maximum of the ratio"
    )
    parser.add_argument("--plateau", action="store_true", help="coverage of flattened balls")
    parser.add_argument("--first", type=int, default=0, help="first of these rigs")
    parser.add_argument("--report", action="store_true", help="leave in what the gap shows")
    parser.add_argument("--remedies", nargs="*", default=[], help="that the rigs of coverage have")
    parser.add_argument("--textured", action="store_true", help="the same before uneven walls")
    parser.add_argument("--target", help='for example "1 %%": with the remedies that reach it')
    parser.add_argument("--rigs", type=int, default=10, help="rigs of --target")
    parser.add_argument("--without", nargs="*", default=[], help="remedies that no list has")
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2, 3])
    parser.add_argument("--only", help="faults whose name contains this text")
    parser.add_argument("--workers", type=int, default=2)
    options = parser.parse_args()
    for key in options.without:  # before the processes of the pool copy the table
        del REMEDIES[key]
    with ProcessPoolExecutor(options.workers) as pool:
        if options.target is not None:
            print_targets(pool, options)
        elif options.beyond:
            print_beyond(pool)
        elif options.sound is not None:
            print_sound(pool, options)
        elif options.coverage is not None:
            print_coverage(pool, options)
        else:
            print_faults(pool, options)


if __name__ == "__main__":
    main()
