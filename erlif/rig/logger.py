"""The encoder of the virtual rig and its data logger: other links, ticks, and logs in time."""

from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np

from erlif.core.arrays import AnyArray, Array
from erlif.rig.film import Triggers, coupler_angle, crank_at, cycle_time, load_of, rocker_angle
from erlif.rig.settings import RigSettings

# Rows of the log in time per second. [Hz]
LOG_RATE = 10_000.0

# Ticks of the encoder in a turn.
TICKS = 36_000

_MARGIN = 0.05  # s: log before the first and after the last frame
_PULSE = 3  # rows for which the trigger of the cameras is high
_CRANK_ZERO = 30.0  # degree: crank angle at reading 0 of an encoder on the crank
_FINE = 3601  # crank angles at which the range of a link is looked up
_HIGH = 4.9  # V


class Reading(NamedTuple):
    """Readings of the encoder, and the angle at reading 0.

    Attributes
    ----------
    values : Array
        Degrees or ticks.
    zero : float
        Angle of its link at reading 0. [degree]
    """

    values: Array
    zero: float


def read_encoder(crank: Array, triggers: Triggers, rig: RigSettings) -> Reading:
    """Return the readings at crank angles [rad]."""
    if not rig.linked:
        return Reading(np.degrees(crank), 0.0)
    angle = _link_angle(crank, rig)
    fine = _link_angle(np.linspace(0, 2 * np.pi, _FINE), rig)
    zeros = {"rocker": triggers.zero, "coupler": float(fine.min()), "crank": _CRANK_ZERO}
    zero = zeros[rig.encoder]
    if rig.reading == "degrees":
        return Reading((angle - zero) % 360.0 if rig.encoder == "crank" else angle - zero, zero)

    # the encoder passes its zero in the middle of the stroke
    zero = float((fine.min() + fine.max()) / 2)
    wrapped = (angle - zero) % 360.0
    if rig.reading == "wrapped":
        return Reading(wrapped, zero)
    return Reading(np.floor(wrapped * TICKS / 360.0 + 0.5) % TICKS, zero)


def _link_angle(crank: Array, rig: RigSettings) -> Array:
    """Angle of the link that carries the encoder. [degree]"""
    if rig.encoder == "coupler":
        crank = coupler_angle(crank, rig)
    elif rig.encoder == "rocker":
        crank = rocker_angle(crank, rig)
    return np.degrees(crank)


def write_log_in_time(path: Path, triggers: Triggers, rig: RigSettings, temperature: float) -> None:
    """Write a log in time, as a logger of a European laboratory does.

    Columns are separated by semicolons, commas are decimal, and a voltage rises at each frame.
    """
    period = 60 / rig.crank_speed
    moments = frame_times(triggers, rig)
    first = moments[0] - _MARGIN
    time = first + np.arange(int((moments[-1] + _MARGIN - first) * LOG_RATE)) / LOG_RATE
    crank = crank_at(time, rig)
    reading = read_encoder(crank, triggers, rig)
    oil = temperature + 0.2 * np.sin(2 * np.pi * time / (rig.cycles * period))

    rises = np.searchsorted(time, moments)
    trigger = np.zeros(time.size)
    for k in range(_PULSE):
        trigger[np.minimum(rises + k, time.size - 1)] = _HIGH

    unit = "ticks" if rig.reading == "ticks" else "deg"
    digits = 0 if rig.reading == "ticks" else 4
    columns = {
        "Time [s]": (time - first, "%.4f"),
        f"Encoder [{unit}]": (reading.values, f"%.{digits}f"),
        "Force [N]": (load_of(crank, rig), "%.3f"),
        "Oil [°C]": (oil, "%.2f"),
        "Trigger [V]": (trigger, "%.1f"),
    }
    write_table(path, columns, delimiter=";")
    text = path.read_text(encoding="utf-8").replace(".", ",")
    path.write_text(f"# virtual logger, 5 channels\n{text}", encoding="utf-8")


def write_table(
    path: Path, columns: Mapping[str, tuple[AnyArray, str]], *, delimiter: str = ","
) -> None:
    """Write columns as text: numbers and their format by their heading."""
    np.savetxt(
        path,
        np.column_stack([values for values, _ in columns.values()]),
        fmt=[form for _, form in columns.values()],
        delimiter=delimiter,
        header=delimiter.join(columns),
        comments="",
        encoding="utf-8",
    )


def frame_times(triggers: Triggers, rig: RigSettings) -> Array:
    """Return the time of every frame, all cycles after one another. [s]"""
    cycles = 1 if rig.pulses_per_cycle else rig.cycles
    return np.concatenate([triggers.time + cycle * cycle_time(rig) for cycle in range(cycles)])
