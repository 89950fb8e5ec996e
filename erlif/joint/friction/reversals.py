"""Friction of a bushing from a torque log with reversals: pair by pair, with its error by cause."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray as xr
from scipy.optimize import brentq
from scipy.special import stdtr, stdtrit

from erlif.core.arrays import Array
from erlif.core.errors import EnduranceError
from erlif.core.tables import fill_template
from erlif.io.conversion import table_csv
from erlif.io.files import write_file
from erlif.joint.friction.coefficient import doubt_friction, require_option, torque_of
from erlif.joint.friction.stretches import Stretch, find_stretches, variation_within
from erlif.joint.models.friction import friction_coefficient

# Correlations of neighbours that are tried, and a prior by which the intervals of 30 pairs hold
# their share for friction without correlation and for that over a sixth of the log alike.
_CORRELATIONS, _PRIOR = np.array([0.0, 0.5, 0.97]), np.array([0.76, 0.19, 0.05])
_VALUES = 40  # more of them are averaged in blocks
_FEWEST = 4  # values from which on a straight line is taken off
_LEVELS = (0.682689, 0.95)

# Independent values below which the log hardly determines its mean, and pairs below which it does
# not show whether friction wanders: the intervals then hold less than their share.
FEW_INDEPENDENT, FEW_PAIRS = 4.0, 15

# Variation of the torque within a stretch from which it is stated that there is no level.
LARGE_VARIATION = 0.2

_MOST_DIGITS = 8  # of a coefficient
_NORMAL = 1.959964  # standard deviations of 95 %, for the errors that all pairs share


@dataclass(frozen=True)
class Spread:
    """Half widths of intervals about an estimate.

    Attributes
    ----------
    std : float
        Half width of the interval of 68 %, with Student's factor.
    wide : float
        Half width of that of 95 %; more than 1.96 `std` where few values are independent.
    independent : float
        Number of independent values with the error of the estimate. [1]
    """

    std: float
    wide: float
    independent: float


def spread_of_line(time: Array, values: Array) -> tuple[Spread, Spread]:
    """Compute the errors of the mean and of the change of a correlated series.

    Parameters
    ----------
    time : array, (n,)
        Times, rising. [s]
    values : array, (n,)
        Two values or more. [any unit]

    Returns
    -------
    tuple of Spread
        Of the mean, and of the change from the first to the last value by a straight line by least
        squares; NaN for the change of two values.

    Examples
    --------
    Ten values whose sign changes every second one are not correlated over the series:

    >>> mean, change = spread_of_line(np.arange(10.0), np.tile([1.0, -1.0], 5))
    >>> 0.3 < mean.std < 0.6 < mean.wide
    True
    """
    blocks = min(values.size, _VALUES)
    time = np.array([part.mean() for part in np.array_split(time, blocks)])
    values = np.array([part.mean() for part in np.array_split(values, blocks)])
    away = (time - time.mean()) / (time[-1] - time[0])

    mean = np.full(blocks, 1 / blocks)
    line = np.column_stack([np.ones(blocks), away])
    found = _spread(time, values, line if blocks >= _FEWEST else line[:, :1], mean)
    if blocks < 3:
        return found, Spread(np.nan, np.nan, np.nan)
    return found, _spread(time, values, line, away / (away @ away))


def _spread(time: Array, values: Array, design: Array, estimate: Array) -> Spread:
    """Half widths for the sum of the values with the weights `estimate`."""
    size, unknowns = design.shape
    apart = np.abs(time[:, None] - time) / np.median(np.diff(time))
    correlation = _CORRELATIONS[:, None, None] ** apart

    # restricted likelihood of each correlation, free of mean and slope
    inverse = np.linalg.inv(correlation)
    seen = inverse @ design
    normal = np.swapaxes(design.T @ seen, 1, 2)
    left = values - design @ np.linalg.lstsq(design, values, rcond=None)[0]
    moved = np.linalg.solve(normal, (left @ seen)[..., None])[..., 0]
    residual = left @ inverse @ left - np.sum(moved * (left @ seen), axis=1)
    residual = np.maximum(residual, (1e-14 * np.max(np.abs(values))) ** 2 + 1e-300)
    free = size - unknowns
    chance = np.log(_PRIOR) - 0.5 * free * np.log(residual)
    chance -= 0.5 * (np.linalg.slogdet(correlation)[1] + np.linalg.slogdet(normal)[1])
    weight = np.exp(chance - chance.max())
    weight /= weight.sum()

    # each correlation gives a distribution of Student; the sum of them has the wanted share
    variance = estimate @ correlation @ estimate
    scale = np.sqrt(residual / free * variance)
    independent = float(1 / (weight @ variance))

    def half_width(level: float) -> float:
        tail = 0.5 * (1 - level)
        largest = float(scale.max() * stdtrit(free, 1 - tail))
        return float(
            brentq(lambda half: float(weight @ stdtr(free, -half / scale)) - tail, 0, 2 * largest)
        )

    return Spread(half_width(_LEVELS[0]), half_width(_LEVELS[1]), independent)


@dataclass(frozen=True)
class ReversalSeries:
    """Apparent friction coefficient of a torque log with reversals.

    Attributes
    ----------
    pairs : xarray.Dataset
        Over ``time`` [s], the middle of each pair of stretches: friction [1], friction_std [1]
        (scatter alone), offset [1], load [N], dwell [s] that is left out, and sliding_distance [m]
        where the speed is known.
    friction : float
        Mean over the pairs. [1]
    friction_std : float
        Its standard deviation from all causes, half the width of the interval of 68 %. [1]
    budget : dict[str, float]
        Standard deviation by cause: scatter, torque, load, shaft radius. [1]
    trend : float
        Change of the coefficient from the first to the last pair by a straight line. [1]
    trend_std : float
        Standard deviation of `trend`, from the scatter of the pairs about the line. [1]
    friction_interval : tuple[float, float]
        Interval of 95 % of `friction`, wider than 1.96 standard deviations where few pairs are
        independent. [1]
    trend_interval : tuple[float, float]
        Interval of 95 % of `trend`. [1]
    independent : float
        Number of independent values among the pairs: less than these where friction wanders. [1]
    variation : float
        Range of the torque within a stretch over its mean, beyond what the scatter explains. [1]
    """

    pairs: xr.Dataset
    friction: float
    friction_std: float
    budget: dict[str, float]
    trend: float
    trend_std: float
    friction_interval: tuple[float, float]
    trend_interval: tuple[float, float]
    independent: float
    variation: float = 0.0


def analyse_friction(
    log: xr.Dataset,
    *,
    shaft_radius: float,
    arm: float | None = None,
    vector: bool = False,
    speed: float | None = None,
    torque_std: float = 0.0,
    load_std: float = 0.0,
    radius_std: float = 0.0,
) -> ReversalSeries:
    """Compute the apparent friction coefficient of a log whose motion reverses.

    Half the difference of the torques of two neighbouring stretches of opposite direction is free
    of an offset of the cell (Colbert et al. 2009, section 2); each stretch belongs to one pair. An
    offset that drifts would change all pairs alike: its slope between the neighbouring pairs is
    taken off, so that a linear drift cancels.

    Parameters
    ----------
    log : xarray.Dataset
        From `erlif.joint.friction.read_torque_log`: over ``time``, ``cells`` (cell, time) [N], and
        ``torque`` [N m] or ``arm_force`` [N], with the sign of the direction.
    shaft_radius : float
        Radius of the shaft. [m]
    arm : float, optional
        Distance of the cell that carries the torque from the axis, where the log has its force. [m]
    vector : bool
        The cells are components across the shaft, and the load is their vector sum; default: the
        load is their sum.
    speed : float, optional
        Sliding speed, for the sliding distance. [m/s]
    torque_std, load_std, radius_std : float
        Relative standard deviations of the calibrations of torque and load and of the radius, which
        all pairs share. [1]

    Returns
    -------
    ReversalSeries
        Coefficient of each pair and of the whole log, with standard deviations.

    Raises
    ------
    EnduranceError
        If the torque does not reverse or is noise, fewer than two pairs are complete, the arm is
        missing, or a length or the speed is not positive.

    Notes
    -----
    The coefficient is torque over load and radius, mu'. The true one is smaller by the torque ratio
    of the contact, see `erlif.joint.models.friction` and `erlif.joint.models.running_in`. The
    standard deviation of a mean counts the scatter of the pairs about a straight line and its
    correlation over several pairs, not that of the samples.

    Examples
    --------
    A torque of 0.6 N m that reverses each 5 s about an offset of 0.1 N m, at 400 N:

    >>> time = np.arange(0.0, 40.0, 0.1)
    >>> torque = 0.6 * np.where(time % 10 < 5, 1, -1) + 0.1
    >>> log = xr.Dataset(
    ...     {"cells": (("cell", "time"), [np.full(time.size, 400.0)]), "torque": ("time", torque)},
    ...     {"time": time},
    ... )
    >>> found = analyse_friction(log, shaft_radius=0.01, load_std=0.01)
    >>> print(f"{found.friction:.3f} ± {found.friction_std:.4f}, {found.pairs.offset[0]:.3f}")
    0.150 ± 0.0015, 0.025
    """
    require_option(shaft_radius=shaft_radius)
    if speed is not None:
        require_option(speed=speed)
    cells = log["cells"].values
    load = np.sqrt((cells**2).sum(axis=0)) if vector else cells.sum(axis=0)
    time = log["time"].values
    torque = torque_of(log, arm)
    stretches = find_stretches(torque)
    pairs = _pairs(time, torque, load, shaft_radius, stretches).assign_attrs(
        file=log.attrs.get("file", ""), shaft_radius=shaft_radius
    )
    if "torque" not in log:
        pairs.attrs["arm"] = arm
    if speed is not None:
        # half of a pair's own dwell lies before its middle
        rest = np.cumsum(pairs["dwell"].values) - 0.5 * pairs["dwell"].values
        distance = (pairs["time"].values - time[0] - rest) * speed
        pairs["sliding_distance"] = ("time", distance, {"units": "m"})

    at, values = pairs["time"].values, pairs["friction"].values
    mean = float(values.mean())
    of_mean, of_trend = spread_of_line(at, values)
    trend = np.nan  # two pairs have none
    if values.size > 2:
        trend = float(np.polyfit(at, values, 1)[0] * np.ptp(at))
    shares = {"torque": torque_std, "load": load_std, "shaft radius": radius_std}
    budget = {"scatter": of_mean.std, **{name: mean * share for name, share in shares.items()}}
    shared = mean * float(np.linalg.norm([*shares.values()]))
    wide = float(np.hypot(of_mean.wide, _NORMAL * shared))
    return ReversalSeries(
        pairs,
        friction=mean,
        friction_std=float(np.hypot(of_mean.std, shared)),
        budget=budget,
        trend=trend,
        trend_std=of_trend.std,
        friction_interval=(mean - wide, mean + wide),
        trend_interval=(trend - of_trend.wide, trend + of_trend.wide),
        independent=of_mean.independent,
        variation=variation_within(torque, stretches),
    )


def _pairs(
    time: Array, torque: Array, load: Array, radius: float, found: list[Stretch]
) -> xr.Dataset:
    """One value for each two neighbouring stretches of opposite direction."""
    levels = np.array([_level(time, torque, load, one, radius) for one in found]).reshape(-1, 5)
    forward = np.array([one.forward for one in found], dtype=bool)
    firsts: list[int] = []
    # neighbours of one direction are no pair: what lay between them was too short
    for place in np.flatnonzero(np.diff(forward)).tolist():
        if firsts[-1:] != [place - 1]:
            firsts.append(place)
    if len(firsts) < 2:
        raise EnduranceError(
            f"Expected a torque that reverses at least three times; got {len(found)} stretches "
            "of one direction. Log the torque with its sign, over two reversals of the motor and "
            "back; for a motion of one direction take erlif endurance."
        )
    one, other = levels[firsts], levels[np.add(firsts, 1)]
    at, middle, _, carried, rested = (0.5 * (one + other)).T
    apart, difference, *_ = (one - other).T

    # a drift of the offset within a pair adds to one direction what it takes from the other
    sign = np.where(forward[firsts], 1, -1)
    half = 0.5 * (np.abs(difference) - sign * apart * np.gradient(middle, at))
    return xr.Dataset(
        {
            "friction": ("time", half, {"units": "1"}),
            "friction_std": ("time", 0.5 * np.hypot(one[:, 2], other[:, 2]), {"units": "1"}),
            "offset": ("time", middle, {"units": "1"}),
            "load": ("time", carried, {"units": "N"}),
            "dwell": ("time", 2 * rested, {"units": "s"}),
        },
        {"time": ("time", at, {"units": "s"})},
    )


_Level = tuple[float, float, float, float, float]


def _level(time: Array, torque: Array, load: Array, stretch: Stretch, radius: float) -> _Level:
    """Mean time, torque over load and radius with its std, load, and dwell of a stretch. [s, N]"""
    inside = stretch.samples
    if np.any(load[inside] <= 0):
        raise EnduranceError(
            f"Expected a load above 0 during the motion; it is {load[inside].min():.3g} N after "
            f"{time[stretch.first]:.1f} s. Cut the log to the loaded time, or check the sign of "
            "the cells."
        )
    ratio = np.asarray(friction_coefficient(torque[inside], load=load[inside], radius=radius))
    interval = (time[stretch.last] - time[stretch.first]) / (stretch.last - stretch.first)
    dwell = interval * sum(stretch.dwell)
    return time[inside].mean(), ratio.mean(), _std_of_mean(ratio), load[inside].mean(), dwell


def _std_of_mean(values: Array) -> float:
    """With the correlation of the noise, by Bartlett's window of square-root width."""
    away = values - values.mean()
    size = values.size
    width = int(np.sqrt(size))
    variance = float(away @ away) / size
    for lag in range(1, width):
        variance += 2 * (1 - lag / width) * float(away[lag:] @ away[:-lag]) / size
    return float(np.sqrt(max(variance, 0.0) / size))


def describe_friction(found: ReversalSeries, *, torque_ratio: float = 1.0) -> list[str]:
    """Describe the friction of a log in lines of text.

    Parameters
    ----------
    found : ReversalSeries
        From `analyse_friction`.
    torque_ratio : float
        T* of the contact, by which the true coefficient is smaller. [1]

    Returns
    -------
    list of str

    Examples
    --------
    >>> time = np.arange(0.0, 40.0, 0.1)
    >>> torque = 0.6 * np.where(time % 10 < 5, 1, -1)
    >>> log = xr.Dataset(
    ...     {"cells": (("cell", "time"), [np.full(time.size, 400.0)]), "torque": ("time", torque)},
    ...     {"time": time},
    ... )
    >>> found = analyse_friction(log, shaft_radius=0.01, load_std=0.01)
    >>> print(describe_friction(found)[0])
    apparent friction coefficient: 0.1500 ± 0.0015 (4 pairs of stretches)
    """
    known = found.pairs.attrs
    # two digits of the standard deviation
    digits = 4
    if found.friction_std > 0:
        digits = min(max(1 - math.floor(math.log10(found.friction_std)), 4), _MOST_DIGITS)
    text = fill_template(
        "erlif.joint.friction",
        "friction.txt",
        found=found,
        form=f"%.{digits}f",
        radius=1e3 * known["shaft_radius"],
        doubts=doubt_friction(
            found.friction, radius=known.get("shaft_radius"), arm=known.get("arm")
        ),
        # the scatter is measured, even where it is 0
        missing=[name for name, value in found.budget.items() if value == 0 and name != "scatter"],
        offset=float(found.pairs["offset"].mean()),
        offset_torque=float((found.pairs["offset"] * found.pairs["load"]).mean())
        * known["shaft_radius"],
        dwell=float(found.pairs["dwell"].median()) / 2,
        torque_ratio=torque_ratio,
        no_level=found.variation > LARGE_VARIATION,
        few=found.independent < FEW_INDEPENDENT,
        few_pairs=found.pairs.sizes["time"] < FEW_PAIRS,
    )
    return text.splitlines()


def write_friction_table(found: ReversalSeries, output: Path) -> Path:
    """Write one row for each pair of stretches as CSV.

    Parameters
    ----------
    found : ReversalSeries
        From `analyse_friction`.
    output : Path

    Returns
    -------
    Path
        `output`.

    Raises
    ------
    OutputError
        If it cannot be written.

    Examples
    --------
    >>> write_friction_table.__name__
    'write_friction_table'
    """
    columns = [found.pairs["time"], *found.pairs.data_vars.values()]
    text = table_csv(
        {f"{one.name} [{one.attrs['units']}]": one.values for one in columns},
        digits=6,
        missing="nan",
    )
    return write_file(output, text)
