"""A test log to stages, onset of galling and load at failure: the order of the steps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import xarray as xr
from threadpoolctl import threadpool_limits

from erlif.core.arrays import Array
from erlif.core.errors import EnduranceError
from erlif.core.notes import Note
from erlif.joint.endurance.blocks import StageFriction
from erlif.joint.endurance.levels import find_level_rises, first_doubtful, note_level_rises
from erlif.joint.endurance.onset import Onset
from erlif.joint.endurance.other_sensors import SensorChange, check_other_sensors, unusable_sensors
from erlif.joint.endurance.search import OnsetSearch, find_onset
from erlif.joint.endurance.stages import Stage, find_stages, join_stages, note_stages
from erlif.joint.friction import measure_friction


@dataclass(frozen=True)
class FailureLoad:
    """The load at which a bearing failed.

    Attributes
    ----------
    load : float
        Load at the onset of galling; of a test that survived the highest load reached. [N]
    std : float
        Standard deviation: onset, noise of the cells and their calibration. [N]
    survived : float
        Highest load of the stages that were survived whole; 0 where there is none. [N]
    failed : bool
        Whether the bearing failed; if not, its load at failure is above `load`.
    stage : int
        Number of the stage of failure, or of the last one that was survived.
    decided : bool
        False where galling cannot be excluded in a later stage: all that is known is that the
        bearing carried `load`.
    next_load : float
        Load of that stage; infinite where the test is decided. [N]
    """

    load: float
    std: float
    survived: float
    failed: bool
    stage: int
    decided: bool = True
    next_load: float = np.inf


def failure_load(
    test: xr.Dataset,
    stages: Sequence[Stage],
    onset: Onset | None,
    *,
    calibration: float = 0.005,
    doubtful: int | None = None,
) -> FailureLoad:
    """Compute the load at the onset of galling.

    Parameters
    ----------
    test : xarray.Dataset
        From `measure_friction`: load over time.
    stages : sequence of Stage
        The stages under load, without idle runs, in the order of the search for the onset; parts
        are joined, see `erlif.joint.endurance.join_stages`.
    onset : Onset or None
        From `find_onset`.
    calibration : float
        Relative standard deviation of the calibration of the cells. [1]
    doubtful : int, optional
        Place of the first stage in which galling cannot be excluded, see
        `erlif.joint.endurance.levels`: what was survived is before it.

    Returns
    -------
    FailureLoad

    Examples
    --------
    A test that survives 36 kN:

    >>> test = xr.Dataset({"load": ("time", np.full(100, 36e3))}, {"time": np.arange(100.0)})
    >>> found = failure_load(test, [Stage(1, 0, 99, 0.0, 99.0, 36e3)], None)
    >>> found.load, found.std, found.failed
    (36000.0, 180.0, False)
    """
    sound = stages if doubtful is None else stages[:doubtful]
    if onset is None:
        doubt = (True, np.inf) if doubtful is None else (False, stages[doubtful].load)
        if not sound:
            return FailureLoad(0.0, 0.0, 0.0, False, 0, *doubt)
        last = max(sound, key=lambda stage: stage.load)
        std = calibration * last.load
        return FailureLoad(last.load, std, last.load, False, last.number, *doubt)

    stage = stages[onset.stage]
    line, covariance = _fit_line(
        test["time"].values[stage.samples], test["load"].values[stage.samples]
    )
    columns = _columns(onset.places, stage.start)
    loads = columns @ line
    mean = float(onset.weights @ loads)
    spread = float(onset.weights @ (loads - mean) ** 2)
    at = onset.weights @ columns
    noise = float(at @ covariance @ at)
    before = [one.load for one in sound[: onset.stage]]
    return FailureLoad(
        load=mean,
        std=float(np.sqrt(spread + noise + (calibration * mean) ** 2)),
        survived=max(before, default=0.0),
        failed=True,
        stage=stage.number,
    )


def _columns(time: Array, start: float) -> Array:
    return np.column_stack([np.ones_like(time), time - start])


def _fit_line(time: Array, load: Array) -> tuple[Array, Array]:
    """Fit a line to load against time in a stage; return it with the covariance of the fit."""
    columns = _columns(time, float(time[0]))
    line, *_ = np.linalg.lstsq(columns, load, rcond=None)
    rest = load - columns @ line
    freedom = max(time.size - columns.shape[1], 1)

    # readings that follow each other closely are alike: fewer of them are independent
    power = float(rest @ rest)
    kept = min(max(float(rest[1:] @ rest[:-1]) / max(power, 1e-300), 0.0), 0.99)
    variance = power / freedom * (1 + kept) / (1 - kept)
    return np.asarray(line), np.asarray(variance * np.linalg.inv(columns.T @ columns))


@dataclass(frozen=True)
class EnduranceResult:
    """Result of the analysis of an endurance test.

    Attributes
    ----------
    name : str
        Name of the test.
    test : xarray.Dataset
        Load, torque, friction, temperature and vibration over time.
    stages : tuple[Stage, ...]
        Stages and idle runs in the order of time.
    search : OnsetSearch
        The search for galling, with its p-value.
    failure : FailureLoad
        Load at failure, or the load survived.
    other_sensors : tuple[SensorChange, ...]
        What temperature and vibration show at the onset.
    unusable : dict[str, str]
        Sensors that show nothing, by name, with the reason.
    notes : tuple[Note, ...]
        What is doubtful about stages and friction.
    calibration : float
        Relative standard deviation of the calibration of the load cells. [1]
    """

    name: str
    test: xr.Dataset
    stages: tuple[Stage, ...]
    search: OnsetSearch
    failure: FailureLoad
    other_sensors: tuple[SensorChange, ...] = ()
    unusable: dict[str, str] = field(default_factory=dict)
    notes: tuple[Note, ...] = ()
    calibration: float = 0.005

    @property
    def onset(self) -> Onset | None:
        """The onset of galling, or None."""
        return self.search.onset

    @property
    def loaded(self) -> tuple[Stage, ...]:
        """The stages under load, in the parts into which pauses of the log divide them."""
        return tuple(stage for stage in self.stages if not stage.is_idle)

    @property
    def whole(self) -> tuple[Stage, ...]:
        """The stages under load, their parts joined; the places in `search` are those in here."""
        return join_stages(self.loaded)


def analyse_endurance(
    log: xr.Dataset,
    *,
    pin_radius: float,
    arm: float | None = None,
    torque_ratio: float = 1.0,
    tare: float = 0.0,
    calibration: float = 0.005,
    idle_load: float | None = None,
    significance: float = 0.01,
    least_rise: float = 0.02,
    name: str = "",
) -> EnduranceResult:
    """Find stages, onset of galling and load at failure of an endurance test.

    Parameters
    ----------
    log : xarray.Dataset
        From `erlif.joint.read_torque_log`.
    pin_radius, arm, torque_ratio, tare
        As for `erlif.joint.friction.measure_friction`.
    calibration : float
        Relative standard deviation of the calibration of the load cells. [1]
    idle_load : float, optional
        As for `erlif.joint.endurance.find_stages`. [N]
    significance : float
        Largest probability of a false alarm in a test. [1]
    least_rise : float
        Smallest rise of friction that is called galling. [1]
    name : str
        Name of the test; default: that of its file.

    Returns
    -------
    EnduranceResult

    Raises
    ------
    EnduranceError
        If there is no stage, or as `erlif.joint.friction.measure_friction`.

    Examples
    --------
    >>> from erlif.joint.rig import simulate_endurance
    >>> log, truth = simulate_endurance(rng=np.random.default_rng(5))
    >>> cells = log[["cell_1", "cell_2"]].to_dataarray("cell")
    >>> log = xr.Dataset({"cells": cells, "arm_force": log.arm})
    >>> found = analyse_endurance(log, pin_radius=0.03336, arm=0.3)
    >>> len(found.loaded), found.failure.stage
    (6, 6)
    >>> found.onset.earliest < truth.onset < found.onset.latest
    True
    """
    test = measure_friction(
        log, pin_radius=pin_radius, arm=arm, torque_ratio=torque_ratio, tare=tare
    )
    time, friction = test["time"].values, test["friction"].values
    stages = find_stages(time, test["load"].values, test["torque"].values, idle_load=idle_load)
    loaded = [stage for stage in stages if not stage.is_idle]
    if not loaded:
        reason = (
            f"there is none among {len(stages)} stretches. Check the columns of the load cells, or "
            "give the load up to which a run is idle with --idle-load."
        )
        if "period" in test.attrs:
            reason = (
                f"the torque reverses with a period of {test.attrs['period']:.3g} s, and friction "
                f"is one value for two periods: {test.sizes['time']} values are too few for "
                "stages. Take erlif friction for a motion that reverses now and then, or log the "
                "size of the torque."
            )
        where = name or log.attrs.get("file", "the log")
        raise EnduranceError(f"Expected a stage of constant load in {where}; {reason}")

    # the cells may read nothing for a moment even in a stage
    whole = join_stages(loaded)
    number = np.zeros(time.size, dtype=int)
    for part in loaded:
        number[part.samples] = part.number
    number[~np.isfinite(friction)] = 0
    known = [np.flatnonzero(number == stage.number) for stage in whole]
    frictions = [StageFriction(time[places], friction[places]) for places in known]
    # the matrices are small: more threads of the linear algebra wait for each other
    with threadpool_limits(1, user_api="blas"):
        search = find_onset(frictions, significance=significance, least_rise=least_rise)
    rises = find_level_rises(frictions, search.onset, least_rise=least_rise)
    other_sensors: tuple[SensorChange, ...] = ()
    if search.onset is not None:
        other_sensors = check_other_sensors(test, whole[search.onset.stage], search.onset)
    return EnduranceResult(
        name=name or Path(log.attrs.get("file", "")).stem,
        test=test,
        stages=stages,
        search=search,
        failure=failure_load(
            test, whole, search.onset, calibration=calibration, doubtful=first_doubtful(rises)
        ),
        other_sensors=other_sensors,
        unusable=unusable_sensors(test, whole, search.onset),
        notes=(
            *note_stages(time, test["load"].values, stages, idle_load=idle_load),
            *note_level_rises(rises, [stage.number for stage in whole]),
        ),
        calibration=calibration,
    )
