"""Writes what the laboratory would have written: a fixture directory, a run directory, and the truth beside them."""

import csv
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass
from importlib.metadata import version
from pathlib import Path

import h5netcdf
import numpy as np
import tifffile
from numpy.typing import NDArray

from erlif.core.arrays import Array, Counts
from erlif.rig.camera import (
    FULL_SCALE,
    Camera,
    build_camera,
    displacement,
    expose,
    seen_from_camera_2,
    vibrate,
    vignetting,
)
from erlif.rig.dyes import BANDS, tabulate_signal
from erlif.rig.film import (
    Bubbles,
    Field,
    Gap,
    Marks,
    Triggers,
    Wedge,
    draw_bubbles,
    draw_marks,
    list_triggers,
)
from erlif.rig.scene import Grains, beam, draw_grains, mix_grains, speckle
from erlif.rig.settings import RigSettings

Progress = Callable[[str, int, int], None]
"""Told what was written, how many of it, and of how many."""

STREAMS = (
    "camera 1",
    "camera 2",
    "marks",
    "grains",
    "run",
    "fixture",
    "run frame",
    "fixture frame",
    "run pages",
    "fixture pages",
)
"""What has random numbers of its own. A new stream goes to the end, so that the old ones keep theirs."""

LASER_ENERGY = 50.0
"""Mean energy of a pulse, as the meter in encoder.csv reports it. [mJ]"""


def random_stream(seed: int, name: str, number: int = 0) -> np.random.Generator:
    """Random numbers of one purpose and frame, whatever was drawn before."""
    return np.random.default_rng(
        np.random.SeedSequence(seed, spawn_key=(STREAMS.index(name), number))
    )


# the optical set-up


@dataclass(frozen=True)
class Setup:
    """Everything that stays the same from frame to frame."""

    rig: RigSettings
    cameras: tuple[Camera, Camera]
    signals: tuple[Callable[[Array], Array], Callable[[Array], Array]]
    grains: Grains
    x: Array
    y: Array
    """Pixel centres, (y, x). [pixel]"""

    def light(self, number: int, film: Array, x: Array, y: Array) -> Array:
        """Electrons that the film at object points (x, y) sends camera `number`, without lens, speckle and jitter."""
        scale = self.rig.light * self.rig.thick_film_signal[number - 1]
        return np.asarray(scale * beam(x, y, self.rig) * self.signals[number - 1](film))


def build_setup(seed: int, rig: RigSettings) -> Setup:
    """Draw the cameras and the fixed speckle of one laboratory."""
    y, x = np.indices((rig.height, rig.width), dtype=np.float64)
    farthest = (
        np.abs(np.stack(displacement(x, y, rig))).max()
        + np.abs(rig.fixture_offset).max()
        + 6 * rig.vibration
    )
    return Setup(
        rig=rig,
        cameras=(
            build_camera(1, rig, random_stream(seed, "camera 1")),
            build_camera(2, rig, random_stream(seed, "camera 2")),
        ),
        signals=(tabulate_signal(BANDS[0]), tabulate_signal(BANDS[1])),
        grains=draw_grains(rig, int(np.ceil(farthest)) + 8, random_stream(seed, "grains")),
        x=x,
        y=y,
    )


@dataclass(frozen=True)
class Shot:
    """What one laser pulse met."""

    film: Field
    bubbles: Bubbles
    grains: Grains
    energy: float
    """Relative pulse energy."""
    drift: tuple[float, float]
    """Extra shift (x, y) of camera 2. [pixel]"""


def photograph(setup: Setup, shot: Shot, rng: np.random.Generator) -> tuple[Counts, Counts]:
    """Return the frames of both cameras: the same pulse, the same object, two filters and two viewpoints.

    Speckle is seen through each camera's point spread; the film is smooth on that scale and taken as it is.
    """
    rig = setup.rig

    def expose_camera(number: int, rng: np.random.Generator) -> Counts:
        x, y = setup.x, setup.y
        if number == 2:
            x, y = seen_from_camera_2(x, y, shot.drift, rig)
        film = shot.bubbles.empty(shot.film(x, y), x, y)
        pattern = speckle(x, y, shot.grains, size=rig.speckle_size, blur=rig.blur[number - 1])
        light = shot.energy * np.maximum(pattern, 0) * setup.light(number, film, x, y)
        return expose(light, setup.cameras[number - 1], rng)

    with ThreadPoolExecutor(2) as pool:
        first, second = pool.map(expose_camera, (1, 2), rng.spawn(2))
    return first, second


# the directories


def write_rig(out: Path, *, seed: int, rig: RigSettings, progress: Progress) -> None:
    """Write `out`/fixture, `out`/run and `out`/truth.nc into an empty directory."""
    setup = build_setup(seed, rig)
    drift = write_fixture(out / "fixture", setup, seed, progress)
    write_run(out / "run", out / "truth.nc", setup, seed, drift, progress)


def write_fixture(directory: Path, setup: Setup, seed: int, progress: Progress) -> Array:
    """Write the calibration fixture's session; returns the drift (frame, axis x y) of camera 2. [pixel]"""
    rig = setup.rig
    wedge = Wedge(rig)
    rng = random_stream(seed, "fixture")
    drift = vibrate(rig.fixture_frames, rig, rng) + rig.fixture_offset
    no_bubbles = Bubbles(*np.empty((3, 0)))
    write_reference_pages(directory, setup, random_stream(seed, "fixture pages"))
    for k in range(rig.fixture_frames):
        rng_frame = random_stream(seed, "fixture frame", k)
        energy = 1 + rig.pulse_jitter * rng_frame.standard_normal()
        grains = mix_grains(setup.grains, rig, rng_frame)
        shot = Shot(wedge, no_bubbles, grains, energy, (drift[k, 0], drift[k, 1]))
        write_pair(directory, k, photograph(setup, shot, rng_frame))
        progress("fixture frame", k + 1, rig.fixture_frames)
    write_profile(directory / "profile.csv", wedge, rng)
    (directory / "fixture.toml").write_text(fixture_toml(rig), encoding="utf-8")
    return drift


def write_run(
    directory: Path, truth: Path, setup: Setup, seed: int, fixture_drift: Array, progress: Progress
) -> None:
    """Write the run and the truth about it."""
    rig = setup.rig
    triggers = list_triggers(rig)
    per_cycle = triggers.reading.size
    frames = per_cycle * rig.cycles
    rng = random_stream(seed, "run")
    drift = vibrate(frames, rig, rng)
    energy = 1 + rig.pulse_jitter * rng.standard_normal(frames)
    marks = draw_marks(rig, random_stream(seed, "marks"))
    write_reference_pages(directory, setup, random_stream(seed, "run pages"))
    with h5netcdf.File(truth, "w") as file:
        describe_truth(file, setup, triggers, seed, drift, fixture_drift, energy)
        write_true_film(file, setup, triggers, marks)
        for k in range(frames):
            rng_frame = random_stream(seed, "run frame", k)
            bubbles = draw_bubbles(rig, rng_frame)
            shot = Shot(
                film=Gap(rig, float(triggers.film_min[k % per_cycle]), marks),
                bubbles=bubbles,
                grains=mix_grains(setup.grains, rig, rng_frame),
                energy=float(energy[k]),
                drift=(drift[k, 0], drift[k, 1]),
            )
            write_pair(directory, k, photograph(setup, shot, rng_frame))
            file["bubble"][k] = bubbles.lack(setup.x, setup.y) > 0
            progress("run frame", k + 1, frames)
    write_encoder_log(directory / "encoder.csv", triggers, rig, energy, rng)
    (directory / "run.toml").write_text(run_toml(rig, triggers), encoding="utf-8")


def write_pages(path: Path, pages: Iterable[Counts]) -> None:
    """Write one TIFF, page by page; nothing in it depends on the day or on this program's version."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with tifffile.TiffWriter(path) as file:
        for page in pages:
            file.write(
                page,
                photometric="minisblack",
                compression="zlib",
                compressionargs={"level": 3},  # noise packs no better at higher levels, only later
                metadata=None,
                software=False,
                contiguous=False,
            )


def write_pair(directory: Path, k: int, frames: tuple[Counts, Counts]) -> None:
    """Write frame `k` of both cameras."""
    for number in (1, 2):
        write_pages(directory / f"camera{number}" / f"frame_{k:04d}.tif", [frames[number - 1]])


def write_reference_pages(directory: Path, setup: Setup, rng: np.random.Generator) -> None:
    """Write darks with the shutter closed, and flats under an even lamp, brighter level by level."""
    rig = setup.rig
    for number, camera in enumerate(setup.cameras, start=1):
        write_pages(
            directory / f"camera{number}_dark.tif",
            (expose(0.0, camera, rng) for _ in range(rig.dark_pages)),
        )
        lamp = np.repeat(rig.flat_levels, rig.flat_pages) * FULL_SCALE * rig.gain
        write_pages(
            directory / f"camera{number}_flat.tif", (expose(level, camera, rng) for level in lamp)
        )


def write_profile(path: Path, wedge: Wedge, rng: np.random.Generator) -> None:
    """Write the wedge as a coordinate-measuring machine finds it, every 0.1 mm and somewhat beyond the picture."""
    rig = wedge.rig
    x = np.arange(-5, round(rig.field_width / 0.1) + 6) / 10
    thickness = wedge.profile(x / rig.pitch)
    x, thickness = x[thickness >= 0], thickness[thickness >= 0]
    read = thickness + rig.cmm_noise * rng.standard_normal(x.size)
    uncertainty = max(rig.cmm_noise, 0.01)
    with path.open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["x_mm", "thickness_um", "uncertainty_um"])
        table.writerows(
            [f"{a:.1f}", f"{b:.5f}", f"{uncertainty:.3f}"] for a, b in zip(x, read, strict=True)
        )


def write_encoder_log(
    path: Path, triggers: Triggers, rig: RigSettings, energy: Array, rng: np.random.Generator
) -> None:
    """Write one row per trigger; the thermometer wanders by 0.2 degree, the energy meter is good to half a per cent."""
    frames = energy.size
    time = np.concatenate(
        [triggers.time + cycle * 60 / rig.crank_speed for cycle in range(rig.cycles)]
    )
    temperature = 25 + 0.2 * np.sin(
        2 * np.pi * np.arange(frames) / frames + rng.uniform(0, 2 * np.pi)
    )
    meter = LASER_ENERGY * energy * (1 + 0.005 * rng.standard_normal(frames))
    with path.open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["frame", "time_s", "angle_deg", "load_N", "temperature_C", "laser_mJ"])
        for k in range(frames):
            row = k % triggers.reading.size
            angle, load = f"{triggers.reading[row]:.4f}", f"{triggers.load[row]:.3f}"
            table.writerow(
                [k, f"{time[k]:.6f}", angle, load, f"{temperature[k]:.2f}", f"{meter[k]:.2f}"]
            )


# settings files


def camera_toml(rig: RigSettings) -> str:
    """Return the tables that run.toml and fixture.toml share."""
    tables = [
        f"""[camera{number}]
files = "camera{number}/*.tif"
band = "{BANDS[number - 1]:.0f} nm"
bit_depth = 12
dark = "camera{number}_dark.tif"
flat = "camera{number}_flat.tif"
gain = "{rig.gain:g} electron/DN"
read_noise = "{rig.read_noise:g} electron"
"""
        for number in (1, 2)
    ]
    tables.append(f"""[optics]
pixel_pitch = "{1e3 * rig.pitch:.10g} um"
x_axis = "sliding"
""")
    return "\n".join(tables)


def fixture_toml(rig: RigSettings) -> str:
    """Return fixture.toml of the virtual wedge."""
    return f"""[fixture]
name = "virtual wedge"
profile = "profile.csv"
origin = [0.0, 0.0]
direction = "0 deg"

{camera_toml(rig)}"""


def run_toml(rig: RigSettings, triggers: Triggers) -> str:
    """Return run.toml of the virtual run."""
    (left, right), (top, bottom) = rig.region
    zero = f'zero = "{triggers.zero:.6f} deg"\n' if rig.write_zero else ""
    return f"""calibration = "../fixture/calibration.nc"

[run]
name = "virtual straight bushing"

{camera_toml(rig)}
[encoder]
file = "encoder.csv"
mounted_on = "rocker"
{zero}triggers_per_cycle = {triggers.reading.size}

[mechanism]
kind = "crank-rocker"
crank = "{rig.crank:g} cm"
coupler = "{rig.coupler:g} cm"
rocker = "{rig.rocker:g} cm"
ground = "{rig.ground:g} cm"
crank_speed = "{rig.crank_speed:g} rpm"

[joint]
pin_radius = "{rig.pin_radius:g} mm"
bushing_radius = "{rig.bushing_radius:g} mm"
length = "237 mm"
load = "{rig.load:g} N"
pin = {{ youngs_modulus = "2.7 GPa", poissons_ratio = 0.37, roughness = "0.2 um" }}
bushing = {{ youngs_modulus = "2.7 GPa", poissons_ratio = 0.37, roughness = "0.2 um" }}

[oil]
name = "80W-90"
viscosity = "0.12 Pa s"
pressure_viscosity = "20 1/GPa"

[thickness]
roi = {{ x = [{left:g}, {right:g}], y = [{top:g}, {bottom:g}] }}
"""


# truth


def describe_truth(
    file: h5netcdf.File,
    setup: Setup,
    triggers: Triggers,
    seed: int,
    drift: Array,
    fixture_drift: Array,
    energy: Array,
) -> None:
    """Write everything of truth.nc that is small, and make room for the mask of bubbles."""
    rig = setup.rig
    per_cycle, frames = triggers.reading.size, energy.size
    file.dimensions = {
        "trigger": per_cycle,
        "frame": frames,
        "fixture_frame": rig.fixture_frames,
        "camera": 2,
        "y": rig.height,
        "x": rig.width,
    }
    columns, rows = np.arange(rig.width), np.arange(rig.height)
    dx, dy = displacement(setup.x, setup.y, rig)
    wedge = Wedge(rig)(setup.x, setup.y)[0]
    small: list[tuple[str, tuple[str, ...], NDArray[np.generic], str, str]] = [
        ("x", ("x",), columns * rig.pitch, "mm", "object position along sliding"),
        ("y", ("y",), rows * rig.pitch, "mm", "object position across sliding"),
        ("camera", ("camera",), np.array([1, 2]), "1", "camera number"),
        (
            "film_min",
            ("trigger",),
            triggers.film_min,
            "um",
            "least film of the smooth gap in the region of interest",
        ),
        ("encoder_angle", ("trigger",), triggers.reading, "degree", "encoder reading"),
        (
            "rocker_angle",
            ("trigger",),
            triggers.zero + triggers.reading,
            "degree",
            "from the ground link",
        ),
        (
            "crank_angle",
            ("trigger",),
            triggers.crank_angle,
            "degree",
            "from the ground link, rocker side positive",
        ),
        ("rocker_speed", ("trigger",), triggers.speed, "rad s-1", "positive with rising angle"),
        ("load", ("trigger",), triggers.load, "N", "load on the joint"),
        (
            "frame_trigger",
            ("frame",),
            np.arange(frames) % per_cycle,
            "1",
            "trigger at which a frame was taken",
        ),
        ("pulse_energy", ("frame",), energy, "1", "laser pulse energy over its mean"),
        ("drift_x", ("frame",), drift[:, 0], "pixel", "extra shift of camera 2 along x"),
        ("drift_y", ("frame",), drift[:, 1], "pixel", "extra shift of camera 2 along y"),
        (
            "fixture_drift_x",
            ("fixture_frame",),
            fixture_drift[:, 0],
            "pixel",
            "the same in the fixture's session",
        ),
        (
            "fixture_drift_y",
            ("fixture_frame",),
            fixture_drift[:, 1],
            "pixel",
            "the same in the fixture's session",
        ),
        (
            "displacement_x",
            ("y", "x"),
            dx,
            "pixel",
            "camera-2 pixel minus camera-1 pixel, at zero drift",
        ),
        (
            "displacement_y",
            ("y", "x"),
            dy,
            "pixel",
            "camera-2 pixel minus camera-1 pixel, at zero drift",
        ),
        ("wedge", ("x",), wedge, "um", "film of the calibration fixture"),
    ]
    for name, dims, values, units, meaning in small:
        variable = file.create_variable(name, dims, data=values)
        variable.attrs["units"] = units
        variable.attrs["long_name"] = meaning
    for name, dims, kind, units, meaning in (
        (
            "film",
            ("trigger", "y", "x"),
            "f4",
            "um",
            "film with its marks, without bubbles, at pixel centres of camera 1",
        ),
        (
            "expected_electrons",
            ("camera", "trigger", "y", "x"),
            "f4",
            "electron",
            "mean signal above dark of the object point under each camera-1 pixel: lens and beam included, "
            "speckle, bubbles, pulse energy, pixel response and dust not",
        ),
        (
            "bubble",
            ("frame", "y", "x"),
            "u1",
            "1",
            "1 where a bubble or its meniscus takes oil away",
        ),
    ):
        chunks = (1,) * (len(dims) - 2) + (rig.height, rig.width)
        variable = file.create_variable(
            name, dims, kind, compression="gzip", compression_opts=4, shuffle=True, chunks=chunks
        )
        variable.attrs["units"] = units
        variable.attrs["long_name"] = meaning
    file.attrs["title"] = "truth of a virtual ERLIF run"
    file.attrs["source"] = f"erlif {version('erlif')}, virtual rig; the dyes' spectra are invented"
    file.attrs["seed"] = np.int64(seed)
    for name, value in asdict(rig).items():
        if value is not None:
            file.attrs[f"rig_{name}"] = (
                np.int8(value) if isinstance(value, bool) else np.asarray(value)
            )
    file.attrs["rig_pixel_pitch"] = np.float64(rig.pitch)


def write_true_film(file: h5netcdf.File, setup: Setup, triggers: Triggers, marks: Marks) -> None:
    """Write film and expected signal trigger by trigger, rounded where no camera could tell, so that they pack well."""
    rig, x, y = setup.rig, setup.x, setup.y
    dx, dy = displacement(x, y, rig)
    lens = vignetting(x, y, 1, rig), vignetting(x + dx, y + dy, 2, rig)
    height = marks(x, y)
    for k, film_min in enumerate(triggers.film_min):
        gap = Gap(rig, float(film_min), marks)
        film = gap.close(gap.smooth(x, y), height)
        file["film"][k] = np.rint(film * 4096) / 4096  # to 0.12 nm
        for number in (1, 2):
            electrons = lens[number - 1] * setup.light(number, film, x, y)
            mantissa, exponent = np.frexp(electrons)
            file["expected_electrons"][number - 1, k] = np.ldexp(
                np.rint(mantissa * 2048) / 2048, exponent
            )  # 0.05 %
