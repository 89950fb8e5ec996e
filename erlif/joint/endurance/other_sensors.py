"""Temperature and vibration at the onset of galling that friction shows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr
from scipy.special import stdtr

from erlif.core.arrays import Array
from erlif.joint.endurance.noise import fit_noise, whiten
from erlif.joint.endurance.onset import Onset
from erlif.joint.endurance.stages import Stage

# p-value below which a sensor confirms the onset. [1]
CONFIRMS = 0.01

_MOST_BLOCKS = 200
_FEWEST_AFTER = 3
_FEWEST = 16
_FLAT = 1e-9  # of the largest value: what varies less is rounding
_START = 1 / 5  # of the stage: time constant of what changes after its start


@dataclass(frozen=True)
class SensorChange:
    """Change of temperature or vibration at the onset of galling.

    Attributes
    ----------
    name : str
        "temperature" or "vibration".
    change : float
        Change of the slope of the temperature [K/min], or factor of the vibration [1].
    low : float
        Start of the 95 % interval of the change.
    high : float
        End of that interval.
    p_value : float
        Probability of such a rise without galling, one-sided. [1]
    """

    name: str
    change: float
    low: float
    high: float
    p_value: float

    @property
    def confirms(self) -> bool:
        """Whether the rise is significant."""
        return self.p_value < CONFIRMS


def check_other_sensors(test: xr.Dataset, stage: Stage, onset: Onset) -> tuple[SensorChange, ...]:
    """Test whether temperature and vibration rise at the onset that friction shows.

    The slope of the temperature may rise, because heat takes time to reach the sensor; vibration
    may jump. Both are fitted with the drift of the stage and with correlated noise. The place is
    that of friction, so the p-value counts one place only.

    Parameters
    ----------
    test : xarray.Dataset
        From `erlif.joint.friction.measure_friction`.
    stage : Stage
        Stage of the onset.
    onset : Onset
        From `erlif.joint.endurance.find_onset`.

    Returns
    -------
    tuple of SensorChange
        Of the sensors in the test; none where too few samples lie beside the interval of the onset
        or follow it, or where a sensor does not change at all.

    Examples
    --------
    >>> from erlif.joint.plots.example import example_test
    >>> result = example_test()
    >>> found = check_other_sensors(result.test, result.loaded[-1], result.onset)
    >>> [(sensor.name, sensor.confirms) for sensor in found]
    [('temperature', True), ('vibration', True)]
    """
    # samples within the interval of the onset may lie before it or after it
    time = test["time"].values[stage.samples]
    clear = (time < onset.earliest) | (time > onset.latest)
    time = time[clear]
    changes: list[SensorChange] = []
    if time.size < _FEWEST:
        return ()
    for name, logged in _sensors(test).items():
        values = logged[stage.samples][clear]
        if _stands_still(values):
            continue
        if name == "vibration":
            if not np.all(values > 0):
                continue  # a level is positive; a signed signal has no level
            values = np.log(values)
        form = np.maximum(time - onset.time, 0.0) if name == "temperature" else time >= onset.time
        fit = _fit_change(time, values, np.asarray(form, float), warms=name == "temperature")
        if fit is None:
            continue
        size, error, p_value = fit
        ends = np.array([size, size - 1.96 * error, size + 1.96 * error])
        change, low, high = ends * 60 if name == "temperature" else np.exp(ends)
        changes.append(SensorChange(name, float(change), float(low), float(high), p_value))
    return tuple(changes)


def unusable_sensors(
    test: xr.Dataset, stages: Sequence[Stage], onset: Onset | None
) -> dict[str, str]:
    """Find the sensors that cannot show galling, with the reason.

    Parameters
    ----------
    test : xarray.Dataset
        From `erlif.joint.friction.measure_friction`.
    stages : sequence of Stage
        The stages under load.
    onset : Onset or None
        From `erlif.joint.endurance.find_onset`.

    Returns
    -------
    dict of str to str
        Reason by the name of the sensor, as the end of a sentence.

    Examples
    --------
    >>> test = xr.Dataset({"temperature": ("time", np.full(100, 30.0))}, {"time": np.arange(100.0)})
    >>> unusable_sensors(test, [Stage(1, 0, 99, 0.0, 99.0, 36e3)], None)
    {'temperature': 'reads 30 throughout'}
    """
    reasons = {}
    for name, values in _sensors(test).items():
        if all(_stands_still(values[stage.samples]) for stage in stages):
            reasons[name] = f"reads {values[stages[0].first]:g} throughout"
        elif onset is not None and _stands_still(values[stages[onset.stage].samples]):
            stage = stages[onset.stage]
            reasons[name] = f"reads {values[stage.first]:g} throughout stage {stage.number}"
        elif name == "vibration" and onset is not None:
            inside = values[stages[onset.stage].samples]
            if np.any(inside <= 0):
                reasons[name] = "is not positive throughout, so that it has no level"
    return reasons


def _sensors(test: xr.Dataset) -> dict[str, Array]:
    return {name: test[name].values for name in ("temperature", "vibration") if name in test}


def _stands_still(values: Array) -> bool:
    return bool(np.ptp(values) <= _FLAT * np.max(np.abs(values)))


def _fit_change(
    time: Array, values: Array, form: Array, *, warms: bool
) -> tuple[float, float, float] | None:
    """Size of a change of a given form, its standard deviation and one-sided p-value."""
    per_block = -(-time.size // _MOST_BLOCKS)
    kept = time.size // per_block * per_block
    passed = time - time[0]
    share = passed / passed[-1]

    # heat spreads over minutes to hours: slow warming is a parabola, quick warming decays
    columns = [np.ones_like(share), share]
    columns += [share**2, np.exp(-share / _START)] if warms else []
    samples = np.stack([*columns, form, time, values])[:, :kept]
    *columns, places, level = samples.reshape(len(samples), -1, per_block).mean(axis=2)
    design = np.column_stack(columns)
    if np.count_nonzero(design[:, -1]) < _FEWEST_AFTER or level.size < _FEWEST:
        return None

    noise = fit_noise([(places, design, level)], interval=float(np.median(np.diff(places))))
    white = whiten(noise.factor(places), np.column_stack([design, level]))
    triangle = np.asarray(np.linalg.qr(white, mode="r"))
    free = level.size - design.shape[1]
    size = float(triangle[-2, -1] / triangle[-2, -2])
    error = float(abs(triangle[-1, -1] / triangle[-2, -2]) / np.sqrt(free))
    return size, error, float(stdtr(free, -size / max(error, np.finfo(float).tiny)))
