"""Simulated endurance tests of a bearing, with the true onset of galling.

The schedule is that of Farzaneh (2002), chapter 4: stages of rising load, between them the machine
at rest while the bolts are turned and a run without load. Nothing here is shared with
`erlif.joint.endurance`, which analyses such tests.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from scipy.constants import pound_force
from scipy.signal import lfilter

from erlif.core.arrays import Array
from erlif.core.errors import ModelError

if TYPE_CHECKING:
    import xarray as xr  # loaded when a test is simulated: the commands import this stage

# Loads of the stages of the source. [N]
THESIS_LOADS = tuple(1000 * kips * pound_force for kips in (8, 12, 16, 20, 24, 28))


@dataclass(frozen=True)
class EnduranceRig:
    """One endurance test: its schedule, its friction and its sensors.

    Attributes
    ----------
    loads : tuple[float, ...]
        Load of each stage. [N]
    stage_duration : float
        Duration of a stage. [s]
    idle_duration : float
        Duration of the run without load before it. [s]
    rest : float
        Time at rest while the bolts are turned, before and after each idle run. [s]
    idle_load : float
        Load that remains in an idle run. [N]
    interval : float
        Interval of the samples. [s]
    relaxation : float
        Share of the load that the bolts lose within a stage. [1]
    friction : float
        Friction coefficient of the first stage after running-in. [1]
    stage_scatter : float
        Standard deviation of the level of friction from stage to stage. [1]
    load_effect : float
        Change of friction from one stage to the next. [1]
    running_in : float
        Excess of friction at the start of each stage. [1]
    running_in_time : float
        Time constant in which it decays. [s]
    drift : float
        Change of friction over the whole test. [1]
    drift_power : float
        Power of the time with which it grows. [1]
    noise : float
        Standard deviation of the noise of friction. [1]
    correlation_time : float
        Correlation time of the noise. [s]
    white : float
        Share of its variance that is white. [1]
    noise_form : str
        "normal"; "student" (3 degrees of freedom); "bursts" (5 times the noise over 20 samples);
        "spikes" (one sample in 100 is 10 to 40 standard deviations too high); "last spike" (one
        such sample, 4 to 8 from the end of each stage); "transients" (one in 100 samples, 2 to 6
        standard deviations over 4 to 10 samples); "oscillating" (a damped oscillation with a period
        of 20 to 60 samples); "random walk" (its steps make `noise` in 100 samples).
    galling_stage : int | None
        Number of the stage in which galling begins, from 1; None for a test that survives.
    galling_time : float
        Time from the start of that stage to the onset. [s]
    rise : float
        Rise of friction by galling. [1]
    rise_time : float
        Time that the rise takes. [s]
    rise_form : str
        "exponential" (rise_time is its time constant) or "ramp".
    noise_growth : float
        Factor by which galling enlarges the noise. [1]
    stop_after : float
        Time from the onset to the end of the test. [s]
    arm : float
        Arm of the load cell that holds the torque. [m]
    pin_radius : float
        Radius of the pin. [m]
    cell_error : float
        Standard deviation of the relative calibration error of the load. [1]
    cell_noise : float
        Standard deviation of one reading of a load cell. [N]
    temperature : float
        Temperature at the start. [degC]
    heating : float
        Rise of the temperature for each watt of friction. [K/W]
    thermal_time : float
        Time constant of the temperature. [s]
    vibration : float
        Level of vibration. [g]
    vibration_growth : float
        Factor by which galling enlarges it. [1]
    """

    loads: tuple[float, ...] = THESIS_LOADS
    stage_duration: float = 600.0
    idle_duration: float = 30.0
    rest: float = 60.0
    idle_load: float = 900.0
    interval: float = 1.0
    relaxation: float = 0.01
    friction: float = 0.14
    stage_scatter: float = 0.003
    load_effect: float = 0.0
    running_in: float = 0.02
    running_in_time: float = 80.0
    drift: float = 0.01
    drift_power: float = 1.0
    noise: float = 0.005
    correlation_time: float = 9.5
    white: float = 0.1
    noise_form: str = "normal"
    galling_stage: int | None = 6
    galling_time: float = 540.0
    rise: float = 0.12
    rise_time: float = 6.0
    rise_form: str = "exponential"
    noise_growth: float = 1.5
    stop_after: float = 45.0
    arm: float = 0.3
    pin_radius: float = 0.03336
    cell_error: float = 0.005
    cell_noise: float = 60.0
    temperature: float = 25.0
    heating: float = 0.02
    thermal_time: float = 900.0
    vibration: float = 0.4
    vibration_growth: float = 2.5


@dataclass(frozen=True)
class EnduranceTruth:
    """True values of a simulated test.

    Attributes
    ----------
    onset : float
        Time at which galling begins; NaN for a test that survives. [s]
    load : float
        Load at that time, or the highest load survived. [N]
    failed : bool
        Whether there is galling.
    stage : int
        Number of the last stage, from 1.
    stages : tuple[tuple[float, float], ...]
        Start and end of each stage. [s]
    friction : Array
        Friction coefficient of each sample, without noise. [1]
    """

    onset: float
    load: float
    failed: bool
    stage: int
    stages: tuple[tuple[float, float], ...]
    friction: Array = field(repr=False)


def simulate_endurance(
    rig: EnduranceRig | None = None, *, rng: np.random.Generator
) -> tuple[xr.Dataset, EnduranceTruth]:
    """Simulate the log of an endurance test.

    Parameters
    ----------
    rig : EnduranceRig, optional
        Default: a test like the first one of Farzaneh (2002), which galls nine minutes into its
        sixth stage.
    rng : numpy.random.Generator

    Returns
    -------
    log : xarray.Dataset
        Over ``time`` [s]: cell_1, cell_2 and arm [N], temperature [degC], vibration [g].
    truth : EnduranceTruth

    Raises
    ------
    ModelError
        If the stage of galling is none of the test, or the schedule is empty.

    Examples
    --------
    >>> log, truth = simulate_endurance(rng=np.random.default_rng(1))
    >>> list(log), truth.stage, round(truth.load / 4.4482)
    (['cell_1', 'cell_2', 'arm', 'temperature', 'vibration'], 6, 27748)
    """
    import xarray as xr

    rig = rig or EnduranceRig()
    if not rig.loads or min(rig.stage_duration, rig.interval) <= 0:
        raise ModelError(
            "Expected a schedule with a stage, a duration and an interval above 0. Give other "
            "loads or times."
        )
    if rig.galling_stage is not None and not 1 <= rig.galling_stage <= len(rig.loads):
        raise ModelError(
            f"Expected galling_stage from 1 to {len(rig.loads)}; got {rig.galling_stage}. Give one "
            "of them, or None for a test that survives."
        )

    stages, idles, onset, end = _schedule(rig)
    time = np.arange(0.0, end, rig.interval) + rig.interval
    load, running = _load(rig, time, stages, idles)
    clean = _friction(rig, time, stages, onset, end, rng)
    noise = (
        rig.noise * _noise(rig, time, stages, rng) * np.where(time >= onset, rig.noise_growth, 1.0)
    )
    friction = np.maximum(clean + noise, 0.0)

    # the cells hold half of the load each, and share an error of calibration
    error = 1 + rig.cell_error * rng.standard_normal()
    reading = [
        0.5 * load * error + rig.cell_noise * rng.standard_normal(time.size) for _ in range(2)
    ]
    torque = np.where(running, friction * load * rig.pin_radius, 0.0)
    arm = torque / rig.arm + 0.1 * rig.cell_noise * rng.standard_normal(time.size)
    log = xr.Dataset(
        {
            "cell_1": ("time", reading[0], {"units": "N"}),
            "cell_2": ("time", reading[1], {"units": "N"}),
            "arm": ("time", arm, {"units": "N"}),
            "temperature": ("time", _temperature(rig, torque, rng), {"units": "degC"}),
            "vibration": ("time", _vibration(rig, time, running, onset, rng), {"units": "g"}),
        },
        {"time": ("time", time, {"units": "s"})},
    )

    failed = rig.galling_stage is not None
    at = int(np.searchsorted(time, onset)) if failed else -1
    truth = EnduranceTruth(
        onset=onset if failed else np.nan,
        load=float(load[at]) if failed else max(rig.loads),
        failed=failed,
        stage=len(stages),
        stages=tuple((start, min(stop, end)) for start, stop in stages),
        friction=clean,
    )
    return log, truth


def write_endurance_log(
    log: xr.Dataset, path: Path, *, names: dict[str, str] | None = None
) -> Path:
    """Write a simulated log as CSV, as a data logger would.

    Parameters
    ----------
    log : xarray.Dataset
        From `simulate_endurance`.
    path : Path
    names : dict of str to str, optional
        Headings by the names of the log. Default: ``Time [s]``, ``Cell 1 [N]`` and so on.

    Returns
    -------
    Path
        `path`.

    Examples
    --------
    >>> import tempfile
    >>> log, _ = simulate_endurance(rng=np.random.default_rng(1))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = write_endurance_log(log, Path(folder, "run.csv"))
    ...     path.read_text().splitlines()[0]
    'Time [s],Cell 1 [N],Cell 2 [N],Arm [N],Temperature [degC],Vibration [g]'
    """
    known = {
        "time": ("Time [s]", "%.7g"),
        "cell_1": ("Cell 1 [N]", "%.0f"),
        "cell_2": ("Cell 2 [N]", "%.0f"),
        "arm": ("Arm [N]", "%.0f"),
        "temperature": ("Temperature [degC]", "%.1f"),
        "vibration": ("Vibration [g]", "%.2f"),
    }
    headings = [(names or {}).get(name, heading) for name, (heading, _) in known.items()]
    columns, forms = [log[name].values for name in known], [form for _, form in known.values()]
    text = {"header": ",".join(headings), "comments": "", "encoding": "utf-8"}
    np.savetxt(path, np.column_stack(columns), forms, delimiter=",", **text)
    return path


_Spans = list[tuple[float, float]]

_WALK = 100  # samples of a random walk in which it goes as far as the noise
_OFTEN = 0.01  # of the samples begin a disturbance
_BURST = 20  # samples of a burst of noise


def _schedule(rig: EnduranceRig) -> tuple[_Spans, _Spans, float, float]:
    """Spans of the stages and of the idle runs, the onset, and the end of the test. [s]"""
    stages: _Spans = []
    idles: _Spans = []
    clock = 0.0
    for number in range(1, len(rig.loads) + 1):
        idles.append((clock, clock + rig.idle_duration))
        start = clock + rig.idle_duration + rig.rest
        stages.append((start, start + rig.stage_duration))
        if number == rig.galling_stage:
            onset = start + rig.galling_time
            return stages, idles, onset, min(onset + rig.stop_after, stages[-1][1])
        clock = stages[-1][1] + rig.rest
    return stages, idles, np.inf, stages[-1][1]


def _load(rig: EnduranceRig, time: Array, stages: _Spans, idles: _Spans) -> tuple[Array, Array]:
    """Load, and whether the machine runs. At rest the load goes straight to its next value."""
    knots, values = [-1.0], [rig.idle_load]
    running = np.zeros(time.size, bool)
    for (start, stop), idle, load in zip(stages, idles, rig.loads, strict=False):
        knots += [idle[0], idle[1], start, stop]
        values += [rig.idle_load, rig.idle_load, load, load * (1 - rig.relaxation)]
        for span in (idle, (start, stop)):
            running |= (time >= span[0]) & (time < span[1])
    return np.interp(time, knots, values), running


def _friction(
    rig: EnduranceRig,
    time: Array,
    stages: _Spans,
    onset: float,
    end: float,
    rng: np.random.Generator,
) -> Array:
    """Friction coefficient without noise."""
    friction = rig.friction + rig.drift * (time / end) ** rig.drift_power
    for number, (start, stop) in enumerate(stages):
        inside = (time >= start) & (time < stop)
        level = number * rig.load_effect + rig.stage_scatter * rng.standard_normal()
        decay = rig.running_in * np.exp(-(time[inside] - start) / rig.running_in_time)
        friction[inside] += level + decay

    lag = np.maximum(time - onset, 0.0)
    if rig.rise_time == 0:
        grown = (time >= onset).astype(float)
    elif rig.rise_form == "ramp":
        grown = np.minimum(lag / rig.rise_time, 1.0)
    else:
        grown = -np.expm1(-lag / rig.rise_time)
    return friction + rig.rise * grown


def _noise(rig: EnduranceRig, time: Array, stages: _Spans, rng: np.random.Generator) -> Array:
    """Noise of unit variance, but for what its form adds."""
    size = time.size
    if rig.noise_form == "random walk":
        return np.asarray(np.cumsum(rng.standard_normal(size)) / np.sqrt(_WALK))
    if rig.noise_form == "oscillating":
        turn, kept = 2 * np.pi / rng.uniform(20, 60), np.exp(-1 / rng.uniform(20, 100))
        wave = lfilter([1], [1, -2 * kept * np.cos(turn), kept**2], rng.standard_normal(size))
        return np.asarray(wave / wave.std())
    noise = _usual_noise(rig, size, rng)
    if rig.noise_form in ("normal", "student"):
        return noise
    starts = np.flatnonzero(rng.random(size) < _OFTEN)
    if rig.noise_form == "bursts":
        burst = np.convolve(rng.random(size) < _OFTEN / 2, np.ones(_BURST))[:size] > 0
        noise *= np.where(burst, 5.0, 1.0)
    elif rig.noise_form == "spikes":
        noise[starts] += rng.uniform(10, 40, starts.size)
    elif rig.noise_form == "last spike":
        ends = np.searchsorted(time, [stop for _, stop in stages])
        noise[ends - rng.integers(4, 9, ends.size)] += rng.uniform(10, 40, ends.size)
    elif rig.noise_form == "transients":
        for start in starts:
            noise[start : start + rng.integers(4, 11)] += rng.uniform(2, 6)
    return noise


def _usual_noise(rig: EnduranceRig, size: int, rng: np.random.Generator) -> Array:
    """Noise with an exponential correlation, and a white part."""
    kept = np.exp(-rig.interval / rig.correlation_time) if rig.correlation_time else 0.0
    student = rig.noise_form == "student"

    def draw() -> Array:
        # Student's deviates of 3 degrees of freedom have a variance of 3
        drawn = rng.standard_t(3, size) / np.sqrt(3) if student else rng.standard_normal(size)
        return np.asarray(drawn)

    steps = draw()
    slow, _ = lfilter([np.sqrt(1 - kept**2)], [1, -kept], steps, zi=kept * steps[:1])
    return np.asarray(np.sqrt(1 - rig.white) * slow + np.sqrt(rig.white) * draw())


def _temperature(rig: EnduranceRig, torque: Array, rng: np.random.Generator) -> Array:
    """Temperature of the pin, which friction heats and the frame cools."""
    speed = 1.7  # rad/s, mean of a swing of 25 degrees at 114 cycles in a minute
    gain = rig.interval / rig.thermal_time
    rises = lfilter([gain], [1, gain - 1], rig.heating * torque * speed)
    return np.asarray(rig.temperature + rises + 0.05 * rng.standard_normal(torque.size))


def _vibration(
    rig: EnduranceRig, time: Array, running: Array, onset: float, rng: np.random.Generator
) -> Array:
    """Level of vibration."""
    level = np.where(time >= onset, rig.vibration_growth, 1.0) * np.where(running, 1.0, 0.05)
    return rig.vibration * level * np.exp(0.1 * rng.standard_normal(time.size))
