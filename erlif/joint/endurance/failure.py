"""Load at failure with its uncertainty, or the load that was survived."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr

from erlif.core.arrays import Array
from erlif.joint.endurance.posterior import Onset
from erlif.joint.endurance.stages import Stage


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
    """

    load: float
    std: float
    survived: float
    failed: bool
    stage: int
    decided: bool = True


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
    >>> failure_load(test, [Stage(1, 0, 99, 0.0, 99.0, 36e3)], None)
    FailureLoad(load=36000.0, std=180.0, survived=36000.0, failed=False, stage=1, decided=True)
    """
    sound = stages if doubtful is None else stages[:doubtful]
    if onset is None:
        decided = doubtful is None
        if not sound:
            return FailureLoad(0.0, 0.0, 0.0, False, 0, decided)
        last = max(sound, key=lambda stage: stage.load)
        std = calibration * last.load
        return FailureLoad(last.load, std, last.load, False, last.number, decided)

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
    """Load against time in a stage, which the bolts lose slowly, and the covariance of the fit."""
    columns = _columns(time, float(time[0]))
    line, *_ = np.linalg.lstsq(columns, load, rcond=None)
    rest = load - columns @ line
    freedom = max(time.size - columns.shape[1], 1)

    # readings that follow each other closely are alike: fewer of them are independent
    power = float(rest @ rest)
    kept = min(max(float(rest[1:] @ rest[:-1]) / max(power, 1e-300), 0.0), 0.99)
    variance = power / freedom * (1 + kept) / (1 - kept)
    return np.asarray(line), np.asarray(variance * np.linalg.inv(columns.T @ columns))
