"""truth.nc: the true film and all other inputs of a simulated run."""

from dataclasses import asdict
from importlib.metadata import version
from typing import Any, NamedTuple

import h5netcdf
import numpy as np
from numpy.typing import NDArray

from erlif.core.arrays import Array
from erlif.core.tables import read_table
from erlif.rig.camera import displacement, vignetting
from erlif.rig.film import Gap, Triggers, Wedge, cycle_time, lay_patch
from erlif.rig.journal import JournalGap, load_at
from erlif.rig.logger import frame_times
from erlif.rig.settings import RigSettings
from erlif.rig.setup import Setup

_FILM_STEPS = 4096  # per um: the film is rounded to 0.12 nm
_SIGNAL_STEPS = 2048  # of the mantissa: the signal is rounded to 0.05 %


# Values of variables by name.
_Values = dict[str, NDArray[Any]]

_TABLE = read_table("erlif.rig", "truth.toml")

# Dimension along which the film changes.
_FILM_DIM = {"law": "trigger", "reynolds": "frame"}

# Variables of the place of the pin, and their names in `JournalGap`.
_PIN = {
    "pin_displacement_load": "along",
    "pin_displacement_side": "side",
    "eccentricity": "eccentricity",
    "attitude": "attitude",
}

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
    groups: dict[str, _Values] = {
        "axes": {
            "x": np.arange(rig.width) * rig.pitch,
            "y": np.arange(rig.height) * rig.pitch,
            "camera": np.array([1, 2]),
        },
        "triggers": _list_triggers(triggers, rig.mechanism),
        "gaps": _list_gaps(gaps),
        "loading": _list_loading(triggers, rig) if rig.film == "reynolds" else {},
        "frames": _list_frames(triggers, session),
        "geometry": _list_geometry(setup),
    }
    film = _FILM_DIM[rig.film]
    for group, variables in groups.items():
        for name, values in variables.items():
            entry = _TABLE[group][name]
            _describe(file.create_variable(name, _dims(entry, film), data=values), entry)

    for name, entry in _TABLE["images"].items():
        dims = _dims(entry, film)
        variable = file.create_variable(
            name,
            dims,
            entry["type"],
            compression="gzip",
            compression_opts=4,
            shuffle=True,
            chunks=(1,) * (len(dims) - 2) + (rig.height, rig.width),
        )
        _describe(variable, entry)

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


def _dims(entry: dict[str, str], film: str) -> tuple[str, ...]:
    """Dims of an entry of the table, with the dimension along which the film changes."""
    return tuple(film if dim == "film" else dim for dim in entry["dims"].split())


def _describe(variable: h5netcdf.Variable, entry: dict[str, str]) -> None:
    variable.attrs["units"] = entry["units"]
    variable.attrs["long_name"] = entry["long_name"]


def _list_triggers(triggers: Triggers, mechanism: str) -> _Values:
    """Film and motion of each trigger."""
    values = {"encoder_angle": triggers.reading, "joint_load": triggers.load}
    if mechanism != "crank-rocker":
        return values | {"sliding_speed": triggers.speed, "time": triggers.time}
    return values | {
        "rocker_angle": triggers.zero + triggers.reading,
        "crank_angle": triggers.crank_angle,
        "rocker_speed": triggers.speed,
    }


def _list_gaps(gaps: list[Gap]) -> _Values:
    """Minimum of every film, and the place of the pin where there is one."""
    values = {"film_min": np.array([gap.film_min for gap in gaps])}
    if all(isinstance(gap, JournalGap) for gap in gaps):
        for name, field in _PIN.items():
            values[name] = np.array([getattr(gap, field) for gap in gaps])
    return values


def _list_loading(triggers: Triggers, rig: RigSettings) -> _Values:
    """Quantities of each frame from which the film of theory follows."""
    time = frame_times(triggers, rig)
    return {
        "time": time,
        "time_since_loading": time + rig.elapsed * cycle_time(rig),
        "frame_load": load_at(time, rig),
        "viscosity": np.full(time.size, rig.viscosity),
        "load_line": np.array(rig.centre[0] * rig.pitch + rig.thin_line),
    }


def _list_frames(triggers: Triggers, session: Session) -> _Values:
    """Trigger, pulse energy and shift of each frame."""
    return {
        "frame_trigger": np.arange(session.energy.size) % triggers.reading.size,
        "pulse_energy": session.energy,
        "drift_x": session.drift[:, 0],
        "drift_y": session.drift[:, 1],
        "fixture_drift_x": session.fixture_drift[:, 0],
        "fixture_drift_y": session.fixture_drift[:, 1],
    }


def _list_geometry(setup: Setup) -> _Values:
    """Displacement of camera 2, and the film of the fixture."""
    dx, dy = displacement(setup.x, setup.y, setup.rig)
    return {
        "background_typical": np.array(setup.typical),
        "displacement_x": dx,
        "displacement_y": dy,
        "wedge": Wedge(setup.rig)(setup.x, setup.y)[0],
    }


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
