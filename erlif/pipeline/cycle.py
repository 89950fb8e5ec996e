"""The triggers of a run: what log and motion give for each."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr

from erlif.core.units import count_of
from erlif.core.variables import FILM
from erlif.io.ingest import FramePairs, Run
from erlif.pipeline.physics.joint import missing_load
from erlif.pipeline.physics.prediction import predict_theory
from erlif.pipeline.plane import ObjectPlane

# What the motion gives for each frame, and a mean for each trigger.
_MOTION = ("encoder_angle", "position", "rocker_speed", "sliding_speed")


def group_frames(cycle: xr.Dataset, pairs: FramePairs) -> list[list[int]]:
    """Usable frame pairs of each trigger; `cycle` as `locate_frames` returns it."""
    trigger = cycle.trigger.values
    frames: list[list[int]] = [[] for _ in range(int(trigger.max()) + 1)]
    for k in pairs.usable:
        frames[trigger[k]].append(k)
    return frames


def summarise_cycle(cycle: xr.Dataset) -> str:
    """Triggers, cycles and highest speed of a run in words; `cycle` as `locate_run` returns it."""
    triggers, cycles = int(cycle.trigger.max()) + 1, int(cycle.cycle.max()) + 1
    text = count_of(triggers, "trigger")
    if cycles > 1 or "encoder_angle" in cycle:  # without angles one cycle is a convention
        text += f" in {count_of(cycles, 'cycle')}"
    if "rocker_speed" in cycle:
        return f"{text}, joint speed up to {float(np.abs(cycle.rocker_speed).max()):.3f} rad/s"
    if "sliding_speed" in cycle:
        return f"{text}, sliding speed up to {float(cycle.sliding_speed.max()):.4g} m/s"
    return f"{text}, no speed"


def describe_triggers(run: Run, cycle: xr.Dataset) -> xr.Dataset:
    """Average all quantities of log and kinematics over the frames of each trigger.

    Parameters
    ----------
    run : Run
    cycle : xarray.Dataset
        As `locate_frames` returns it.

    Returns
    -------
    xarray.Dataset
        On dim trigger; complete enough for the theory. What needs a table that run.toml lacks is
        left out.

    Raises
    ------
    ConfigError
        If neither log nor settings give the load, Vogel's law has no temperature, or the region of
        interest or the load line lies outside the image.
    """
    columns = _columns_by_frame(run, cycle)
    usable = group_frames(cycle, run.pairs)
    film = xr.Dataset(coords={"trigger": np.arange(len(usable))})

    # a trigger whose frames were all left out keeps its place in the cycle
    of = cycle.trigger.values
    every = [frames or np.flatnonzero(of == k).tolist() for k, frames in enumerate(usable)]
    for name, column in columns.items():
        if column.dtype.kind in "fiu":
            values = np.array([_trigger_mean(column, frames) for frames in every])
        else:
            values = np.array([str(column.values[frames[0]]) for frames in every])
        film[name] = ("trigger", values, column.attrs)

    if "stroke" in cycle:
        stroke = cycle.stroke.values[[frames[0] for frames in every]]
        film["stroke"] = ("trigger", stroke, cycle.stroke.attrs)
    if "crank_angle" in cycle:
        angle = np.radians(cycle.crank_angle.values)
        circle = [np.exp(1j * angle[frames]).mean() for frames in every]
        attrs = cycle.crank_angle.attrs
        film["crank_angle"] = ("trigger", np.degrees(np.angle(circle)) % 360, attrs)

    # frames that are averaged over cycles have no common time
    apart = all(len(frames) == 1 for frames in every)
    if "time" in run.log and (apart or not cycle.cycle.any()):
        read = run.log.time.values
        film["time"] = FILM["time"].fill(np.array([read[frames].mean() for frames in every]))

    # what would fail at the end fails here
    predict_theory(run.settings, film)
    ObjectPlane(run.settings, run.pairs.shape).check()
    return film


def _trigger_mean(column: xr.DataArray, frames: Sequence[int]) -> float:
    """Mean of a column over the frames of a trigger."""
    values = column.values[list(frames)].astype(float)
    if column.name == "encoder_angle" and column.attrs.get("mounted_on", "crank") == "crank":
        # on a crank, a disc or a drive 359 and 1 degree are near 0; readings may count on
        values = values[0] + (values - values[0] + 180.0) % 360.0 - 180.0
    return float(values.mean())


def _columns_by_frame(run: Run, cycle: xr.Dataset) -> dict[str, xr.DataArray]:
    """Quantities that have one value per frame and are averaged over each trigger."""
    columns = {name: cycle[name] for name in _MOTION if name in cycle}
    of_log = ("number", "angle", "angle_rate", "time", *_MOTION)
    columns |= {str(name): run.log[name] for name in run.log if name not in of_log}
    if "joint_load" not in columns:
        load = run.settings.load
        if load is not None:
            columns["joint_load"] = xr.full_like(cycle.trigger, load, float)
            columns["joint_load"].attrs = dict(FILM["joint_load"].attrs)
        elif run.settings.joint is not None:
            raise missing_load()
    return columns
