"""The directory of a simulation: written whole, and never in the place of something else.

It holds what a laboratory writes: a fixture, a run, and the truth beside them.
"""

from __future__ import annotations

import dataclasses
import math
import re
import shutil
import tempfile
from collections.abc import Iterable
from functools import lru_cache, partial
from os import PathLike
from pathlib import Path

import h5netcdf
import numpy as np
import tifffile

from erlif.core.arrays import Array, Counts
from erlif.core.errors import ModelError, OutputError
from erlif.core.progress import Progress, ShowProgress, choose_progress
from erlif.core.tables import fill_template
from erlif.rig.camera import FULL_SCALE, alter_camera, expose, vibrate
from erlif.rig.dyes import BANDS, DyedOil, signals_of
from erlif.rig.film import (
    Bubbles,
    Field,
    Gap,
    Triggers,
    Wedge,
    draw_bubbles,
    draw_marks,
    lay_patch,
    list_pictures,
)
from erlif.rig.journal import list_gaps
from erlif.rig.logger import TICKS, frame_times, read_encoder, write_log_in_time, write_table
from erlif.rig.settings import RigSettings
from erlif.rig.setup import Setup, Shot, build_setup, mix_grains, photograph, random_stream
from erlif.rig.truth import Session, describe_truth, write_true_film

# Names that a simulation writes into its directory.
WRITTEN = ("fixture", "fixture_after", "run", "truth.nc")

# Files that a simulation writes, and those that the commands write beside them by default.
_OWN = re.compile(
    r"truth\.nc"
    r"|(run|fixture(_after)?)/camera[12]/frame_\d+\.tif"
    r"|(run|fixture(_after)?)/camera[12]_(dark|flat|background)\.tif"
    r"|run/(run\.toml|bore\.csv|encoder\.\w+)|fixture(_after)?/(fixture\.toml|profile\.csv)"
    r"|run/(\.?film\.(nc|zarr)[^/]*(/.*)?|figures/.*|report\.html)"
    r"|fixture(_after)?/calibration\.\w+"
)

_HDF5 = b"\x89HDF\r\n\x1a\n"


def simulate(
    out: str | Path,
    *,
    seed: int = 0,
    rig: RigSettings | None = None,
    overwrite: bool = False,
    progress: ShowProgress = None,
) -> Path:
    """Photograph a known film with two virtual cameras, and a wedge to calibrate them with.

    Parameters
    ----------
    out : path
        Directory that receives ``fixture/`` and ``run/`` as the laboratory would have written
        them, and ``truth.nc`` with the film, the displacement between the cameras and all other
        inputs of the simulation.
    seed : int
        The same seed and settings write the same bytes.
    rig : RigSettings, optional
        The rig and its run; the defaults describe the joint of the thesis.
    overwrite : bool
        Replace ``fixture``, ``run`` and ``truth.nc`` as a whole once the new ones are complete.
    progress : "bar", bool or callable, optional
        "bar" or True shows bars; a function is called after each frame with the kind of frame, its
        number from 1, and their total.

    Returns
    -------
    Path
        `out`.

    Raises
    ------
    OutputError
        If something of that name exists and `overwrite` is not set, or the directory cannot be
        written.
    ModelError
        If the settings describe no rig that could work.

    Examples
    --------
    A run of six triggers, 8 degrees apart, has six frame pairs:

    >>> rig = RigSettings(width=64, height=48, spacing=8.0, fixture_frames=1)
    >>> with tempfile.TemporaryDirectory() as directory:
    ...     out = simulate(Path(directory), seed=1, rig=rig)
    ...     print(len(list((out / "run" / "camera1").iterdir())))
    6
    """
    report = choose_progress(progress)
    if not isinstance(out, str | PathLike):
        raise OutputError(
            f"Expected the path of a directory as out=, got {type(out).__name__}. Name a directory."
        )
    if rig is not None and not isinstance(rig, RigSettings):
        raise ModelError(
            f"Expected erlif.rig.RigSettings as rig=, got {type(rig).__name__}. Write "
            "rig=erlif.rig.RigSettings(width=256, height=192)."
        )
    out = Path(out)
    existing = [name for name in WRITTEN if (out / name).exists()]
    if existing and not overwrite:
        raise OutputError(
            f"{out} holds {', '.join(existing)} already; choose another directory or pass "
            "--overwrite."
        )
    _refuse_foreign(out, existing)

    # the old directories stay until the new ones are complete
    try:
        out.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix=".simulate-", dir=out) as scratch:
            write_rig(Path(scratch), seed=seed, rig=rig or RigSettings(), progress=report)
            for name in existing:
                shutil.rmtree(out / name) if (out / name).is_dir() else (out / name).unlink()
            for path in Path(scratch).iterdir():
                path.rename(out / path.name)
    except OSError as error:
        raise OutputError(
            f"{out} could not be written: {error.strerror or error}. Choose another directory, or "
            "make room."
        ) from error
    return out


def _refuse_foreign(out: Path, existing: list[str]) -> None:
    """Refuse to replace a directory with a file in it that no command has written."""
    places = [path for name in existing for path in (out / name, *(out / name).rglob("*"))]
    files = [path for path in places if path.is_symlink() or not path.is_dir()]
    foreign = [path for path in files if not _OWN.fullmatch(path.relative_to(out).as_posix())]

    truth = out / "truth.nc"
    if truth in files:
        with truth.open("rb") as file:
            foreign += [truth] if file.read(len(_HDF5)) != _HDF5 else []
    if foreign:
        raise OutputError(
            f"Expected nothing but an earlier simulation in {out}; "
            f"{foreign[0].relative_to(out).as_posix()} is something else, which --overwrite does "
            "not remove. Move it away, or choose another directory."
        )


# Mean energy of a pulse, as the meter in encoder.csv reports it. [mJ]
LASER_ENERGY = 50.0

_METER_NOISE = 0.005  # relative standard deviation of the energy meter
_TEMPERATURE = (25, 0.2)  # degree_Celsius: mean, and amplitude over the run
_CMM_STEPS = 10  # readings per mm
_CMM_MARGIN = 5  # readings beyond the picture on each side
_SMALLEST_UNCERTAINTY = 0.01  # um: a CMM states no uncertainty of zero
_EVERY = 4  # pixel: step of the grid on which the median light is taken
_REFERENCE_STD = 0.02  # um: uncertainty of the reference film
_PATCH_EDGE = 2  # pixel: margin of the region named in run.toml within the patch
_SESSION = 1_000_000  # frames of a fixture at most, so that those of two sessions differ
_COMPRESSION = 3  # of zlib: higher levels are slower and compress noise no better


# Name of the run by the mechanism.
_NAMES = {
    "crank-rocker": "straight bushing",
    "slider-crank": "crank pin",
    "rotation": "pin on disc",
    "sinusoidal": "slider",
    "static": "static film",
}

# the directories


def write_rig(out: Path, *, seed: int, rig: RigSettings, progress: Progress) -> None:
    """Write `out`/fixture, `out`/run and `out`/truth.nc into an empty directory."""
    setup = build_setup(seed, rig)
    drift = write_fixture(out / "fixture", setup, seed, progress)
    write_run(out / "run", out / "truth.nc", setup, seed, drift, progress)
    if rig.fixture_after:
        last = frame_times(list_pictures(rig), rig).size - 1
        same_wall = dataclasses.replace(rig, wall=(rig.wall[0], rig.wall[0]))
        aged = age(dataclasses.replace(setup, rig=same_wall, texture=None), last, last + 1)
        write_fixture(out / "fixture_after", aged, seed, progress, session=1)
        shutil.copy(out / "fixture" / "profile.csv", out / "fixture_after")


def write_fixture(
    directory: Path, setup: Setup, seed: int, progress: Progress, *, session: int = 0
) -> Array:
    """Write a session of the calibration fixture.

    Returns the drift of camera 2, (frame, axis x y). [pixel]
    """
    rig = setup.rig
    wedge = Wedge(rig)
    rng = random_stream(seed, "fixture", session)
    drift = vibrate(rig.fixture_frames, rig, rng) + rig.fixture_offset
    no_bubbles = Bubbles(*np.empty((3, 0)))

    write_reference_pages(directory, setup, random_stream(seed, "fixture pages", session))
    for k in range(rig.fixture_frames):
        rng_frame = random_stream(seed, "fixture frame", session * _SESSION + k)
        energy = 1 + rig.pulse_jitter * rng_frame.standard_normal()
        grains = mix_grains(setup.grains, rig, rng_frame)
        shot = Shot(wedge, no_bubbles, grains, energy, (drift[k, 0], drift[k, 1]))
        write_pair(directory, k, photograph(setup, shot, rng_frame))
        progress("fixture frame", k + 1, rig.fixture_frames)

    write_profile(directory / "profile.csv", wedge, rng)
    bands = BANDS if rig.dyes is None else rig.dyes.bands
    settings = fill_template("erlif.rig", "fixture.toml", rig=rig, bands=bands, background=False)
    (directory / "fixture.toml").write_text(settings, encoding="utf-8")
    return drift


def write_run(
    directory: Path, truth: Path, setup: Setup, seed: int, fixture_drift: Array, progress: Progress
) -> None:
    """Write the run, and its film into `truth`."""
    rig = setup.rig
    triggers = list_pictures(rig)
    frames = frame_times(triggers, rig).size

    # the order of the draws belongs to the bytes of a seed
    rng = random_stream(seed, "run")
    drift = vibrate(frames, rig, rng)
    energy = 1 + rig.pulse_jitter * rng.standard_normal(frames)
    marks = draw_marks(rig, random_stream(seed, "marks"))
    gaps = list_gaps(triggers, rig, marks)
    if rig.rough:
        setup = dataclasses.replace(setup, roughness=np.sqrt(2) * rig.roughness)
    setup = dataclasses.replace(setup, typical=median_light(setup, gaps))

    drift[int(rig.bump[0]) :] += rig.bump[1:]
    write_reference_pages(directory, setup, random_stream(seed, "run pages"))
    write_background_pages(directory, setup, random_stream(seed, "run background"))
    one, two = (alter_camera(each, n, rig) for n, each in enumerate(setup.cameras, 1))
    setup = dataclasses.replace(setup, cameras=(one, two))
    last: list[Array | None] | None = [None, None] if any(rig.lag) else None
    with h5netcdf.File(truth, "w", locking=False) as file:
        describe_truth(file, setup, triggers, gaps, Session(drift, fixture_drift, energy), seed)
        write_true_film(file, setup, gaps)
        for k in range(frames):
            rng_frame = random_stream(seed, "run frame", k)
            bubbles = draw_bubbles(rig, rng_frame)
            shot = Shot(
                film=partial(_patched, gaps[k % len(gaps)], rig),
                bubbles=bubbles,
                grains=mix_grains(setup.grains, rig, rng_frame),
                energy=float(energy[k]),
                drift=(drift[k, 0], drift[k, 1]),
            )
            write_pair(directory, k, photograph(age(setup, k, frames), shot, rng_frame, last=last))
            file["bubble"][k] = bubbles.lack(setup.x, setup.y) > 0
            progress("run frame", k + 1, frames)

    if rig.log == "continuous":
        write_log_in_time(directory / "encoder.csv", triggers, rig, _TEMPERATURE[0])
    elif rig.mechanism != "static":
        write_encoder_log(directory / "encoder.csv", triggers, rig, energy, rng)
    if rig.profile is not None:
        place = np.linspace(-0.5, 0.5, len(rig.profile)) * rig.length
        columns = {"axial_mm": (place, "%.5f"), "depth_um": (np.array(rig.profile), "%.4f")}
        write_table(directory / "bore.csv", columns)
    (directory / "run.toml").write_text(run_toml(rig, triggers), encoding="utf-8")


def _patched(film: Field, rig: RigSettings, x: Array, y: Array) -> Array:
    """Film at object points [pixel], with the patch of the reference film in it. [um]"""
    return lay_patch(film(x, y), x, y, rig)


def median_light(setup: Setup, gaps: list[Gap]) -> tuple[float, float]:
    """Median light of each camera over the run, at a pulse of energy 1. [electron]"""
    x, y = setup.x[::_EVERY, ::_EVERY], setup.y[::_EVERY, ::_EVERY]
    films = [gap(x, y) for gap in gaps]
    one, two = (
        float(np.median([setup.light(number, film, x, y) for film in films])) for number in (1, 2)
    )
    return one, two


def age(setup: Setup, pulse: int, pulses: int) -> Setup:
    """The set-up at a pulse of the run: joint, dyes and camera 2 as they are by then."""
    rig = setup.rig
    one, two = rig.bleaching
    warmer = rig.warming * pulse / max(pulses - 1, 1)
    oil = DyedOil(
        left=(rig.batch[0] * (1 - one) ** pulse, rig.batch[1] * (1 - two) ** pulse),
        glow=(1 + rig.glow_per_kelvin[0] * warmer, 1 + rig.glow_per_kelvin[1] * warmer),
        reflectance=rig.wall[1],
    )
    if oil != DyedOil(reflectance=rig.wall[0]):
        setup = dataclasses.replace(setup, signals=_signals(rig.dyes, oil))
    if setup.texture is not None:
        walls = (dataclasses.replace(oil, reflectance=n * rig.wall[1]) for n in range(3))
        signals = tuple(_signals(rig.dyes, wall) for wall in walls)
        textured = dataclasses.replace(setup.texture, signals=signals)
        setup = dataclasses.replace(setup, texture=textured)
    first, second = setup.cameras
    (start, factor), (since, rise) = rig.gain_step, rig.dark_step
    if factor != 1 and pulse >= start:
        second = dataclasses.replace(second, sensitivity=factor * second.sensitivity)
    if rise != 0 and pulse >= since:
        second = dataclasses.replace(second, dark_level=second.dark_level + rise)
    if rig.blur_step[1] and pulse >= rig.blur_step[0]:
        blur = (rig.blur[0], math.hypot(rig.blur[1], rig.blur_step[1]))
        setup = dataclasses.replace(setup, rig=dataclasses.replace(rig, blur=blur))
    return dataclasses.replace(setup, cameras=(first, second))


# a joint whose wall differs from the fixture's has one oil in all its frames, before three walls
_signals = lru_cache(maxsize=4)(signals_of)


def write_background_pages(directory: Path, setup: Setup, rng: np.random.Generator) -> None:
    """Write the frames of the dry joint under the laser, if there are to be any."""
    rig = setup.rig
    if rig.background_pages == 0:
        return
    for number, camera in enumerate(setup.cameras, start=1):
        energy = 1 + rig.pulse_jitter * rng.standard_normal(rig.background_pages)
        energy *= rig.background_energy
        light = setup.background(number, setup.x, setup.y)
        write_pages(
            directory / f"camera{number}_background.tif",
            (expose(pulse * light, camera, rng) for pulse in energy),
        )


def write_pages(path: Path, pages: Iterable[Counts]) -> None:
    """Write one TIFF, page by page; its bytes depend on neither date nor version."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with tifffile.TiffWriter(path) as file:
        for page in pages:
            file.write(
                page,
                photometric="minisblack",
                compression="zlib",
                compressionargs={"level": _COMPRESSION},
                metadata=None,
                software=False,
                contiguous=False,
            )


def write_pair(directory: Path, k: int, frames: tuple[Counts, Counts]) -> None:
    """Write frame `k` of both cameras."""
    for number in (1, 2):
        write_pages(directory / f"camera{number}" / f"frame_{k:04d}.tif", [frames[number - 1]])


def write_reference_pages(directory: Path, setup: Setup, rng: np.random.Generator) -> None:
    """Write darks with the shutter closed, and flats under an even lamp at rising levels."""
    rig = setup.rig
    for number, camera in enumerate(setup.cameras, start=1):
        write_pages(
            directory / f"camera{number}_dark.tif",
            (expose(0.0, camera, rng) for _ in range(rig.dark_pages)),
        )
        largest = min(FULL_SCALE * rig.gain, camera.full_well)
        lamp = np.repeat(rig.flat_levels, rig.flat_pages) * largest
        write_pages(
            directory / f"camera{number}_flat.tif", (expose(level, camera, rng) for level in lamp)
        )


def write_profile(path: Path, wedge: Wedge, rng: np.random.Generator) -> None:
    """Write the wedge as a coordinate measuring machine reads it.

    Readings are 0.1 mm apart and extend a little beyond the picture.
    """
    rig = wedge.rig
    last = round(rig.field_width / 0.1) + _CMM_MARGIN
    x = np.arange(-_CMM_MARGIN, last + 1) / _CMM_STEPS
    thickness = wedge.profile(x / rig.pitch)
    x, thickness = x[thickness >= 0], thickness[thickness >= 0]
    read = thickness + rig.cmm_noise * rng.standard_normal(x.size)
    uncertainty = max(rig.cmm_noise, _SMALLEST_UNCERTAINTY)

    columns = {
        "x_mm": (x, "%.1f"),
        "thickness_um": (read, "%.5f"),
        "uncertainty_um": (np.full(x.size, uncertainty), "%.3f"),
    }
    write_table(path, columns)


def write_encoder_log(
    path: Path, triggers: Triggers, rig: RigSettings, energy: Array, rng: np.random.Generator
) -> None:
    """Write one row per trigger.

    The temperature drifts by 0.2 degree; the energy meter is good to half a per cent.
    """
    frames = energy.size
    time = frame_times(triggers, rig)
    reading = read_encoder(np.radians(triggers.crank_angle), triggers, rig).values
    digits, column = (0, "encoder [ticks]") if rig.reading == "ticks" else (4, "angle_deg")
    mean, amplitude = _TEMPERATURE
    temperature = mean + amplitude * np.sin(
        2 * np.pi * np.arange(frames) / frames + rng.uniform(0, 2 * np.pi)
    )
    temperature += rig.warming * np.arange(frames) / max(frames - 1, 1)
    meter = LASER_ENERGY * energy * (1 + _METER_NOISE * rng.standard_normal(frames))

    columns = {
        "frame": (np.arange(frames), "%d"),
        "time_s": (time, "%.6f"),
        column: (np.resize(reading, frames), f"%.{digits}f"),
        "load_N": (np.resize(triggers.load, frames), "%.3f"),
        "temperature_C": (temperature, "%.2f"),
        "laser_mJ": (meter, "%.2f"),
    }
    write_table(path, columns)


def run_toml(rig: RigSettings, triggers: Triggers) -> str:
    """Return run.toml of the virtual run."""
    (first, last), (upper, lower) = rig.patch
    edge = _PATCH_EDGE * rig.pitch
    return fill_template(
        "erlif.rig",
        "run.toml",
        rig=rig,
        name=_NAMES[rig.mechanism],
        bands=BANDS if rig.dyes is None else rig.dyes.bands,
        background=rig.background_pages > 0,
        zero=read_encoder(np.radians(triggers.crank_angle), triggers, rig).zero,
        # frames at even crank angles need not repeat; without a linkage only cycles do
        folded=not rig.pulses_per_cycle if rig.linked else rig.cycles > 1,
        triggers=triggers.reading.size,
        ticks=TICKS,
        load_line=rig.centre[0] * rig.pitch + rig.thin_line,
        roi=(*rig.region[0], *rig.region[1]),
        patch=(first + edge, last - edge, upper + edge, lower - edge),
        reference_std=_REFERENCE_STD,
    )
