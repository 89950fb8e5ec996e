"""The difference of two runs with its error, and tests of many differences at once.

Maps are compared cell by cell: where they differ by more than chance.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import xarray as xr

from erlif.calibration import calibration_of
from erlif.core.arrays import Array, Mask
from erlif.core.described import describe
from erlif.core.errors import ErlifError
from erlif.io.files import describe_trigger, settings_of
from erlif.review.comparison.calibrations import RunErrors, difference_var, largest_term
from erlif.review.comparison.cells import average_cells, cell_edges
from erlif.review.comparison.records import REPEATING, RunRecord

_FULL_TURN = 360.0  # degree
_REACH = 1.5  # median distances of triggers between which a film is interpolated
_LEAST_COMMON = 3


@dataclass(frozen=True)
class PairDifference:
    """Second run less first, of one film statistic.

    Attributes
    ----------
    value : float
        Mean over the common triggers; NaN where there is none. [um]
    std : float
        Its standard deviation. [um]
    own_std : float
        The part of it without the calibration. [um]
    changed_std : float
        The rest: what the two calibrations, and the rig in both runs, have not in common. [um]
    largest : str
        The term of `erlif.core.terms.SOURCES` that is most of `changed_std`.
    probability : float
        Of such a difference, or a larger one, by chance.
    at : Array
        Difference at each common angle, (angle,). [um]
    at_std : Array
        Its standard deviation, (angle,). [um]
    """

    value: float
    std: float
    own_std: float
    changed_std: float
    largest: str
    probability: float
    at: Array
    at_std: Array


def common_angles(records: list[RunRecord]) -> Array:
    """Crank angles of the first run that lie between triggers of all runs; else trigger numbers.

    Parameters
    ----------
    records : list of RunRecord

    Returns
    -------
    array, (angle,)
        [degree], or numbers of triggers where the runs have no crank angle.

    Raises
    ------
    ErlifError
        If fewer than three are common, or runs without crank angle have other numbers of triggers.

    Examples
    --------
    >>> from erlif.review.comparison import read_run
    >>> from erlif.show.plots import example_film
    >>> record = read_run(example_film())
    >>> common_angles([record, record]).tolist()
    [250.0, 290.0, 330.0, 70.0, 110.0, 150.0]
    """
    first = records[0]
    if not first.by_angle:
        counts = sorted({record.angle.size for record in records})
        if len(counts) > 1:
            raise ErlifError(
                "Expected runs with one number of triggers, as they have no crank angle; they have "
                f"{' and '.join(map(str, counts))}. Compare runs of the same length."
            )
        return first.angle

    near = np.all([weights(record.angle, first.angle)[0] for record in records], axis=0)
    if near.sum() < _LEAST_COMMON:
        ranges = "; ".join(
            f"{one.name} {np.min(one.angle):.1f} to {np.max(one.angle):.1f}" for one in records
        )
        raise ErlifError(
            f"Expected runs with {_LEAST_COMMON} common crank angles or more; there are "
            f"{int(near.sum())} (degree: {ranges}). Compare runs with triggers at the same angles."
        )
    return first.angle[near]


def weights(angle: Array, goal: Array) -> tuple[Mask, Array]:
    """Weights with which the triggers of a run give its film at other angles.

    Between two triggers the film is interpolated linearly.

    Parameters
    ----------
    angle : array, (trigger,)
        Crank angles of the run. [degree]
    goal : array, (angle,)
        Angles at which the film is wanted. [degree]

    Returns
    -------
    near : array of bool, (angle,)
        Whether an angle lies between neighbouring triggers, or at one.
    weights : array, (angle, trigger)
        Rows sum to 1.

    Examples
    --------
    >>> near, found = weights(np.array([350.0, 0.0, 10.0]), np.array([355.0, 10.0, 100.0]))
    >>> near.tolist(), found[:2].tolist()
    ([True, True, False], [[0.5, 0.5, 0.0], [0.0, 0.0, 1.0]])
    """
    # each angle between the next smaller and the next larger one on the circle
    order = np.argsort(angle % _FULL_TURN)
    sorted_angle = (angle % _FULL_TURN)[order]
    steps = np.diff(np.append(sorted_angle, sorted_angle[0] + _FULL_TURN))
    reach = _REACH * float(np.median(steps))
    place = (np.searchsorted(sorted_angle, goal % _FULL_TURN + 1e-9, side="right") - 1) % angle.size
    beyond = (goal - sorted_angle[place]) % _FULL_TURN
    beyond = np.where(beyond > _FULL_TURN - 1e-6, 0.0, beyond)  # rounding
    share = np.where(steps[place] > 0, beyond / np.where(steps[place] > 0, steps[place], 1), 0.0)

    # at a trigger itself no neighbour is needed
    exact = beyond < 1e-6
    share = np.where(exact, 0.0, share)
    shares = np.zeros((goal.size, angle.size))
    rows = np.arange(goal.size)
    shares[rows, order[place]] += 1 - share
    shares[rows, order[(place + 1) % angle.size]] += share
    return exact | (steps[place] <= reach), shares


def average_difference(
    one: RunRecord, other: RunRecord, statistic: str, *, angle: Array
) -> PairDifference:
    """Difference of a film statistic of two runs, mean over common angles.

    Errors of one calibration that both runs share cancel as far as the films are equal; those of
    two calibrations add. What repeats within a run, such as marks, is not averaged away by many
    triggers.

    Parameters
    ----------
    one, other : RunRecord
        The difference is `other` less `one`.
    statistic : str
        "film_min" or "film_mean".
    angle : array, (angle,)
        As `common_angles` returns it.

    Returns
    -------
    PairDifference

    Examples
    --------
    >>> from dataclasses import replace
    >>> from erlif.review.comparison import read_run
    >>> from erlif.show.plots import example_film
    >>> one = read_run(example_film())
    >>> thicker = {name: film + 0.5 for name, film in one.value.items()}
    >>> found = average_difference(one, replace(one, value=thicker), "film_min", angle=one.angle)
    >>> round(found.value, 6), found.probability < 1e-6
    (0.5, True)
    """
    parts = [_at_angles(record, statistic, angle) for record in (one, other)]
    (v1, own1, g1), (v2, own2, g2) = parts
    at = v2 - v1
    use = np.isfinite(at) & np.isfinite(own1) & np.isfinite(own2)
    errors = one.errors, other.errors
    at_std = np.sqrt(own1**2 + own2**2 + difference_var(g1, g2, errors))
    if not use.any():
        nothing = math.nan
        return PairDifference(nothing, nothing, nothing, nothing, "", nothing, at, at_std)

    # the mean over angles: what is new at every trigger averages, what repeats does not
    count, repeating = int(use.sum()), REPEATING[statistic]
    own_var = sum(
        (1 - repeating) * float((own[use] ** 2).sum()) / count**2
        + repeating * float(own[use].mean()) ** 2
        for own in (own1, own2)
    )
    means = g1[use].mean(axis=0), g2[use].mean(axis=0)
    shared, largest = float(difference_var(*means, errors)), largest_term(*means, errors)
    value, std = float(at[use].mean()), math.sqrt(own_var + shared)
    probability = math.erfc(abs(value) / std / math.sqrt(2)) if std > 0 else float(value == 0)
    return PairDifference(
        value, std, math.sqrt(own_var), math.sqrt(shared), largest, probability, at, at_std
    )


def _at_angles(record: RunRecord, statistic: str, angle: Array) -> tuple[Array, Array, Array]:
    """Film, own standard deviation and gradient of a run at common angles."""
    value, own = record.value[statistic], record.own_std[statistic]
    gradient = record.gradient[statistic]
    if not record.by_angle:
        return value, own, gradient
    _, share = weights(record.angle, angle)
    # a trigger without a film counts only where it has a weight
    lost = (share > 0) @ ~np.isfinite(value + own) > 0
    known = [np.nan_to_num(each) for each in (value, own, gradient)]
    values = [share @ each for each in known]
    return np.where(lost, np.nan, values[0]), values[1], values[2]


def correct_for_many(probability: Array) -> Array:
    """Correct probabilities of several tests for their number, after Holm (1979).

    Parameters
    ----------
    probability : array, (test,)
        Probability of each by chance; NaN for no test.

    Returns
    -------
    array, (test,)
        With a limit of 5 % on these, all the tests together give a false alarm in 5 % of the
        comparisons at most, whatever their correlation.

    Examples
    --------
    >>> correct_for_many(np.array([0.01, 0.04, 0.03])).round(3).tolist()
    [0.03, 0.06, 0.06]
    """
    corrected = np.full(probability.shape, np.nan)
    tested = np.flatnonzero(np.isfinite(probability))
    order = tested[np.argsort(probability[tested], kind="stable")]
    factor = tested.size - np.arange(tested.size)
    corrected[order] = np.minimum(np.maximum.accumulate(factor * probability[order]), 1.0)
    return corrected


# Expected share of cells that do not differ, among those stated to differ.
FALSE_DISCOVERIES = 0.05


def difference_map(
    one: xr.Dataset, other: xr.Dataset, *, triggers: tuple[int, int], drift: float = 0.0
) -> xr.Dataset:
    """Subtract the map of a trigger of one film from that of another one, cell by cell.

    Cells have 8 x 8 pixels of the coarser camera and are placed by the positions from the first
    pixel of each image; nothing is interpolated. The errors of one calibration cancel as far as the
    films are equal, those of two add.

    Parameters
    ----------
    one, other : xarray.Dataset
        Films; the difference is `other` less `one`.
    triggers : (int, int)
        Number of the trigger of each film.
    drift : float
        Change of the ratio between calibrations of the rig from day to day. [1]

    Returns
    -------
    xarray.Dataset
        On (y, x): difference, difference_std [um]; significance, their ratio; differs, 1 where the
        difference is significant with 5 % of false discoveries (Benjamini and Hochberg 1995).

    Raises
    ------
    ErlifError
        If the axes of the images lie along other directions, or the images hardly overlap.

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> film = example_film()
    >>> found = difference_map(film, film.assign(thickness=film.thickness + 0.5), triggers=(0, 0))
    >>> float(found.difference.mean().round(2)), int(found.differs.sum())
    (0.5, 24)
    """
    if settings_of(one).optics.x_axis != settings_of(other).optics.x_axis:
        raise ErlifError(
            "Expected images whose x lies along the same direction; x_axis in [optics] differs. "
            "Compare the film statistics alone, or runs of one camera."
        )
    edges = {axis: cell_edges([one, other], axis) for axis in ("x", "y")}
    calibrations = calibration_of(one, triggers[0]), calibration_of(other, triggers[1])
    a, b = (
        average_cells(film, trigger, calibration, edges)
        for film, trigger, calibration in zip((one, other), triggers, calibrations, strict=True)
    )
    errors = (
        RunErrors.of(one, calibrations[0], drift=drift),
        RunErrors.of(other, calibrations[1], drift=drift),
    )
    shared = difference_var(a.gradient, b.gradient, errors)

    difference = b.film - a.film
    std = np.where(np.isfinite(difference), np.sqrt(a.own_var + b.own_var + shared), np.nan)
    significance = difference / std
    dims = ("y", "x")
    described = [describe_trigger(film, k) for film, k in zip((one, other), triggers, strict=True)]
    mapped = describe(
        {
            "difference": (dims, difference, "um", ""),
            "difference_std": (dims, std, "um", ""),
            "significance": (dims, significance, "1", ""),
            "differs": (dims, _significant(significance), "1", ""),
        },
        {axis: (axis, 0.5 * (edge[1:] + edge[:-1]), "mm", "") for axis, edge in edges.items()},
    )
    return mapped.assign_attrs(
        first=described[0],
        second=described[1],
        first_trigger=triggers[0],
        second_trigger=triggers[1],
        same_calibration=int(errors[0].fixture == errors[1].fixture),
    )


def _significant(significance: Array) -> npt.NDArray[np.uint8]:
    """Mark the cells in which a difference is significant, controlling false discoveries."""
    signs = np.zeros(significance.shape, np.uint8)
    known = np.isfinite(significance)
    if known.any():
        import scipy.stats

        probability = 2 * scipy.stats.norm.sf(np.abs(significance[known]))
        corrected = scipy.stats.false_discovery_control(probability)
        signs[known] = corrected < FALSE_DISCOVERIES
    return signs
