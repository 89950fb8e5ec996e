"""truth.nc: the true film and all other inputs of a simulated run."""

from collections.abc import Iterator
from dataclasses import asdict
from importlib.metadata import version
from typing import NamedTuple

import h5netcdf
import numpy as np
from numpy.typing import NDArray

from erlif.core.arrays import Array
from erlif.rig.camera import displacement, vignetting
from erlif.rig.film import Gap, Triggers, Wedge, lay_patch
from erlif.rig.journal import JournalGap, load_at
from erlif.rig.logger import frame_times
from erlif.rig.motion import cycle_time
from erlif.rig.settings import RigSettings
from erlif.rig.setup import Setup

_FILM_STEPS = 4096  # per um: the film is rounded to 0.12 nm
_SIGNAL_STEPS = 2048  # of the mantissa: the signal is rounded to 0.05 %


_LAW = ("film_reference", "exponent", "film_floor", "film_table", "tilt")
"""Settings of the film by the law alone."""
_THEORY = ("elapsed", "sideways", "cavitation_pressure", "write_mount")
"""Settings of the film "reynolds" alone."""


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


class _Variable(NamedTuple):
    name: str
    dims: tuple[str, ...]
    values: NDArray[np.generic]
    units: str
    meaning: str


class _Image(NamedTuple):
    name: str
    dims: tuple[str, ...]
    kind: str
    units: str
    meaning: str


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
    for small in (
        *_list_axes(rig),
        *_list_triggers(triggers, rig.mechanism),
        *_list_gaps(triggers, gaps, rig),
        *_list_frames(triggers, session),
        *_list_geometry(setup),
    ):
        variable = file.create_variable(small.name, small.dims, data=small.values)
        variable.attrs["units"] = small.units
        variable.attrs["long_name"] = small.meaning

    for image in _IMAGES:
        dims = tuple(_FILM_DIM[rig.film] if dim == "film" else dim for dim in image.dims)
        variable = file.create_variable(
            image.name,
            dims,
            image.kind,
            compression="gzip",
            compression_opts=4,
            shuffle=True,
            chunks=(1,) * (len(dims) - 2) + (rig.height, rig.width),
        )
        variable.attrs["units"] = image.units
        variable.attrs["long_name"] = image.meaning

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


def _list_axes(rig: RigSettings) -> Iterator[_Variable]:
    """Positions of the pixels on the object, and camera numbers."""
    columns, rows = np.arange(rig.width), np.arange(rig.height)
    yield _Variable("x", ("x",), columns * rig.pitch, "mm", "object position along sliding")
    yield _Variable("y", ("y",), rows * rig.pitch, "mm", "object position across sliding")
    yield _Variable("camera", ("camera",), np.array([1, 2]), "1", "camera number")


def _list_triggers(triggers: Triggers, mechanism: str) -> Iterator[_Variable]:
    """Film and motion of each trigger."""
    dims = ("trigger",)
    yield _Variable("encoder_angle", dims, triggers.reading, "degree", "encoder reading")
    yield _Variable("load", dims, triggers.load, "N", "load on the joint")
    if mechanism != "crank-rocker":
        yield _Variable("sliding_speed", dims, triggers.speed, "m s-1", "signed, of the surface")
        yield _Variable("time", dims, triggers.time, "s", "time in the first cycle")
        return

    rocker = triggers.zero + triggers.reading
    ground, side = "from the ground link", "from the ground link, rocker side positive"
    yield _Variable("rocker_angle", dims, rocker, "degree", ground)
    yield _Variable("crank_angle", dims, triggers.crank_angle, "degree", side)
    yield _Variable("rocker_speed", dims, triggers.speed, "rad s-1", "positive with rising angle")


def _list_gaps(triggers: Triggers, gaps: list[Gap], rig: RigSettings) -> Iterator[_Variable]:
    """Minimum of every film, and the place of the pin where there is one."""
    dims = (_FILM_DIM[rig.film],)
    minimum = "minimum film thickness of the smooth gap in the region of interest"
    yield _Variable("film_min", dims, np.array([gap.film_min for gap in gaps]), "um", minimum)

    pins = [gap for gap in gaps if isinstance(gap, JournalGap)]
    if not pins:
        return
    columns = (
        ("pin_displacement_load", "along", "um", "of the pin from the bushing, along the load"),
        ("pin_displacement_side", "side", "um", "of the pin from the bushing, along +x"),
        ("eccentricity", "eccentricity", "1", "distance of the axes over the radial clearance"),
        ("attitude", "attitude", "rad", "from the load line to the thinnest film, along +x"),
    )
    for name, field, units, meaning in columns:
        yield _Variable(name, dims, np.array([getattr(pin, field) for pin in pins]), units, meaning)

    time = frame_times(triggers, rig)
    since = time + rig.elapsed * cycle_time(rig)
    line = np.array(rig.centre[0] * rig.pitch + rig.thin_line)
    viscosity = np.full(time.size, rig.viscosity)
    yield _Variable("time", dims, time, "s", "as in the encoder log")
    yield _Variable("time_since_loading", dims, since, "s", "the pin is centred at time 0")
    yield _Variable("frame_load", dims, load_at(time, rig), "N", "load on the joint")
    yield _Variable("viscosity", dims, viscosity, "Pa s", "of the oil in the gap")
    yield _Variable("load_line", (), line, "mm", "position of the load line along x")


def _list_frames(triggers: Triggers, session: Session) -> Iterator[_Variable]:
    """Trigger, pulse energy and shift of each frame."""
    frame, fixture_frame = ("frame",), ("fixture_frame",)
    drift, fixture_drift = session.drift, session.fixture_drift
    number = np.arange(session.energy.size) % triggers.reading.size
    fixture = "the same in the fixture's session"
    energy = "laser pulse energy over its mean"
    yield _Variable("frame_trigger", frame, number, "1", "trigger at which a frame was taken")
    yield _Variable("pulse_energy", frame, session.energy, "1", energy)
    yield _Variable("drift_x", frame, drift[:, 0], "pixel", "extra shift of camera 2 along x")
    yield _Variable("drift_y", frame, drift[:, 1], "pixel", "extra shift of camera 2 along y")
    yield _Variable("fixture_drift_x", fixture_frame, fixture_drift[:, 0], "pixel", fixture)
    yield _Variable("fixture_drift_y", fixture_frame, fixture_drift[:, 1], "pixel", fixture)


def _list_geometry(setup: Setup) -> Iterator[_Variable]:
    """Displacement of camera 2, and the film of the fixture."""
    dx, dy = displacement(setup.x, setup.y, setup.rig)
    wedge = Wedge(setup.rig)(setup.x, setup.y)[0]
    yield _Variable(
        "background_typical",
        ("camera",),
        np.array(setup.typical),
        "electron",
        "median light of the run, of which rig_background and rig_background_beam are shares",
    )
    meaning = "camera-2 pixel minus camera-1 pixel, at zero drift"
    yield _Variable("displacement_x", ("y", "x"), dx, "pixel", meaning)
    yield _Variable("displacement_y", ("y", "x"), dy, "pixel", meaning)
    yield _Variable("wedge", ("x",), wedge, "um", "film of the calibration fixture")


_FILM_DIM = {"law": "trigger", "reynolds": "frame"}
"""Dimension along which the film changes."""

_IMAGES = (
    _Image(
        name="film",
        dims=("film", "y", "x"),
        kind="f4",
        units="um",
        meaning="film with its marks, without bubbles, at pixel centres of camera 1",
    ),
    _Image(
        name="expected_electrons",
        dims=("camera", "film", "y", "x"),
        kind="f4",
        units="electron",
        meaning=(
            "mean signal above dark of the object point under each camera-1 pixel: lens and beam "
            "included, speckle, bubbles, pulse energy, pixel response and dust not"
        ),
    ),
    _Image(
        name="bubble",
        dims=("frame", "y", "x"),
        kind="u1",
        units="1",
        meaning="1 where a bubble or its meniscus takes oil away",
    ),
)


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
