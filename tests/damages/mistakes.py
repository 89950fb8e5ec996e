"""Mistakes of a laboratory that leave a run readable: each changes a copy of a sound rig."""

import itertools
import re
import shutil
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import datetime, timedelta
from functools import partial
from pathlib import Path

import cv2
import h5py
import numpy as np
import tifffile

from erlif.rig import RigSettings

SMALL = {"width": 128, "height": 96, "bubbles": 0}
SMALL |= {"fixture_frames": 6, "dark_pages": 4, "flat_pages": 3}

RIGS = {
    "law": RigSettings(**SMALL),
    "law, other": RigSettings(**SMALL, film_reference=5.0, thin_line=0.3, load_swing=0.1),
    "crank": RigSettings(**SMALL, encoder="crank"),
    "zero fitted": RigSettings(**SMALL, write_zero=False),
    "transient": RigSettings(**SMALL, film="reynolds", tilt=0.0),
    "two cycles": RigSettings(**SMALL, cycles=2, spacing=1.92),
    "disc": RigSettings(**SMALL, mechanism="rotation", pictures=12, cycles=4),
    "one turn": RigSettings(**SMALL, mechanism="rotation", pictures=40),
    "slider": RigSettings(**SMALL, mechanism="sinusoidal", pictures=40),
    "static": RigSettings(**SMALL, mechanism="static", pictures=20),
    "rod": RigSettings(**SMALL, mechanism="slider-crank", crank=16.0, pictures=40),
    "slider-crank": RigSettings(
        **SMALL, mechanism="slider-crank", crank=16.0, pictures=40, encoder="crank"
    ),
}
"""Sound rigs; each is simulated once."""

SEEDS = {name: 40 + n for n, name in enumerate(RIGS)}


TURN = 60 / 114
"""Time of one turn of the crank. [s]"""


class Table:
    """The log of a run as columns of text."""

    def __init__(self, path: Path) -> None:
        self.path = path
        head, *rows = path.read_text(encoding="utf-8").splitlines()
        cells = [row.split(",") for row in rows]
        self.columns = dict(zip(head.split(","), map(list, zip(*cells, strict=True)), strict=True))

    def numbers(self, name: str) -> np.ndarray:
        return np.array(self.columns[name], float)

    def put(self, name: str, values) -> None:
        self.columns[name] = [f"{value:.7g}" for value in values]

    def write(self) -> None:
        rows = zip(*self.columns.values(), strict=True)
        lines = [",".join(self.columns), *map(",".join, rows)]
        self.path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def frames(run: Path, camera: int) -> list[Path]:
    return sorted((run / f"camera{camera}").iterdir())


@dataclass(frozen=True)
class Mistake:
    """One mistake.

    Attributes
    ----------
    name : str
        What was done.
    change : Callable
        Does it to the directory of a rig, which holds run and fixture.
    cause : str
        Words of the warning that names it; several alternatives are divided by a bar. Empty where
        nothing can show it, or where the film and its errors remain right.
    rig : str
        The rig it is done to, of `RIGS`.
    """

    name: str
    change: Callable[[Path], object]
    cause: str
    rig: str = "law"

    @property
    def kind(self) -> str:
        """Its kind, of `KINDS`."""
        return next(kind for kind, words in KINDS.items() if re.search(words, self.name))


# changes of a rig: each function is called with the rig later


def change(function: Callable[..., object]) -> Callable[..., Callable[[Path], object]]:
    """Give a change of the rig, which is the first argument, for the other arguments."""
    return lambda *args, **options: lambda rig: function(rig, *args, **options)


@contextmanager
def log_of(rig: Path) -> Iterator[Table]:
    table = Table(rig / "run" / "encoder.csv")
    yield table
    table.write()


@change
def column(rig: Path, name: str, change: Callable[[np.ndarray], np.ndarray]) -> None:
    """Change the numbers of one column."""
    with log_of(rig) as table:
        table.put(name, change(table.numbers(name)))


@change
def without(rig: Path, name: str, then: Callable[[Path], object]) -> None:
    """Leave a column out of the log, then do something else."""
    with log_of(rig) as table:
        del table.columns[name]
    then(rig)


def at(rows, change):
    """Change some rows of a column."""

    def apply(values: np.ndarray) -> np.ndarray:
        values = values.copy()
        values[rows] = change(values[rows])
        return values

    return apply


@change
def late(rig: Path, count: int, since: int = 0) -> None:
    """Row k + count of the log stands in row k, from a row on; the last rows repeat the cycle."""
    with log_of(rig) as table:
        size = len(table.columns["frame"])
        order = np.arange(size)
        order[since:] += count
        time = table.numbers("time_s")
        for name, cells in table.columns.items():
            if name != "frame":
                table.columns[name] = [cells[n % size] for n in order]
        # of one turn of the crank, or of all rows of another rig
        again = TURN if np.ptp(time) < TURN else np.ptp(time) + np.median(np.diff(time))
        time = np.round(time[order % size] + again * (order // size), 6)
        table.put("time_s", time - min(time.min(), 0.0))


@change
def setting(rig: Path, *changes: tuple[str, str]) -> None:
    """Replace text of the settings."""
    path = rig / "run" / "run.toml"
    text = path.read_text(encoding="utf-8")
    for old, new in changes:
        assert old in text, old
        text = text.replace(old, new, 1)
    path.write_text(text, encoding="utf-8")


@change
def each(rig: Path, change: Callable[[np.ndarray], np.ndarray], cameras=(1, 2)) -> None:
    """Change the counts of frames."""
    for camera in cameras:
        for path in frames(rig / "run", camera):
            image = tifffile.imread(path)
            path.unlink()
            tifffile.imwrite(path, change(image).astype(np.uint16))


@change
def order(rig: Path, change: Callable[[list[bytes]], list[bytes]]) -> None:
    """Put the frames of both cameras in another order; names and log stay."""
    for camera in (1, 2):
        paths = frames(rig / "run", camera)
        content = change([path.read_bytes() for path in paths])
        for path, data in zip(paths, content, strict=True):
            path.unlink()
            path.write_bytes(data)


@change
def from_another(rig: Path, source: str, places: Sequence[int], taken: Sequence[int]) -> None:
    """Pairs of another recording in the place of some: "fixture", or the run of another rig."""
    other = rig / "fixture" if source == "fixture" else rig.parent / source / "run"
    for camera in (1, 2):
        own, foreign = frames(rig / "run", camera), frames(other, camera)
        for place, n in zip(places, taken, strict=True):
            own[place].unlink()
            shutil.copy(foreign[n % len(foreign)], own[place])


@change
def lost(rig: Path, first: int, count: int) -> None:
    """Pairs lost in the middle of the run, their rows taken from the end of the log."""
    for camera in (1, 2):
        for path in frames(rig / "run", camera)[first : first + count]:
            path.unlink()
        for n, path in enumerate(frames(rig / "run", camera)):
            path.rename(path.with_name(f"frame_{n:04d}.tif"))
    with log_of(rig) as table:
        table.columns = {name: cells[:-count] for name, cells in table.columns.items()}
    if "triggers_per_cycle" in (rig / "run" / "run.toml").read_text(encoding="utf-8"):
        setting(("triggers_per_cycle = ", "# "))(rig)


@change
def copy_camera(rig: Path, one: int, two: int) -> None:
    for source, target in zip(frames(rig / "run", one), frames(rig / "run", two), strict=True):
        target.unlink()
        shutil.copy(source, target)


def jpeg(quality: int, scale: float):
    """Eight bits by way of JPEG, rescaled."""

    def change(image: np.ndarray) -> np.ndarray:
        eight = (image >> 4).astype(np.uint8)
        packed = cv2.imencode(".jpg", eight, [cv2.IMWRITE_JPEG_QUALITY, quality])[1]
        return np.rint(cv2.imdecode(packed, cv2.IMREAD_GRAYSCALE) * scale)

    return change


@change
def stacked(rig: Path, then: Callable[[Path], object]) -> None:
    """Do something, then put the frames of each camera into one file."""
    then(rig)
    for camera in (1, 2):
        paths = frames(rig / "run", camera)
        images = [tifffile.imread(path) for path in paths]
        for path in paths:
            path.unlink()
        tifffile.imwrite(paths[0].with_name("run.tif"), np.stack(images), photometric="minisblack")


@change
def reference_image(rig: Path, kind: str, camera: int, change: Callable) -> None:
    """Change the pages of a dark or flat image."""
    for folder in (rig / "run", rig / "fixture"):
        path = folder / f"camera{camera}_{kind}.tif"
        pages = change(tifffile.imread(path).astype(float))
        path.unlink()
        tifffile.imwrite(path, np.rint(pages).astype(np.uint16), photometric="minisblack")


@change
def fitted_anew(rig: Path, then: Callable[[Path], object]) -> None:
    """Do something to the fixture too, whose calibration is then made with it."""
    then(rig)
    (rig / "fixture" / "calibration.nc").unlink()


@change
def profile(rig: Path, by: float) -> None:
    """All points of the profile are too thick, or too thin."""
    table = Table(rig / "fixture" / "profile.csv")
    table.put("thickness_um", np.maximum(table.numbers("thickness_um") + by, 0.0))
    table.write()


@change
def one_file(rig: Path, kind: str) -> None:
    """The dark, or the flat, is the file of both."""
    for camera in (1, 2):
        dark, flat = (rig / "run" / f"camera{camera}_{name}.tif" for name in ("dark", "flat"))
        source, target = (dark, flat) if kind == "dark" else (flat, dark)
        target.unlink()
        shutil.copy(source, target)


@change
def local_clock(rig: Path, hours: int) -> None:
    """Local times in place of seconds; the clock is put forward or back in the middle."""
    with log_of(rig) as table:
        time = table.numbers("time_s")
        start = datetime(2026, 3, 29, 2) if hours > 0 else datetime(2026, 10, 25, 3)
        middle = float(np.median(time))
        clocks = [
            start + timedelta(seconds=each - middle, hours=hours if each >= middle else 0)
            for each in time
        ]
        del table.columns["time_s"]
        table.columns["Clock"] = [f"{clock:%Y-%m-%d %H:%M:%S.%f}" for clock in clocks]
    setting(('"encoder.csv"', '"encoder.csv"\ntime = "Clock"'))(rig)


rocker_as_crank = setting(('mounted_on = "rocker"', 'mounted_on = "crank"'))


@change
def attribute(rig: Path, name: str, value) -> None:
    path = rig / "fixture" / "calibration.nc"
    content = path.read_bytes()
    path.unlink()
    path.write_bytes(content)
    with h5py.File(path, "r+") as file:
        file.attrs[name] = value


LOAD = "load_N"
ANGLE = "angle|reading|encoder"
PAIRS = "rows of the pairs"
FOREIGN = "another|other recording|fixture"
LINKS = "crank|swing|linkage|reach"
MOUNTING = "crank|rocker"


def scaled(name: str, factor: float):
    return column(name, lambda values: values * factor)


def load_of(row: int, factor: float):
    return column(LOAD, at([row], lambda v: v * factor))


def off(name: str, row: int, by: float):
    return column(name, at([row], lambda v: v + by))


def reading(row: int, degrees: float):
    return off("angle_deg", row, degrees)


def slip(row: int, degrees: float):
    return column("angle_deg", at(slice(row, None), lambda v: v + degrees))


def replaced(text: str):
    """Values of the settings, `old` by `new`, in a text of both."""
    return lambda old, new: setting((text.format(old), text.format(new)))


def reverse(content: list[bytes]) -> list[bytes]:
    return content[::-1]


def exchange(one: int, two: int):
    def change(content: list[bytes]) -> list[bytes]:
        content = list(content)
        content[one], content[two] = content[two], content[one]
        return content

    return order(change)


def unlogged(name: str, make: Callable[..., Callable[[Path], object]]):
    """The same where a column is not in the log."""
    return lambda *values: without(name, make(*values))


def on(rigs: Sequence[str], *rows: tuple) -> list[tuple]:
    """Each row of values with each rig."""
    return [(*row, rig) for row in rows for rig in rigs]


def family(name: str, make: Callable, cause: str, rows: Iterable[tuple]) -> list[Mistake]:
    """A mistake for each row of values, the last of which is the rig."""
    return [
        Mistake(name.format(*row, rig=row[-1]), make(*row[:-1]), cause, row[-1]) for row in rows
    ]


def in_stacks(mistakes: Iterable[Mistake]) -> list[Mistake]:
    """The same mistakes where the frames of a camera are in one file."""
    return [
        Mistake(f"{one.name}, in stacks", stacked(one.change), one.cause, one.rig)
        for one in mistakes
    ]


def vignette(pages: np.ndarray) -> np.ndarray:
    """Darker towards the corners by a fifth, as if the lamp were not even."""
    height, width = pages.shape[-2:]
    y, x = np.ogrid[-1 : 1 : height * 1j, -1 : 1 : width * 1j]
    return 64 + (pages - 64) * (1 - 0.1 * (x**2 + y**2))


LAW, CRANK, ZERO = ("law",), ("law", "crank"), ("law", "zero fitted")
MOVED, PINS = ("one turn", "slider", "slider-crank"), ("slider-crank", "rod")
OTHERS = (*MOVED, "static")

MISTAKES = [
    # files and counts
    *family(
        "camera {1} holds copies of camera {0}", copy_camera, "same image", on(LAW, (1, 2), (2, 1))
    ),
    *family(
        "bit {} of camera {} is never set",
        lambda bit, camera: each(lambda i: i & ~np.uint16(1 << bit), [camera]),
        "bit|bits",
        itertools.product((2, 4, 5, 7, 9), (1, 2), LAW),
    ),
    *family(
        "bit {} of both cameras is always set",
        lambda bit: each(lambda i: i | np.uint16(1 << bit)),
        "bit|bits",
        itertools.product((3, 6, 8), LAW),
    ),
    *family(
        "JPEG of quality {}, scaled by {} to 12 bit",
        lambda quality, scale: each(jpeg(quality, scale)),
        "fewer bits|multiples",
        on(LAW, (95, 16), (95, 16.06), (80, 16), (80, 16.06), (60, 16)),
    ),
    *family(
        "8 bits scaled by {} in camera {}",
        lambda scale, camera: each(lambda i: np.rint((i >> 4) * scale), [camera]),
        "fewer bits|multiples",
        itertools.product((16, 16.06), (1, 2), LAW),
    ),
    Mistake("counts of both cameras halved", each(lambda i: i >> 1), "counts|gain|noise"),
    Mistake(
        "counts of both cameras halved, rounded",
        each(lambda i: np.rint(i / 2)),
        "counts|gain|noise",
    ),
    *family(
        "counts of camera {} halved",
        lambda camera: each(lambda i: i >> 1, [camera]),
        "counts|gain|noise|ratio",
        itertools.product((2, 1), LAW),
    ),
    Mistake(
        "counts of both cameras times 1.5",
        each(lambda i: np.minimum(np.rint(i * 1.5), 4095)),
        "counts|gain|noise|bits",
    ),
    Mistake("dark subtracted twice", each(lambda i: np.maximum(i.astype(int) - 64, 0)), "dark"),
    # log: units and conditions
    *family(
        "load in {} under load_N",
        lambda unit, factor: scaled(LOAD, factor),
        "load",
        on(LAW, ("kgf", 1 / 9.80665), ("lbf", 1 / 4.448), ("kN", 1e-3), ("mN", 1e3)),
    ),
    *family(
        "time in {0}, {2}",
        lambda unit, factor: scaled("time_s", factor),
        "time|crank turns",
        on((*CRANK, "zero fitted"), ("ms", 1e3), ("minutes", 1 / 60), ("us", 1e6)),
    ),
    *family(
        "crank speed of {1} rpm for {0}, {2}",
        replaced('"{} rpm"'),
        "crank turns|crank_speed",
        on((*CRANK, "two cycles"), (114, 11.4), (114, 141), (114, 228), (114, 57)),
    ),
    *family(
        "speed of the disc of {1} rpm for {0}",
        replaced('"{} rpm"'),
        "angle and time of the log",
        on(("disc",), (60, 6), (60, 54), (60, 120), (60, 600)),
    ),
    *family(
        "temperature in {} under temperature_C",
        lambda unit, change: column("temperature_C", change),
        "temperature",
        on(LAW, ("K", lambda v: v + 273.15), ("degF times 10", lambda v: 10 * (v * 1.8 + 32))),
    ),
    # log: single values
    *family(
        "load of row {} times {}",
        load_of,
        "load",
        [
            *on(LAW, (20, 1000), (49, 1000), (0, 1000), (20, 0.001), (31, 0.1), (12, 5)),
            *((3, 1000, "crank"), (31, 10, "law, other")),
            *((7, 100, "transient"), (30, 1000, "two cycles")),
        ],
    ),
    *family(
        "ten loads of 0.5 N {}",
        lambda where, rows: column(LOAD, at(rows, lambda v: 0 * v + 0.5)),
        "load",
        [
            *on(LAW, ("in a row", slice(20, 30)), ("scattered", list(range(2, 50, 5)))),
            *(("at the start", slice(0, 10), "law"), ("at the end", slice(40, 50), "crank")),
        ],
    ),
    *family(
        "temperature of row {} off by {} K",
        partial(off, "temperature_C"),
        "temperature",
        on(LAW, (20, 500), (0, 60), (49, -80), (33, 8)),
    ),
    *family(
        "reading of row {} off by {} degrees, {}",
        reading,
        ANGLE,
        [
            *on(LAW, (12, -8), (30, 5), (40, 3), (8, 2)),
            *on(("crank",), (20, 8), (33, -20)),
            *((12, -8, "zero fitted"), (30, 5, "transient"), (12, -8, "two cycles")),
        ],
    ),
    *family(
        "reading of row {} off by {} degrees, no times",
        unlogged("time_s", reading),
        ANGLE,
        on(LAW, (12, -8), (30, 5), (40, 3)),
    ),
    *family(
        "encoder slips by {1} degrees at row {0}, {2}",
        slip,
        ANGLE,
        [
            *on(LAW, (20, -1), (33, 1), (10, -0.5), (30, 0.5)),
            *on(("crank",), (20, 5), (30, -5), (25, 10)),
            *((20, -1, "zero fitted"), (28, -1, "two cycles"), (20, -1, "transient")),
        ],
    ),
    *family(
        "time of row {0} off", partial(off, "time_s"), "time", on(LAW, (20, 0.005), (30, -0.004))
    ),
    # order of pairs and rows
    *family(
        "log late by {}, {}",
        late,
        PAIRS,
        [*on(CRANK, (1,), (-1,), (5,), (-5,), (2,)), *on(("transient",), (1,), (5,), (-5,))],
    ),
    *family(
        "log late by {}, no energies",
        unlogged("laser_mJ", late),
        PAIRS,
        on(LAW, (1,), (-1,), (5,), (-5,)),
    ),
    *family(
        "rows of the log {0} on from row {1}",
        late,
        PAIRS,
        [(1, 20, "law"), (1, 30, "crank"), (3, 25, "law"), (1, 25, "transient")],
    ),
    *family(
        "{1} pairs lost from pair {0}, {2}",
        lost,
        PAIRS,
        [*on(LAW, (20, 10), (25, 1), (20, 3)), *((10, 10, "crank"), (20, 10, "transient"))],
    ),
    *family(
        "{1} pairs lost from pair {0}, no energies",
        unlogged("laser_mJ", lost),
        PAIRS,
        on(LAW, (20, 10), (10, 5), (25, 1)),
    ),
    *family(
        "both cameras in reverse order, {}",
        lambda: order(reverse),
        "in reverse order",
        on((*CRANK, "transient", "two cycles"), ()),
    ),
    Mistake(
        "both cameras in reverse order, no energies",
        without("laser_mJ", order(reverse)),
        "in reverse order",
    ),
    *family(
        "pairs {} and {} exchanged in both cameras",
        exchange,
        "of another place",
        on(LAW, (10, 35), (5, 12), (20, 21)),
    ),
    # pairs of other recordings
    *family(
        "{} pairs of {!r} ({}) from pair {}, {}",
        lambda count, other, taken, first: from_another(
            other, range(first, first + count), range(taken, taken + count)
        ),
        FOREIGN,
        [
            *on(LAW, (10, "law, other", 20, 20), (10, "law, other", 0, 20)),
            *on(LAW, (10, "crank", 0, 0), (3, "law, other", 30, 30), (10, "transient", 20, 20)),
            *((10, "law", 40, 40, "crank"), (10, "law", 20, 20, "transient")),
        ],
    ),
    *family(
        "{0} pairs of the fixture from pair {1}, {rig}",
        lambda count, first, step=1: from_another(
            "fixture", range(first, first + count * step, step), range(count)
        ),
        FOREIGN,
        [*on(LAW, (3, 20), (3, 0), (1, 30)), *((3, 10, 15, "crank"), (3, 47, "transient"))],
    ),
    # settings
    *family(
        "crank of {1} cm for {0} cm, {2}",
        replaced('"{} cm"'),
        LINKS,
        on(ZERO, (5.5, 5.4), (5.5, 5.6), (5.5, 5.45), (5.5, 5.7)),
    ),
    *family(
        "{0} {2} for {1} cm, {3}",
        lambda link, old, new: replaced(f'{link} = "{{}} cm"')(old, new),
        f"{LINKS}|zero",
        on(ZERO, ("rocker", 26, 27), ("rocker", 26, 25), ("coupler", 44, 45), ("ground", 51, 50)),
    ),
    Mistake("stated on the crank, logged on the rocker", rocker_as_crank, MOUNTING),
    Mistake("the same, zero not stated", rocker_as_crank, MOUNTING, "zero fitted"),
    Mistake("the same, two cycles", rocker_as_crank, MOUNTING, "two cycles"),
    Mistake(
        "stated on the crank, logged on the rocker, no times",
        without("time_s", rocker_as_crank),
        MOUNTING,
    ),
    Mistake(
        "stated on the rocker, logged on the crank",
        setting(('mounted_on = "crank"', 'mounted_on = "rocker"')),
        "crank|rocker|reach",
        "crank",
    ),
    Mistake(
        "encoder zero off by 2 degrees", setting(('zero = "48.1', 'zero = "46.1')), "reach|zero"
    ),
    *family(
        "load of {1} N in [joint] for {0}",
        replaced('load = "{} N"'),
        "load",
        on(LAW, (222.411, 22.2), (222.411, 2220)),
    ),
    *family(
        "calibration of erlif {}",
        partial(attribute, "erlif_version"),
        "version",
        itertools.product(("99.0.0", "99", "2.1.0"), LAW),
    ),
]

MISTAKES += [
    # other kinds of rig
    *family(
        "camera {1} holds copies of camera {0}, {2}", copy_camera, "same image", on(OTHERS, (1, 2))
    ),
    *family(
        "bit {} of camera {} is never set, {}",
        lambda bit, camera: each(lambda i: i & ~np.uint16(1 << bit), [camera]),
        "bit|bits",
        on(OTHERS, (4, 1), (7, 2)),
    ),
    *family(
        "JPEG of quality {}, scaled by {} to 12 bit, {}",
        lambda quality, scale: each(jpeg(quality, scale)),
        "fewer bits|multiples",
        on(OTHERS, (95, 16)),
    ),
    *family(
        "counts of both cameras halved, {}",
        lambda: each(lambda i: i >> 1),
        "counts|gain|noise",
        on(OTHERS, ()),
    ),
    *family(
        "counts of camera 2 times 1.1, {}",
        lambda: each(lambda i: np.minimum(64 + np.rint((i.astype(int) - 64) * 1.1), 4095), [2]),
        "counts|gain|noise|bits|brighter|ratio",
        on(OTHERS, ()),
    ),
    *family(
        "dark subtracted twice, {}",
        lambda: each(lambda i: np.maximum(i.astype(int) - 64, 0)),
        "dark",
        on(OTHERS, ()),
    ),
    *family(
        "load in {0} under load_N, {2}",
        lambda unit, factor: scaled(LOAD, factor),
        "load",
        on(MOVED, ("kgf", 1 / 9.80665), ("g", 1e3 / 9.80665), ("kN", 1e-3)),
    ),
    *family(
        "time in {0}, {2}",
        lambda unit, factor: scaled("time_s", factor),
        "time|crank turns",
        on(("disc", *MOVED), ("ms", 1e3), ("minutes", 1 / 60)),
    ),
    *family(
        "angle in {0}, {2}",
        lambda unit, factor: scaled("angle_deg", factor),
        f"{ANGLE}|turns",
        on(("law", "crank", "disc", *MOVED), ("turns", 1 / 360), ("radian", np.pi / 180)),
    ),
    *family(
        "frequency of {1} Hz for {0}, {2}",
        replaced('"{} Hz"'),
        "frequency|angle and time",
        on(("slider",), (5, 0.5), (5, 10), (5, 4)),
    ),
    *family(
        "speed of the disc of {1} rpm for {0}, {2}",
        replaced('"{} rpm"'),
        "angle and time of the log",
        on(("one turn",), (60, 6), (60, 120)),
    ),
    *family(
        "load of row {} times {}, {}", load_of, "load", on(MOVED, (20, 1000), (31, 0.1), (12, 5))
    ),
    *family(
        "load ramp in reverse, {}", lambda: column(LOAD, lambda v: v[::-1] * 1), "", on(MOVED, ())
    ),
    *family(
        "reading of row {} off by {} degrees, {}",
        reading,
        ANGLE,
        on(("disc", *MOVED), (12, -8), (30, 100)),
    ),
    *family(
        "encoder slips by {1} degrees at row {0}, {2}",
        slip,
        ANGLE,
        on(("disc", *MOVED), (20, 20), (30, -10)),
    ),
    *family(
        "log late by {}, {}",
        late,
        PAIRS,
        on(("disc", *MOVED), (1,), (-1,), (4,), (-3,)),
    ),
    *family(
        "log late by {}, no energies, {}",
        unlogged("laser_mJ", late),
        PAIRS,
        on(("slider", *PINS), (1,), (-1,), (4,), (-3,)),
    ),
    *family("{1} pairs lost from pair {0}, {2}", lost, PAIRS, on(MOVED, (20, 3), (10, 5))),
    *family(
        "both cameras in reverse order, {}",
        lambda: order(reverse),
        "in reverse order",
        on(("disc", *MOVED), ()),
    ),
    *family(
        "both cameras in reverse order, no energies, {}",
        lambda: without("laser_mJ", order(reverse)),
        "in reverse order",
        on(("slider", "crank", *PINS), ()),
    ),
    *family(
        "pairs {} and {} exchanged in both cameras, {}",
        exchange,
        "of another place",
        on(("disc", *MOVED), (10, 35), (5, 12)),
    ),
    *family(
        "{} pairs of {!r} ({}) from pair {}, {}",
        lambda count, other, taken, first: from_another(
            other, range(first, first + count), range(taken, taken + count)
        ),
        FOREIGN,
        on(OTHERS, (10, "law", 10, 5), (3, "law", 10, 10)),
    ),
    *family(
        "{0} pairs of the fixture from pair {1}, {rig}",
        lambda count, first: from_another("fixture", range(first, first + count), range(count)),
        FOREIGN,
        on(OTHERS, (3, 10), (1, 5)),
    ),
    *family(
        "drive angle off by {} degrees, {}",
        lambda by: column("angle_deg", lambda v: v + by),
        "zero|angle",
        on(("slider",), (20,), (90,), (180,)),
    ),
    *family(
        "dark of camera {} from a hot camera, 300 DN up, {}",
        lambda camera: reference_image("dark", camera, lambda p: p + 300),
        "dark",
        on(("law", *OTHERS), (1,), (2,)),
    ),
    *family(
        "flat of camera {} under an uneven lamp, {}",
        lambda camera: reference_image("flat", camera, vignette),
        "",
        on(("law", "static"), (1,), (2,)),
    ),
    *family(
        "one page of the flat of camera {} copied, {}",
        lambda camera: reference_image("flat", camera, lambda p: np.repeat(p[:1], len(p), axis=0)),
        "flat",
        on(("law", "static"), (1,), (2,)),
    ),
]

MISTAKES += [
    # slider-cranks: their encoder is on the crank, or on the rod
    *family(
        "crank speed of {1} rpm for {0}, {2}",
        replaced('"{} rpm"'),
        "crank turns|crank_speed",
        on(PINS, (114, 11.4), (114, 141), (114, 57)),
    ),
    *family(
        "crank of {1} cm for {0} cm, {2}",
        replaced('"{} cm"'),
        "swing|reach|lengths of the links",
        on(PINS, (16, 15), (16, 17), (16, 1.6)),
    ),
    *family(
        "rod of {1} cm for {0} cm, {2}",
        replaced('"{} cm"'),
        "swing|reach",
        on(PINS, (44, 46), (44, 40)),
    ),
    *family(
        "links in mm for cm, {}",
        lambda: setting(('"16 cm"', '"16 mm"'), ('"44 cm"', '"44 mm"')),
        "",
        on(PINS, ()),
    ),
    *family(
        "linkage stated as a crank-rocker, {}",
        lambda: setting(
            ('kind = "slider-crank"', 'kind = "crank-rocker"\nrocker = "60 cm"\nground = "65 cm"')
        ),
        "kind in|reach|swing",
        on(PINS, ()),
    ),
    Mistake(
        "linkage stated as a slider-crank, crank",
        setting(
            ('kind = "crank-rocker"', 'kind = "slider-crank"'),
            ('rocker = "26 cm"\nground = "51 cm"\n', ""),
        ),
        "crank-rocker",
        "crank",
    ),
    Mistake(
        "stated on the crank, logged on the rod",
        rocker_as_crank,
        MOUNTING,
        "rod",
    ),
    Mistake(
        "stated on the rod, logged on the crank",
        setting(('mounted_on = "crank"', 'mounted_on = "rocker"')),
        "crank|rocker|reach",
        "slider-crank",
    ),
    *family(
        "crank zero off by {} degrees, {}",
        lambda by: setting(('zero = "30.', f'zero = "{30 + by}.')),
        "zero",
        on(("slider-crank", "crank"), (20,), (90,), (180,)),
    ),
    *family(
        "rod zero off by {} degrees, {}",
        lambda by: setting(('zero = "-21.', f'zero = "{-21 + by}.')),
        "reach|zero",
        on(("rod",), (2,), (20,)),
    ),
    *family(
        "encoder counts the other way, {}",
        lambda: column("angle_deg", lambda v: v.max() - v),
        "direction",
        on(PINS, ()),
    ),
    *family("log late by {}, {}", late, PAIRS, on(("rod",), (1,), (-1,), (4,))),
    *family("reading of row {} off by {} degrees, {}", reading, ANGLE, on(("rod",), (12, -8))),
    *family("encoder slips by {1} degrees at row {0}, {2}", slip, ANGLE, on(("rod",), (20, -3))),
    # damages of frames, references, profile and clock on each kind of rig
    *family(
        "all frames {} counts above the darks, {}",
        lambda by: each(lambda i: np.minimum(i + float(by), 4095)),
        "offset|dark",
        on(("law", *OTHERS), (1000,), (200,)),
    ),
    *family(
        "dark of both cameras hot, 300 DN up, in run and fixture, {}",
        lambda: fitted_anew(
            lambda rig: [
                reference_image("dark", camera, lambda p: p + 300)(rig) for camera in (1, 2)
            ]
        ),
        "dark",
        on(("law", *OTHERS), ()),
    ),
    *family(
        "profile {:+g} um, {}",
        lambda by: fitted_anew(profile(by)),
        "profile",
        on(("law", *OTHERS), (5,), (-2,)),
    ),
    *family(
        "clock put by {:+d} h in mid-run, {}",
        local_clock,
        "",
        on(("law", *MOVED), (1,), (-1,)),
    ),
    *family(
        "one file as dark and flat, the {}, {}",
        one_file,
        "flat",
        on(("law", *OTHERS), ("dark",), ("flat",)),
    ),
]
MISTAKES += in_stacks(
    one
    for one in MISTAKES
    if one.rig in ("law", "slider")
    and re.search(
        "copies of|bit [47] of camera|late by (1|-3)|lost from|reverse order|exchanged"
        "|counts of both cameras halved|of the fixture|pairs of '",
        one.name,
    )
)

KINDS = {
    "the same files under both cameras": "copies of camera",
    "a bit that is stuck": "^bit ",
    "8 bits scaled to 12, also by way of JPEG": "JPEG|^8 bits",
    "counts halved or scaled, dark subtracted twice": "^counts|^dark sub",
    "load, temperature or time in another unit": "^load in|^temperature in|^time in",
    "another speed of the crank or disc in run.toml": "^crank speed|^speed of",
    "single loads 5 to 1000 times too large or small": "^load of row",
    "ten loads of 0.5 N": "^ten loads",
    "single temperatures or times that are off": "^temperature of|^time of",
    "a reading of the encoder 2 to 20 degrees off": "^reading of",
    "an encoder that slips by 0.5 to 10 degrees": "^encoder slips",
    "log late or early by 1 to 5 pairs": "^log late",
    "rows shifted from a row on, 1 to 10 pairs lost": "^rows of|pairs lost",
    "both cameras in reverse order": "reverse order",
    "two pairs exchanged in both cameras": "exchanged in both",
    "3 to 10 pairs of another run": "^[0-9]+ pairs of '",
    "1 to 3 pairs of the fixture": "of the fixture",
    "a link too long or short, a zero off": "^(crank|rod|links|rocker|coupler|ground) |zero off",
    "encoder or linkage of another kind": "^stated|^the same|^linkage",
    "another load in [joint]": "in .joint. for",
    "calibration of a later erlif": "^calibration of",
    "angle in turns or radian": "^angle in",
    "another frequency of the slider": "^frequency of",
    "load ramp in reverse": "^load ramp",
    "drive angle off": "^drive angle",
    "another dark or flat": "^dark of|^flat of|of the flat|^one file",
    "an encoder that counts the other way": "the other way",
    "an offset of all frames": "^all frames",
    "a profile of the fixture that is off as a whole": "^profile ",
    "a clock at the change to summer time": "^clock",
}
"""Kinds of mistakes, by words of their names; the first that fits holds."""
