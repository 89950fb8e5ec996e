"""Smallest errors that frames, fixture, log and radii allow, beside those that erlif states.

``python benchmarks/bound.py`` photographs a rig without faults for each row, and prints standard
deviations in nm of films of 3, 5 and 10 um and of film_mean, in the middle third of the run: by
the widths of the errors (and the patch, where there is one), by the Fisher bound, as erlif states
them, and these over the bound. The columns of "whole picture" are the bound without a region of
interest, those of "steady beam" that of a laser whose beam is the same at every pulse.

The bound shares no code with the fit of erlif. Observations are the logarithm of the ratio and of
the light of camera 1 in 16 x 20 blocks of each frame, with photon noise and speckle. Unknowns are
position, tilt and bend of the pin in each frame, the form of the gap, the marks of each block, the
energy of each pulse, the beam at each block and its change from pulse to pulse up to the second
degree (a ratio is measured because no beam is steady), the curve of the fixture, the film of the
patch, what stands still in each block of a textured wall, and all errors. What erlif knows of them
(docs/limits.md) is their prior. Derivatives are finite differences of the light of the virtual rig
at the true films.
"""

from __future__ import annotations

import argparse
import tempfile
import warnings
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
import real_rigs
import scipy
import xarray as xr

import erlif
from erlif.rig import RigSettings, simulate
from erlif.rig.dyes import BANDS, DyedOil, filtered_light
from erlif.rig.film import draw_marks
from erlif.rig.setup import beam, random_stream

MICROMETRES = (3.0, 5.0, 10.0)
NEAR = 0.07  # share by which a film of the table may differ
ROWS, COLUMNS = 16, 20  # blocks
STEP = 1e-4  # of a finite difference
EXCESS = 3e-4 * np.sqrt(ROWS * COLUMNS / 120)  # noise of the ratio of a block beyond photons [1]
PATCH_EXCESS = 1e-4  # the same of the patch [1]
PATCH_STD = 0.02  # um: its film
FULL = 4095 * 4.4  # electron at full scale

CLEARANCE = 4.1  # um: both radii are known to half of their last digit, 0.01 mm
FLATTENING = 0.19  # um: of the acrylic joint
ROUNDNESS, BEND = np.hypot(FLATTENING, (0.5, 0.01))  # um: at the edge of the picture
FREE = 1e3  # um, and logarithm of the light

DEFAULTS = {key: float(width) for key, width in real_rigs.WIDTHS.items() if width}
LABORATORY = DEFAULTS | {"ratio": 0.003, "lag": 0.001, "temperature": 0.001, "bleaching": 0.002}
LABORATORY |= {"batch": 0.0, "wall": 0.005, "linearity": 0.002, "field": 0.001, "size": 0.001}
LABORATORY |= {"position": 0.2, "background": 0.015 * 0.05}  # after frames of the dry joint
SMALL = {"width": 160, "height": 128, "spacing": 2.0}
MOVING = {"film_table": tuple(2 + 6 * np.sin(np.pi * np.arange(24) / 12) ** 2)}


TEXTURED = {"wall": (0.1, 0.1), "wall_texture": (0.5, 1.0)}
PATTERN, LENGTH = 0.023, 1.0  # of the ratio by this wall [1], and where it falls to 1/e [mm]
PATTERN_FILM = np.array(
    6.0
)  # um: film whose ratio has this pattern; that of others by their derivative


class Row(NamedTuple):
    """What a rig has, and the widths that are stated of it."""

    changes: dict[str, object]
    widths: dict[str, float] = DEFAULTS
    pattern: float = 0.0  # rms of what stands still in the image


TABLE = {
    "nothing stated": Row(SMALL),
    "the same, minimum film of 2 to 8 um": Row(SMALL | MOVING),
    "the same, 320 x 256 pixels, 50 pairs": Row({}),
    "laboratory": Row(SMALL | real_rigs.LABORATORY, LABORATORY),
    "laboratory, field not stated": Row(
        SMALL | real_rigs.LABORATORY, LABORATORY | {"field": DEFAULTS["field"]}
    ),
    "laboratory, walls 10 %, texture of 50 %": Row(
        real_rigs.LABORATORY | TEXTURED, LABORATORY, PATTERN
    ),
    "nothing stated, walls 10 %, texture of 50 %": Row(TEXTURED, DEFAULTS, PATTERN),
}


def logarithms(film: np.ndarray, oil: DyedOil) -> np.ndarray:
    """Logarithms of the light of both bands, (band, ...)."""
    return np.log([filtered_light(film, band, oil=oil) for band in BANDS])


def by_film(film: np.ndarray, oil: DyedOil) -> np.ndarray:
    """Their derivatives by the film. [1/um]"""
    return (logarithms(film + STEP, oil) - logarithms(film - STEP, oil)) / (2 * STEP)


def by_oil(film: np.ndarray, oil: DyedOil, **changed: object) -> np.ndarray:
    """Their derivatives by a change of the oil or of the wall, which comes with `STEP`."""
    return (logarithms(film, replace(oil, **changed)) - logarithms(film, oil)) / STEP


def by_wall(film: np.ndarray, oil: DyedOil) -> np.ndarray:
    """Their derivatives by the reflectance of the wall."""
    return by_oil(film, oil, reflectance=oil.reflectance + STEP)


class Blocks(NamedTuple):
    """Films (frame, block) in um, places from -1 to 1, light (band, frame, block), and the oil."""

    film: np.ndarray
    u: np.ndarray
    v: np.ndarray
    light: np.ndarray  # electrons
    oil: DyedOil  # with the wall of the joint

    @classmethod
    def of(cls, rig: RigSettings, film: np.ndarray, u: np.ndarray, v: np.ndarray) -> Blocks:
        x, y = (u + 1) * rig.centre[0], (v + 1) * rig.centre[1]
        oil = DyedOil(reflectance=rig.wall[1])
        relative = np.exp(logarithms(film, oil) - logarithms(np.array(200.0), oil)[:, None, None])
        full = rig.light * np.array(rig.thick_film_signal)[:, None, None]
        return cls(film, u, v, full * beam(x, y, rig) * relative, oil)


def curve_errors(rig: RigSettings, film: np.ndarray, oil: DyedOil) -> tuple[np.ndarray, np.ndarray]:
    """Derivatives of the log ratio by ln K, p and q, and their covariance by the fixture.

    The model is r = K p/q (1 - exp(-q t)) / (1 - exp(-p t)).
    """

    def predict(at: np.ndarray, of: np.ndarray) -> np.ndarray:
        k, p, q = at
        return k + np.log(p / q * np.expm1(-q * of) / np.expm1(-p * of))

    wedge = np.linspace(*rig.wedge, rig.width)
    true = np.diff(logarithms(wedge, oil), axis=0)[0]
    at = scipy.optimize.least_squares(lambda k: predict(k, wedge) - true, [true[0], 0.4, 0.25]).x
    steps = STEP * np.eye(3)
    acts, own = (
        np.array([(predict(at + s, of) - predict(at - s, of)) / (2 * STEP) for s in steps])
        for of in (film, wedge)
    )
    relative = np.exp(logarithms(wedge, oil) - logarithms(np.array([200.0]), oil))
    electrons = np.array(rig.thick_film_signal)[:, None] * relative
    noise = (1 / electrons).sum(axis=0) / (rig.height * rig.fixture_frames)
    return acts, np.linalg.inv(own / noise @ own.T)


def list_errors(
    width: dict[str, float], rig: RigSettings, at: Blocks, typical: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Derivatives of the log light by all errors, (error, band, frame, block), and covariance.

    `typical` is the median light of both cameras [electron].
    """
    film, u, v, light, oil = at
    passed = np.linspace(0, 1, len(film))[:, None] * np.ones(film.shape)
    slope, one = by_film(film, oil), np.ones(film.shape)
    second, first = np.stack([0 * one, one]), np.stack([one, 0 * one])
    both = by_oil(film, oil, left=(1 + STEP, 1 + STEP))
    legendre = (3**0.5 * u, 3**0.5 * v, 3 * u * v, *(5**0.5 * (1.5 * n**2 - 0.5) for n in (u, v)))
    pixel = (rig.wedge[1] - rig.wedge[0]) / rig.width  # um of the wedge
    listed = [
        *((width[key], second) for key in ("ratio", "lag", "temperature")),
        *((width[key], second * passed) for key in ("temperature", "bleaching")),
        (width["bleaching"], -both * passed),
        (width["batch"], both),
        (width["batch"], by_oil(film, oil, left=(1.0, 1 + STEP))),
        (width["wall"], by_wall(film, oil)),
        *((width["linearity"], -light / FULL * side) for side in (first, second)),
        *((width["field"] / 5**0.5, second * shape) for shape in legendre),
        (width["position"] * pixel, slope),
        (width["size"], film * slope),
        *((width["background"], typical[:, None, None] / light * side) for side in (first, second)),
    ]
    covariance = np.diag([std**2 for std, _ in listed])
    covariance[-1, -2] = covariance[-2, -1] = 0.9 * width["background"] ** 2
    acts, fitted = curve_errors(rig, film, oil)
    table = [acts for _, acts in listed] + [np.stack([0 * each, each]) for each in acts]
    return np.array(table), scipy.linalg.block_diag(covariance, fitted)


def pattern_unknowns(row: Row, rig: RigSettings, at: Blocks) -> tuple[np.ndarray, np.ndarray]:
    """Derivatives of the log light by the pattern of each block, and covariance of these."""
    frames, blocks = at.film.shape
    acts = np.zeros((blocks, 2, frames, blocks))
    typical = np.diff(by_wall(PATTERN_FILM, at.oil), axis=0)[0]
    of_wall = by_wall(at.film, at.oil) / typical
    acts[np.arange(blocks), ..., np.arange(blocks)] = of_wall.transpose(2, 0, 1)
    covariance = np.full((blocks, blocks), row.pattern**2)
    sides = ((at.u, rig.field_width, COLUMNS), (at.v, rig.height * rig.pitch, ROWS))
    for place, side, count in sides:
        seen = LENGTH**2 + (side / count) ** 2 / 3
        apart = np.subtract.outer(place, place) * side / 2
        covariance *= LENGTH / np.sqrt(seen) * np.exp(-(apart**2) / seen)
    return acts, covariance


def gap_unknowns(rig: RigSettings, at: Blocks, marks: float) -> np.ndarray:
    """Change of the films with all unknowns of the gap at their width, (unknown, frame, block)."""
    frames, blocks = at.film.shape
    place = at.u * rig.centre[0] * rig.pitch - rig.thin_line
    phi = place / np.sqrt(rig.pin_radius * rig.bushing_radius)
    cosine, sine, u, v = np.cos(phi), np.sin(phi), at.u, at.v
    motion = FREE * np.stack([cosine, sine, v * cosine, v * sine])
    moving = np.concatenate([motion, BEND * u[None] ** 2])
    powers = ((2, 0), (0, 2), (3, 0), (2, 1), (1, 2), (0, 3), (4, 0))
    round_off = [ROUNDNESS * u**a * v**b for a, b in powers]
    form = np.concatenate([[CLEARANCE * (1 - cosine)], round_off, marks * np.eye(blocks)])
    by_pin = np.einsum("fg,mc->fmgc", np.eye(frames), moving).reshape(-1, frames, blocks)
    return np.concatenate([by_pin, np.repeat(form[:, None], frames, axis=1)])


def information_of(
    rig: RigSettings, at: Blocks, by_unknown: np.ndarray, seen: np.ndarray, *, steady: bool
) -> np.ndarray:
    """Fisher information of log ratio and light in the blocks `seen`, (unknown, unknown).

    The beam is `steady`, or changes from pulse to pulse up to the second degree over the picture.
    """
    frames, blocks = at.film.shape
    pixels = rig.width * rig.height / blocks
    ratio = np.diff(by_unknown, axis=1)[:, 0].reshape(len(by_unknown), -1)
    weight = (seen / ((1 / at.light).sum(axis=0) / pixels + EXCESS**2)).ravel()
    found = ratio * weight @ ratio.T

    # pulse energy and beam are unknown
    u, v = at.u, at.v
    shapes = np.stack([np.ones_like(u), u, v, u * u, u * v, v * v][: 1 if steady else None])
    light = by_unknown[:, 0].reshape(len(by_unknown), -1)
    grain = 4 * np.pi * rig.speckle_size**2  # pixel
    weight = (pixels * seen / (rig.speckle_new**2 * grain + 1 / at.light[0])).ravel()
    free = [np.kron(np.eye(frames), shapes), np.tile(np.eye(blocks), frames)]
    own = np.concatenate(free)
    known = own * weight @ own.T + np.eye(len(own)) / FREE**2
    mixed = light * weight @ own.T
    return found + light * weight @ light.T - mixed @ np.linalg.solve(known, mixed.T)


def patch_information(
    row: Row, rig: RigSettings, frames: int, typical: np.ndarray, root: np.ndarray
) -> np.ndarray:
    """Fisher information of the log ratio of the patch, whose film is the last unknown.

    `root` is that of the covariance of all errors, (error, error).
    """
    (left, right), (top, bottom) = rig.patch
    u = np.array([(left + right) / rig.field_width - 1])
    v = np.array([(top + bottom) / (rig.height * rig.pitch) - 1])
    film = np.full((frames, 1), rig.reference)
    patch = Blocks.of(rig, film, u, v)

    of_errors = list_errors(row.widths, rig, patch, typical)[0]
    acts = np.einsum("ebfc,en->nbfc", of_errors, root[: len(of_errors)])
    # what stands still on the patch looks like another film of it
    slope = by_film(film, patch.oil)
    over = row.pattern**2
    for side in (right - left, bottom - top):
        places = np.linspace(0, side, 50)
        over *= np.exp(-((np.subtract.outer(places, places) / LENGTH) ** 2)).mean()
    film_std = np.hypot(PATCH_STD, np.sqrt(over) / np.diff(slope, axis=0)[0, 0, 0])
    acts = np.concatenate([acts, film_std * slope[None]])
    ratio = np.diff(acts, axis=1)[:, 0, :, 0]
    pixels = (right - left) * (bottom - top) / rig.pitch**2
    noise = (1 / patch.light).sum(axis=0)[:, 0] / pixels + PATCH_EXCESS**2
    return ratio / noise @ ratio.T


def bounds(
    row: Row, rig: RigSettings, maps: np.ndarray, inside: np.ndarray, seed: int
) -> np.ndarray:
    """Standard deviations by widths, and three bounds: in the region, in the picture, and in the
    region by a steady beam, (4, film). [um]
    """
    shape = (ROWS, rig.height // ROWS, COLUMNS, rig.width // COLUMNS)
    rows, columns = np.linspace(-1, 1, rig.height), np.linspace(-1, 1, rig.width)
    y, x = np.indices(maps.shape[1:], dtype=float)
    grids = (*np.meshgrid(columns, rows), draw_marks(rig, random_stream(seed, "marks"))(x, y))
    u, v, marks = (each.reshape(shape).mean(axis=(1, 3)).ravel() for each in grids)
    film = maps.reshape(-1, *shape).mean(axis=(2, 4)).reshape(len(maps), -1)
    region = inside.reshape(shape).all(axis=(1, 3)).ravel()
    at = Blocks.of(rig, film, u, v)
    typical = np.median(at.light[:, :, region], axis=(1, 2))
    acts, covariance = list_errors(row.widths, rig, at, typical)
    if row.pattern:
        more, known = pattern_unknowns(row, rig, at)
        acts, covariance = np.concatenate([acts, more]), scipy.linalg.block_diag(covariance, known)
    root = np.linalg.cholesky(covariance + 1e-18 * np.eye(len(covariance)))  # widths may be zero
    acts = np.einsum("ebfc,en->nbfc", acts, root, optimize=True)

    errors = np.eye(len(root) + 1)
    if rig.reference:
        errors += patch_information(row, rig, len(maps), typical, root)

    slope = by_film(film, at.oil)
    of_error = np.concatenate([acts, 0 * acts[:1]])
    by_error = np.diff(of_error, axis=1)[:, 0] / np.diff(slope, axis=0)[0]
    of_gap = gap_unknowns(rig, at, float(marks.std()))
    by_unknown = np.concatenate([of_gap[:, None] * slope, of_error])
    prior = scipy.linalg.block_diag(np.eye(len(of_gap)), errors)
    found = [read_films(film, region, by_error, np.linalg.inv(errors))]
    for chosen, steady in ((region, False), (np.ones_like(region), False), (region, True)):
        usable = chosen & (film < 0.8 * rig.wedge[1])
        shown = information_of(rig, at, by_unknown, usable, steady=steady)
        posterior = np.linalg.inv(prior + shown)
        found.append(read_films(film, region, by_error, posterior[len(of_gap) :, len(of_gap) :]))
    return np.array(found)


def read_films(
    film: np.ndarray, region: np.ndarray, by_error: np.ndarray, covariance: np.ndarray
) -> list[float]:
    """Median standard deviation near each film, and that of the mean film, in the middle third."""
    middle = slice(len(film) // 3, 2 * (len(film) // 3) + 1)
    of, chosen = film[middle], by_error[:, middle]
    variance = np.einsum("nfc,nm,mfc->fc", chosen, covariance, chosen, optimize=True)
    near = [np.sqrt(variance[np.abs(of / one - 1) < NEAR]) for one in MICROMETRES]
    mean = chosen[..., region].mean(axis=-1)
    of_mean = np.sqrt(np.einsum("nf,nm,mf->f", mean, covariance, mean))
    return [float(np.median(each)) for each in (*near, of_mean)]


def stated(film: xr.Dataset, maps: np.ndarray) -> list[float]:
    """The same as a film states them. [um]"""
    third = len(maps) // 3
    middle = slice(third, 2 * third + 1)
    true, std = maps[middle], film.thickness_std_shared.values[middle]
    valid = film["flags"].values[middle] == 0
    near = [std[valid & (np.abs(true / one - 1) < NEAR)] for one in MICROMETRES]
    return [float(np.median(each)) for each in (*near, film.film_mean_std.values[middle])]


def measure(name: str, seed: int) -> None:
    """Photograph a rig, and print its row."""
    row = TABLE[name]
    rig = RigSettings(write_systematics=False, **row.changes)
    with tempfile.TemporaryDirectory() as scratch:
        out = Path(scratch)
        simulate(out, seed=seed, rig=rig)
        if rig.reference:
            real_rigs.state_laboratory(out, rig, field=row.widths["field"] < DEFAULTS["field"])
        film = erlif.process(out / "run")
        with xr.open_dataset(out / "truth.nc", engine="h5netcdf") as truth:
            maps = truth.film.values
        inside = real_rigs.region_of(rig, film)
        by_widths, bound, whole, steady = bounds(row, rig, maps, inside, seed)
        found = np.array(stated(film, maps))
    columns = {"widths": by_widths, "bound": bound, "whole picture": whole}
    columns |= {"steady beam": steady, "stated": found}
    parts = [f"{key} {' '.join(f'{1e3 * n:4.0f}' for n in part)}" for key, part in columns.items()]
    over = " ".join(f"{n:.2f}" for n in found / bound)
    print(f"{name:38s} {seed}  {'   '.join(parts)}   stated/bound {over}", flush=True)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", default="", help="rows whose name contains this text")
    parser.add_argument("--seeds", type=int, nargs="+", default=[5])
    options = parser.parse_args()
    warnings.simplefilter("ignore")  # medians of films that a rig does not have
    for name in TABLE:
        for seed in options.seeds if options.only in name else ():
            measure(name, seed)


if __name__ == "__main__":
    main()
