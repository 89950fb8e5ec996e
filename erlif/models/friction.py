"""Friction of a pin in a bushing: from torque to coefficient, from wrap angle to torque, and the onset of galling."""

from dataclasses import dataclass

import numpy as np
from scipy import stats
from scipy.special import hyp0f1

from erlif.core.errors import ModelError
from erlif.models.arguments import Values, require_between, require_not_negative, require_positive

STEADY_WEAR_TORQUE_RATIO = 4 / np.pi
"""Torque ratio of a bushing worn to its steady state, a cosine over half the shaft. Colbert et al. (2009), eq. A6.

The source prints 1.25 for this limit of its equation; the limit is 1.2732, and 1.25 belongs to 86.6 degrees.
"""


def friction_torque(
    friction: Values, *, load: Values, radius: Values, torque_ratio: Values = 1.0
) -> Values:
    """Torque [N m] that turns a loaded shaft in its bushing: T = T* mu F R. Colbert et al. (2009), eqs. 1 and 4.

    Parameters
    ----------
    friction : float or array
        Friction coefficient mu. [1]
    load : float or array
        F. [N]
    radius : float or array
        Radius R of the shaft. [m]
    torque_ratio : float or array
        T* of the pressure distribution; 1 takes the contact for a line, as Farzaneh (2002), appendix A.3, does. [1]

    Notes
    -----
    Farzaneh (2002) works its torque with a pin radius of 1.25 in; the pin has 33.36 mm, which asks for 5 % more.
    """
    require_not_negative(friction=friction, load=load)
    require_positive(radius=radius)
    return torque_ratio * friction * load * radius


def friction_coefficient(
    torque: Values, *, load: Values, radius: Values, torque_ratio: Values = 1.0
) -> Values:
    """Friction coefficient [1] from a torque [N m]: mu = T / (T* F R). Colbert et al. (2009), eqs. 1, 4 and B6.

    With the default torque ratio of 1 this is the apparent coefficient mu' of the source, at least the true one.
    """
    require_positive(load=load, radius=radius, torque_ratio=torque_ratio)
    return torque / (torque_ratio * load * radius)


def uniform_torque_ratio(half_angle: Values) -> Values:
    """T* [1] of a uniform pressure over an arc: alpha / sin alpha, pi/2 at 90 degrees. Colbert et al. (2009), eq. 4.

    `half_angle` alpha is half of the arc of contact, 0 to pi/2. [rad]
    """
    require_between(0.0, np.pi / 2, half_angle=half_angle)
    return 1 / _sinc(half_angle)


def cosine_torque_ratio(half_angle: Values) -> Values:
    """T* [1] of the pressure cos(pi theta / 2 alpha): (pi^2 - 4 alpha^2) / (pi^2 cos alpha). Colbert et al. (2009), A6.

    `half_angle` alpha is half of the arc of contact, 0 to pi/2. [rad]

    Note: the limit at 90 degrees is 4/pi = 1.2732; the source prints 1.25.
    """
    require_between(0.0, np.pi / 2, half_angle=half_angle)
    rest = np.pi / 2 - half_angle  # cos alpha = sin rest goes to zero with pi - 2 alpha = 2 rest
    return 2 * (np.pi + 2 * half_angle) / (np.pi**2 * _sinc(rest))


def elliptic_torque_ratio(half_angle: Values) -> Values:
    """T* [1] of the pressure sqrt(1 - (theta/alpha)^2): alpha / (2 J1(alpha)). Colbert et al. (2009), section 3.

    `half_angle` alpha is half of the arc of contact, 0 to pi/2. [rad]
    """
    require_between(0.0, np.pi / 2, half_angle=half_angle)
    return 1 / hyp0f1(2.0, -(half_angle**2) / 4)  # 2 J1(x) / x


def truncated_cosine_torque_ratio(half_angle: Values) -> Values:
    """T* [1] of the pressure cos theta cut off at the arc: sin a / (a/2 + sin(2a)/4), 4/pi at 90 degrees.

    `half_angle` a is half of the arc of contact, 0 to pi/2. [rad]
    """
    require_between(0.0, np.pi / 2, half_angle=half_angle)
    return 2 * _sinc(half_angle) / (1 + _sinc(2 * half_angle))


def thin_winkler_torque_ratio(half_angle: Values) -> Values:
    """mu* [1] of a Winkler bushing with a thin clearance: 2 (sin a - a cos a) / (a - sin a cos a).

    Colbert et al. (2009), B1 to B10, as Rs/c goes to infinity: the pressure is cos theta - cos a. `half_angle` a is half of
    the arc of contact, 0 to pi/2 [rad]; `thin_winkler_load` gives the load that belongs to it.
    """
    require_between(0.0, np.pi / 2, half_angle=half_angle)
    small = (half_angle < 0.03) * 1  # both brackets vanish as a^3: their series there
    series = (1 - half_angle**2 / 10 + half_angle**4 / 280) / (
        1 - half_angle**2 / 5 + 2 * half_angle**4 / 105
    )
    a = half_angle + small
    closed = 2 * (np.sin(a) - a * np.cos(a)) / (a - np.sin(a) * np.cos(a))
    return small * series + (1 - small) * closed


def thin_winkler_load(half_angle: Values) -> Values:
    """F* t* R/c [1] that wraps a thin-clearance Winkler bushing to a half angle: (a - sin a cos a) / cos a.

    `half_angle` a is half of the arc of contact, 0 to below pi/2 [rad]. See `thin_winkler_torque_ratio`.
    """
    require_between(0.0, np.pi / 2, half_angle=half_angle)
    return (half_angle - np.sin(half_angle) * np.cos(half_angle)) / np.cos(half_angle)


def torque_ratio(angle: Values, *, pressure: Values) -> Values:
    """T* [1] of any pressure distribution: int P / int P cos theta. Colbert et al. (2009), eq. 4.

    Parameters
    ----------
    angle : array, (..., n)
        Angles from the line of load, rising, spanning the contact. [rad]
    pressure : array, (..., n)
        Pressure there, in any unit.

    Raises
    ------
    ModelError
        A pressure that is negative or carries no load.
    """
    require_not_negative(pressure=pressure)
    carried = np.trapezoid(pressure * np.cos(angle), angle, axis=-1)
    require_positive(pressure=carried)
    return np.trapezoid(pressure, angle, axis=-1) / carried


@dataclass(frozen=True)
class ReversalFriction:
    """Friction from a motion that goes both ways."""

    friction: float
    """Apparent coefficient mu', the mean of the two directions. [1]"""
    offset: float
    """Torque over load and radius that does not reverse: a misaligned load cell. [1]"""
    standard_error: float
    """Of `friction`, from the scatter of the samples taken as independent. [1]"""


def average_reversals(
    torque: Values, *, load: Values, radius: float, direction: Values
) -> ReversalFriction:
    """Friction coefficient from a torque measured in both directions, free of a constant offset.

    Parameters
    ----------
    torque : array, (n,)
        Signed torque about the shaft. [N m]
    load : float or array, (n,)
        Magnitude of the load, the vector sum of its components. [N]
    radius : float
        Radius of the shaft. [m]
    direction : array, (n,)
        Sign of the rotation; samples at 0 are left out.

    Raises
    ------
    ModelError
        Fewer than two samples in a direction.

    Notes
    -----
    Colbert et al. (2009), section 2: a small angle between load cell and contact adds a torque that does not change sign
    on reversal; half of the difference of the two directions is free of it.
    """
    ratio = np.asarray(friction_coefficient(torque, load=load, radius=radius), float)
    forward, backward = ratio[np.asarray(direction) > 0], ratio[np.asarray(direction) < 0]
    if forward.size < 2 or backward.size < 2:
        raise ModelError(
            f"direction must hold at least two samples each way, got {forward.size} forward, {backward.size} backward."
        )
    return ReversalFriction(
        friction=float(forward.mean() - backward.mean()) / 2,
        offset=float(forward.mean() + backward.mean()) / 2,
        standard_error=float(np.hypot(stats.sem(forward), stats.sem(backward))) / 2,
    )


@dataclass(frozen=True)
class LoadStage:
    """One stage of constant load in an endurance test."""

    number: int
    """Counted from 1."""
    start: float
    """[s]"""
    end: float
    """[s]"""
    load: float
    """Mean. [N]"""
    friction: float
    """Median. [1]"""
    friction_spread: float
    """Standard deviation that the median absolute deviation stands for. [1]"""
    temperature: float
    """Mean. [K]"""


@dataclass(frozen=True)
class Galling:
    """A jump in friction and how sure it is."""

    time: float
    """First sample after the jump. [s]"""
    earliest: float
    """Of the interval that holds the jump with 95 % probability. [s]"""
    latest: float
    """Of that interval. [s]"""
    p_value: float
    """Probability of so marked a jump somewhere in a record without one."""
    stage: int
    """Number of the load stage in which it falls."""
    friction_before: float
    """Median. [1]"""
    friction_after: float
    """Median. [1]"""
    temperature_before: float
    """Mean. [K]"""
    temperature_after: float
    """Mean. [K]"""


@dataclass(frozen=True)
class EnduranceTest:
    """Stages of an endurance test and its end."""

    stages: tuple[LoadStage, ...]
    galling: Galling | None
    """None where no jump in friction is significant."""


def analyse_endurance(
    time: Values,
    *,
    load: Values,
    torque: Values,
    temperature: Values,
    radius: float,
    load_step: float,
    torque_ratio: float = 1.0,
    least_load: float = 0.0,
    least_duration: float = 30.0,
    least_rise: float = 1.2,
    significance: float = 0.01,
) -> EnduranceTest:
    """Find friction and temperature of each load stage and the onset of galling. Farzaneh (2002), chapter 4.

    Parameters
    ----------
    time, load, torque, temperature : array, (n,)
        Log of the test: rising time [s], load [N], size of the friction torque [N m], temperature [K]. One sample per
        oscillation or more, the torque averaged over reversals.
    radius : float
        Radius of the pin. [m]
    load_step : float
        Rise of the load between stages (4,000 lbf in the source); changes of more than half of it end a stage. [N]
    torque_ratio : float
        T* of the pressure distribution. [1]
    least_load : float
        Loads up to this count as unloaded and belong to no stage. [N]
    least_duration : float
        Shorter stretches (a load being raised) are no stage. [s]
    least_rise : float
        Median friction after over before that makes a jump galling; the source saw 0.15 become 0.27. [1]
    significance : float
        Largest probability of a false alarm.

    Returns
    -------
    EnduranceTest
        The stages, and the galling or None.

    Raises
    ------
    ModelError
        Columns of different length, values that are missing, time that does not rise, or no stage at all.

    Notes
    -----
    Galling announces itself by a sudden rise of friction. The jump is put where two constant levels leave the least sum
    of squares; Mann and Whitney's rank test across it, times the number of places it could have been, bounds the
    probability of a false alarm; the interval of its time is that of the posterior of two levels in Gaussian noise of
    unknown size. Samples are taken as independent: thin out a log that is sampled faster than friction fluctuates.
    """
    columns = {"time": time, "load": load, "torque": torque, "temperature": temperature}
    t, force, moment, heat = (np.asarray(column, float) for column in columns.values())
    if not t.ndim == 1 or not t.shape == force.shape == moment.shape == heat.shape:
        raise ModelError(
            f"time, load, torque and temperature must be columns of one length, got {t.shape} for time."
        )
    for name, column in columns.items():
        if not np.all(np.isfinite(np.asarray(column, float))):
            raise ModelError(f"{name} must hold no missing values.")
    if np.any(np.diff(t) <= 0):
        raise ModelError("time must rise from sample to sample.")
    require_positive(load_step=load_step, radius=radius, torque_ratio=torque_ratio)

    stretches = [
        stretch
        for stretch in _stretches(force, load_step / 2, least_load)
        if t[stretch[-1]] - t[stretch[0]] >= least_duration
    ]
    if not stretches:
        raise ModelError(
            f"load must hold at least one stage of {least_duration:g} s above {least_load:g} N."
        )
    kept = np.concatenate(stretches)
    number = np.concatenate(
        [np.full(stretch.size, i) for i, stretch in enumerate(stretches, start=1)]
    )
    friction = friction_coefficient(
        moment[kept], load=force[kept], radius=radius, torque_ratio=torque_ratio
    )
    stages = tuple(
        LoadStage(
            number=i,
            start=float(t[stretch[0]]),
            end=float(t[stretch[-1]]),
            load=float(force[stretch].mean()),
            friction=float(np.median(friction[number == i])),
            friction_spread=float(
                stats.median_abs_deviation(friction[number == i], scale="normal")
            ),
            temperature=float(heat[stretch].mean()),
        )
        for i, stretch in enumerate(stretches, start=1)
    )
    return EnduranceTest(
        stages, _find_galling(t[kept], friction, heat[kept], number, least_rise, significance)
    )


def _stretches(load: Values, tolerance: float, least_load: float) -> list[Values]:
    """Indices of each stretch in which the load stays within the tolerance of its own running mean."""
    stretches: list[list[int]] = []
    mean = np.nan
    for i, value in enumerate(load):
        if value <= least_load:
            mean = np.nan
        elif abs(value - mean) <= tolerance:
            stretches[-1].append(i)
            mean += (value - mean) / len(stretches[-1])
        else:
            stretches.append([i])
            mean = value
    return [np.array(stretch) for stretch in stretches]


def _find_galling(
    time: Values,
    friction: Values,
    temperature: Values,
    stage: Values,
    least_rise: float,
    significance: float,
) -> Galling | None:
    """The jump between two levels of friction that leaves the least sum of squares, if it is galling."""
    n = friction.size
    if n < 4:
        return None
    before = np.arange(1, n)  # samples before the jump
    centred = friction - friction.mean()
    first = np.cumsum(centred)[:-1]
    explained = first**2 / before + first**2 / (n - before)
    left = np.maximum(np.sum(centred**2) - explained, np.finfo(float).tiny)
    jump = int(np.argmin(left)) + 1

    low, high = friction[:jump], friction[jump:]
    p_value = min(1.0, (n - 1) * float(stats.mannwhitneyu(high, low, alternative="greater").pvalue))
    if p_value > significance or np.median(high) < least_rise * np.median(low):
        return None
    log_posterior = -0.5 * (n - 2) * np.log(left / left.min()) - 0.5 * np.log(before * (n - before))
    posterior = np.exp(log_posterior - log_posterior.max())
    cumulative = np.cumsum(posterior) / posterior.sum()
    return Galling(
        time=float(time[jump]),
        earliest=float(time[int(np.searchsorted(cumulative, 0.025)) + 1]),
        latest=float(time[min(int(np.searchsorted(cumulative, 0.975)), n - 2) + 1]),
        p_value=p_value,
        stage=int(stage[jump]),
        friction_before=float(np.median(low)),
        friction_after=float(np.median(high)),
        temperature_before=float(temperature[:jump].mean()),
        temperature_after=float(temperature[jump:].mean()),
    )


def _sinc(x: Values) -> Values:
    """sin(x)/x, 1 at zero."""
    safe = x + (x == 0)
    return np.sin(safe) / safe * (x != 0) + (x == 0)
