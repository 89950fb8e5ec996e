"""truth.nc: the true film and all other inputs of a simulated run."""

from dataclasses import asdict
from functools import partial
from importlib.metadata import version
from typing import Any, NamedTuple

import h5netcdf
import numpy as np

from erlif.core.arrays import Array
from erlif.rig.camera import displacement, vignetting
from erlif.rig.film import Gap, Triggers, Wedge, cycle_time, lay_patch
from erlif.rig.journal import JournalGap, load_at
from erlif.rig.logger import frame_times
from erlif.rig.settings import RigSettings
from erlif.rig.setup import Setup

_FILM_STEPS = 4096  # per um: the film is rounded to 0.12 nm
_SIGNAL_STEPS = 2048  # of the mantissa: the signal is rounded to 0.05 %


# Long names of the images, which are filled frame by frame.
_FILM = "film with its marks, without bubbles, at pixel centres of camera 1"
_ELECTRONS = (
    "mean signal above dark of the object point under each camera-1 pixel: lens and beam included, "
    "speckle, bubbles, pulse energy, pixel response and dust not"
)

# Settings of the film by the law alone.
_LAW = ("film_reference", "exponent", "film_floor", "film_table", "tilt")
# Settings of the film "reynolds" alone.
_THEORY = ("elapsed", "sideways", "cavitation_pressure", "write_mount")


class Session(NamedTuple):
    """Random motion and light of the run and the fixture's session.

    Attributes
    ----------
    drift : Array
        Extra shift of camera 2 in each frame of the run, (frame, axis x y). [pixel]
    fixture_drift : Array
        The same in the fixture's session, (fixture_frame, axis x y). [pixel]
    energy : Array
        Relative pulse energy of each frame of the run, (frame,). [1]
    """

    drift: Array
    fixture_drift: Array
    energy: Array


def describe_truth(
    file: h5netcdf.File,
    setup: Setup,
    triggers: Triggers,
    gaps: list[Gap],
    session: Session,
    seed: int,
) -> None:
    """Write all small variables and the attributes, and create the images.

    The images are filled later, frame by frame: film and expected_electrons by `write_true_film`,
    bubble by the run.
    """
    rig = setup.rig
    file.dimensions = {
        "trigger": triggers.reading.size,
        "frame": session.energy.size,
        "fixture_frame": rig.fixture_frames,
        "camera": 2,
        "y": rig.height,
        "x": rig.width,
    }
    _describe_triggers(file, triggers, rig)
    # dimension along which the film changes
    film = "frame" if rig.film == "reynolds" else "trigger"
    _describe_gaps(file, film, gaps)
    if rig.film == "reynolds":
        _describe_loading(file, triggers, rig)
    _describe_frames(file, triggers, session)
    _describe_geometry(file, setup)

    options: dict[str, Any] = {"compression": "gzip", "compression_opts": 4, "shuffle": True}
    for name, dims, kind, units, long_name in (
        ("film", (film,), "f4", "um", _FILM),
        ("expected_electrons", ("camera", film), "f4", "electron", _ELECTRONS),
        ("bubble", ("frame",), "u1", "1", "1 where a bubble or its meniscus takes oil away"),
    ):
        chunks = (1,) * len(dims) + (rig.height, rig.width)
        image = file.create_variable(name, (*dims, "y", "x"), kind, chunks=chunks, **options)
        image.attrs["units"], image.attrs["long_name"] = units, long_name

    file.attrs["title"] = "truth of a virtual ERLIF run"
    origin = "invented" if rig.dyes is None else "those of a plan"
    file.attrs["source"] = f"erlif {version('erlif')}, virtual rig; the dyes' spectra are {origin}"
    file.attrs["seed"] = np.int64(seed)
    for name, value in asdict(rig).items():
        if name == "dyes" and rig.dyes is not None:
            for part, numbers in asdict(rig.dyes).items():
                file.attrs[f"rig_dyes_{part}"] = np.asarray(numbers)
        elif value is not None and name not in (_LAW if rig.film == "reynolds" else _THEORY):
            number = np.int8(value) if isinstance(value, bool) else np.asarray(value)
            file.attrs[f"rig_{name}"] = value if isinstance(value, str) else number
    file.attrs["rig_pixel_pitch"] = np.float64(rig.pitch)


def _put(
    file: h5netcdf.File, name: str, dims: str, values: Any, units: str, long_name: str
) -> None:
    """Write a variable on dims that are separated by spaces."""
    variable = file.create_variable(name, tuple(dims.split()), data=np.asarray(values))
    variable.attrs["units"], variable.attrs["long_name"] = units, long_name


def _describe_triggers(file: h5netcdf.File, triggers: Triggers, rig: RigSettings) -> None:
    """Axes, and motion of each trigger."""
    put = partial(_put, file)
    put("x", "x", np.arange(rig.width) * rig.pitch, "mm", "object position along sliding")
    put("y", "y", np.arange(rig.height) * rig.pitch, "mm", "object position across sliding")
    put("camera", "camera", [1, 2], "1", "camera number")
    put("encoder_angle", "trigger", triggers.reading, "degree", "encoder reading")
    put("joint_load", "trigger", triggers.load, "N", "load on the joint")
    if not rig.linked:
        put("sliding_speed", "trigger", triggers.speed, "m s-1", "signed, of the surface")
        put("time", "trigger", triggers.time, "s", "time in the first cycle")
        return
    rocker, crank = triggers.zero + triggers.reading, triggers.crank_angle
    put("rocker_angle", "trigger", rocker, "degree", "from the ground link")
    put("crank_angle", "trigger", crank, "degree", "from the ground link, rocker side positive")
    put("rocker_speed", "trigger", triggers.speed, "rad s-1", "positive with rising angle")


def _describe_gaps(file: h5netcdf.File, film: str, gaps: list[Gap]) -> None:
    """Minimum of every film, and the place of the pin where there is one."""
    put = partial(_put, file)
    of_gap = "minimum film thickness of the smooth gap in the region of interest"
    put("film_min", film, [gap.film_min for gap in gaps], "um", of_gap)
    radius, over = gaps[0].rig.plateau
    if radius > 0:
        put("film_central", film, [over * gap.film_min for gap in gaps], "um", "of the plateau")
    pins = [gap for gap in gaps if isinstance(gap, JournalGap)]
    if pins:
        along, side = [pin.along for pin in pins], [pin.side for pin in pins]
        put(
            "pin_displacement_load",
            film,
            along,
            "um",
            "of the pin from the bushing, along the load",
        )
        put("pin_displacement_side", film, side, "um", "of the pin from the bushing, along +x")
        far, turned = [pin.eccentricity for pin in pins], [pin.attitude for pin in pins]
        put("eccentricity", film, far, "1", "distance of the axes over the radial clearance")
        put("attitude", film, turned, "rad", "from the load line to the thinnest film, along +x")


def _describe_loading(file: h5netcdf.File, triggers: Triggers, rig: RigSettings) -> None:
    """Quantities of each frame from which the film of theory follows."""
    put, time = partial(_put, file), frame_times(triggers, rig)
    loaded, line = time + rig.elapsed * cycle_time(rig), rig.centre[0] * rig.pitch + rig.thin_line
    put("time", "frame", time, "s", "as in the encoder log")
    put("time_since_loading", "frame", loaded, "s", "the pin is centred at time 0")
    put("frame_load", "frame", load_at(time, rig), "N", "load on the joint")
    put("viscosity", "frame", np.full(time.size, rig.viscosity), "Pa s", "of the oil in the gap")
    put("load_line", "", line, "mm", "position of the load line along x")


def _describe_frames(file: h5netcdf.File, triggers: Triggers, session: Session) -> None:
    """Trigger, pulse energy and shift of each frame."""
    put, energy = partial(_put, file), session.energy
    number = np.arange(energy.size) % triggers.reading.size
    put("frame_trigger", "frame", number, "1", "trigger at which a frame was taken")
    put("pulse_energy", "frame", energy, "1", "laser pulse energy over its mean")
    for axis, shift in zip("xy", session.drift.T, strict=True):
        put(f"drift_{axis}", "frame", shift, "pixel", f"extra shift of camera 2 along {axis}")
    for axis, shift in zip("xy", session.fixture_drift.T, strict=True):
        name, text = f"fixture_drift_{axis}", "the same in the fixture's session"
        put(name, "fixture_frame", shift, "pixel", text)


def _describe_geometry(file: h5netcdf.File, setup: Setup) -> None:
    """Light of the run, displacement of camera 2, and the film of the fixture."""
    put, x, y = partial(_put, file), setup.x, setup.y
    shares = "median light of the run, of which rig_background and rig_background_beam are shares"
    put("background_typical", "camera", setup.typical, "electron", shares)
    for axis, image in zip("xy", displacement(x, y, setup.rig), strict=True):
        text = "camera-2 pixel minus camera-1 pixel, at zero drift"
        put(f"displacement_{axis}", "y x", image, "pixel", text)
    put("wedge", "x", Wedge(setup.rig)(x, y)[0], "um", "film of the calibration fixture")


def write_true_film(file: h5netcdf.File, setup: Setup, gaps: list[Gap]) -> None:
    """Write each film and its expected signal.

    They are rounded below what any camera could resolve, so that they compress well.
    """
    rig, x, y = setup.rig, setup.x, setup.y
    dx, dy = displacement(x, y, rig)
    lens = vignetting(x, y, 1, rig), vignetting(x + dx, y + dy, 2, rig)
    height = gaps[0].marks(x, y)
    for k, gap in enumerate(gaps):
        film = lay_patch(gap.close(gap.smooth(x, y), height), x, y, rig)
        file["film"][k] = np.rint(film * _FILM_STEPS) / _FILM_STEPS
        for number in (1, 2):
            electrons = lens[number - 1] * setup.light(number, film, x, y)
            mantissa, exponent = np.frexp(electrons)
            file["expected_electrons"][number - 1, k] = np.ldexp(
                np.rint(mantissa * _SIGNAL_STEPS) / _SIGNAL_STEPS, exponent
            )
