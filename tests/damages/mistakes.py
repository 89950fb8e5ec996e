"""Mistakes of a laboratory that leave a run readable: each changes a copy of a sound rig."""

import re
import shutil
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import cv2
import h5py
import numpy as np
import tifffile

from erlif.rig import RigSettings

SMALL = {
    "width": 128,
    "height": 96,
    "fixture_frames": 6,
    "dark_pages": 4,
    "flat_pages": 3,
    "bubbles": 0,
}

RIGS = {
    "law": RigSettings(**SMALL),
    "law, other": RigSettings(**SMALL, film_reference=5.0, thin_line=0.3, load_swing=0.1),
    "crank": RigSettings(**SMALL, encoder="crank"),
    "zero fitted": RigSettings(**SMALL, write_zero=False),
    "transient": RigSettings(**SMALL, film="reynolds", tilt=0.0),
    "two cycles": RigSettings(**SMALL, cycles=2, spacing=1.92),
    "disc": RigSettings(**SMALL, mechanism="rotation", pictures=12, cycles=4),
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


# changes of the log


def column(name: str, change: Callable[[np.ndarray], np.ndarray]):
    """Change the numbers of one column."""

    def damage(rig: Path) -> None:
        table = Table(rig / "run" / "encoder.csv")
        table.put(name, change(table.numbers(name)))
        table.write()

    return damage


def without(*names: str, then: Callable[[Path], object] | None = None):
    """Leave columns out of the log, then do something else."""

    def damage(rig: Path) -> None:
        table = Table(rig / "run" / "encoder.csv")
        for name in names:
            table.columns.pop(name, None)
        table.write()
        if then is not None:
            then(rig)

    return damage


def at(rows, change):
    """Change some rows of a column."""

    def apply(values: np.ndarray) -> np.ndarray:
        values = values.copy()
        values[rows] = change(values[rows])
        return values

    return apply


def late(count: int, *, since: int = 0):
    """Row k + count of the log stands in row k, from a row on; the last rows repeat the cycle."""

    def damage(rig: Path) -> None:
        table = Table(rig / "run" / "encoder.csv")
        size = len(table.columns["frame"])
        time = table.numbers("time_s") if "time_s" in table.columns else None
        order = np.arange(size)
        order[since:] += count
        for name, cells in table.columns.items():
            if name == "frame":
                continue
            moved = [cells[n % size] for n in order]
            if name == "time_s":
                assert time is not None
                moved = [f"{time[n % size] + TURN * (n // size):.6f}" for n in order]
            table.columns[name] = moved
        if time is not None:
            first = min(map(float, table.columns["time_s"]))
            table.put("time_s", table.numbers("time_s") - min(first, 0.0))
        table.write()

    return damage


def setting(*changes: tuple[str, str], file: str = "run/run.toml"):
    """Replace text of the settings."""

    def damage(rig: Path) -> None:
        path = rig / file
        text = path.read_text(encoding="utf-8")
        for old, new in changes:
            assert old in text, old
            text = text.replace(old, new, 1)
        path.write_text(text, encoding="utf-8")

    return damage


# changes of the frames


def each(change: Callable[[np.ndarray], np.ndarray], cameras=(1, 2), chosen=slice(None)):
    """Change the counts of frames."""

    def damage(rig: Path) -> None:
        for camera in cameras:
            for path in frames(rig / "run", camera)[chosen]:
                image = tifffile.imread(path)
                path.unlink()
                tifffile.imwrite(path, change(image).astype(np.uint16))

    return damage


def order(change: Callable[[list[bytes]], list[bytes]], cameras=(1, 2)):
    """Put the frames of cameras in another order; names and log stay."""

    def damage(rig: Path) -> None:
        for camera in cameras:
            paths = frames(rig / "run", camera)
            content = change([path.read_bytes() for path in paths])
            for path, data in zip(paths, content, strict=True):
                path.unlink()
                path.write_bytes(data)

    return damage


def from_another(source: str, places: list[int], taken: list[int] | None = None):
    """Pairs of another recording in the place of some: "fixture", or the run of another rig."""

    def damage(rig: Path) -> None:
        other = rig / "fixture" if source == "fixture" else rig.parent / source / "run"
        for camera in (1, 2):
            own, foreign = frames(rig / "run", camera), frames(other, camera)
            for place, n in zip(places, taken or range(len(places)), strict=True):
                own[place].unlink()
                shutil.copy(foreign[n % len(foreign)], own[place])

    return damage


def lost(first: int, count: int):
    """Pairs lost in the middle of the run, their rows taken from the end of the log."""

    def damage(rig: Path) -> None:
        for camera in (1, 2):
            for path in frames(rig / "run", camera)[first : first + count]:
                path.unlink()
            for n, path in enumerate(frames(rig / "run", camera)):
                path.rename(path.with_name(f"frame_{n:04d}.tif"))
        table = Table(rig / "run" / "encoder.csv")
        table.columns = {name: cells[:-count] for name, cells in table.columns.items()}
        table.write()
        setting(("triggers_per_cycle = ", "# "))(rig)

    return damage


def copy_camera(one: int, two: int):
    def damage(rig: Path) -> None:
        for source, target in zip(frames(rig / "run", one), frames(rig / "run", two), strict=True):
            target.unlink()
            shutil.copy(source, target)

    return damage


def jpeg(quality: int, scale: float):
    """Eight bits by way of JPEG, rescaled."""

    def change(image: np.ndarray) -> np.ndarray:
        packed = cv2.imencode(
            ".jpg", (image >> 4).astype(np.uint8), [cv2.IMWRITE_JPEG_QUALITY, quality]
        )[1]
        return np.rint(cv2.imdecode(packed, cv2.IMREAD_GRAYSCALE) * scale)

    return change


def rocker_as_crank(rig: Path) -> None:
    setting(('mounted_on = "rocker"', 'mounted_on = "crank"'))(rig)


def attribute(name: str, value):
    def damage(rig: Path) -> None:
        path = rig / "fixture" / "calibration.nc"
        content = path.read_bytes()
        path.unlink()
        path.write_bytes(content)
        with h5py.File(path, "r+") as file:
            file.attrs[name] = value

    return damage


def cut_ms(values):
    return values * 1000


def kgf(values):
    return values / 9.80665


def slip(row: int, degrees: float):
    return column("angle_deg", at(slice(row, None), lambda v: v + degrees))


def reading(row: int, degrees: float):
    return column("angle_deg", at([row], lambda v: v + degrees))


def spread(values, seed=1, std=0.01):
    return values * (1 + std * np.random.default_rng(seed).normal(size=values.size))


LOAD = "load_N"
ANGLE = "angle|reading|encoder"
PAIRS = "rows of the pairs"
FOREIGN = "another|other recording|fixture"

MISTAKES = [
    # files and counts
    Mistake("camera 2 holds copies of camera 1", copy_camera(1, 2), "same image"),
    Mistake("camera 1 holds copies of camera 2", copy_camera(2, 1), "same image"),
    *(
        Mistake(
            f"bit {bit} of camera {camera} is never set",
            each(lambda i, b=bit: i & ~np.uint16(1 << b), [camera]),
            "bit|bits",
        )
        for bit in (2, 4, 5, 7, 9)
        for camera in (1, 2)
    ),
    *(
        Mistake(
            f"bit {bit} of both cameras is always set",
            each(lambda i, b=bit: i | np.uint16(1 << b)),
            "bit|bits",
        )
        for bit in (3, 6, 8)
    ),
    *(
        Mistake(
            f"JPEG of quality {quality}, scaled by {scale} to 12 bit",
            each(jpeg(quality, scale)),
            "fewer bits|multiples",
        )
        for quality, scale in ((95, 16), (95, 16.06), (80, 16), (80, 16.06), (60, 16))
    ),
    *(
        Mistake(
            f"8 bits scaled by {scale} in camera {camera}",
            each(lambda i, s=scale: np.rint((i >> 4) * s), [camera]),
            "fewer bits|multiples",
        )
        for scale in (16, 16.06)
        for camera in (1, 2)
    ),
    Mistake("counts of both cameras halved", each(lambda i: i >> 1), "counts|gain|noise"),
    Mistake(
        "counts of both cameras halved, rounded",
        each(lambda i: np.rint(i / 2)),
        "counts|gain|noise",
    ),
    Mistake("counts of camera 2 halved", each(lambda i: i >> 1, [2]), "counts|gain|noise|ratio"),
    Mistake("counts of camera 1 halved", each(lambda i: i >> 1, [1]), "counts|gain|noise|ratio"),
    Mistake(
        "counts of both cameras times 1.5",
        each(lambda i: np.minimum(np.rint(i * 1.5), 4095)),
        "counts|gain|noise|bits",
    ),
    Mistake("dark subtracted twice", each(lambda i: np.maximum(i.astype(int) - 64, 0)), "dark"),
    # log: units and conditions
    *(
        Mistake(f"load in {unit} under load_N", column(LOAD, lambda v, f=factor: v * f), "load")
        for unit, factor in (("kgf", 1 / 9.80665), ("lbf", 1 / 4.448), ("kN", 1e-3), ("mN", 1e3))
    ),
    *(
        Mistake(
            f"time in {unit}, {rig}",
            column("time_s", lambda v, f=factor: v * f),
            "time|crank turns",
            rig,
        )
        for unit, factor in (("ms", 1e3), ("minutes", 1 / 60), ("us", 1e6))
        for rig in ("law", "crank", "zero fitted")
    ),
    *(
        Mistake(
            f"crank speed of {rpm} rpm for 114, {rig}",
            setting(('"114 rpm"', f'"{rpm} rpm"')),
            "crank turns|crank_speed",
            rig,
        )
        for rpm in (11.4, 141, 228, 57)
        for rig in ("law", "crank", "two cycles")
    ),
    *(
        Mistake(
            f"speed of the disc of {rpm} rpm for 60",
            setting(('"60 rpm"', f'"{rpm} rpm"')),
            "angle and time of the log",
            "disc",
        )
        for rpm in (6, 54, 120, 600)
    ),
    *(
        Mistake(
            f"temperature in {unit} under temperature_C",
            column("temperature_C", change),
            "temperature",
        )
        for unit, change in (
            ("K", lambda v: v + 273.15),
            ("degF times 10", lambda v: 10 * (v * 1.8 + 32)),
        )
    ),
    # log: single values
    *(
        Mistake(
            f"load of row {row} times {factor}",
            column(LOAD, at([row], lambda v, f=factor: v * f)),
            "load",
            rig,
        )
        for row, factor, rig in (
            (20, 1000, "law"),
            (3, 1000, "crank"),
            (49, 1000, "law"),
            (0, 1000, "law"),
            (20, 0.001, "law"),
            (31, 10, "law, other"),
            (31, 0.1, "law"),
            (7, 100, "transient"),
            (12, 5, "law"),
            (30, 1000, "two cycles"),
        )
    ),
    *(
        Mistake(
            f"ten loads of 0.5 N {where}",
            column(LOAD, at(rows, lambda v: 0 * v + 0.5)),
            "load",
            rig,
        )
        for where, rows, rig in (
            ("in a row", slice(20, 30), "law"),
            ("scattered", list(range(2, 50, 5)), "law"),
            ("at the start", slice(0, 10), "law"),
            ("at the end", slice(40, 50), "crank"),
        )
    ),
    *(
        Mistake(
            f"temperature of row {row} off by {off} K",
            column("temperature_C", at([row], lambda v, o=off: v + o)),
            "temperature",
        )
        for row, off in ((20, 500), (0, 60), (49, -80), (33, 8))
    ),
    *(
        Mistake(f"reading of row {row} off by {off} degrees, {rig}", reading(row, off), ANGLE, rig)
        for row, off, rig in (
            (12, -8, "law"),
            (30, 5, "law"),
            (40, 3, "law"),
            (8, 2, "law"),
            (20, 8, "crank"),
            (33, -20, "crank"),
            (12, -8, "zero fitted"),
            (30, 5, "transient"),
            (12, -8, "two cycles"),
        )
    ),
    *(
        Mistake(
            f"reading of row {row} off by {off} degrees, no times",
            without("time_s", then=reading(row, off)),
            ANGLE,
        )
        for row, off in ((12, -8), (30, 5), (40, 3))
    ),
    *(
        Mistake(f"encoder slips by {off} degrees at row {row}, {rig}", slip(row, off), ANGLE, rig)
        for row, off, rig in (
            (20, -1, "law"),
            (33, 1, "law"),
            (10, -0.5, "law"),
            (30, 0.5, "law"),
            (20, -1, "zero fitted"),
            (20, 5, "crank"),
            (30, -5, "crank"),
            (25, 10, "crank"),
            (28, -1, "two cycles"),
            (20, -1, "transient"),
        )
    ),
    *(
        Mistake(f"{name} of row {row} off", column("time_s", at([row], change)), "time", rig)
        for name, row, change, rig in (
            ("time", 20, lambda v: v + 0.005, "law"),
            ("time", 30, lambda v: v - 0.004, "law"),
        )
    ),
    # order of pairs and rows
    *(
        Mistake(f"log late by {count}, {rig}", late(count), PAIRS, rig)
        for count in (1, -1, 5, -5, 2)
        for rig in ("law", "crank")
    ),
    *(
        Mistake(f"log late by {count}, transient", late(count), PAIRS, "transient")
        for count in (1, 5, -5)
    ),
    *(
        Mistake(f"log late by {count}, no energies", without("laser_mJ", then=late(count)), PAIRS)
        for count in (1, -1, 5, -5)
    ),
    *(
        Mistake(f"rows of the log {count} on from row {row}", late(count, since=row), PAIRS, rig)
        for row, count, rig in (
            (20, 1, "law"),
            (30, 1, "crank"),
            (25, 3, "law"),
            (25, 1, "transient"),
        )
    ),
    *(
        Mistake(f"{count} pairs lost from pair {first}, {rig}", lost(first, count), PAIRS, rig)
        for first, count, rig in (
            (20, 10, "law"),
            (10, 10, "crank"),
            (25, 1, "law"),
            (20, 3, "law"),
            (20, 10, "transient"),
        )
    ),
    *(
        Mistake(
            f"{count} pairs lost from pair {first}, no energies",
            without("laser_mJ", then=lost(first, count)),
            PAIRS,
        )
        for first, count in ((20, 10), (10, 5), (25, 1))
    ),
    *(
        Mistake(
            f"both cameras in reverse order, {rig}",
            order(lambda c: c[::-1]),
            "in reverse order",
            rig,
        )
        for rig in ("law", "crank", "transient", "two cycles")
    ),
    Mistake(
        "both cameras in reverse order, no energies",
        without("laser_mJ", then=order(lambda c: c[::-1])),
        "in reverse order",
    ),
    *(
        Mistake(
            f"pairs {one} and {two} exchanged in both cameras",
            order(
                lambda c, a=one, b=two: [
                    c[b] if n == a else c[a] if n == b else x for n, x in enumerate(c)
                ]
            ),
            "of another place",
        )
        for one, two in ((10, 35), (5, 12), (20, 21))
    ),
    # pairs of other recordings
    *(
        Mistake(
            f"{count} pairs of {other!r} ({taken}) from pair {first}, {rig}",
            from_another(
                other, list(range(first, first + count)), list(range(taken, taken + count))
            ),
            FOREIGN,
            rig,
        )
        for count, first, taken, other, rig in (
            (10, 20, 20, "law, other", "law"),
            (10, 20, 0, "law, other", "law"),
            (10, 0, 0, "crank", "law"),
            (3, 30, 30, "law, other", "law"),
            (10, 20, 20, "transient", "law"),
            (10, 40, 40, "law", "crank"),
            (10, 20, 20, "law", "transient"),
        )
    ),
    *(
        Mistake(
            f"{len(places)} pairs of the fixture from pair {places[0]}, {rig}",
            from_another("fixture", places),
            FOREIGN,
            rig,
        )
        for places, rig in (
            ([20, 21, 22], "law"),
            ([0, 1, 2], "law"),
            ([10, 25, 40], "crank"),
            ([47, 48, 49], "transient"),
            ([30], "law"),
        )
    ),
    # settings
    *(
        Mistake(
            f"crank of {cm} cm for 5.5 cm, {rig}",
            setting(('"5.5 cm"', f'"{cm} cm"')),
            "crank|swing|linkage|reach",
            rig,
        )
        for cm in (5.4, 5.6, 5.45, 5.7)
        for rig in ("law", "zero fitted")
    ),
    *(
        Mistake(
            f"{link} {new} for {old} cm, {rig}",
            setting((f'{link} = "{old} cm"', f'{link} = "{new} cm"')),
            "crank|swing|linkage|reach|zero",
            rig,
        )
        for link, old, new in (
            ("rocker", 26, 27),
            ("rocker", 26, 25),
            ("coupler", 44, 45),
            ("ground", 51, 50),
        )
        for rig in ("law", "zero fitted")
    ),
    Mistake("stated on the crank, logged on the rocker", rocker_as_crank, "crank|rocker"),
    Mistake("the same, zero not stated", rocker_as_crank, "crank|rocker", "zero fitted"),
    Mistake("the same, two cycles", rocker_as_crank, "crank|rocker", "two cycles"),
    Mistake(
        "stated on the crank, logged on the rocker, no times",
        without("time_s", then=rocker_as_crank),
        "crank|rocker",
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
    *(
        Mistake(
            f"load of {load} N in [joint] for 222",
            setting(('load = "222.411 N"', f'load = "{load} N"')),
            "load",
        )
        for load in (22.2, 2220)
    ),
    *(
        Mistake(f"calibration of erlif {version}", attribute("erlif_version", version), "version")
        for version in ("99.0.0", "99", "2.1.0")
    ),
]

KINDS = {
    "the same files under both cameras": "copies of camera",
    "a bit that is stuck": "^bit ",
    "8 bits scaled to 12, also by way of JPEG": "JPEG|^8 bits",
    "counts halved or scaled, dark subtracted twice": "^counts|^dark",
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
    "a link 1 to 4 % too long or short, a zero off": "^(crank of|rocker|coupler|ground)|zero off",
    "encoder stated on another link": "^stated|^the same",
    "another load in [joint]": "in .joint. for",
    "calibration of a later erlif": "^calibration of",
}
"""Kinds of mistakes, by words of their names; the first that fits holds."""
